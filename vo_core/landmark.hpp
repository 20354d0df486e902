#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "vo_core/fixed_vector.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

/// A landmark seen by one pair.
struct Sighting {
  std::int64_t frame = -1;                             ///< index of the pair
  bool stereo = false;                                 ///< whether it was found in the right image too
  Eigen::Vector2d left = Eigen::Vector2d::Zero();      ///< px
  Eigen::Vector2d parallax = Eigen::Vector2d::Zero();  ///< px, left minus right position; x is the disparity
  /// How much noisier each coordinate of the left position is than a typical patch's.
  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();
};

/// A patch of the world followed through the left images. The pair it is first seen by, its host, defines it:
/// the patch there is the template that all later images are compared with, so that no error adds up along a
/// track. Its place is the host's pixel and an inverse depth (J. Civera, A. Davison, J. Montiel, "Inverse
/// depth parametrization for monocular SLAM", 2008): it is as good for points at infinity as for near ones.
struct Landmark {
  int level = 0;       ///< of the pyramids that the patch is taken from, below kLandmarkLevels
  int age = 0;         ///< pairs that saw it, those of earlier hosts among them
  double trust = 1.0;  ///< in [0, 1]: how much it is believed to belong to the static world

  FixedVector<Sighting, kMostWindowPairs> sightings;   ///< the host's first; never empty
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();  ///< of the patch, host to last sighting
  Eigen::Matrix2d stereo_warp =
      Eigen::Matrix2d::Identity();  ///< of the patch, left to right, at the last sighting
  double row_miss = 0.0;            ///< px, below the row where the last stereo match was expected

  double inverse_depth = 0.0;  ///< 1/m, along the host camera's z axis
  double information = 0.0;    ///< m^2, inverse variance of inverse_depth; 0: not known
  /// What earlier hosts knew of inverse_depth, when the landmark got its present one; of the information,
  /// what counts of it (BundleSettings::standing_share).
  double prior_inverse_depth = 0.0;
  double prior_information = 0.0;
  /// How much the two err, 1/m, for each second by which the right cameras were exposed later than is
  /// believed.
  double by_late_right = 0.0;
  double prior_by_late_right = 0.0;

  const Sighting& host() const { return sightings.front(); }
  const Sighting& last() const { return sightings.back(); }
  bool hasDepth() const { return information > 0.0; }
};

/// Of the landmarks, those that the last pair found in its right image too.
int countStereo(const std::vector<Landmark>& landmarks);

/// How much noisier each coordinate of a left position is than a typical patch's, by the variance that its
/// alignment foretells (px^2 of the image), with a floor, as no patch is a plane.
Eigen::Vector2d relativeNoise(const Eigen::Vector2d& variance, int level);

/// Takes the last pair's positions to be noisier than their patches say, as those of a video are: what the
/// encoder has left as it was differs in nothing from what it was, and is off all the same.
void doubtLastPositions(std::vector<Landmark>& landmarks);

/// Takes back the last pair's stereo matches whose rows miss otherwise than those of most. Where a video has
/// not enough bits, blocks of its pictures lie up to two pixels off: the row is known and tells of it, the
/// column errs as much. `rows` is worked with.
void forgetOffRows(std::vector<Landmark>& landmarks, std::vector<double>& rows);

/// Landmarks as if the last pair had not found them in its right image.
void forgetLastStereo(std::vector<Landmark>& landmarks);

}  // namespace cartvo
