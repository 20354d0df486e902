// Measures the processor load of recording. `cartvo_recording_cost [SECONDS [FOLDER]]` passes the encoded
// pictures of two cameras, 25 per second and 4 Mbit/s each, to a StreamRecorder that writes to FOLDER
// (default: the temporary folder), and then runs the same loop without a recorder. The difference in
// processor time is the recorder's.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "capture/recording/stream_recorder.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace {

using namespace cartvo;  // NOLINT(google-build-using-namespace): a program of its own
using Clock = std::chrono::steady_clock;

constexpr int kFrameRate = 25;    // Hz
constexpr double kBitrate = 4.0;  // Mbit/s per camera
constexpr std::int64_t kPeriod_ns = 1'000'000'000 / kFrameRate;
const cv::Size kSize(1280, 720);

/// One second of moving noise, which uses the full bit rate.
std::vector<capture::EncodedUnit> secondOfPictures() {
  simulate::StreamEncoder encoder({.bitrate_kbps = static_cast<int>(1e3 * kBitrate)}, kSize, kFrameRate);
  cv::Mat scene(kSize.height + 100, kSize.width + 100, CV_8UC1);
  cv::RNG random(1);
  random.fill(scene, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(scene, scene, {5, 5}, 1.5);
  std::vector<capture::EncodedUnit> units;
  for (int i = 0; i < 3 * kFrameRate; ++i) {  // the first two seconds settle the rate control
    const simulate::EncodedPicture picture =
        encoder.encode(scene(cv::Rect({2 * (i % 50), i % 50}, kSize)).clone());
    if (i < 2 * kFrameRate) continue;
    capture::EncodedUnit unit;
    unit.data = picture.data;
    unit.key = picture.key_frame;
    units.push_back(std::move(unit));
  }
  return units;
}

double processorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Passes the pictures to the observers in real time. Returns the processor time per second.
double load(const std::vector<capture::EncodedUnit>& pictures, capture::StreamObserver* left,
            capture::StreamObserver* right, int seconds) {
  const double before = processorSeconds();
  const Clock::time_point start = Clock::now();
  for (int i = 0; i < seconds * kFrameRate; ++i) {
    capture::EncodedUnit unit = pictures[static_cast<std::size_t>(i) % pictures.size()];
    unit.sequence = static_cast<std::uint64_t>(i);
    unit.pts = i * 90'000 / kFrameRate;
    unit.exposure_ns = 1'700'000'000'000'000'000 + i * kPeriod_ns;
    unit.first_arrival_ns = unit.arrival_ns = unit.min_delay_arrival_ns = unit.exposure_ns + 30'000'000;
    if (left != nullptr) left->onUnit(unit);
    if (right != nullptr) right->onUnit(unit);
    std::this_thread::sleep_until(start + std::chrono::nanoseconds((i + 1) * kPeriod_ns));
  }
  return (processorSeconds() - before) / seconds;
}

void measure(int seconds, const std::filesystem::path& folder) {
  const std::vector<capture::EncodedUnit> pictures = secondOfPictures();
  capture::RecordingSettings settings;
  settings.folder = folder / ("cartvo-recording-cost-" + std::to_string(getpid()));
  double recording = 0.0;
  capture::RecorderHealth health;
  {
    capture::StreamRecorder recorder(settings);
    recorder.left().onStream({});
    recorder.right().onStream({});
    recording = load(pictures, &recorder.left(), &recorder.right(), seconds);
    recorder.finish();
    health = recorder.health();
  }
  std::filesystem::remove_all(settings.folder);
  const double idle = load(pictures, nullptr, nullptr, seconds);
  std::printf("%.2f Mbit/s for %d s, %llu pictures dropped: %.2f %% of a core\n",
              8e-6 * static_cast<double>(health.bytes) / seconds, seconds,
              static_cast<unsigned long long>(health.dropped_pictures), 100.0 * (recording - idle));
  if (!health.error.empty()) std::fprintf(stderr, "%s\n", health.error.c_str());
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    const int seconds = argument_count > 1 ? std::stoi(arguments[1]) : 60;
    measure(seconds, argument_count > 2 ? arguments[2] : std::filesystem::temp_directory_path());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cartvo_recording_cost: %s\nusage: cartvo_recording_cost [SECONDS [FOLDER]]\n",
                 error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
