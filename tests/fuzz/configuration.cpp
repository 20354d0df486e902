// Fuzz target for cartvod's configuration, as read from disk and from recordings.

#include "daemon/service/configuration.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kName = "/etc/cartvo/cartvod.yaml";
  const auto configuration =
      fuzz::parseOrReject([&] { return daemon::parseConfiguration(fuzz::toText(data, size), kName); }, kName);
  if (!configuration) return 0;
  const std::string text = daemon::effectiveConfiguration(*configuration);
  const auto again = fuzz::parseOrReject([&] { return daemon::parseConfiguration(text, kName); }, kName);
  fuzz::require(again.has_value(), "the configuration in effect can be read:\n" + text);
  fuzz::require(daemon::effectiveConfiguration(*again) == text,
                "the configuration in effect is read back:\n" + text);
  return 0;
}
