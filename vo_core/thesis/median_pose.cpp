// Component-wise median of poses, robust against a minority of wrong ones.
#include "vo_core/thesis/median_pose.hpp"

#include "common/statistics.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

Eigen::Isometry3d medianPose(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.linear() = poses.front().linear();
  std::vector<Vector6d> vectors;
  vectors.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses) {
    Vector6d vector = vectorFromMotion(base.inverse() * pose);
    vector.head<3>() = pose.translation();
    vectors.push_back(vector);
  }

  Vector6d middle;
  std::vector<double> component(vectors.size());
  for (int i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < vectors.size(); ++j)
      component[j] = vectors[j][i];
    middle[i] = median(component);
  }
  Eigen::Isometry3d pose = motionFromVector(middle);
  pose.linear() = base.linear() * pose.linear();
  return pose;
}

}  // namespace cartvo::vo
