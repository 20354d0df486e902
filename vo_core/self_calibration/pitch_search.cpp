// Coarse search for the pitch of the right camera.
#include "vo_core/self_calibration/pitch_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cartvo::vo {
namespace {

// Shares of matched landmarks. With a correct rig at least a quarter is matched in most scenes; at a pitch
// error of half a degree a tenth by chance.
constexpr double kFewMatchesShare = 0.2;
constexpr double kManyMatchesShare = 0.3;
// In the dark a twentieth of new corners is matched at the correct pitch and a hundredth by chance, so that
// the correct pitch has many times as many matches as any other. A scene that hides matches hides them at
// every pitch.
constexpr int kMinimumGain = 2;                // times the matches without the pitch
constexpr int kMinimumMatches = 20;            // more than by chance
constexpr int kMinimumSampleMatches = 2;       // for a trial with all landmarks
constexpr std::size_t kMinimumLandmarks = 50;  // for a meaningful share
constexpr std::size_t kSampleSize = 100;       // landmarks tried at each pitch
constexpr double kStep = 1.5;                  // px, half the range of the search over rows and the alignment
constexpr double kMaximumPitch = 0.0105;       // rad, 0.6 degrees

struct PitchCount {
  double pitch = 0.0;  // rad
  int matched = 0;     // landmarks
};

PitchCount countMatchesAt(double pitch, std::vector<Landmark> landmarks, const MatchAtPitch& match) {
  match(landmarks, pitch);
  return {pitch, countStereo(landmarks)};
}

/// Pitch at which most of the unmatched landmarks find a match.
PitchCount bestPitch(const std::vector<Landmark>& landmarks, double focal_length, const MatchAtPitch& match) {
  PitchCount best;
  const double step = kStep / focal_length;
  const int steps = static_cast<int>(std::floor(kMaximumPitch / step));
  for (int i = -steps; i <= steps; ++i) {
    if (i == 0) continue;
    const PitchCount tried = countMatchesAt(i * step, landmarks, match);
    if (tried.matched > best.matched) best = tried;
  }
  return best;
}

/// The unmatched of every `stride`-th landmark.
std::vector<Landmark> unmatchedOf(const std::vector<Landmark>& landmarks, std::size_t stride) {
  std::vector<Landmark> unmatched;
  for (std::size_t i = 0; i < landmarks.size(); i += stride)
    if (!landmarks[i].last().stereo) unmatched.push_back(landmarks[i]);
  return unmatched;
}

bool isSignificantGain(int found, int matched) {
  return found >= kMinimumMatches && found >= kMinimumGain * matched;
}

}  // namespace

double pitchSearchRange(double focal_length) {
  return 2.0 * kStep / focal_length;
}

bool hasFewMatches(const std::vector<Landmark>& landmarks) {
  return landmarks.size() >= kMinimumLandmarks &&
         static_cast<double>(countStereo(landmarks)) <
             kFewMatchesShare * static_cast<double>(landmarks.size());
}

std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match) {
  const std::size_t stride = std::max<std::size_t>(1, landmarks.size() / kSampleSize);
  const std::vector<Landmark> sample = unmatchedOf(landmarks, stride);
  const PitchCount best = bestPitch(sample, focal_length, match);
  if (best.matched > static_cast<int>(kManyMatchesShare * static_cast<double>(sample.size())))
    return best.pitch;
  // Few matches, but possibly many times as many as without the pitch: try all landmarks if the sample allows
  // it.
  const int matched = countStereo(landmarks);
  if (best.matched < kMinimumSampleMatches || best.matched * static_cast<int>(stride) < matched)
    return std::nullopt;
  const int found = countMatchesAt(best.pitch, unmatchedOf(landmarks, 1), match).matched;
  if (!isSignificantGain(found, matched)) return std::nullopt;
  return best.pitch;
}

}  // namespace cartvo::vo
