// Instants of KITTI's raw recordings.
#include "capture/dataset/dates_and_times.hpp"

#include <ctime>
#include <optional>
#include <stdexcept>
#include <string>

#include "capture/dataset/frame_interval.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Parses "2011-09-26 13:02:25.594360375" (UTC) as ns since 1970.
std::optional<std::int64_t> parseDateAndTime(const std::string& text) {
  std::tm calendar{};
  const char* const end = strptime(text.c_str(), "%Y-%m-%d %H:%M:%S", &calendar);
  if (end == nullptr) return std::nullopt;
  const std::int64_t seconds = timegm(&calendar);
  constexpr std::int64_t kMaxSeconds = kMaxTimestampNs / kNanosecondsPerSecond;
  if (seconds < -kMaxSeconds || seconds >= kMaxSeconds) return std::nullopt;
  std::string decimals(end);
  if (!decimals.empty() && decimals.front() != '.') return std::nullopt;
  decimals = decimals.empty() ? "0" : decimals.substr(1, 9);
  decimals.resize(9, '0');
  const auto fraction = parseNumber<std::int64_t>(decimals);
  return fraction && *fraction >= 0 ? std::optional(seconds * kNanosecondsPerSecond + *fraction)
                                    : std::nullopt;
}

}  // namespace

std::vector<std::int64_t> readDatesAndTimes(const std::filesystem::path& file) {
  std::vector<std::int64_t> instants;
  for (const TextLine& line : readLines(file)) {
    const std::optional<std::int64_t> instant_ns = parseDateAndTime(line.text);
    if (!instant_ns) {
      throw std::runtime_error(
          fileAndLine(file, line) +
          "expected a date and a time such as 2011-09-26 13:02:25.594360375 instead of '" +
          printableExcerpt(line.text) + "'");
    }
    requireIncreasing(instants, *instant_ns, file, line);
    instants.push_back(*instant_ns);
  }
  requirePlausibleInterval(instants, file, TimeUnit::seconds);
  return instants;
}

}  // namespace cartvo::capture
