// Fuzz target for StereoTimestamper: RTP times, sender reports and arrivals in any order and of any size.
// Nothing may overflow, and time must not run backwards.
//
// Input: lines of text, so that findings are readable:
//   choice N                     0 to 3, as ClockChoice; only as the first line
//   left TICKS NS [US]           a picture: RTP time since the camera's last one, host's time since the last
//   right TICKS NS [US]          line, and the camera's wall clock by its reports minus the host's clock
//   connect left|right
//   visual [NS NS]               offset by the image content, and its standard deviation
//   again LINES TIMES            repeats the previous LINES lines TIMES times

#include <array>
#include <cmath>
#include <sstream>

#include "capture/clock/stereo_timestamper.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

constexpr int kMaxLines = 300;  // including repeated ones; enough to fill the windows of the clock models
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kLatest_ns = std::int64_t{1} << 62;  // the year 2116

/// Host's clock after a step, kept in its valid range.
std::int64_t hostTime(std::int64_t now_ns, std::int64_t step_ns) {
  std::int64_t sum = 0;
  const bool overflows = __builtin_add_overflow(now_ns, step_ns, &sum);
  return overflows || sum < 0 || sum > kLatest_ns ? now_ns : sum;
}

bool isFinite(const capture::OffsetEstimate& estimate) {
  return std::isfinite(estimate.value_ns) && std::isfinite(estimate.stddev_ns) && estimate.stddev_ns >= 0.0;
}

void check(const capture::ClockStatus& status) {
  for (const capture::ClockStatus::Camera& camera : status.cameras) {
    fuzz::require(std::isfinite(camera.skew) && std::abs(camera.skew) < 0.001,
                  "the skew of a crystal is small");
    fuzz::require(std::isfinite(camera.latency_ns.value_or(0.0)), "a latency is finite");
  }
  fuzz::require(isFinite(status.offset), "the offset is finite");
  fuzz::require(!status.ntp || isFinite(*status.ntp), "the reports' offset is finite");
  fuzz::require(!status.visual || isFinite(*status.visual), "the pictures' offset is finite");
}

class Cameras {
 public:
  explicit Cameras(capture::ClockChoice choice) : timestamper_(choice) {}

  void runLines(const std::vector<std::string>& lines, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && lines_++ < kMaxLines; ++i) {
      std::istringstream words(lines[i]);
      std::string verb;
      words >> verb;
      if (verb == "left" || verb == "right") {
        picture(verb == "left" ? capture::CameraSide::left : capture::CameraSide::right, words);
      } else if (verb == "connect") {
        words >> verb;
        timestamper_.connect(verb == "left" ? capture::CameraSide::left : capture::CameraSide::right);
      } else if (verb == "visual") {
        setVisual(words);
      } else if (verb == "again") {
        std::size_t count = 0, times = 0;
        words >> count >> times;
        // Only earlier lines, so that it terminates.
        for (; times > 0 && lines_++ < kMaxLines; --times)
          runLines(lines, i - std::min(count, i - begin), i);
      }
    }
  }

  void check() const { ::check(timestamper_.status()); }

 private:
  struct Camera {
    std::int64_t pts = 0;
    std::uint32_t usable_ticks = 0;  ///< RTP time of the last picture whose instant can be
    std::int64_t arrival_ns = 0;     ///< of that picture
    std::optional<std::int64_t> exposure_ns;
  };

  void picture(capture::CameraSide side, std::istringstream& words) {
    std::int64_t ticks = 0, step_ns = 0, report_us = 0;
    words >> ticks >> step_ns;
    Camera& camera = cameras_[static_cast<std::size_t>(side)];
    now_ns_ = hostTime(now_ns_, step_ns);
    if (__builtin_add_overflow(camera.pts, ticks, &camera.pts)) camera.pts = ticks;
    capture::RtpTimestamps timestamps{camera.pts, std::nullopt, now_ns_};
    if (words >> report_us && !__builtin_add_overflow(now_ns_ / 1000, report_us, &report_us))
      timestamps.reference_us = report_us;
    const capture::ExposureTimestamp instant = timestamper_.stamp(side, timestamps);
    fuzz::require(instant.exposure_stddev_ns >= 0, "a standard deviation is not negative");
    if (!instant.is_usable) return;
    const auto step = static_cast<std::int32_t>(static_cast<std::uint32_t>(camera.pts) - camera.usable_ticks);
    camera.usable_ticks = static_cast<std::uint32_t>(camera.pts);
    const bool is_later = now_ns_ >= camera.arrival_ns && step > 0;
    fuzz::require(!camera.exposure_ns || !is_later || instant.exposure_ns > *camera.exposure_ns,
                  "time does not run backwards unless a clock is set back");
    camera.arrival_ns = now_ns_;
    camera.exposure_ns = instant.exposure_ns;
  }

  void setVisual(std::istringstream& words) {
    constexpr std::int64_t kMaxOffset_ns = 1'000'000'000;  // largest offset that the visual estimator returns
    std::int64_t value_ns = 0, stddev_ns = 0;
    if (!(words >> value_ns >> stddev_ns)) return timestamper_.setVisual(std::nullopt);
    timestamper_.setVisual(
        capture::OffsetEstimate{static_cast<double>(std::clamp(value_ns, -kMaxOffset_ns, kMaxOffset_ns)),
                                static_cast<double>(std::clamp(stddev_ns, std::int64_t{1}, kMaxOffset_ns))});
  }

  capture::StereoTimestamper timestamper_;
  std::array<Camera, 2> cameras_;
  std::int64_t now_ns_ = kStart_ns;
  int lines_ = 0;
};

capture::ClockChoice parseChoice(const std::vector<std::string>& lines) {
  constexpr int kChoices = 4;
  int number = 0;
  if (!lines.empty() && lines.front().starts_with("choice "))
    std::istringstream(lines[0].substr(7)) >> number;
  return static_cast<capture::ClockChoice>(std::clamp(number, 0, kChoices - 1));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> lines = fuzz::splitLines(fuzz::toText(data, size));
  Cameras cameras(parseChoice(lines));
  cameras.check();
  cameras.runLines(lines, 0, lines.size());
  cameras.check();
  return 0;
}
