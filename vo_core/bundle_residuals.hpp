#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"

// The residuals of a bundle, linearised. Not for use outside the bundle adjustment.

namespace cartvo {

constexpr int kRowPoses = 4;  // poses that one residual depends on at most

/// What all landmarks share: the rig's correction, and the window's scale.
constexpr int kShared = RigCorrection::kSize + 1;
using SharedVector = Eigen::Matrix<double, kShared, 1>;
using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;
using RowVector6d = Eigen::Matrix<double, 1, 6>;

/// One residual, linearised: its derivative by some poses and by the landmark's inverse depth.
struct BundleRow {
  double residual = 0.0;  // measured minus predicted, in standard deviations
  double weight = 0.0;
  double by_inverse_depth = 0.0;
  SharedVector by_shared = SharedVector::Zero();
  double by_late_right = 0.0;  ///< the right camera's later exposure itself, not what it did to earlier poses
  int poses = 0;
  std::array<int, kRowPoses> pose{};
  std::array<RowVector6d, kRowPoses> by_pose{RowVector6d::Zero(), RowVector6d::Zero(), RowVector6d::Zero(),
                                             RowVector6d::Zero()};

  void add(int index, const RowVector6d& derivative) {
    for (int i = 0; i < poses; ++i) {
      if (pose[i] != index) continue;
      by_pose[i] += derivative;
      return;
    }
    pose[poses] = index;
    by_pose[poses++] = derivative;
  }
};

/// The cameras of a problem, each left and right one as seen from each left one.
class BundleCameras {
 public:
  BundleCameras(const std::vector<TimedPose>& poses, double baseline);

  const Eigen::Isometry3d& leftFromHost(int camera, int host) const {
    return T_left_host_[camera * count_ + host];
  }
  const Eigen::Isometry3d& rightFromHost(int camera, int host) const {
    return T_right_host_[camera * count_ + host];
  }
  const RightCamera& right(int camera) const { return right_[camera]; }

 private:
  int count_;
  std::vector<RightCamera> right_;
  std::vector<Eigen::Isometry3d> T_left_host_, T_right_host_;
};

/// The residuals of one landmark.
class LandmarkRows {
 public:
  LandmarkRows(const BundleProblem& problem, const BundleCameras& cameras, double robust_width)
      : problem_(problem), cameras_(cameras), robust_width_(robust_width) {}

  /// False if a camera has the landmark behind it.
  bool linearise(const BundleLandmark& landmark);

  /// In the order of the sightings: two of the left position, but for the host, and one of the disparity.
  const std::vector<BundleRow>& rows() const { return rows_; }

 private:
  bool addSighting(const BundleLandmark& landmark, const BundleSighting& sighting, int host, bool is_host);
  bool addDisparity(const BundleLandmark& landmark, const BundleSighting& sighting, int host, bool is_host,
                    const Projection& left, const ProjectionJacobians& by_left);

  const BundleProblem& problem_;
  const BundleCameras& cameras_;
  double robust_width_;
  std::vector<BundleRow> rows_;
};

}  // namespace cartvo
