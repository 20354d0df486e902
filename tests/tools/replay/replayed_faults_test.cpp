// Repeated replays of a recording with all known capture faults: same results, no growth of resources.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "calib/format/rig_file.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/pattern_content.hpp"
#include "support/resources.hpp"
#include "support/temporary_folder.hpp"
#include "tools/replay/motion_csv.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {
namespace {

constexpr int kFrameRate = 5;
constexpr int kSeconds = 40;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Sends the pictures of one camera to the recorder, with faults at given seconds of the drive. A key picture
/// is sent each second.
class FaultyCamera {
 public:
  FaultyCamera(capture::StreamObserver& recorder, bool is_right)
      : recorder_(recorder), is_right_(is_right), encoder_({.bitrate_kbps = 600}, {160, 120}, kFrameRate) {
    recorder_.onStream({});
  }

  void send(int index, const cv::Mat& image) {
    const double second = static_cast<double>(index) / kFrameRate;
    const auto during = [&](double from, double to) { return second >= from && second < to; };
    const simulate::EncodedPicture picture = encoder_.encode(image);
    if (is_right_ && during(10.0, 13.0)) {  // reboot: the RTP clock restarts
      is_connected_ = false;
      first_ = index + 1;
      return;
    }
    capture::EncodedUnit unit;
    unit.sequence = static_cast<std::uint64_t>(index);
    if (!is_right_ && (index == 3 * kFrameRate + 1 || index == 22 * kFrameRate + 2)) {  // lost packet
      is_damaged_ = true;
      return;
    }
    if (!is_connected_) recorder_.onStream({});
    is_connected_ = true;
    unit.data = picture.data;
    unit.key = picture.key_frame;
    if (index == 17 * kFrameRate + 2) {  // corrupt packets
      for (std::size_t i = unit.data.size() / 3; i < unit.data.size() / 2; ++i)
        unit.data[i] = static_cast<std::uint8_t>(37 * i);
      unit.data_lost = is_damaged_ = true;
    }
    if (unit.key) is_damaged_ = unit.data_lost;
    unit.status = is_damaged_ ? capture::FrameStatus::damaged : capture::FrameStatus::good;
    stamp(index, second, during(25.0, 28.0), unit);
    recorder_.onUnit(unit);
  }

 private:
  /// `is_jittery`: packets are delayed by up to 200 ms.
  void stamp(int index, double second, bool is_jittery, capture::EncodedUnit& unit) const {
    const std::int64_t exposure_ns = kStart_ns + index * (kSecond_ns / kFrameRate);
    unit.pts = (index - first_) * (90'000 / kFrameRate);
    unit.first_arrival_ns = unit.arrival_ns =
        exposure_ns + 30'000'000 + (is_jittery ? (index % 5) * 50'000'000 : (index % 3) * 200'000);
    if (index % (5 * kFrameRate) == 2) {  // a sender report; from 30 s on the clock is an hour off
      const std::int64_t hour_us = !is_right_ && second > 30.0 ? 3'600'000'000 : 0;
      unit.reference_us = exposure_ns / 1000 + hour_us;
    }
    unit.exposure_ns = exposure_ns;
    unit.min_delay_arrival_ns = exposure_ns + 30'000'000;
  }

  capture::StreamObserver& recorder_;
  bool is_right_;
  simulate::StreamEncoder encoder_;
  int first_ = 0;  ///< index of the connection's first picture
  bool is_connected_ = true;
  bool is_damaged_ = false;
};

/// Records the drive, then truncates a video and an index, as a failing disk does.
void recordFaultyDrive(const std::filesystem::path& folder) {
  test::PatternSettings pattern;
  pattern.size = {160, 120};
  pattern.focal_length = 120.0;
  pattern.frame_rate = kFrameRate;
  pattern.pairs = kSeconds * kFrameRate;
  const test::PatternContent content(pattern);
  capture::RecordingSettings settings;
  settings.folder = folder;
  settings.rig = calib::rigText(content.rig());
  settings.segment_length = std::chrono::milliseconds(20'000);
  capture::StreamRecorder recorder(settings);
  FaultyCamera left(recorder.left(), false), right(recorder.right(), true);
  cv::Mat left_image, right_image;
  for (int index = 0; index < pattern.pairs; ++index) {
    const bool is_frozen = index > 35 * kFrameRate && index < 37 * kFrameRate;
    if (!is_frozen) content.images(index, left_image, right_image);
    left.send(index, left_image);
    right.send(index, right_image);
  }
  recorder.finish();
  const std::filesystem::path video = folder / "000001/right.mkv";
  std::filesystem::resize_file(video, std::filesystem::file_size(video) * 19 / 20);
  const std::filesystem::path index = folder / "000000/left.csv";
  std::filesystem::resize_file(index, std::filesystem::file_size(index) - 40);
}

Replay replayRecording(const std::filesystem::path& folder) {
  ReplaySettings settings;
  settings.source = folder;
  settings.odometry.features = 150;
  settings.alert_limits = {2.5, 1e6, 1e6, 1e6};  // pictures of 160x120 bound most velocities by 1 m/s
  settings.clock = ReplayClock::automatic;
  return replaySource(settings, [](const pipeline::PairResult&, std::size_t) {});
}

/// Number of replays: CARTVO_REPLAYED_HOURS sets the total duration of the replayed drives; by default 3.
int replayCount() {
  const char* const hours = std::getenv("CARTVO_REPLAYED_HOURS");
  return hours == nullptr ? 3 : static_cast<int>(3600.0 * std::atof(hours) / kSeconds);
}

TEST(ReplayedFaults, GiveSameResultEachTimeWithoutGrowth) {
  const test::TemporaryFolder folder;
  recordFaultyDrive(folder / "drive");
  const Replay first = replayRecording(folder / "drive");
  const std::string motions = motionCsv(first);

  EXPECT_FALSE(first.problems.empty()) << "the files are damaged";
  const auto second_of = [&](const ReplayedPair& pair) {
    return 1e-9 * static_cast<double>(pair.exposure_ns - first.pairs.front().exposure_ns);
  };
  const auto valid_pairs = [&](double from, double to) {
    int valid = 0;
    for (const ReplayedPair& pair : first.pairs) {
      const double second = second_of(pair);
      if (second >= from && second < to && pair.valid) ++valid;
    }
    return valid;
  };
  // Between the faults the odometry is valid: five pairs a second, except those after each loss.
  EXPECT_GE(valid_pairs(1.0, 3.0), 7);
  EXPECT_GE(valid_pairs(5.0, 9.0), 14);
  EXPECT_EQ(valid_pairs(10.2, 12.8), 0) << "the right camera was off";
  EXPECT_GE(valid_pairs(15.0, 16.5), 5);
  EXPECT_GE(valid_pairs(31.0, 34.0), 12) << "a camera's clock was set";
  // The frozen picture is encoded anew: each key frame seems to show a cart that has stopped, and the picture
  // behind it one that has moved by two seconds' way.
  const Eigen::Vector3d true_velocity(0.0, -0.4, 0.0);  // m/s, to the right
  for (const ReplayedPair& pair : first.pairs) {
    if (!pair.valid || pair.reasons != vo::OdometryReason::none) continue;
    const Eigen::Vector3d errors = (pair.velocity - true_velocity).cwiseAbs();
    EXPECT_TRUE((errors.array() <= pair.level.velocity.array()).all())
        << pair.exposure_ns << ": " << errors.transpose() << " above " << pair.level.velocity.transpose();
    EXPECT_LT(errors.norm(), 0.3) << pair.exposure_ns;
  }

  const int replays = replayCount();
  test::Resources settled = test::resourcesInUse();
  for (int i = 1; i < replays; ++i) {
    ASSERT_EQ(motionCsv(replayRecording(folder / "drive")), motions) << "replay " << i;
    if (i == 5) settled = test::resourcesInUse();
  }
  const test::Resources after = test::resourcesInUse();
  EXPECT_EQ(after.descriptors, settled.descriptors);
  EXPECT_EQ(after.threads, settled.threads);
#if !defined(__SANITIZE_ADDRESS__)  // AddressSanitizer delays deallocation and detects leaks itself
  EXPECT_LT(after.megabytes - settled.megabytes, 16.0);
#endif
  std::printf("%d replays of %d s, %zu pairs each: %+td descriptors, %+td threads, %+.1f MB\n", replays,
              kSeconds, first.pairs.size(), after.descriptors - settled.descriptors,
              after.threads - settled.threads, after.megabytes - settled.megabytes);
}

}  // namespace
}  // namespace cartvo
