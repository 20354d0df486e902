#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/patch_search.hpp"
#include "vo_core/integrity/stereo_look.hpp"
#include "vo_core/odometry_estimate.hpp"

namespace cartvo::vo {

/// Collects the evidence on one question of StereoLook.
class GeometryQuestion {
 public:
  void update(Evidence evidence);

  bool isWrong() const { return wrong_; }
  /// Whether two looks contradict a question that no look has answered well so far.
  bool isSuspected() const { return !wrong_ && !settled_ && contradictions_ > 1; }
  /// Whether a look has answered it well.
  bool isSettled() const { return settled_; }
  /// Whether the last answer contradicts what is taken for true.
  bool isContested() const { return contradictions_ > 0; }

 private:
  bool wrong_ = false;
  bool settled_ = false;    ///< a look has shown what is right
  int contradictions_ = 0;  ///< consecutive answers against the present one
  int silent_ = 0;          ///< looks without an answer since the last one
};

/// Detects gross faults of the rig, with which a motion may look good and be wrong (StereoFault). It looks at
/// the first pairs and then at intervals, with matches of its own that assume neither a calibration nor a
/// correction by self-calibration.
///
/// A fault is named when it shows in four looks, some pairs apart, and ends when as many looks show correct
/// images. Two images that are equal to the byte are named at once. Until a look has shown that the images
/// belong together, two looks against it make the fault suspected.
class StereoGeometryCheck {
 public:
  explicit StereoGeometryCheck(const StereoCamera& camera);

  /// Looks at the next pair if a look is due. `repeats`: an image equals the previous one, so that the pair
  /// is no new evidence. Returns the fault.
  StereoFault update(const StereoImages& images, bool repeats);

 private:
  void updateSamePicture(const StereoImages& images);
  void updatePeriod(const StereoImages& images);
  void look(const StereoImages& images);
  void match(const ImagePyramid& left, const ImagePyramid& right);
  std::int64_t nextInterval() const;
  StereoFault fault() const;

  StereoCamera camera_;
  PatchSearch search_;
  PyramidPool pyramids_;
  SharedPyramid previous_left_;  ///< of the previous pair, if a look is due
  std::int64_t previous_exposure_ns_ = 0;
  double period_ = 0.0;  ///< s, of the cameras; 0 before the second pair
  std::vector<LookMatch> matches_;
  std::vector<Eigen::Vector2i> found_;  ///< centres of the patches of matches_
  GeometryQuestion rows_, order_, lag_;
  int looks_ = 0;                                    ///< at the start, one pair after the other
  std::int64_t last_look_ns_ = 0;                    ///< exposure of the left image of the last look
  std::int64_t interval_ns_ = 0;                     ///< to the next one
  std::array<std::uint64_t, 2> previous_digests_{};  ///< pictureDigest() of left and right
  int same_picture_pairs_ = 0;                       ///< pairs for which the fault lasts
};

}  // namespace cartvo::vo
