#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/stereo_camera.hpp"

// Evidence of the matches of one pair on how its two images belong together.

namespace cartvo::vo {

/// A patch of the left image found in the right one without assuming rows or the sign of the disparity, px.
struct LookMatch {
  Eigen::Vector2d left = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  std::optional<double> row_flow;  ///< rows that the patch has moved down since the left image before
};

/// Times of a pair, s.
struct PairTimes {
  double offset = 0.0;         ///< right minus left exposure
  double flow = 0.0;           ///< between the two left images of LookMatch::row_flow; 0 if there are none
  double period = 0.0;         ///< of the camera
  double offset_stddev = 0.0;  ///< standard deviation of `offset`
};

/// Answer of one pair to one question.
enum class Evidence : std::uint8_t {
  none,   ///< the images cannot tell
  right,  ///< they are as they should be
  wrong,
};

/// Answers of one pair.
struct StereoLook {
  Evidence rows = Evidence::none;   ///< do rows agree, after a rotation that self-calibration can correct?
  Evidence order = Evidence::none;  ///< does the left image come from the left camera?
  Evidence lag = Evidence::none;    ///< are the images as far apart in time as their timestamps say?
};

/// Answers by the matches of one pair.
StereoLook lookAt(const StereoCamera& camera, const std::vector<LookMatch>& matches, const PairTimes& times);

}  // namespace cartvo::vo
