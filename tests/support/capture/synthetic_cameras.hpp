#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "capture/camera_source.hpp"
#include "common/host_clock.hpp"
#include "pipeline/pair_processor.hpp"
#include "support/pipeline/alert_limits.hpp"

// Synthetic cameras and frames for tests of the pipeline.

namespace cartvo::test {

constexpr std::int64_t kPeriod_ns = 20'000'000;  // 50 Hz: quick tests

/// Rig of two rectified cameras with 320x240 px images.
inline calib::Rig smallRig() {
  calib::Rig rig;
  rig.name = "test";
  rig.left.size = rig.right.size = {320, 240};
  rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = 240.0;
  rig.left.cx = rig.right.cx = 159.5;
  rig.left.cy = rig.right.cy = 119.5;
  rig.T_right_left.translation() = Eigen::Vector3d(-0.2, 0.0, 0.0);
  rig.T_body_camera = calib::forwardLookingMount();
  return rig;
}

inline pipeline::PairProcessor smallProcessor(const calib::Rig& rig,
                                              const pipeline::AlertLimits& alert_limits = kNoAlertLimits) {
  const calib::RectificationSettings settings;
  vo::OdometrySettings odometry;
  odometry.features = 300;
  return {rig,
          calib::Rectifier(rig, settings, calib::buildTables(rig, settings)),
          {.odometry = odometry, .alert_limits = alert_limits}};
}

/// Image of two walls of random texture: in the upper half 4 m ahead (disparity 12 px), in the lower half 2 m
/// ahead. The cart moves to its right by 33 mm a frame, so the walls move to the left by 2 px and 4 px.
/// `disparity`: 12 for the right camera, 0 for the left one.
inline cv::Mat wall(int index, int disparity) {
  static const cv::Mat kTexture = [] {
    cv::Mat texture(240, 4000, CV_8UC1);
    cv::RNG random(42);
    random.fill(texture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(texture, texture, {5, 5}, 1.2);
    cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
    return texture;
  }();
  const int column = 20 + 2 * (index % 800) + disparity;
  cv::Mat image(240, 320, CV_8UC1);
  kTexture(cv::Rect(column, 0, 320, 120)).copyTo(image.rowRange(0, 120));
  kTexture(cv::Rect(2 * column, 120, 320, 120)).copyTo(image.rowRange(120, 240));
  return image;
}

inline capture::Frame wallFrame(int index, int disparity, std::int64_t exposure_ns) {
  capture::Frame frame;
  frame.image = wall(index, disparity);
  frame.exposure_ns = exposure_ns;
  frame.arrival_ns = frame.decoded_ns = hostNow();
  frame.sequence = static_cast<std::uint64_t>(index);
  return frame;
}

/// Plays a list of frames as fast as they are read.
class ListedCamera : public capture::CameraSource {
 public:
  explicit ListedCamera(std::vector<capture::Frame> frames) : frames_(std::move(frames)) {}

  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds /*timeout*/) override {
    if (interrupted_ || next_ == frames_.size()) return capture::ReadOutcome::ended;
    frame = frames_[next_++];
    return capture::ReadOutcome::frame;
  }
  capture::CameraHealth health() const override { return {}; }
  void interrupt() noexcept override { interrupted_ = true; }

 private:
  std::vector<capture::Frame> frames_;
  std::size_t next_ = 0;
  std::atomic<bool> interrupted_ = false;
};

/// Live camera: at each multiple of the period it delivers the frame that `deliver(index, exposure_ns)`
/// returns, or nothing if the image is empty. The exposure is that multiple, counted from the construction.
class TickingCamera : public capture::CameraSource {
 public:
  using Clock = std::chrono::steady_clock;
  using Deliver = std::function<capture::Frame(int index, std::int64_t exposure_ns)>;

  explicit TickingCamera(Deliver deliver) : deliver_(std::move(deliver)) {}

  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds timeout) override {
    const Clock::time_point deadline = Clock::now() + timeout;
    std::unique_lock lock(mutex_);
    while (!interrupted_) {
      const Clock::time_point due = start_ + index_ * std::chrono::nanoseconds(kPeriod_ns);
      changed_.wait_until(lock, std::min(due, deadline), [this] { return interrupted_; });
      if (interrupted_) break;
      if (Clock::now() < due) return capture::ReadOutcome::timed_out;
      frame = deliver_(index_, index_ * kPeriod_ns);
      ++index_;
      if (!frame.image.empty()) return capture::ReadOutcome::frame;
    }
    return capture::ReadOutcome::ended;
  }
  capture::CameraHealth health() const override { return {}; }
  void interrupt() noexcept override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    changed_.notify_all();
  }

 private:
  Deliver deliver_;
  Clock::time_point start_ = Clock::now();
  int index_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool interrupted_ = false;
};

}  // namespace cartvo::test
