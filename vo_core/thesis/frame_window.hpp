#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <optional>

#include "vo_core/image/image_pyramid.hpp"

// Window of the last pairs, as `estimator: thesis` needs it.

namespace cartvo::vo {

/// Record of a processed pair.
struct FrameRecord {
  std::int64_t index = -1;
  std::int64_t exposure_ns = 0;                     ///< of the left image
  ImagePyramid left;                                ///< grey levels only
  std::optional<Eigen::Isometry3d> T_world_camera;  ///< in the current epoch; none where it was not measured
};

/// The last few pairs, oldest first.
class FrameWindow {
 public:
  explicit FrameWindow(int capacity) : capacity_(static_cast<std::size_t>(capacity)) {}

  void push(FrameRecord frame) {
    frames_.push_back(std::move(frame));
    if (frames_.size() > capacity_) frames_.pop_front();
  }
  void clear() { frames_.clear(); }

  /// The pair `index`; nullptr if it has left the window.
  const FrameRecord* find(std::int64_t index) const {
    for (const FrameRecord& frame : frames_)
      if (frame.index == index) return &frame;
    return nullptr;
  }
  /// The newest pair, or nullptr.
  const FrameRecord* newest() const { return frames_.empty() ? nullptr : &frames_.back(); }
  /// The newest pair with a pose, or nullptr.
  const FrameRecord* reference() const {
    const FrameRecord* found = nullptr;
    for (const FrameRecord& frame : frames_)
      if (frame.T_world_camera) found = &frame;
    return found;
  }

  /// Begins an epoch with the newest pair as its origin; the poses of the others are dropped.
  void beginEpochAtNewest() {
    for (FrameRecord& frame : frames_)
      frame.T_world_camera.reset();
    frames_.back().T_world_camera = Eigen::Isometry3d::Identity();
  }

 private:
  std::size_t capacity_;
  std::deque<FrameRecord> frames_;
};

}  // namespace cartvo::vo
