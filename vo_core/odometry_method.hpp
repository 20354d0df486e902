#pragma once

#include "vo_core/repeated_pictures.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// A way from pairs to motion. Images come checked.
class OdometryMethod {
 public:
  virtual ~OdometryMethod() = default;
  virtual OdometryEstimate process(const StereoImages& images, const PictureRepeats& repeats,
                                   StageObserver& observer) = 0;
  virtual void aimAt(int features) = 0;
  /// As StereoOdometry's.
  virtual void placeNext(StereoImages&) {}
};

}  // namespace cartvo
