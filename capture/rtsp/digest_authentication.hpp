#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/network/credentials.hpp"

// Authentication of RTSP requests (RFC 2326, 14; RFC 7616 Digest; RFC 7617 Basic).

namespace cartvo::capture {

/// One challenge of a WWW-Authenticate header.
struct Challenge {
  enum class Scheme : std::uint8_t { digest, basic, other };
  Scheme scheme = Scheme::other;
  std::string name;       ///< scheme and algorithm as the server names them, for messages
  std::string algorithm;  ///< as the server writes it; empty: MD5 (RFC 7616, 3.3)
  std::string realm, nonce, opaque;
  bool has_opaque = false;
  bool has_qop = false;      ///< the server names qualities of protection
  bool offers_auth = false;  ///< qop "auth" is among them
  bool stale = false;
};

/// The challenges of one WWW-Authenticate header's value; one header may hold several.
std::vector<Challenge> parseChallenges(std::string_view value);

/// Answers a server's challenges. Digest only, by SHA-256 rather than MD5, whatever the order in which they
/// are offered; Basic, which sends the password readably, only if the configuration allows it.
class Authenticator {
 public:
  Authenticator(Credentials credentials, bool allow_basic)
      : credentials_(std::move(credentials)), allow_basic_(allow_basic) {}

  /// Result of `accept`.
  enum class Outcome : std::uint8_t {
    accepted,     ///< `authorization` answers the challenge
    basic_only,   ///< the server offers only Basic, which is not allowed
    unsupported,  ///< none of the schemes and algorithms is known
  };

  /// Takes the best of the challenges of a 401 response. `offered` receives their names.
  Outcome accept(const std::vector<Challenge>& challenges, std::string& offered);

  /// Whether a challenge was accepted.
  bool isReady() const { return challenge_.has_value(); }
  /// Whether the accepted challenge is answered by the readable password.
  bool sendsPassword() const { return challenge_ && challenge_->scheme == Challenge::Scheme::basic; }
  /// The accepted challenge's nonce; empty for Basic.
  const std::string& nonce() const { return challenge_->nonce; }

  /// Value of the Authorization header for a request, for the accepted challenge.
  std::string authorization(std::string_view method, std::string_view url);

 private:
  Credentials credentials_;
  bool allow_basic_;
  std::optional<Challenge> challenge_;
  std::uint32_t nonce_count_ = 0;
};

/// Value of a Digest Authorization header (RFC 7616, 3.4). `cnonce` and `nonce_count` are used with qop=auth
/// and the -sess algorithms. The challenge's algorithm must be MD5 or SHA-256, with or without -sess.
std::string digestAuthorization(const Challenge& challenge, const Credentials& credentials,
                                std::string_view method, std::string_view url, std::string_view cnonce,
                                std::uint32_t nonce_count);

}  // namespace cartvo::capture
