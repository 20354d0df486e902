#pragma once

#include <string>

// URLs of LCM.

namespace cartvo::daemon {

constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

/// The URL that programs use where none is given: that of the environment variable LCM_DEFAULT_URL, as LCM's
/// own programs do, else kDefaultLcmUrl. Not checked.
std::string defaultLcmUrl();

/// The URL for the operator, with its source if that is LCM_DEFAULT_URL.
std::string describeLcmUrl(const std::string& url);

/// A group of UDP multicast, with LCM's defaults.
struct LcmGroup {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;          ///< hops; 0 stays on this host
  std::string options;  ///< as in the URL, with '?'; empty: none

  std::string text() const { return address + ":" + std::to_string(port); }
  /// The URL with all parts, for LCM.
  std::string url() const { return "udpm://" + text() + options; }
};

/// Parses udpm://[GROUP[:PORT]][?OPTION=NUMBER[&...]], as LCM does. Throws std::invalid_argument that names
/// what is wrong, in particular if the URL is of LCM's other providers.
LcmGroup parseLcmUrl(const std::string& url);

}  // namespace cartvo::daemon
