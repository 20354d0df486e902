#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/rig.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {

/// What a pair of simulated cameras sees: a rendered world or a recorded image sequence. Instants are ns
/// since the content's start; each camera has its own.
class Content {
 public:
  virtual ~Content() = default;

  virtual Rig rig() const = 0;
  virtual double frameRate() const = 0;  ///< nominal, Hz
  virtual int pairCount() const = 0;
  virtual std::int64_t leftInstant(int index) const = 0;
  virtual std::int64_t rightInstant(int index) const = 0;

  /// The images (CV_8UC1, raw: distorted as the rig says) at `index`, each at its camera's own instant. May
  /// use all cores. Deterministic.
  virtual void images(int index, cv::Mat& left, cv::Mat& right) const = 0;

  /// Whether the cameras may have stood before the first picture for any time. Else they see nothing until it
  /// comes: who showed it as standing would let them jump to a speed.
  virtual bool beginsStanding() const { return true; }

  /// T_world_body at the left instants, exact or as recorded; empty if unknown. World: the body axes at the
  /// start.
  virtual Trajectory truth() const = 0;

  /// Names everything the images depend on, so that an encoded copy can be cached under it.
  virtual std::string cacheKey() const = 0;
};

}  // namespace cartvo::simulate
