#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/http/listen_address.hpp"
#include "daemon/page/page_access.hpp"

namespace cartvo::daemon {

/// Content of the status page. Called by the server's threads.
class PageContent {
 public:
  virtual ~PageContent() = default;

  /// Properties that do not change while the program runs, as JSON.
  virtual std::string about() = 0;
  /// The newest frame (frameBytes) unless its number is `seen`; nothing: no newer one.
  virtual std::optional<std::string> newestFrame(std::uint64_t seen) = 0;
  /// The stored frame of a replayed pair; nothing: not stored.
  virtual std::optional<std::string> storedFrame(std::uint64_t pair) = 0;
  /// The last minute and the path, as JSON (PageHistory).
  virtual std::string history() = 0;
  /// Cameras, clocks, self-checks, recording, replay, as JSON.
  virtual std::string health() = 0;
  /// Carries out what a button asks for. Returns the reason why it is not done; empty: it is done.
  virtual std::string control(const std::string& action) = 0;
};

/// Who may press the page's buttons.
enum class PageControllers : std::uint8_t { readers, token_holders };

struct PageServerSettings {
  ListenAddress address;
  std::string token;  ///< empty: none
  PageControllers controllers = PageControllers::token_holders;
};

/// Serves the status page over HTTP with threads of low priority: at most four clients at a time, and
/// as many again wait. An answer fits the socket's buffer, so that a client on a slow network keeps no thread
/// waiting. Everyone who reaches a loopback address may read; another address needs the token for everything
/// but the page's own files. See HttpService for the requests that are answered.
class PageServer {
 public:
  /// `content` must outlive the server. Throws std::invalid_argument if the address is not of the loopback
  /// and there is no token, or if the token is too short, and std::runtime_error if it cannot listen.
  PageServer(const PageServerSettings& settings, PageContent& content);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// The page's URL, such as "http://127.0.0.1:9465/".
  std::string url() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::daemon
