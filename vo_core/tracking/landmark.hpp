#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/geometry/residual_variance.hpp"
#include "vo_core/landmark_view.hpp"
#include "vo_core/odometry_settings.hpp"

// Landmark of the window, with its observations and inverse depth.

namespace cartvo::vo {

/// Observation of a landmark by one pair.
struct Observation {
  std::int64_t frame = -1;                                  ///< index of the pair
  bool stereo = false;                                      ///< whether it has a match in the right image
  bool outlier = false;                                     ///< PosePoint::outlier of the pair's pose search
  Eigen::Vector2d left = Eigen::Vector2d::Zero();           ///< px
  Eigen::Vector2d stereo_offset = Eigen::Vector2d::Zero();  ///< px, left minus right position; x: disparity
  /// Stddev of each coordinate of `left` relative to that of a typical patch.
  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();
  /// px, displacement of the left and right position by the motion from the exposure of the image to that of
  /// the position's row; zero with a global shutter. See correctRows().
  Eigen::Vector2f left_row_shift = Eigen::Vector2f::Zero(), right_row_shift = Eigen::Vector2f::Zero();

  Eigen::Vector2d right() const { return left - stereo_offset; }  ///< px
  /// Positions as if all rows were exposed with the middle one, px.
  Eigen::Vector2d leftAtExposure() const { return left - left_row_shift.cast<double>(); }
  Eigen::Vector2d rightAtExposure() const { return right() - right_row_shift.cast<double>(); }
};

constexpr double kStillFlow = 0.5;  ///< px, the most that noise and a video codec move a still landmark

/// A patch of the world tracked through the left images. Its anchor, the first pair of its observations,
/// defines the template that is compared with all later images, so that no error accumulates. Its position is
/// the anchor's pixel and an inverse depth (J. Civera, A. Davison, J. Montiel, "Inverse depth parametrization
/// for monocular SLAM", 2008), which suits points at infinity as well as near ones.
struct Landmark {
  int level = 0;  ///< pyramid level of the patch, below kLandmarkLevels
  int age = 0;    ///< number of pairs with an observation, including those before a change of the anchor
  ResidualVariance residuals;  ///< of its observations
  double weight = 1.0;         ///< as part of the static world: ResidualVariance::weight(), at most 1

  FixedVector<Observation, kMaximumWindowPairs> observations;  ///< anchor first; never empty
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();          ///< of the patch, anchor to last left image
  Eigen::Matrix2d stereo_warp =
      Eigen::Matrix2d::Identity();  ///< of the patch, left to right image of the last stereo match

  double inverse_depth = 0.0;  ///< 1/m, along the z axis of the anchor camera
  double information = 0.0;    ///< m^2, inverse variance of inverse_depth; 0: no depth

  const Observation& anchor() const { return observations.front(); }
  const Observation& last() const { return observations.back(); }
  /// Length (px) of the way from the last but one to the last left position; 0 with one observation.
  double lastFlow() const {
    const auto count = observations.size();
    return count > 1 ? (last().left - observations[count - 2].left).norm() : 0.0;
  }
  /// The observation by the pair with this index, or nullptr.
  const Observation* find(std::int64_t frame) const {
    const auto found = std::find_if(observations.begin(), observations.end(),
                                    [&](const Observation& seen) { return seen.frame == frame; });
    return found == observations.end() ? nullptr : &*found;
  }
  bool hasDepth() const { return information > 0.0; }
};

/// The landmark where its last pair observed it. `previous`: index of the pair tracked before.
LandmarkView viewOf(const Landmark& landmark, std::int64_t previous);

/// Number of landmarks with a stereo match in the last pair.
int countStereo(const std::vector<Landmark>& landmarks);

/// Number of landmarks with a depth.
int countWithDepth(const std::vector<Landmark>& landmarks);

/// Stddev of each coordinate of a left position relative to a typical patch, from the predicted variance of
/// its alignment (px^2 of the full image), with a floor because no patch is a plane.
Eigen::Vector2d relativeNoise(const Eigen::Vector2d& variance, int level, const TrackingSettings& settings);

/// Increases the noise of the last pair's positions for inter-coded pictures: a block that the encoder copies
/// unchanged matches perfectly, but its position has an error.
void inflateCodecNoise(std::vector<Landmark>& landmarks, const TrackingSettings& settings);

/// Removes all stereo matches of the last pair.
void discardLastStereo(std::vector<Landmark>& landmarks);

}  // namespace cartvo::vo
