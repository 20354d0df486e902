#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

// HTTP and HTTPS to a camera, on libcurl. Knows nothing of passwords: the caller sets the Authorization
// header.

namespace cartvo::capture {

constexpr std::uint16_t kHttpPort = 80, kHttpsPort = 443;

/// Where a camera answers HTTP.
struct HttpAddress {
  std::string host;  ///< name or address; IPv6 without brackets, its zone after '%'
  std::uint16_t port = kHttpPort;
  bool tls = false;

  /// "http://host:port"
  std::string url() const;
};

struct HttpRequest {
  std::string method = "GET";  ///< GET or PUT
  std::string path = "/";
  std::string body = {};
  std::vector<std::string> headers = {};  ///< "Name: value"
};

struct HttpResponse {
  int status = 0;
  std::string body;                     ///< at most kMaxResponseBytes
  std::vector<std::string> challenges;  ///< values of the WWW-Authenticate headers
};

constexpr std::size_t kMaxResponseBytes = 1024 * 1024;

/// The camera did not answer as HTTP should. The text names the camera and what to do.
class HttpError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t { unreachable, wrong_key, too_large, interrupted };
  HttpError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// Connection to one camera, kept open between requests. Follows no redirection and uses no proxy. Not
/// thread-safe.
class HttpConnection {
 public:
  /// `timeout`: limit for each request.
  HttpConnection(HttpAddress address, std::chrono::milliseconds timeout);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  /// Ends requests early, within about a second, once it is true. Must outlive the connection.
  void setInterruption(const std::atomic<bool>& interrupted);

  /// Key that the camera's certificate must have, as `fetchKey` returns it. Without it no request goes over
  /// TLS.
  void setKey(const std::string& key);

  /// Public key of the camera's certificate, "sha256//BASE64" of its SubjectPublicKeyInfo (RFC 7469). Sends
  /// no request. Throws HttpError.
  std::string fetchKey();

  /// Throws HttpError.
  HttpResponse send(const HttpRequest& request);

  const HttpAddress& address() const { return address_; }

 private:
  struct Handle;

  HttpAddress address_;
  std::chrono::milliseconds timeout_;
  std::string key_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace cartvo::capture
