#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "vo_core/fixed_vector.hpp"
#include "vo_core/key_frames.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// By how much a pair's pose, as its pictures show it, is off: perturbation on the right, in the axes of that
/// pair's camera, m and rad.
struct PoseShift {
  Vector6d value = Vector6d::Zero();
  Vector6d variance = Vector6d::Zero();
};

/// A motion to a pair from the last one, as the pictures show it.
struct ShownMotion {
  Vector6d motion = Vector6d::Zero();     ///< vectorFromMotion, in the camera's axes
  Vector6d deviation = Vector6d::Zero();  ///< standard deviations, as the landmarks tell them
  double time_step = 0.0;                 ///< s, positive
  bool guessed = false;                   ///< so is the deviation: nothing is learned from it
};

/// What a video's poses err by that all landmarks agree on, so that no residual tells. Pictures that are not
/// key frames are made of the one before by motion vectors of quarter pixels, each coded as its difference
/// from those to the left and above (ITU-T H.264, 8.4.1.3): what is not worth its bits stays behind, and all
/// over the picture in the same direction. What tells is that a cart does not leap: how far five poses in a
/// row are off a cubic of their instants.
///
/// *Key frames* show the world ahead of the pictures between them. Axis by axis the shift is s b, forwards
/// where the camera moves forwards and backwards where it moves backwards, with the motion's standard
/// deviation s: weak geometry makes more of the same pixels. b has been found to be the same at each speed.
/// It is a running mean over key frames, beginning from none, and so is its mean square error, which begins
/// from the most that any stream had. A pair has one of three such shifts: its left picture is a key frame,
/// its right one, or both.
///
/// *The pictures between them* are off by little in the light, but at dusk, where noise takes the bits, by
/// several standard deviations, another way in each. By how much poses leap more than their landmarks say is
/// a running mean, too; of the axes along and around which a wheeled cart moves smoothly, as bumps in the
/// road make it leap along and around the others. These are the camera's axes: one that looks down steeply
/// counts bumps in, on the safe side. It takes five pairs in a row without a key frame to learn it, and to
/// learn shifts; a video with more of them is taken for what its landmarks say.
class VideoErrors {
 public:
  /// Begins anew at a pair that no motion leads to, or where the cart is held; what has been learned stays.
  /// Returns how that pair is shifted, if motions are known as well as the last: it cannot be taken out, so
  /// that all of it is variance.
  std::optional<PoseShift> begin(KeyFrames pair);

  /// Takes the motion to the next pair and returns how that one is shifted; nothing without a key frame, and
  /// nothing in a stream of nothing else.
  std::optional<PoseShift> next(KeyFrames pair, const ShownMotion& shown);

  /// How many times as large as the landmarks say the variance of a pose is where no key frame is: 1 to 30.
  double excess() const;

 private:
  struct Passed {
    KeyFrames key_frames;
    ShownMotion shown{};                ///< from the pair before
    Vector6d lever = Vector6d::Zero();  ///< by which b shifts a key frame
  };
  struct Learned {
    Vector6d mean;    ///< of b
    Vector6d square;  ///< mean square of b less that
  };
  static constexpr std::size_t kClasses = 3;  ///< left, right, both
  static constexpr std::size_t kPairs = 5;    ///< the key frame's, and two on each side
  using Levers = std::array<Vector6d, kClasses>;
  using Weights = std::array<double, kPairs>;

  static Learned unknown();
  static std::size_t classOf(KeyFrames pair) { return (pair.left ? 1 : 0) + (pair.right ? 2 : 0) - 1; }
  Weights weightsOffCubic() const;
  void learn();
  void learnRoughness(const Vector6d& leap);
  void learnShift(const Vector6d& leap, const Levers& levers);

  FixedVector<Passed, kPairs> passed_;  ///< oldest first
  std::array<Learned, kClasses> learned_{unknown(), unknown(), unknown()};
  double time_step_ = 0.0;                 ///< s, the last
  Vector6d roughness_ = Vector6d::Zero();  ///< mean square of leaps where no key frame is: a pose's variance
  Vector6d foretold_ = Vector6d::Zero();   ///< what it would be by the landmarks alone
  int rough_pairs_ = 0;                    ///< that tell both, up to the memory
};

}  // namespace cartvo
