#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "vo_core/geometry/fixed_vector.hpp"
#include "vo_core/key_frames.hpp"
#include "vo_core/rigid_motion.hpp"

// Model of the pose errors that video compression causes.

namespace cartvo::vo {

/// Error of a pair's pose caused by the codec: perturbation on the right, in the axes of that pair's camera,
/// m and rad.
struct PoseShift {
  Vector6d value = Vector6d::Zero();
  Vector6d variance = Vector6d::Zero();
};

/// Motion measured from the previous pair, with its codec errors.
struct MeasuredMotion {
  Vector6d motion = Vector6d::Zero();  ///< vectorFromMotion, in the camera's axes
  Vector6d stddev = Vector6d::Zero();  ///< by the landmarks
  double time_step = 0.0;              ///< s, positive
  bool noise_uncalibrated = false;     ///< the stddev is an assumption: the model is not updated
};

/// Model of the pose errors that video coding causes. All landmarks share them, so that residuals do not show
/// them. Images between key frames are predicted from the previous one with motion vectors of quarter pixels,
/// each coded as the difference from those to the left and above (ITU-T H.264, 8.4.1.3): motion that is not
/// worth its bits is left out, over the whole image in the same direction. The model observes these errors
/// because a cart moves smoothly: the innovation is the deviation of five consecutive poses from a cubic in
/// time.
///
/// *Key frames* do not lag; their poses lie ahead of those from the images between them. The shift of each
/// axis is s b, forwards if the camera moves forwards and backwards if it moves backwards, where s is the
/// motion's standard deviation: weak geometry amplifies the same pixel error. b was found to be independent
/// of the speed. Its mean and variance are running means over key frames; they start from zero and from the
/// largest value of any stream. There is one b each for pairs whose left, right or both images are key
/// frames.
///
/// *Images between key frames* have small errors in daylight, but at dusk, when noise takes the bits, errors
/// of several standard deviations, independent from image to image. The inflation is the running mean of the
/// squared innovation over the variance by the landmarks, of the axes along and around which a wheeled cart
/// moves smoothly (forwards and yaw); bumps of the road disturb the others. The axes are the camera's: a
/// camera that looks down steeply includes bumps, which is conservative. Both estimates require five
/// consecutive pairs without a key frame; a video with more key frames gets no inflation.
class CodecErrorModel {
 public:
  /// Restarts the sequence of consecutive pairs with `pair`: no motion to it was measured, or the cart is at
  /// a standstill. Keeps the estimates. Returns the shift of a key frame, with the value zero and the whole
  /// expected square as variance, which is zero before the first motion; returns nothing for other pairs.
  std::optional<PoseShift> restart(KeyFrames pair);

  /// Updates with the motion to the next pair and returns the shift of that pair; nothing if it is not a key
  /// frame, or if the previous pair is a key frame of the same kind.
  std::optional<PoseShift> update(KeyFrames pair, const MeasuredMotion& measured);

  /// Factor on the variance by the landmarks of a pose between key frames, 1 to 30.
  double poseNoiseInflation() const;

 private:
  struct History {
    KeyFrames key_frames;
    MeasuredMotion measured{};                ///< from the previous pair
    Vector6d sensitivity = Vector6d::Zero();  ///< d(shift)/d(b) of a key frame
  };
  struct BiasEstimate {
    Vector6d mean;      ///< of b
    Vector6d variance;  ///< of b
  };
  static constexpr std::size_t kClasses = 3;  ///< key frames: left, right, both
  static constexpr std::size_t kPairs = 5;    ///< the key frame's, and two on each side
  using Sensitivities = std::array<Vector6d, kClasses>;
  using Weights = std::array<double, kPairs>;

  static BiasEstimate initialBias();
  static std::size_t classOf(KeyFrames pair) { return (pair.left ? 1 : 0) + (pair.right ? 2 : 0) - 1; }
  Weights weightsOffCubic() const;
  void updateEstimates();
  void updateRoughness(const Vector6d& innovation);
  void updateBias(const Vector6d& innovation, const Sensitivities& sensitivities);

  FixedVector<History, kPairs> history_;  ///< oldest first
  std::array<BiasEstimate, kClasses> biases_{initialBias(), initialBias(), initialBias()};
  double time_step_ = 0.0;                           ///< s, of the last motion
  Vector6d roughness_ = Vector6d::Zero();            ///< mean squared innovation without key frames
  Vector6d predicted_roughness_ = Vector6d::Zero();  ///< the same by the landmarks' noise alone
  int rough_pairs_ = 0;  ///< number of pairs in both, up to the length of the memory
};

}  // namespace cartvo::vo
