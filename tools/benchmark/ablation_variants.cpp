// The parts of the method that can be left out, by the settings that do it.
#include "tools/benchmark/ablation_variants.hpp"

#include <algorithm>

namespace cartvo::benchmark {

const std::vector<Ablation>& ablations() {
  static const std::vector<Ablation> all{
      {"as-it-is", "the default", [](OdometrySettings&) {}},
      {"two-pairs", "a window of two pairs: motion from one to the next only",
       [](OdometrySettings& s) { s.bundle.frames = 2; }},
      {"one-free", "the newest pose moves alone, not the last two",
       [](OdometrySettings& s) { s.bundle.free_frames = 1; }},
      {"four-free", "the newest four poses move, not the last two",
       [](OdometrySettings& s) { s.bundle.free_frames = 4; }},
      {"no-hold", "the last pose but one moves as freely as the newest",
       [](OdometrySettings& s) { s.bundle.hold = 0.0; }},
      {"certain", "poses that stand in the window count as exact",
       [](OdometrySettings& s) { s.bundle.standing_share = 1.0; }},
      {"not-robust", "each residual has its full weight",
       [](OdometrySettings& s) { s.bundle.robust_width = 1000.0; }},
      {"no-history", "no landmark is distrusted or removed for how it fitted before",
       [](OdometrySettings& s) { s.history = {.deviation = 100.0, .minimum_weight = 0.0}; }},
      {"any-motion", "the search believes motions that no cart can make",
       [](OdometrySettings& s) { s.pose_search.maximum_acceleration = s.pose_search.maximum_turn = 1e6; }},
      {"no-rig", "the right camera's yaw and bend are not corrected",
       [](OdometrySettings& s) { s.rig_refinement = RigRefinement::off; }},
      {"no-stand", "a standing cart is not noticed",
       [](OdometrySettings& s) { s.standstill.least_time = 3600.0; }},
      {"one-way", "no alignment is rejected for a step backwards that misses its start",
       [](OdometrySettings& s) { s.tracking.maximum_return = 100.0; }},
      {"fixed-threshold", "one FAST threshold for all windows",
       [](OdometrySettings& s) {
         s.detection.minimum_threshold = s.detection.maximum_threshold = s.detection.initial_threshold;
       }},
      {"fine-only", "all landmarks from the image itself, none from its half",
       [](OdometrySettings& s) { s.detection.levels = 1; }},
      {"half-features", "half as many landmarks", [](OdometrySettings& s) { s.features /= 2; }},
      {"double-features", "twice as many landmarks", [](OdometrySettings& s) { s.features *= 2; }},
      {"simultaneous", "the offset between the cameras is ignored (matters with --offset-ms)",
       [](OdometrySettings&) {}, true},
      {"thesis", "estimator: thesis", [](OdometrySettings& s) { s.estimator = Estimator::thesis; }},
  };
  return all;
}

std::vector<std::string> ablationNames() {
  std::vector<std::string> names;
  for (const Ablation& ablation : ablations())
    names.emplace_back(ablation.name);
  return names;
}

std::vector<OdometryVariant> ablatedVariants(const OdometrySettings& full,
                                             const std::vector<std::string>& names) {
  std::vector<OdometryVariant> variants;
  for (const Ablation& ablation : ablations()) {
    const bool wanted = std::find(names.begin(), names.end(), ablation.name) != names.end();
    if (!wanted && !variants.empty()) continue;
    variants.push_back({ablation.name, full, ablation.simultaneous});
    ablation.change(variants.back().odometry);
  }
  return variants;
}

}  // namespace cartvo::benchmark
