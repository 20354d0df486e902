// A right camera that looks up or down: a coarse search over pitches.
#include "vo_core/pitch_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cartvo {
namespace {

// Shares of the landmarks. With a rig in order at least a quarter is matched in most scenes; half a degree
// off, a tenth by chance.
constexpr double kHardly = 0.2;
constexpr double kMany = 0.3;
// In the dark a twentieth is matched where the right camera looks, of new corners, and a hundredth by chance:
// so the right pitch brings many times as many as any other. A scene that hides matches hides them at each
// pitch.
constexpr int kClearlyMore = 2;       // times as many as without it
constexpr int kFewestFound = 20;      // that are not there by chance
constexpr int kFewestInSample = 2;    // for all to be tried
constexpr std::size_t kFewest = 50;   // landmarks, of which a share says anything
constexpr std::size_t kSample = 100;  // that each pitch is tried with
constexpr double kStep = 1.5;         // px, half of what the search over rows and the alignment forgive
constexpr double kMost = 0.0105;      // rad, 0.6 degrees

struct PitchCount {
  double pitch = 0.0;  // rad
  int matched = 0;     // landmarks
};

PitchCount matchedAt(double pitch, std::vector<Landmark> landmarks, const MatchAtPitch& match) {
  match(landmarks, pitch);
  return {pitch, countStereo(landmarks)};
}

/// The pitch at which most of the landmarks, none of which is matched, find a match.
PitchCount bestPitch(const std::vector<Landmark>& landmarks, double focal_length, const MatchAtPitch& match) {
  PitchCount best;
  const double step = kStep / focal_length;
  const int steps = static_cast<int>(std::floor(kMost / step));
  for (int i = -steps; i <= steps; ++i) {
    if (i == 0) continue;
    const PitchCount tried = matchedAt(i * step, landmarks, match);
    if (tried.matched > best.matched) best = tried;
  }
  return best;
}

/// Each of so many that is not matched.
std::vector<Landmark> unmatchedOf(const std::vector<Landmark>& landmarks, std::size_t stride) {
  std::vector<Landmark> unmatched;
  for (std::size_t i = 0; i < landmarks.size(); i += stride)
    if (!landmarks[i].last().stereo) unmatched.push_back(landmarks[i]);
  return unmatched;
}

bool clearlyMore(int found, int matched) {
  return found >= kFewestFound && found >= kClearlyMore * matched;
}

}  // namespace

bool hardlyMatched(const std::vector<Landmark>& landmarks) {
  return landmarks.size() >= kFewest &&
         static_cast<double>(countStereo(landmarks)) < kHardly * static_cast<double>(landmarks.size());
}

std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match) {
  const std::size_t stride = std::max<std::size_t>(1, landmarks.size() / kSample);
  const std::vector<Landmark> sample = unmatchedOf(landmarks, stride);
  const PitchCount best = bestPitch(sample, focal_length, match);
  if (best.matched > static_cast<int>(kMany * static_cast<double>(sample.size()))) return best.pitch;
  // Few, but perhaps far more than without it. All are tried only where the sample lets that be hoped for.
  const int matched = countStereo(landmarks);
  if (best.matched < kFewestInSample || best.matched * static_cast<int>(stride) < matched)
    return std::nullopt;
  const int found = matchedAt(best.pitch, unmatchedOf(landmarks, 1), match).matched;
  if (!clearlyMore(found, matched)) return std::nullopt;
  return best.pitch;
}

}  // namespace cartvo
