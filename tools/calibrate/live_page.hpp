#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/board_spec.hpp"
#include "tools/calibrate/stream_views.hpp"

namespace cartvo {

/// Where a page is served.
struct PageAddress {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8600;  ///< 0: one that is free

  /// PORT or ADDRESS:PORT, the address in numbers (an IPv6 one in brackets). Throws std::invalid_argument
  /// naming the text.
  static PageAddress parse(const std::string& text);

  bool isLoopback() const;
};

/// A page to look at while views are taken: both pictures with the corners found, where corners are missing,
/// the views taken and rejected, what to show next, and in the end the verdict. A browser asks for it five
/// times a second. It can only be looked at: nothing is changed through it, and no address or password of a
/// camera is on it.
///
/// Requests are answered by threads of its own; only those that name the server by its number or as
/// localhost, so that no other site can have a browser read it.
class LivePage {
 public:
  /// Serves from now on. Throws std::runtime_error if the address cannot be listened on.
  LivePage(const PageAddress& address, const BoardSpec& board);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// Such as "http://127.0.0.1:8600/".
  std::string url() const;

  void show(const StreamProgress& progress);

  /// The taking of views is over, and the rig is being solved.
  void showSolving();

  /// The verdict in words; waits, for two seconds at most, until who was looking has seen it.
  void showResult(bool passed, const std::string& text);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
