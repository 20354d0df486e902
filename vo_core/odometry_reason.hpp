#pragma once

#include <array>
#include <cstdint>

// Why a pair is INVALID: the one table of the reasons, and that of the gross faults. Enumerations, bits of
// odometry_t.reasons, names, docs/controllers.md and the advice of `cartvo replay` come from here.

namespace cartvo::vo {

// X(name in summary.json, bit of odometry_t.reasons, name for people, sentence of the documentation, advice
// of a replay without a valid pair). In the order of the bits.
#define CARTVO_ODOMETRY_REASONS(X)                                                                           \
  X(first_pair, 1, "first pair", "first pair after a start or a loss", kSinglePair)                          \
  X(too_few_features, 2, "too few features", "fewer than 30 features: dark, covered or blank",               \
    "the images show too little texture, or are nearly black or white")                                      \
  X(too_few_matches, 4, "too few matches", "too few features were tracked and matched in stereo", kOtherRig) \
  X(too_few_inliers, 8, "too few inliers",                                                                   \
    "no motion agrees with enough matches, or another one with half as many (ambiguous)", kNoMotion)         \
  X(high_residual, 16, "high residual", "the residuals of the best motion are too large", kNoMotion)         \
  X(time_step, 32, "time step", "the time between two pairs was not between 0 and 1.5 s",                    \
    "the instants of the pairs are too far apart for odometry, or do not increase")                          \
  X(implausible_motion, 64, "implausible motion", "faster than 50 m/s or 4 rad/s", kNoMotion)                \
  X(degenerate_geometry, 128, "degenerate geometry",                                                         \
    "the matches do not determine all directions of the motion", kNoMotion)                                  \
  X(no_pair, 256, "no pair", "no pair came within a frame period", "")                                       \
  X(damaged_frame, 512, "damaged frame", "a frame lost packets", "")                                         \
  X(wrong_size, 1024, "wrong picture size", "a stream has another size than the rig file", "")               \
  X(zero_velocity, 2048, "zero velocity", "only in VALID messages: standstill", kSinglePair)                 \
  X(offset_uncertain, 4096, "offset uncertain",                                                              \
    "the time offset is less certain than `odometry.maximum_offset_uncertainty`, a clock has not "           \
    "settled after a connection, or `utime` would be later than now",                                        \
    "the time offset of the cameras is not known well enough")                                               \
  X(repeated_picture, 8192, "repeated picture",                                                              \
    "a camera is frozen: it repeats its picture while the cart moves", "the same images are repeated")       \
  X(offset_too_large, 16384, "offset too large",                                                             \
    "the exposures of the pair (`offset_us`) are farther apart than `odometry.maximum_offset`",              \
    "the exposures of left and right are too far apart")                                                     \
  X(wrong_stereo_geometry, 32768, "wrong stereo geometry",                                                   \
    "the pictures do not belong together as the rig file says; `self_check` in health says why", kOtherRig)  \
  X(bound, 65536, "bound above its alert limit", "a bound reaches its alert limit",                          \
    "the motion is not known as well as --alert-limits ask; odometry.csv has the bounds")

/// Unless the sentence says otherwise an invalid estimate repeats the last pose, and the epoch goes on. A new
/// epoch starts at time_step, after wrong_stereo_geometry, and when a camera that repeated its image recovers
/// after an unknown distance. StereoOdometry has no pair without images and no alert limits: it does not use
/// no_pair, damaged_frame, wrong_size and bound. high_residual is of `estimator: thesis` only.
enum class OdometryReason : std::uint32_t {
  none,  ///< the estimate is valid
#define CARTVO_ENUMERATOR(name, bit, words, sentence, advice) name = bit,
  CARTVO_ODOMETRY_REASONS(CARTVO_ENUMERATOR)
#undef CARTVO_ENUMERATOR
};

/// A row of the table.
struct OdometryReasonText {
  OdometryReason reason;
  const char *name, *words, *sentence, *advice;
};

inline constexpr auto kOdometryReasons = [] {
  constexpr const char* kSinglePair = "there is no motion to measure in a single pair";
  constexpr const char* kOtherRig =
      "left and right do not fit to each other by this rig: is it the rig of these images, are left "
      "and right exchanged?";
  constexpr const char* kNoMotion =
      "no motion explains the images: are the images in order, and is it their rig?";
#define CARTVO_ROW(name, bit, words, sentence, advice) \
  OdometryReasonText{OdometryReason::name, #name, words, sentence, advice},
  return std::to_array<OdometryReasonText>({CARTVO_ODOMETRY_REASONS(CARTVO_ROW)});
#undef CARTVO_ROW
}();
#undef CARTVO_ODOMETRY_REASONS

/// Set of reasons. Only `estimator: thesis` sets more than one.
class OdometryReasons {
 public:
  constexpr OdometryReasons() = default;
  constexpr OdometryReasons(OdometryReason reason) { add(reason); }  // NOLINT(google-explicit-constructor)

  constexpr void add(OdometryReason reason) { bits_ |= static_cast<std::uint32_t>(reason); }
  constexpr bool has(OdometryReason reason) const {
    return (bits_ & static_cast<std::uint32_t>(reason)) != 0;
  }
  constexpr std::uint32_t bits() const { return bits_; }  ///< as in odometry_t.reasons
  constexpr bool operator==(const OdometryReasons&) const = default;

 private:
  std::uint32_t bits_ = 0;
};

// X(name in summary.json, sentence for the operator)
#define CARTVO_STEREO_FAULTS(X)                                                                      \
  /* both images are the same picture */                                                             \
  X(same_picture,                                                                                    \
    "both cameras give the same picture: check that cameras.left.url and cameras.right.url are the " \
    "addresses of two cameras")                                                                      \
  /* the left image comes from the right camera and vice versa */                                    \
  X(swapped,                                                                                         \
    "the left and the right picture are exchanged, or from one camera: check cameras.left.url and "  \
    "cameras.right.url; if they are right, switch mirroring off, or calibrate again, as one is "     \
    "turned")                                                                                        \
  /* rows disagree by more than self-calibration can correct: another rig's file */                  \
  X(misaligned,                                                                                      \
    "the pictures do not fit the rig file: check that it is the file of these two cameras; if a "    \
    "camera was turned, calibrate again")                                                            \
  /* the right image lies a period of the camera or more from its timestamp */                       \
  X(period_offset,                                                                                   \
    "the pictures of a pair were taken a frame or more apart, unlike their timestamps: check both "  \
    "cameras' clocks and frame rates")

/// A gross fault of the rig or of the pairs, at which a motion may look good and be wrong.
enum class StereoFault : std::uint8_t {
  none,
  suspected,  ///< one of the following was seen, but not yet in enough pairs to name it
#define CARTVO_ENUMERATOR(name, sentence) name,
  CARTVO_STEREO_FAULTS(CARTVO_ENUMERATOR)
#undef CARTVO_ENUMERATOR
};

struct StereoFaultText {
  StereoFault fault;
  const char *name, *sentence;
};

/// The faults that are named.
inline constexpr auto kStereoFaults = std::to_array<StereoFaultText>({
#define CARTVO_ROW(name, sentence) {StereoFault::name, #name, sentence},
    CARTVO_STEREO_FAULTS(CARTVO_ROW)
#undef CARTVO_ROW
});
#undef CARTVO_STEREO_FAULTS

}  // namespace cartvo::vo
