#include "vo_core/landmark.hpp"

#include <algorithm>

namespace cartvo {

int countStereo(const std::vector<Landmark>& landmarks) {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                        [](const Landmark& landmark) { return landmark.last().stereo; }));
}

void forgetLastStereo(std::vector<Landmark>& landmarks) {
  for (Landmark& landmark : landmarks)
    landmark.sightings.back().stereo = false;
}

void forgetStereo(std::vector<Landmark>& landmarks) {
  for (Landmark& landmark : landmarks)
    for (Sighting& sighting : landmark.sightings)
      sighting.stereo = false;
}

void forgetStereoAndDepth(std::vector<Landmark>& landmarks) {
  forgetStereo(landmarks);
  for (Landmark& landmark : landmarks) {
    landmark.information = 0.0;
    landmark.stereo_warp.setIdentity();
  }
}

}  // namespace cartvo
