// Digest and Basic authentication of RTSP requests.

#include "capture/rtsp/digest_authentication.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

extern "C" {
#include <libavutil/md5.h>
#include <libavutil/mem.h>
#include <libavutil/sha.h>
}

#include "capture/rtsp/rtsp_message.hpp"
#include "common/ascii_text.hpp"
#include "common/base64.hpp"

namespace cartvo::capture {
namespace {

constexpr std::size_t kMaxChallenges = 16;
constexpr std::string_view kSession = "-SESS";

bool equalIgnoringCase(std::string_view a, std::string_view b) {
  return upperCase(a) == upperCase(b);
}

/// Reads the tokens and quoted strings of a header's value.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : text_(text) {}

  bool isAtEnd() {
    skip(" \t,");
    return text_.empty();
  }
  /// A token (RFC 7230, 3.2.6). At least one character is consumed.
  std::string readToken() {
    std::size_t length = text_.find_first_of(" \t,=\"");
    if (length == 0) length = 1;
    std::string token(text_.substr(0, length));
    text_.remove_prefix(std::min(text_.size(), length));
    return token;
  }
  /// Consumes "=" if it comes next.
  bool readEqualSign() {
    skip(" \t");
    if (text_.empty() || text_.front() != '=') return false;
    text_.remove_prefix(1);
    skip(" \t");
    return true;
  }
  /// A quoted string without its quotes and escapes, or a token that may contain "=".
  std::string readValue() {
    if (text_.empty() || text_.front() != '"') {
      const std::size_t length = text_.find_first_of(" \t,");
      std::string value(text_.substr(0, length));
      text_.remove_prefix(std::min(text_.size(), value.size()));
      return value;
    }
    std::string value;
    std::size_t i = 1;
    for (; i < text_.size() && text_[i] != '"'; ++i) {
      if (text_[i] == '\\' && i + 1 < text_.size()) ++i;
      value += text_[i];
    }
    text_.remove_prefix(std::min(text_.size(), i + 1));
    return value;
  }

 private:
  void skip(const char* characters) {
    text_.remove_prefix(std::min(text_.find_first_not_of(characters), text_.size()));
  }

  std::string_view text_;
};

Challenge beginChallenge(const std::string& scheme) {
  Challenge challenge;
  challenge.name = scheme;
  if (equalIgnoringCase(scheme, "digest")) challenge.scheme = Challenge::Scheme::digest;
  if (equalIgnoringCase(scheme, "basic")) challenge.scheme = Challenge::Scheme::basic;
  return challenge;
}

void setParameter(Challenge& challenge, const std::string& name, std::string value) {
  if (equalIgnoringCase(name, "realm")) {
    challenge.realm = std::move(value);
  } else if (equalIgnoringCase(name, "nonce")) {
    challenge.nonce = std::move(value);
  } else if (equalIgnoringCase(name, "opaque")) {
    challenge.opaque = std::move(value);
    challenge.has_opaque = true;
  } else if (equalIgnoringCase(name, "algorithm")) {
    challenge.name += " " + value;
    challenge.algorithm = std::move(value);
  } else if (equalIgnoringCase(name, "stale")) {
    challenge.stale = equalIgnoringCase(value, "true");
  } else if (equalIgnoringCase(name, "qop")) {
    challenge.has_qop = !value.empty();
    for (HeaderReader qualities(value); !qualities.isAtEnd();)
      challenge.offers_auth |= equalIgnoringCase(qualities.readToken(), "auth");
  }
}

/// The algorithm without -sess, in capitals: "MD5" if the challenge names none.
std::string hashName(const Challenge& challenge) {
  std::string name = upperCase(challenge.algorithm);
  if (name.ends_with(kSession)) name.resize(name.size() - kSession.size());
  return name.empty() ? "MD5" : name;
}

/// Strength of a challenge; 0: it cannot be answered.
int rank(const Challenge& challenge, bool allow_basic) {
  if (challenge.scheme == Challenge::Scheme::basic) return allow_basic ? 1 : 0;
  if (challenge.scheme != Challenge::Scheme::digest || (challenge.has_qop && !challenge.offers_auth))
    return 0;
  const std::string hash = hashName(challenge);
  if (hash == "SHA-256") return 3;
  return hash == "MD5" ? 2 : 0;
}

std::string hexadecimal(const std::uint8_t* bytes, std::size_t size) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < size; ++i)
    text += {kDigits[bytes[i] >> 4], kDigits[bytes[i] & 15]};
  return text;
}

std::string hash(const std::string& algorithm, const std::string& text) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
  if (algorithm == "MD5") {
    std::array<std::uint8_t, 16> digest{};
    av_md5_sum(digest.data(), bytes, text.size());
    return hexadecimal(digest.data(), digest.size());
  }
  const auto release = [](AVSHA* context) { av_free(context); };
  const std::unique_ptr<AVSHA, decltype(release)> context(av_sha_alloc(), release);
  if (!context) throw std::bad_alloc();
  std::array<std::uint8_t, 32> digest{};
  av_sha_init(context.get(), 256);
  av_sha_update(context.get(), bytes, text.size());
  av_sha_final(context.get(), digest.data());
  return hexadecimal(digest.data(), digest.size());
}

std::string inQuotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) result += c;
  }
  return result += '"';
}

std::string randomNonce() {
  std::random_device device;
  std::array<std::uint8_t, 16> bytes{};
  for (std::uint8_t& byte : bytes)
    byte = static_cast<std::uint8_t>(device());
  return hexadecimal(bytes.data(), bytes.size());
}

std::string basicAuthorization(const Credentials& credentials) {
  return "Basic " + encodeBase64(credentials.user + ":" + credentials.password);
}

}  // namespace

std::vector<Challenge> parseChallenges(std::string_view value) {
  std::vector<Challenge> challenges;
  HeaderReader reader(value);
  while (!reader.isAtEnd() && challenges.size() < kMaxChallenges) {
    const std::string token = reader.readToken();
    if (reader.readEqualSign()) {
      std::string parameter = reader.readValue();
      if (!challenges.empty()) setParameter(challenges.back(), token, std::move(parameter));
    } else {
      challenges.push_back(beginChallenge(token));
    }
  }
  return challenges;
}

Authenticator::Outcome Authenticator::accept(const std::vector<Challenge>& challenges, std::string& offered) {
  offered.clear();
  const Challenge* best = nullptr;
  bool offers_basic = false;
  for (const Challenge& challenge : challenges) {
    offered += (offered.empty() ? "" : ", ") + quotedForMessage(challenge.name);
    offers_basic = offers_basic || challenge.scheme == Challenge::Scheme::basic;
    const int strength = rank(challenge, allow_basic_);
    if (strength > 0 && (best == nullptr || strength > rank(*best, allow_basic_))) best = &challenge;
  }
  if (best == nullptr) return offers_basic ? Outcome::basic_only : Outcome::unsupported;
  challenge_ = *best;
  nonce_count_ = 0;
  return Outcome::accepted;
}

std::string Authenticator::authorization(std::string_view method, std::string_view url) {
  if (challenge_->scheme == Challenge::Scheme::basic) return basicAuthorization(credentials_);
  return digestAuthorization(*challenge_, credentials_, method, url, randomNonce(), ++nonce_count_);
}

std::string digestAuthorization(const Challenge& challenge, const Credentials& credentials,
                                std::string_view method, std::string_view url, std::string_view cnonce,
                                std::uint32_t nonce_count) {
  const std::string algorithm = hashName(challenge);
  const bool has_session = upperCase(challenge.algorithm).ends_with(kSession);
  char count[16];
  std::snprintf(count, sizeof count, "%08x", nonce_count);
  const auto joined = [](std::initializer_list<std::string_view> parts) {
    std::string text;
    for (const std::string_view part : parts)
      text.append(part).append(":");
    text.pop_back();
    return text;
  };
  std::string ha1 = hash(algorithm, joined({credentials.user, challenge.realm, credentials.password}));
  if (has_session) ha1 = hash(algorithm, joined({ha1, challenge.nonce, cnonce}));
  const std::string ha2 = hash(algorithm, joined({method, url}));
  const std::string response =
      hash(algorithm, challenge.has_qop ? joined({ha1, challenge.nonce, count, cnonce, "auth", ha2})
                                        : joined({ha1, challenge.nonce, ha2}));
  std::string value = "Digest username=" + inQuotes(credentials.user) +
                      ", realm=" + inQuotes(challenge.realm) + ", nonce=" + inQuotes(challenge.nonce) +
                      ", uri=" + inQuotes(url) + ", response=" + inQuotes(response);
  if (!challenge.algorithm.empty()) value += ", algorithm=" + algorithm + (has_session ? "-sess" : "");
  if (challenge.has_opaque) value += ", opaque=" + inQuotes(challenge.opaque);
  if (challenge.has_qop) value.append(", qop=auth, nc=").append(count);
  if (challenge.has_qop || has_session) value += ", cnonce=" + inQuotes(cnonce);
  return value;
}

}  // namespace cartvo::capture
