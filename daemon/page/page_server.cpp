// HTTP server of the status page: routes, and what each needs.
#include "daemon/page/page_server.hpp"

#include <charconv>
#include <exception>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <sys/socket.h>

#include "common/http/http_service.hpp"
#include "common/threads/thread_priority.hpp"
#include "daemon/page/page_files.hpp"

namespace cartvo::daemon {
namespace {

using httplib::Request, httplib::Response;

constexpr std::size_t kServerThreads = 4;
constexpr int kSendBuffer = 512 * 1024;  // bytes; the operating system may give less
constexpr int kForbidden = 403, kUnauthorized = 401, kTooMany = 429, kNoContent = 204, kNotFound = 404,
              kConflict = 409, kBadRequest = 400;
constexpr const char* kNotFromPage =
    "only the page itself can do this; a proxy must send the browser's Host or X-Forwarded-Host";

PageReaders readersOf(const ListenAddress& address) {
  return address.isLoopback() ? PageReaders::everyone : PageReaders::token_holders;
}

/// A number in the query; `absent` if it is missing or not a number.
std::uint64_t number(const Request& request, const char* name, std::uint64_t absent) {
  const std::string text = request.get_param_value(name);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : absent;
}

/// Whether the page itself sends the request. A proxy names the host that the browser asked in
/// X-Forwarded-Host; another site's page cannot send that header.
bool comesFromPage(const Request& request) {
  const std::string origin = request.get_header_value("Origin");
  return isSameOrigin(origin, request.get_header_value("Host")) ||
         isSameOrigin(origin, request.get_header_value("X-Forwarded-Host"));
}

void answerText(Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text + "\n", kPlainText);
}

/// Begins to serve with threads of low priority. They inherit it from a thread of their own, because a thread
/// that has lowered its priority may not raise it again.
void startWithLowPriority(HttpService& server) {
  std::exception_ptr failure;
  std::thread([&] {
    lowerThreadPriority();
    try {
      server.start();
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

struct PageServer::Implementation {
  Implementation(const PageServerSettings& settings, PageContent& what)
      : content(what),
        access(settings.token, readersOf(settings.address)),
        controllers(settings.controllers),
        server(kServerThreads, HttpLimits{.request_bytes = 8192}) {}

  void route() {
    server.set_default_headers({{"Cache-Control", "no-store"},
                                {"X-Content-Type-Options", "nosniff"},
                                {"X-Frame-Options", "DENY"},
                                {"Referrer-Policy", "same-origin"},
                                {"Cross-Origin-Resource-Policy", "same-origin"},
                                {"Content-Security-Policy",
                                 "default-src 'none'; script-src 'self'; style-src 'self'; connect-src "
                                 "'self'; img-src 'self' data:; "
                                 "form-action 'none'; base-uri 'none'; frame-ancestors 'none'"}});
    for (const PageFile& file : pageFiles()) {
      server.Get(file.path, [&file](const Request&, Response& response) {
        response.set_content(file.content.data(), file.content.size(), file.type);
      });
    }
    server.Get("/about.json", [this](const Request& request, Response& response) {
      response.set_content(about(request), "application/json");
    });
    routeData("/history.json", [this](const Request&, Response& response) {
      response.set_content(content.history(), "application/json");
    });
    routeData("/health.json", [this](const Request&, Response& response) {
      response.set_content(content.health(), "application/json");
    });
    routeData("/frame",
              [this](const Request& request, Response& response) { answerFrame(request, response); });
    server.Post("/login", [this](const Request& request, Response& response) { login(request, response); });
    server.Post("/control",
                [this](const Request& request, Response& response) { control(request, response); });
  }
  void routeData(const char* path, const std::function<void(const Request&, Response&)>& answer) {
    server.Get(path, [this, answer](const Request& request, Response& response) {
      if (!mayRead(request)) return answerText(response, kUnauthorized, "the token is needed");
      answer(request, response);
    });
  }
  void answerFrame(const Request& request, Response& response) const {
    const std::optional<std::string> frame = request.has_param("pair")
                                                 ? content.storedFrame(number(request, "pair", UINT64_MAX))
                                                 : content.newestFrame(number(request, "seen", 0));
    if (frame) return response.set_content(*frame, "application/octet-stream");
    response.status = request.has_param("pair") ? kNotFound : kNoContent;
  }
  void login(const Request& request, Response& response) {
    if (!comesFromPage(request)) return answerText(response, kForbidden, kNotFromPage);
    if (!access.mayTryLogin()) return answerText(response, kTooMany, "too many wrong tokens: wait a minute");
    if (!access.isToken(request.body)) {
      access.addWrongLogin();
      return answerText(response, kUnauthorized, "this is not the token");
    }
    response.set_header("Set-Cookie", access.cookie());
    response.status = kNoContent;
  }
  /// A request with a cookie, or of a page that needs none, must come from the page itself; a program that
  /// sends the token as a header need not say where it comes from.
  void control(const Request& request, Response& response) {
    const bool sends_token = access.isHolder("", request.get_header_value("Authorization"));
    if (!(sends_token && !request.has_header("Origin")) && !comesFromPage(request))
      return answerText(response, kForbidden, kNotFromPage);
    if (!mayControl(request)) return answerText(response, kUnauthorized, "the token is needed");
    constexpr std::size_t kMaxActionBytes = 64;
    if (request.body.empty() || request.body.size() > kMaxActionBytes)
      return answerText(response, kBadRequest, "expected the name of an action");
    const std::string reason = content.control(request.body);
    if (!reason.empty()) return answerText(response, kConflict, reason);
    response.status = kNoContent;
  }
  /// JSON that the page needs before it may read data.
  std::string about(const Request& request) const {
    if (!mayRead(request)) return R"({"login":"needed"})";
    const char* may_control = "no";
    if (mayControl(request)) {
      may_control = "yes";
    } else if (access.hasToken()) {
      may_control = "with_token";
    }
    return fmt::format(R"({{"login":"{}","control":"{}","content":{}}})",
                       isHolder(request) ? "done" : "not_needed", may_control, content.about());
  }
  bool isHolder(const Request& request) const {
    return access.isHolder(request.get_header_value("Cookie"), request.get_header_value("Authorization"));
  }
  bool mayRead(const Request& request) const {
    return access.mayRead(request.get_header_value("Cookie"), request.get_header_value("Authorization"));
  }
  bool mayControl(const Request& request) const {
    return isHolder(request) || (controllers == PageControllers::readers && mayRead(request));
  }

  PageContent& content;
  PageAccess access;
  PageControllers controllers;
  std::string url;
  HttpService server;  ///< last, because its threads use the others
};

PageServer::PageServer(const PageServerSettings& settings, PageContent& content)
    : implementation_(std::make_unique<Implementation>(settings, content)) {
  Implementation& page = *implementation_;
  if (page.access.readers() == PageReaders::token_holders && !page.access.hasToken())
    throw std::invalid_argument("the status page at " + settings.address.text() +
                                " can be reached from other computers: it needs a token");
  page.route();
  page.server.setSendBuffer(kSendBuffer);
  if (page.access.readers() == PageReaders::token_holders) page.server.allowAnyHost();
  const int port = page.server.bind(settings.address);
  if (port < 0)
    throw std::runtime_error("cannot listen at " + settings.address.text() +
                             ": is the port taken, or the address not one of this computer?");
  page.url =
      "http://" + ListenAddress{settings.address.address, static_cast<std::uint16_t>(port)}.text() + "/";
  startWithLowPriority(page.server);
}

PageServer::~PageServer() = default;

std::string PageServer::url() const {
  return implementation_->url;
}

}  // namespace cartvo::daemon
