// Parses LCM's URLs.
#include "daemon/publish/lcm_url.hpp"

#include <cstdlib>
#include <regex>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace cartvo::daemon {
namespace {

constexpr const char* kVariable = "LCM_DEFAULT_URL";
constexpr int kMaxTtl = 255;

std::string variable() {
  const char* url = std::getenv(kVariable);
  return url == nullptr ? "" : url;
}

bool isOfVariable(const std::string& url) {
  return !url.empty() && url == variable();
}

[[noreturn]] void fail(const std::string& url, const std::string& text) {
  throw std::invalid_argument("'" + url + "'" +
                              (isOfVariable(url) ? std::string(" (of the variable ") + kVariable + ")" : "") +
                              " " + text);
}

}  // namespace

std::string defaultLcmUrl() {
  const std::string url = variable();
  return url.empty() ? kDefaultLcmUrl : url;
}

std::string describeLcmUrl(const std::string& url) {
  return isOfVariable(url) ? url + " (" + kVariable + ")" : url;
}

LcmGroup parseLcmUrl(const std::string& url) {
  static const std::regex kProvider("([a-z]+)://.*");
  static const std::regex kUrl(R"(udpm://([0-9.]*)(:([0-9]{1,5}))?(\?[a-z_]+=[0-9]+(&[a-z_]+=[0-9]+)*)?)");
  static const std::regex kTtl("[?&]ttl=0*([0-9]+)(&|$)");
  const std::string example = std::string(" such as ") + kDefaultLcmUrl;
  std::smatch parts;
  if (std::regex_match(url, parts, kProvider) && parts[1] != "udpm") {
    fail(url, "has LCM's provider '" + parts[1].str() +
                  "': cartvo sends and receives by UDP multicast only; use a URL" + example);
  }
  if (!std::regex_match(url, parts, kUrl)) fail(url, "is not a URL of LCM's UDP multicast" + example);
  LcmGroup group;
  if (parts[1].length() > 0) group.address = parts[1];
  if (parts[3].length() > 0) group.port = std::stoi(parts[3]);
  group.options = parts[4];
  static const std::regex kName("[?&]([a-z_]+)=");
  for (std::sregex_iterator name(group.options.begin(), group.options.end(), kName);
       name != std::sregex_iterator(); ++name) {
    const std::string option = (*name)[1];
    if (option != "ttl" && option != "recv_buf_size" && option != "transmit_only")
      fail(url, "has the option '" + option +
                    "', which LCM does not know; ttl=1 lets messages leave the computer");
  }
  std::smatch ttl;
  if (std::regex_search(group.options, ttl, kTtl))
    group.ttl = ttl[1].length() > 3 ? kMaxTtl + 1 : std::stoi(ttl[1]);
  in_addr parsed{};
  if (inet_pton(AF_INET, group.address.c_str(), &parsed) != 1 || !IN_MULTICAST(ntohl(parsed.s_addr)))
    fail(url, "names '" + group.address + "', which is not a multicast address (224.0.0.0/4)");
  if (group.port < 1 || group.port > 65535) fail(url, "names a port that is not from 1 to 65535");
  if (group.ttl > kMaxTtl) fail(url, "names a ttl that is not from 0 to 255");
  return group;
}

}  // namespace cartvo::daemon
