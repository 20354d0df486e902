// A right camera that looks up or down: a coarse search over pitches.
#include "vo_core/pitch_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cartvo {
namespace {

// Shares of the landmarks. With a rig in order at least a quarter is matched in most scenes, and at dusk a
// twentieth when nothing is known of depths yet; half a degree off, a tenth by chance.
constexpr double kHardly = 0.2;
constexpr double kMany = 0.3;
constexpr std::size_t kFewest = 50;   // landmarks, of which a share says anything
constexpr std::size_t kSample = 100;  // that each pitch is tried with
constexpr double kStep = 1.5;         // px, half of what the search over rows and the alignment forgive
constexpr double kMost = 0.0105;      // rad, 0.6 degrees

bool isMatched(const Landmark& landmark) {
  return landmark.last().stereo;
}

}  // namespace

bool hardlyMatched(const std::vector<Landmark>& landmarks) {
  const auto matched = std::count_if(landmarks.begin(), landmarks.end(), isMatched);
  return landmarks.size() >= kFewest &&
         static_cast<double>(matched) < kHardly * static_cast<double>(landmarks.size());
}

std::optional<double> findPitch(const std::vector<Landmark>& landmarks, double focal_length,
                                const MatchAtPitch& match) {
  std::vector<Landmark> sample;
  const std::size_t stride = std::max<std::size_t>(1, landmarks.size() / kSample);
  for (std::size_t i = 0; i < landmarks.size(); i += stride)
    if (!isMatched(landmarks[i])) sample.push_back(landmarks[i]);
  auto most = static_cast<std::ptrdiff_t>(kMany * static_cast<double>(sample.size()));
  std::optional<double> found;
  const double step = kStep / focal_length;
  const int steps = static_cast<int>(std::floor(kMost / step));
  for (int i = -steps; i <= steps; ++i) {
    if (i == 0) continue;
    std::vector<Landmark> tried = sample;
    match(tried, i * step);
    const auto matched = std::count_if(tried.begin(), tried.end(), isMatched);
    if (matched <= most) continue;
    most = matched;
    found = i * step;
  }
  return found;
}

}  // namespace cartvo
