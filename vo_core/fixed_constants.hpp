#pragma once

#include <array>
#include <cstddef>

// The tuned constants that are not settings: the one list of their values, units and sources. Each is in a
// namespace of its part: still_regions::kMemory. tuned_constants.hpp has those of OdometrySettings. Numbers
// that only end iterations or bound buffers, and those of kernels and geometry (image, stereo, tracking,
// estimation), stand where they are used.

namespace cartvo::vo {

// X(part, name, value, unit, source)
#define CARTVO_FIXED_CONSTANTS(X)                                                                          \
  X(still_regions, kExpectedFlow, 3.0, "px", "less says nothing about a landmark")                         \
  X(still_regions, kMovedFlow, 1.5, "px", "more shows that the cell moves")                                \
  X(still_regions, kMinimumPairs, 8.0, "pairs", "half a second of a turning or driving cart")              \
  X(still_regions, kMinimumRatio, 4.0, "",                                                                 \
    "pairs in which the cell was still, over those in which it moved")                                     \
  X(still_regions, kMemory, 0.98, "per pair", "dirt is wiped off, the lettering is switched off")          \
  X(still_regions, kMaximumShare, 1.0 / 3.0, "", "of the landmarks and of the cells")                      \
  X(codec_errors, kPoseVariance, 0.5, "",                                                                  \
    "of that of a motion with independent pose errors, which has the errors of two")                       \
  X(codec_errors, kInitialBiasStddev, 2.0, "", "of b, in standard deviations of a motion")                 \
  X(codec_errors, kMinimumBiasStddev, 0.2, "", "of b, in standard deviations of a motion")                 \
  X(codec_errors, kBiasMemory, 0.8, "", "from key frame to key frame, without noise")                      \
  X(codec_errors, kRoughnessMemory, 20, "pairs", "assumption")                                             \
  X(codec_errors, kMinimumRoughPairs, 5, "pairs", "assumption")                                            \
  X(codec_errors, kInnovationGate, 3.0, "", "three standard deviations")                                   \
  X(codec_errors, kMaximumInflation, 30.0, "", "larger errors have other causes")                          \
  X(codec_errors, kMaximumStepRatio, 3.5, "", "of consecutive time steps")                                 \
  X(stereo_look, kMinimumMatches, 24, "", "twice what ten mismatches can outvote")                         \
  X(stereo_look, kRowTolerance, 2.0, "px", "the search is wrong by less, a mismatch mostly by more")       \
  X(stereo_look, kDisagreeingShare, 0.5, "", "of the matches")                                             \
  X(stereo_look, kAgreeingShare, 0.7, "", "of the matches")                                                \
  X(stereo_look, kRotatedShare, 0.9, "", "of the matches")                                                 \
  X(stereo_look, kSignificance, 3.0, "", "three standard deviations")                                      \
  X(stereo_look, kRowNoise, 0.15, "px",                                                                    \
    "row errors of the search and of good lenses; matches share them: no average")                         \
  X(stereo_look, kBands, 8, "", "bands of rows: lettering fills one or two")                               \
  X(stereo_look, kMinimumBands, 3, "", "more than lettering fills")                                        \
  X(stereo_look, kMinimumInBand, 2, "", "matches by which a band counts")                                  \
  X(stereo_look, kMinimumNear, 12, "", "assumption")                                                       \
  X(stereo_look, kOrderMajority, 4, "", "near matches of one order over those of the other")               \
  X(stereo_look, kDistant, 0.0015, "rad", "disparity of a point 700 baselines away, which is not near")    \
  X(geometry_check, kAnswers, 4, "", "looks that change an answer")                                        \
  X(geometry_check, kFirstLooks, 4, "", "at the first pairs, one after the other")                         \
  X(geometry_check, kInterval, 3'000'000'000, "ns",                                                        \
    "from look to look, after all questions have had a good answer")                                       \
  X(geometry_check, kUnsettledInterval, 1'000'000'000, "ns",                                               \
    "before: at 5 Hz four looks name a fault within 5 s")                                                  \
  X(geometry_check, kContestedInterval, 150'000'000, "ns",                                                 \
    "after a look that contradicts: patches and motion have changed")                                      \
  X(geometry_check, kFlowShare, 8, "", "width over the largest motion in a period, to both sides")         \
  X(geometry_check, kSamePicturePairs, 20, "pairs",                                                        \
    "unequal ones that end the fault; a stream may skip some")                                             \
  X(geometry_check, kPeriodGrowth, 1.01, "per pair", "so that the period follows a slower camera")         \
  X(frozen_camera, kLimitFactor, 3.0, "",                                                                  \
    "on standstill limits: noise of positions and depths; rendered: 1.2 mm, 0.2 mrad")                     \
  X(frozen_camera, kMinimumLandmarkShare, 0.25, "",                                                        \
    "of those at the start; on rendered standstills three quarters match")                                 \
  X(pitch_search, kFewMatchesShare, 0.2, "",                                                               \
    "of landmarks: with a correct rig a quarter is matched, by chance a fifth")                            \
  X(pitch_search, kMinimumLandmarks, std::size_t{50}, "", "for a meaningful share")                        \
  X(pitch_search, kMinimumPatches, std::size_t{24}, "", "of two scenes a fifth agrees by chance")          \
  X(pitch_search, kSearchedRows, 1.5, "px", "half the range of the stereo search over rows")               \
  X(pitch_search, kRowTolerance, 3.0, "px", "near points move up and down between the exposures")          \
  X(pitch_search, kSearchInterval, 20, "pairs", "the search takes some milliseconds")                      \
  X(pitch_search, kMaximumPitch, 0.0105, "rad", "0.6 degrees, up to which self-calibration corrects")      \
  X(landmark_errors, kSharedVariance, 0.05, "",                                                            \
    "of their variance in an image, in common: at rest 0.02 with MPEG-4 and JPEG, more in single pairs")   \
  X(track_start, kSpeed, 15.0, "m/s, rad/s", "stddev of an unknown velocity")                              \
  X(track_start, kEstablished, 7.0, "nats",                                                                \
    "odds of 1,000: a bus ahead that fills two thirds of the view does not reach them")                    \
  X(track_adjustment, kStopTolerance, 2.0, "", "on the limits of a standstill, for the noise of a motion") \
  X(track_adjustment, kLongestStep, 0.1, "s", "the gate of an uncertain motion grows no more beyond")      \
  X(protection, kBoundFactor, 3.9, "",                                                                     \
    "normal errors exceed it, to either side, with a probability of 1e-4")                                 \
  X(protection, kUnannouncedJerk, 50.0, "m/s^3, rad/s^3",                                                  \
    "a kerb; lively rendered drives have an RMS of 30 m/s^3")                                              \
  X(protection, kMotionFloor, 0.005, "m", "errors of landmarks and rig that no covariance contains")       \
  X(protection, kRotationFloor, 0.0004, "rad", "the same")                                                 \
  X(protection, kWayShare, 0.004, "", "of the distance: the same, most of them of scale")                  \
  X(protection, kKerbRate, 0.1, "rad/s",                                                                   \
    "all that a kerb changes a rate by; 9 Hz, as at night, miss it as a whole")

#define CARTVO_CONSTANT(part, name, value, unit, source) \
  namespace part {                                       \
  inline constexpr auto name = value;                    \
  }
CARTVO_FIXED_CONSTANTS(CARTVO_CONSTANT)
#undef CARTVO_CONSTANT

struct FixedConstant {
  const char* name;  ///< "still_regions::kMemory"
  double value;
  const char* unit;    ///< empty: a ratio, share or count
  const char* source;  ///< derivation, paper or measurement
};

inline constexpr auto kFixedConstants = std::to_array<FixedConstant>({
#define CARTVO_ROW(part, name, value, unit, source) \
  {#part "::" #name, static_cast<double>(part::name), unit, source},
    CARTVO_FIXED_CONSTANTS(CARTVO_ROW)
#undef CARTVO_ROW
});
#undef CARTVO_FIXED_CONSTANTS

}  // namespace cartvo::vo
