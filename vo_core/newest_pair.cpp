#include "vo_core/newest_pair.hpp"

namespace cartvo {

void matchTurned(const NewestPair& pair, const Eigen::Isometry3d& T_right_left, const RigMonitor& rig,
                 std::vector<Landmark>& landmarks) {
  const Eigen::Isometry3d turned(rig.expected().rotation().transpose());
  pair.tracker.matchStereo(landmarks, pair.window, pair.left, pair.right, turned * T_right_left,
                           pair.window.back().T_world_camera);
}

}  // namespace cartvo
