// Token, cookie and origin of requests to the status page.
#include "daemon/page/page_access.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

namespace cartvo::daemon {
namespace {

constexpr int kMaxWrongLogins = 10;  // a minute
constexpr std::string_view kCookieName = "cartvo_page=";

/// HMAC-SHA256 as hexadecimal text.
std::string digest(const std::string& key, std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned int size = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), bytes.data(), &size);
  std::string hexadecimal;
  for (unsigned int i = 0; i < size; ++i)
    hexadecimal += fmt::format("{:02x}", bytes[i]);
  return hexadecimal;
}

bool areEqual(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

/// The value of the page's cookie in a header Cookie; empty: none.
std::string_view cookieIn(std::string_view cookies) {
  while (!cookies.empty()) {
    const std::size_t end = cookies.find(';');
    std::string_view one = cookies.substr(0, end);
    while (one.starts_with(' '))
      one.remove_prefix(1);
    if (one.starts_with(kCookieName)) return one.substr(kCookieName.size());
    cookies = end == std::string_view::npos ? std::string_view() : cookies.substr(end + 1);
  }
  return {};
}

}  // namespace

PageAccess::PageAccess(const std::string& token, PageReaders readers) : readers_(readers) {
  if (token.empty()) return;
  if (token.size() < kMinTokenBytes)
    throw std::invalid_argument(fmt::format(
        "the page's token has {} characters: expected at least {}; 'openssl rand -hex 16' makes one",
        token.size(), kMinTokenBytes));
  token_digest_ = digest(token, "token");
  cookie_digest_ = digest(token, "cookie");
}

bool PageAccess::isToken(const std::string& token) const {
  return hasToken() && areEqual(digest(token, "token"), token_digest_);
}

bool PageAccess::isHolder(const std::string& cookies, const std::string& authorization) const {
  constexpr std::string_view kBearer = "Bearer ";
  if (!hasToken()) return false;
  if (authorization.starts_with(kBearer)) return isToken(authorization.substr(kBearer.size()));
  return areEqual(cookieIn(cookies), cookie_digest_);
}

bool PageAccess::mayRead(const std::string& cookies, const std::string& authorization) const {
  return readers_ == PageReaders::everyone || isHolder(cookies, authorization);
}

std::string PageAccess::cookie() const {
  constexpr int kDays = 30;
  return fmt::format("{}{}; HttpOnly; SameSite=Strict; Path=/; Max-Age={}", kCookieName, cookie_digest_,
                     kDays * 86400);
}

bool PageAccess::mayTryLogin() {
  const std::lock_guard lock(mutex_);
  if (Clock::now() - minute_ > std::chrono::minutes(1)) {
    minute_ = Clock::now();
    wrong_logins_ = 0;
  }
  return wrong_logins_ < kMaxWrongLogins;
}

void PageAccess::addWrongLogin() {
  const std::lock_guard lock(mutex_);
  ++wrong_logins_;
}

bool isSameOrigin(const std::string& origin, const std::string& host) {
  return !host.empty() && (origin == "http://" + host || origin == "https://" + host);
}

}  // namespace cartvo::daemon
