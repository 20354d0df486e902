// Statistics of one camera's stream.
#include "tools/doctor/cameras/stream_measurement.hpp"

#include <algorithm>
#include <cmath>

#include "common/host_clock.hpp"
#include "common/statistics.hpp"

namespace cartvo::doctor {
namespace {

constexpr double kSecond = 1e9;           // ns
constexpr std::size_t kMinPictures = 10;  // for rates
constexpr std::int64_t kTicksPerSecond = 90'000;

using Pictures = std::vector<ReceivedPicture>;

/// The pictures in the order of their exposure.
Pictures inOrder(Pictures pictures) {
  std::stable_sort(pictures.begin(), pictures.end(),
                   [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
  return pictures;
}

double secondsFrom(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) / kSecond;
}

/// A straight line by least squares: its slope with its standard deviation.
struct Slope {
  double value = 0.0, stddev = 0.0;
};

/// Slope of the arrivals over the camera's time.
Slope arrivalSlope(const Pictures& pictures) {
  const ReceivedPicture& first = pictures.front();
  double sum_x = 0.0, sum_y = 0.0;
  const auto count = static_cast<double>(pictures.size());
  const auto x = [&](const ReceivedPicture& picture) { return secondsFrom(first.time_ns, picture.time_ns); };
  const auto y = [&](const ReceivedPicture& picture) {
    return secondsFrom(first.first_arrival_ns, picture.first_arrival_ns) - x(picture);
  };
  for (const ReceivedPicture& picture : pictures) {
    sum_x += x(picture);
    sum_y += y(picture);
  }
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const ReceivedPicture& picture : pictures) {
    const double dx = x(picture) - sum_x / count, dy = y(picture) - sum_y / count;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  if (xx <= 0.0) return {1.0, 1.0};
  const double slope = xy / xx;
  const double residual = std::max(0.0, yy - slope * xy) / std::max(1.0, count - 2.0);
  return {1.0 + slope, std::sqrt(residual / xx)};
}

void measureRates(const Pictures& pictures, StreamStatistics& statistics) {
  const ReceivedPicture &first = pictures.front(), &last = pictures.back();
  statistics.seconds = secondsFrom(first.time_ns, last.time_ns);
  if (pictures.size() < kMinPictures || statistics.seconds <= 0.0) return;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < pictures.size(); ++i)
    intervals.push_back(secondsFrom(pictures[i - 1].time_ns, pictures[i].time_ns));
  const double period = medianOf(intervals);
  statistics.largest_gap = *std::max_element(intervals.begin(), intervals.end());
  // Pictures that are missing do not change the rate: each interval counts as a number of periods.
  double periods = 0.0, squares = 0.0;
  for (const double interval : intervals) {
    const double count = std::max(1.0, std::round(interval / period));
    periods += count;
    squares += std::pow(interval / period - count, 2);
  }
  statistics.rate = periods / statistics.seconds;
  statistics.uneven = std::sqrt(squares / static_cast<double>(intervals.size()));
  if (first.first_arrival_ns == 0) return;
  const Slope slope = arrivalSlope(pictures);
  statistics.host_rate = statistics.rate / slope.value;
  statistics.host_rate_stddev = statistics.host_rate * slope.stddev;
}

void measureArrivals(const Pictures& pictures, StreamStatistics& statistics) {
  const ReceivedPicture& first = pictures.front();
  if (first.first_arrival_ns == 0) return;
  std::vector<double> delays;
  for (const ReceivedPicture& picture : pictures)
    delays.push_back(secondsFrom(first.first_arrival_ns, picture.first_arrival_ns) -
                     secondsFrom(first.time_ns, picture.time_ns));
  constexpr double kMost = 0.95;
  statistics.arrival_jitter = percentile(delays, kMost) - *std::min_element(delays.begin(), delays.end());
}

void measureReports(const Pictures& pictures, StreamStatistics& statistics) {
  constexpr std::int64_t kNanoseconds = 1000;
  std::vector<double> latencies, offsets;
  const std::int64_t correction_ns = hostClockCorrection();
  for (const ReceivedPicture& picture : pictures) {
    if (!picture.reference_us) continue;
    const std::int64_t exposure_ns = *picture.reference_us * kNanoseconds;
    latencies.push_back(secondsFrom(exposure_ns, picture.first_arrival_ns + correction_ns));
    offsets.push_back(secondsFrom(picture.time_ns, exposure_ns));
  }
  if (latencies.empty()) return;
  statistics.latency = *std::min_element(latencies.begin(), latencies.end());
  const auto [least, largest] = std::minmax_element(offsets.begin(), offsets.end());
  statistics.report_spread = *largest - *least;
}

void measureKeyInterval(const Pictures& pictures, StreamStatistics& statistics) {
  std::optional<std::int64_t> last;
  for (const ReceivedPicture& picture : pictures) {
    if (!picture.key) continue;
    if (last)
      statistics.key_interval =
          std::max(statistics.key_interval.value_or(0.0), secondsFrom(*last, picture.time_ns));
    last = picture.time_ns;
  }
}

bool hasBFrames(const Pictures& received) {
  return std::adjacent_find(received.begin(), received.end(), [](const auto& a, const auto& b) {
           return b.time_ns < a.time_ns;
         }) != received.end();
}

}  // namespace

ReceivedPicture receivedPicture(const capture::EncodedUnit& unit) {
  constexpr std::int64_t kNanoseconds = 1'000'000'000;
  const std::int64_t whole = unit.pts / kTicksPerSecond, rest = unit.pts % kTicksPerSecond;
  return {.time_ns = whole * kNanoseconds + rest * kNanoseconds / kTicksPerSecond,
          .first_arrival_ns = unit.first_arrival_ns,
          .reference_us = unit.reference_us,
          .sequence = unit.sequence,
          .bytes = unit.data.size(),
          .key = unit.key,
          .data_lost = unit.data_lost};
}

StreamStatistics statisticsOf(const StreamMeasurement& measurement) {
  StreamStatistics statistics;
  if (measurement.pictures.empty()) return statistics;
  const Pictures pictures = inOrder(measurement.pictures);
  measureRates(pictures, statistics);
  measureArrivals(pictures, statistics);
  measureReports(pictures, statistics);
  measureKeyInterval(pictures, statistics);
  statistics.has_b_frames = hasBFrames(measurement.pictures);
  double bytes = 0.0;
  for (const ReceivedPicture& picture : pictures) {
    bytes += static_cast<double>(picture.bytes);
    statistics.losses += picture.data_lost ? 1 : 0;
  }
  constexpr double kBitsPerByte = 8.0;
  if (statistics.seconds > 0.0) statistics.bit_rate = kBitsPerByte * bytes / statistics.seconds;
  return statistics;
}

}  // namespace cartvo::doctor
