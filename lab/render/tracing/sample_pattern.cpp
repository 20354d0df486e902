// Generates stratified sample patterns for 1 to 16 rays per pixel.
#include "lab/render/tracing/sample_pattern.hpp"

#include <numeric>
#include <utility>

#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

SamplePatterns::SamplePatterns() {
  Random random(20161);
  for (std::size_t level = 0; level < patterns_.size(); ++level) {
    const int samples = 1 << level;
    for (int variant = 0; variant < kVariants; ++variant) {
      // Latin hypercube (one point in each row and column) with the largest minimum distance of 12
      // permutations.
      std::vector<Eigen::Vector2f> best;
      float best_distance = -1.0F;
      for (int attempt = 0; attempt < 12; ++attempt) {
        std::vector<int> rows(samples);
        std::iota(rows.begin(), rows.end(), 0);
        for (int i = samples - 1; i > 0; --i)
          std::swap(rows[i], rows[random.below(i + 1)]);
        std::vector<Eigen::Vector2f> points;
        for (int i = 0; i < samples; ++i) {
          const double spread = samples == 1 ? 0.49 : 0.3;
          points.emplace_back(
              (static_cast<float>(i) + 0.5F + random.real(-spread, spread)) / static_cast<float>(samples) -
                  0.5F,
              (static_cast<float>(rows[i]) + 0.5F + random.real(-spread, spread)) /
                      static_cast<float>(samples) -
                  0.5F);
        }
        float nearest = 2.0F;
        for (int i = 0; i < samples; ++i) {
          for (int j = 0; j < i; ++j)
            nearest = std::min(nearest, (points[i] - points[j]).norm());
        }
        if (nearest > best_distance) {
          best_distance = nearest;
          best = points;
        }
      }
      patterns_[level].insert(patterns_[level].end(), best.begin(), best.end());
    }
  }
}

}  // namespace cartvo::world
