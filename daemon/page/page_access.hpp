#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>

namespace cartvo::daemon {

/// Who may read the status page.
enum class PageReaders : std::uint8_t {
  everyone,  ///< that reaches the address: the loopback's programs
  token_holders,
};

/// Checks the token of the status page. A browser shows it once and gets a cookie, which does not contain it
/// and stays valid as long as the token. Thread-safe.
class PageAccess {
 public:
  static constexpr std::size_t kMinTokenBytes = 12;

  /// `token`: empty if there is none; then no request holds it. Throws std::invalid_argument if
  /// it is shorter than kMinTokenBytes.
  PageAccess(const std::string& token, PageReaders readers);

  bool hasToken() const { return !token_digest_.empty(); }
  PageReaders readers() const { return readers_; }

  /// Compares in a time that does not depend on the token's bytes.
  bool isToken(const std::string& token) const;
  /// `cookies`: the header Cookie. `authorization`: the header of that name, "Bearer TOKEN".
  bool isHolder(const std::string& cookies, const std::string& authorization) const;
  bool mayRead(const std::string& cookies, const std::string& authorization) const;

  /// Value of the header Set-Cookie for a token's holder.
  std::string cookie() const;

  /// Whether another login may be tried now: ten wrong ones a minute.
  bool mayTryLogin();
  void addWrongLogin();

 private:
  using Clock = std::chrono::steady_clock;

  std::string token_digest_, cookie_digest_;
  PageReaders readers_;
  std::mutex mutex_;
  int wrong_logins_ = 0;        ///< in the current minute
  Clock::time_point minute_{};  ///< its begin
};

/// Whether a request that changes something comes from the page itself: its Origin names the Host that it was
/// sent to, by HTTP or, through a proxy, by HTTPS.
bool isSameOrigin(const std::string& origin, const std::string& host);

}  // namespace cartvo::daemon
