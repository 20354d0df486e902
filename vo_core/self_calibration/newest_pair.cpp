// Stereo matching of the newest pair with the expected rotation of the right camera.
#include "vo_core/self_calibration/newest_pair.hpp"

namespace cartvo::vo {

void matchStereoRotated(const NewestPair& pair, const Eigen::Isometry3d& T_right_left,
                        const RigCalibration& rig, std::vector<Landmark>& landmarks) {
  const Eigen::Isometry3d right_rotation(rig.expected().rotation().transpose());
  const RowTransform right_from_left(pair.camera, pair.timing, pair.window.back(),
                                     right_rotation * T_right_left);
  pair.tracker.matchStereo(landmarks, pair.window, pair.left, pair.right, right_from_left,
                           pair.window.back().T_world_camera);
}

}  // namespace cartvo::vo
