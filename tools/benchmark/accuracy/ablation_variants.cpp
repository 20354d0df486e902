// The ablation variants: the settings that each of them changes.
#include "tools/benchmark/accuracy/ablation_variants.hpp"

#include <algorithm>

namespace cartvo::benchmark {

const std::vector<Ablation>& ablations() {
  static const std::vector<Ablation> all{
      {"as-it-is", "the default", [](vo::OdometrySettings&) {}},
      {"two-pairs", "a window of two pairs: each motion is estimated from two consecutive pairs only",
       [](vo::OdometrySettings& s) { s.bundle.frames = 2; }},
      {"one-free", "only the newest pose is free, not the last two",
       [](vo::OdometrySettings& s) { s.bundle.free_frames = 1; }},
      {"four-free", "the newest four poses are free, not the last two",
       [](vo::OdometrySettings& s) { s.bundle.free_frames = 4; }},
      {"no-hold", "no prior on the last pose but one, which is as free as the newest",
       [](vo::OdometrySettings& s) { s.bundle.prior_weight = 0.0; }},
      {"certain", "fixed poses of the window count as exact",
       [](vo::OdometrySettings& s) { s.bundle.fixed_pose_weight = 1.0; }},
      {"not-robust", "no robust loss: each residual has its full weight",
       [](vo::OdometrySettings& s) { s.bundle.robust_width = 1000.0; }},
      {"no-history", "no landmark is down-weighted or removed for its earlier residuals",
       [](vo::OdometrySettings& s) { s.history = {.half_weight_stddevs = 100.0, .minimum_weight = 0.0}; }},
      {"any-motion", "the search accepts motions beyond the acceleration limits of a cart",
       [](vo::OdometrySettings& s) { s.pose_search.maximum_acceleration = 1e6; }},
      {"no-rig", "the right camera's yaw and decentring (p2) are not corrected",
       [](vo::OdometrySettings& s) { s.rig_refinement = vo::RigRefinement::off; }},
      {"no-stand", "standstill is not detected",
       [](vo::OdometrySettings& s) { s.standstill.least_time = 3600.0; }},
      {"one-way", "no alignment is rejected for its forward-backward error",
       [](vo::OdometrySettings& s) { s.tracking.maximum_backward_error = 100.0; }},
      {"fixed-threshold", "one FAST threshold, 20, for all windows",
       [](vo::OdometrySettings& s) { s.detection.minimum_threshold = s.detection.maximum_threshold = 20; }},
      {"fine-only", "all landmarks from the full image, none from the pyramid level of half size",
       [](vo::OdometrySettings& s) { s.detection.levels = 1; }},
      {"half-features", "half as many landmarks", [](vo::OdometrySettings& s) { s.features /= 2; }},
      {"double-features", "twice as many landmarks", [](vo::OdometrySettings& s) { s.features *= 2; }},
      {"simultaneous", "the time offset between the cameras is ignored (has an effect with --offset-ms)",
       [](vo::OdometrySettings&) {}, true},
      {"thesis", "estimator: thesis", [](vo::OdometrySettings& s) { s.estimator = vo::Estimator::thesis; }},
  };
  return all;
}

std::vector<std::string> ablationNames() {
  std::vector<std::string> names;
  for (const Ablation& ablation : ablations())
    names.emplace_back(ablation.name);
  return names;
}

std::vector<OdometryVariant> ablatedVariants(const vo::OdometrySettings& full,
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
