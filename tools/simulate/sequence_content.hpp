#pragma once

#include <filesystem>

#include "capture/image_folder.hpp"
#include "tools/simulate/content.hpp"

namespace cartvo::simulate {

/// Which part of a recorded sequence is shown, and how its right camera's clock is shifted.
struct SequenceSettings {
  double seconds = 0.0;           ///< from its start; 0: all of it
  double offset_s = 0.0;          ///< added to the right camera's instants; its pictures stay what they are
  double offset_drift_ppm = 0.0;  ///< the right camera's period is longer by this, 1e-6
};

/// A recorded image sequence (KITTI's or EuRoC's layout) as content. An odd last column or row is left out:
/// H.264 in 4:2:0 has none. Truth comes from poses.txt (KITTI: left camera relative to the first one), if
/// there is one.
class SequenceContent final : public Content {
 public:
  /// Throws std::runtime_error naming the file for anything missing, unreadable or contradictory.
  SequenceContent(const std::filesystem::path& folder, const SequenceSettings& settings);

  Rig rig() const override { return rig_; }
  double frameRate() const override { return frame_rate_; }
  int pairCount() const override { return static_cast<int>(folder_.left.images.size()); }
  std::int64_t leftInstant(int index) const override;
  std::int64_t rightInstant(int index) const override;
  void images(int index, cv::Mat& left, cv::Mat& right) const override;
  /// Most are cut out of a drive.
  bool beginsStanding() const override { return false; }
  Trajectory truth() const override { return truth_; }
  std::string cacheKey() const override;

 private:
  void readRigOf(cv::Size image_size);
  void readTruth(const std::filesystem::path& poses);

  ImageFolder folder_;
  SequenceSettings settings_;
  Rig rig_;
  double frame_rate_ = 0.0;
  Trajectory truth_;
};

}  // namespace cartvo::simulate
