#pragma once

#include <filesystem>

#include "capture/dataset/image_folder.hpp"
#include "tools/simulate/content.hpp"

namespace cartvo::simulate {

/// Part of a recorded sequence to show, and the shift of the right camera's clock.
struct SequenceSettings {
  double seconds = 0.0;           ///< length from the start; 0: all
  double offset_s = 0.0;          ///< added to the right camera's instants; the pictures do not change
  double offset_drift_ppm = 0.0;  ///< relative excess of the right camera's period, 1e-6
};

/// A recorded image sequence (KITTI or EuRoC layout) as content. An odd last column or row is cropped,
/// because H.264 4:2:0 needs even sizes. The truth is poses.txt (KITTI: left camera relative to the first
/// pose), if it exists.
class SequenceContent final : public Content {
 public:
  /// Throws std::runtime_error that names the file if something is missing, unreadable or inconsistent.
  SequenceContent(const std::filesystem::path& folder, const SequenceSettings& settings);

  calib::Rig rig() const override { return rig_; }
  double frameRate() const override { return frame_rate_; }
  int pairCount() const override { return static_cast<int>(folder_.left.images.size()); }
  std::int64_t leftInstant(int index) const override;
  std::int64_t rightInstant(int index) const override;
  void images(int index, cv::Mat& left, cv::Mat& right) const override;
  /// False: most sequences start within a drive.
  bool startsAtStandstill() const override { return false; }
  Trajectory truth() const override { return truth_; }
  std::string cacheKey() const override;

 private:
  void readRigFor(cv::Size image_size);
  void readTruth(const std::filesystem::path& poses);

  capture::ImageFolder folder_;
  SequenceSettings settings_;
  calib::Rig rig_;
  double frame_rate_ = 0.0;
  Trajectory truth_;
};

}  // namespace cartvo::simulate
