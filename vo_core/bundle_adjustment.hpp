#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "vo_core/fixed_vector.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/reprojection.hpp"
#include "vo_core/rig_correction.hpp"
#include "vo_core/stereo_camera.hpp"

namespace cartvo {

/// One sighting of a landmark, measured. See Sighting.
struct BundleSighting {
  int pose = 0;  ///< index into the problem's poses
  bool stereo = false;
  Eigen::Vector2d left = Eigen::Vector2d::Zero();   ///< px
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< px, at the right camera's own instant

  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();  ///< of the left position, times BundleNoise's

  double disparity() const { return left.x() - right.x(); }
};

struct BundleLandmark {
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< in the host, z = 1
  double inverse_depth = 0.0;                          ///< 1/m; the start, then the result
  double information = 0.0;                            ///< m^2, the result's, with the poses held
  double prior_inverse_depth = 0.0;
  double prior_information = 0.0;
  double prior_by_late_right = 0.0;  ///< as Landmark's
  double by_late_right = 0.0;        ///< result: as Landmark's
  double weight = 1.0;
  int level = 0;  ///< as Landmark's
  FixedVector<BundleSighting, kMostWindowPairs>
      sightings;       ///< the host's first; its `left` defines the bearing
  double error = 0.0;  ///< result: rms of the last sighting's normalised residuals
};

/// Standard deviations of what is measured by patches of one level, px of the image.
struct BundleNoise {
  double pixel = 0.15;      ///< of each coordinate of a typical left position against its template
  double disparity = 0.15;  ///< of a disparity
  double stretch = 0.006;   ///< added to a disparity's for each px of it: near patches deform more
};

using BundleNoises = std::array<BundleNoise, kLandmarkLevels>;

struct BundleProblem {
  StereoCamera camera;
  /// The start, then the result. `by_late_right` of those that stand is given, of the free ones a result.
  TimedPoses poses;
  int fixed = 1;                ///< so many of the oldest poses stand
  double standing_share = 1.0;  ///< weight of left positions in their pairs: less than 1 if these poses err
  /// Information that holds a free pose where it starts, perturbations on the right: pose by pose, no more
  /// than there are. Of poses that stand it is not used; what is beyond its end is free.
  FixedVector<Matrix6d, kMostWindowPairs> held;
  std::vector<BundleLandmark> landmarks;
  BundleNoises noise;
};

/// Of free poses together, six each, oldest first; held without memory of their own.
constexpr int kMostPoseUnknowns = 6 * kMostWindowPairs;
using PoseMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostPoseUnknowns, kMostPoseUnknowns>;
using PoseVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostPoseUnknowns, 1>;

/// How much larger residuals are than assumed, by their median.
struct NoiseScale {
  double pixel = 1.0;      ///< those of left positions
  double disparity = 1.0;  ///< and of disparities
};

struct BundleResult {
  bool converged = false;
  /// Of the free poses together, perturbations on the right, six each, oldest first, against the fixed ones.
  PoseMatrix covariance;
  std::array<NoiseScale, kLandmarkLevels> noise_scale;
  /// Of the window's scale, a factor, as its disparities tell it: no more than that of a scale which is not
  /// known.
  double scale_variance = 0.0;
  /// What the residuals say of the rig, beyond what is corrected already: information and information times
  /// change. The scale of the whole window is left open here: it has come about under the same error.
  RigCorrection::Matrix rig_information = RigCorrection::Matrix::Zero();
  RigCorrection::Vector rig_gradient = RigCorrection::Vector::Zero();
};

/// Minimises the reprojection error in both images, each at its own instant, over the free poses and all
/// inverse depths: robust (Cauchy), Gauss-Newton, the depths eliminated by the Schur complement (B. Triggs et
/// al., "Bundle adjustment - a modern synthesis", 2000). Residuals of a sighting: the left position against
/// the landmark's projection (not at the host, which defines it), and its disparity against that of the
/// projections; and poses that are held against their starts.
class BundleAdjuster {
 public:
  BundleAdjuster();
  BundleAdjuster(BundleAdjuster&&) noexcept;
  BundleAdjuster& operator=(BundleAdjuster&&) noexcept;
  ~BundleAdjuster();

  BundleResult adjust(BundleProblem& problem, const BundleSettings& settings);

 private:
  struct Work;
  std::unique_ptr<Work> work_;  // kept from problem to problem for its memory
};

}  // namespace cartvo
