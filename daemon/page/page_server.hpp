#pragma once

#include <memory>
#include <string>

#include "common/http/listen_address.hpp"
#include "daemon/page/page_access.hpp"
#include "daemon/page/page_content.hpp"

namespace cartvo::daemon {

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
