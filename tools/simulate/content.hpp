#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <opencv2/core/mat.hpp>

#include "calib/model/rig.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {

/// A drive of two cameras: when they are exposed, and where the cart is. Instants are exposures in ns since
/// the start of the content, separate for each camera.
class ContentDescription {
 public:
  virtual ~ContentDescription() = default;

  virtual calib::Rig rig() const = 0;
  virtual double frameRate() const = 0;  ///< nominal, Hz
  virtual int pairCount() const = 0;
  virtual std::int64_t leftInstant(int index) const = 0;
  virtual std::int64_t rightInstant(int index) const = 0;

  /// T_world_body at the left instants, exact or as recorded; empty if unknown. World: body axes at the
  /// start.
  virtual Trajectory truth() const = 0;

  /// As truth(), and between the left instants too where the motion is known there: motions faster than half
  /// the frame rate, such as vibrations, have a velocity that the poses at the left instants do not show.
  virtual Trajectory denseTruth() const { return truth(); }

  /// The texts of rig.yaml, times_0.txt, times_1.txt, poses.txt and truth.tum by their names, if the drive
  /// was read from them: written again from its numbers, they could differ in the last digits.
  virtual std::map<std::string, std::string> writtenFiles() const { return {}; }
};

/// A drive as pictures: a rendered world or a recorded image sequence.
class Content : public ContentDescription {
 public:
  /// The images at `index` (CV_8UC1, raw, i.e. distorted by the rig's lenses), each at its camera's own
  /// instant. Deterministic; may use all cores.
  virtual void images(int index, cv::Mat& left, cv::Mat& right) const = 0;

  /// Whether the cart is at standstill in the first picture. If not, the lead-in is blank: a repeated first
  /// picture would be a standstill followed by a jump to full speed.
  virtual bool startsAtStandstill() const { return true; }

  /// Key of everything that the images depend on, for caching encoded streams.
  virtual std::string cacheKey() const = 0;
};

}  // namespace cartvo::simulate
