// Plausibility of the intervals between a camera's frames.
#include "capture/dataset/frame_interval.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "common/exact_text.hpp"
#include "common/statistics.hpp"

namespace cartvo::capture {
namespace {

constexpr double kMinInterval = 1e-3, kMaxInterval = 2.0;  // s
constexpr double kUsualInterval = 0.05;                    // s

struct NamedUnit {
  const char* name;
  double seconds;
};
constexpr std::array<NamedUnit, 4> kUnits{
    {{"seconds", 1.0}, {"milliseconds", 1e-3}, {"microseconds", 1e-6}, {"nanoseconds", 1e-9}}};

std::string intervalText(double seconds) {
  return roundedText(seconds, 3) + " s";
}

/// The unit in which an interval of so many units is plausible, and nearest to the usual one; null if none.
const NamedUnit* plausibleUnit(double units) {
  const NamedUnit* best = nullptr;
  const auto distance = [units](const NamedUnit& unit) {
    return std::abs(std::log(units * unit.seconds / kUsualInterval));
  };
  for (const NamedUnit& unit : kUnits) {
    if (isPlausibleInterval(units * unit.seconds) && (best == nullptr || distance(unit) < distance(*best)))
      best = &unit;
  }
  return best;
}

double medianInterval(const std::vector<std::int64_t>& instants_ns) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < instants_ns.size(); ++i)
    intervals.push_back(1e-9 * static_cast<double>(instants_ns[i] - instants_ns[i - 1]));
  return quantile(std::move(intervals), 0.5);
}

}  // namespace

bool isPlausibleInterval(double interval) {
  return interval >= kMinInterval && interval <= kMaxInterval;
}

void requirePlausibleInterval(const std::vector<std::int64_t>& instants_ns, const std::filesystem::path& file,
                              TimeUnit unit) {
  if (instants_ns.size() < 2) return;
  const double interval = medianInterval(instants_ns);
  if (isPlausibleInterval(interval)) return;
  const NamedUnit& read = unit == TimeUnit::seconds ? kUnits.front() : kUnits.back();
  std::string message = file.string() + ": the instants are read as " + read.name +
                        ", and the median of their intervals is " + intervalText(interval) +
                        "; expected a camera's, " + intervalText(kMinInterval) + " to " +
                        intervalText(kMaxInterval);
  const double units = interval / read.seconds;
  if (const NamedUnit* const other = plausibleUnit(units)) {
    message += std::string(". In ") + other->name + " they would be " + intervalText(units * other->seconds) +
               ": convert the instants from " + other->name + " to " + read.name;
  }
  throw std::runtime_error(message);
}

std::string frameNumberWarning(const std::vector<std::int64_t>& instants_ns,
                               const std::filesystem::path& file) {
  constexpr std::size_t kMinCount = 5;
  constexpr std::int64_t kSecond = 1'000'000'000;
  if (instants_ns.size() < kMinCount || instants_ns.front() < 0 || instants_ns.front() > kSecond) return {};
  for (std::size_t i = 0; i < instants_ns.size(); ++i) {
    const std::int64_t expected = instants_ns.front() + static_cast<std::int64_t>(i) * kSecond;
    if (instants_ns[i] % kSecond != 0 || instants_ns[i] != expected) return {};
  }
  return file.string() +
         ": the instants are 1 s apart, like frame numbers; if they are numbers, give the frame rate by "
         "--frame-rate";
}

}  // namespace cartvo::capture
