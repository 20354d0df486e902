#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"

// Not for use outside the bundle adjustment.

namespace cartvo {

/// The cameras of a problem, each left and right one as seen from each left one.
class BundleCameras {
 public:
  using Change = Eigen::Matrix<double, 3, 4>;  // of R and t

  void take(const BundleProblem& problem);

  /// After the problem's free poses have moved.
  void update(const BundleProblem& problem);

  const Eigen::Isometry3d& leftFromHost(int camera, int host) const {
    return T_left_host_[place(camera, host)];
  }
  const Eigen::Isometry3d& rightFromHost(int camera, int host) const {
    return T_right_host_[place(camera, host)];
  }
  const RightCamera& right(int camera) const { return right_[camera]; }

  /// Whether the right camera moves with a free pose.
  bool rightIsFree(int camera) const;

  /// How the left and the right camera, as seen from a host, change per second by which all right cameras are
  /// exposed later than is believed: by that itself, and by what it has done to the poses that stand.
  Change leftByLateRight(const BundleProblem& problem, int camera, int host) const;
  Change rightByLateRight(const BundleProblem& problem, int camera, int host) const;

 private:
  std::size_t place(int camera, int host) const { return camera * count_ + host; }

  int count_ = 0;
  int fixed_ = 0;
  std::vector<RightCamera> right_;
  std::vector<Eigen::Isometry3d> T_left_host_, T_right_host_;
};

}  // namespace cartvo
