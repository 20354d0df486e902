#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "calib/board/board_spec.hpp"
#include "common/http/listen_address.hpp"
#include "tools/calibrate/views/stream_views.hpp"

namespace cartvo {

constexpr std::uint16_t kDefaultPagePort = 8600;

/// Web page that shows a live calibration: both pictures with the corners found, the cells without corners,
/// the views taken and rejected, advice on the next view, and finally the result. A browser polls it five
/// times a second. The page is read-only, and does not contain addresses or passwords of the cameras.
///
/// The server has threads of its own. It answers only requests whose Host header is a numeric address or
/// localhost, so that no other site can make a browser read the page.
class LivePage {
 public:
  /// Starts the server. Throws std::runtime_error if it cannot listen at the address.
  LivePage(const ListenAddress& address, const calib::BoardSpec& board);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// The page's URL, such as "http://127.0.0.1:8600/".
  std::string url() const;

  /// Shows the progress of the collection of views.
  void show(const StreamProgress& progress);

  /// Shows that the collection is complete and the rig is being computed.
  void showSolving();

  /// Shows the result. Waits up to two seconds until a browser that is polling has read it.
  void showResult(bool passed, const std::string& text);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
