#pragma once

// What the filters of row errors share: PitchRollFilter and DelayFilter.

namespace cartvo::vo {

// Standard deviations before any measurement, of a calibration and of timestamps.
constexpr double kRotationPriorStddev = 3e-3;   // rad
constexpr double kCrossTermPriorStddev = 1e-2;  // rad
constexpr double kDelayPriorStddev = 1e-2;      // s

constexpr double kRowMemory = 10.0;  // s, time constant of the decay of information
// Weight of a pair: errors of consecutive pairs are correlated because landmarks last about ten pairs.
constexpr double kRowPairWeight = 0.1;
// px rms, row patterns of a good calibration that a filter does not estimate. They do not average out over
// pairs.
constexpr double kUnmodelledRows = 0.03;

}  // namespace cartvo::vo
