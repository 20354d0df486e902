// Fuzz target for the headers by which the status page decides who may read and press buttons.
//
// Input: lines: the header Cookie, the header Authorization, the header Origin, the header Host.

#include "daemon/page/page_access.hpp"

#include <sstream>
#include <string>

#include "tests/fuzz/fuzzing.hpp"

using cartvo::daemon::PageAccess, cartvo::daemon::PageReaders;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string kToken = "a-token-of-the-fuzzer";
  static const PageAccess kAccess(kToken, PageReaders::token_holders);
  static const std::string kCookie = kAccess.cookie().substr(0, kAccess.cookie().find(';'));
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  std::string cookies, authorization, origin, host;
  std::getline(lines, cookies);
  std::getline(lines, authorization);
  std::getline(lines, origin);
  std::getline(lines, host);
  const bool has_secret =
      cookies.find(kCookie) != std::string::npos || authorization.find(kToken) != std::string::npos;
  cartvo::fuzz::require(has_secret || !kAccess.mayRead(cookies, authorization), "no secret, no access");
  cartvo::fuzz::require(!cartvo::daemon::isSameOrigin(origin, host) || origin.ends_with(host),
                        "the same origin");
  return 0;
}
