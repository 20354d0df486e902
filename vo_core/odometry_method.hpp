#pragma once

#include "vo_core/integrity/integrity_monitor.hpp"
#include "vo_core/landmark_view.hpp"
#include "vo_core/odometry_estimate.hpp"
#include "vo_core/stage_observer.hpp"

namespace cartvo::vo {

/// Interface of the estimators that `estimator:` selects. Used by StereoOdometry, which validates the images
/// first.
class OdometryMethod {
 public:
  virtual ~OdometryMethod() = default;
  /// Processes a pair that the evidence of its images does not reject. Updates `integrity` by its own.
  virtual OdometryEstimate process(const StereoImages& images, IntegrityMonitor& integrity,
                                   StageObserver& observer) = 0;
  virtual void setTargetFeatureCount(int features) = 0;
  /// See StereoOdometry::acquireBuffers(). Lends nothing by default.
  virtual void acquireBuffers(StereoImages&) {}
  /// See StereoOdometry::viewLandmarks().
  virtual void viewLandmarks(LandmarkViews& views) const = 0;
};

}  // namespace cartvo::vo
