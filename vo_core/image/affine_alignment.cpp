// Affine alignment of 15x15 patches by inverse-compositional Gauss-Newton, four patches per SIMD block.
#include "vo_core/image/affine_alignment.hpp"

#include <algorithm>
#include <array>

#include "vo_core/image/affine_equations.hpp"
#include "vo_core/image/patch_comparison.hpp"
#include "vo_core/image/patch_sums.hpp"

namespace cartvo::vo {
namespace {

constexpr int kBatchSize = kDoubleLanes;
constexpr int kEarlyExitIteration = 1;         // iterations before patches are dropped early
constexpr double kEarlyExitCorrelation = 0.6;  // a patch that correlates less after them is dropped

/// Arguments of alignAffine().
struct AlignmentRequest {
  std::span<const AlignmentTask> tasks;
  int iterations;
  double convergence;
  std::span<std::optional<AffineAlignment>> results;
};

/// Aligns up to four tasks at once, one SIMD lane each.
class FourAlignments {
 public:
  explicit FourAlignments(std::span<const AlignmentTask> tasks) : tasks_(tasks) {
    for (std::size_t i = 0; i < kBatchSize; ++i) {
      const AlignmentTask& task = tasks[std::min(i, tasks.size() - 1)];
      warps_.set(i, task.start.position, task.start.warp);
      bounds_.start_x.value[i] = task.start.position.x();
      bounds_.start_y.value[i] = task.start.position.y();
      bounds_.level.set(i, *task.after);
    }
    bounds_.findInside(warps_, active_);
    for (std::size_t i = tasks.size(); i < kBatchSize; ++i)
      active_[i] = 0;
    std::array<SumsOfPatch<TemplateSums<kAffineParameters>>, kBatchSize> sums{};
    for (std::size_t i = 0; i < kBatchSize; ++i)
      if (active_[i] != 0) buildTemplate(*tasks[i].before, tasks[i].from, templates_[i], sums[i]);
    SumsOfFour<TemplateSums<kAffineParameters>> lanes;
    gatherLanes(sums, lanes);
    MaskLanes regular;
    equations_.setUp(lanes, regular);
    active_ &= regular;
  }

  void align(int iterations, double convergence) {
    for (int iteration = 0; iteration < iterations && any(active_); ++iteration) {
      compare();
      if (iteration >= kEarlyExitIteration) active_ &= at_.correlation.lanes() >= kEarlyExitCorrelation;
      MaskLanes converged, inside;
      equations_.applyStep(at_, convergence, active_, warps_, converged);
      bounds_.findInside(warps_, inside);
      active_ &= inside;
      // The correlation dates from before the last step; a converged step hardly changes it.
      done_ |= active_ & converged;
      active_ &= ~converged;
    }
    done_ |= active_;
  }

  void writeResults(std::span<std::optional<AffineAlignment>> results) const {
    std::array<SumsOfPatch<ForwardBackwardSums>, kBatchSize> sums{};
    for (std::size_t i = 0; i < kBatchSize; ++i)
      if (done_[i] != 0) compareForwardBackward(templates_[i], now_[i], sums[i]);
    SumsOfFour<ForwardBackwardSums> lanes;
    gatherLanes(sums, lanes);
    LaneValues errors, variance_x, variance_y;
    forwardBackwardErrors(lanes, at_, equations_.mean(), errors);
    equations_.findVariances(at_, variance_x, variance_y);
    for (std::size_t i = 0; i < results.size(); ++i) {
      results[i].reset();
      if (done_[i] != 0)
        results[i] = {warps_.position(i),
                      warps_.warp(i),
                      at_.correlation.value[i],
                      {variance_x.value[i], variance_y.value[i]},
                      errors.value[i]};
    }
  }

 private:
  /// Samples and compares the active patches; the results of the others stay as they are.
  void compare() {
    for (std::size_t i = 0; i < kBatchSize; ++i) {
      if (active_[i] == 0) continue;
      samplePatch(*tasks_[i].after, warps_.position(i), warps_.warp(i), now_[i]);
      comparePatches(templates_[i], now_[i], sums_[i]);
    }
    SumsOfFour<ComparisonSums<kAffineParameters>> lanes;
    gatherLanes(sums_, lanes);
    equations_.compare(lanes, at_);
  }

  std::span<const AlignmentTask> tasks_;
  MaskLanes active_{}, done_{};
  std::array<AlignedTemplate<kAffineParameters>, kBatchSize> templates_;
  std::array<AlignedPatch, kBatchSize> now_;
  std::array<SumsOfPatch<ComparisonSums<kAffineParameters>>, kBatchSize> sums_{};
  AlignmentEquations equations_;
  FourComparisons at_;
  FourWarps warps_;
  WarpBounds bounds_;
};

void alignAll(const AlignmentRequest& request) {
  // Stretched by at most 1.6 in each of two directions, the patch reaches 22.4 px: the border holds it.
  constexpr int kSpan = kPatchSide - 1;
  static_assert(kSpan * (1.0 + kMaximumStretch) < PyramidLevel::kBorder - 1);
  for (std::size_t first = 0; first < request.tasks.size(); first += kBatchSize) {
    const std::size_t count = std::min<std::size_t>(kBatchSize, request.tasks.size() - first);
    FourAlignments four(request.tasks.subspan(first, count));
    four.align(request.iterations, request.convergence);
    four.writeResults(request.results.subspan(first, count));
  }
}

CARTVO_TARGET_CLONES void dispatchAlignments(const AlignmentRequest& request) {
  return alignAll(request);
}

}  // namespace

void alignAffine(std::span<const AlignmentTask> tasks, int iterations, double convergence,
                 std::span<std::optional<AffineAlignment>> aligned) {
  dispatchAlignments({tasks, iterations, convergence, aligned});
}

std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           int iterations, double convergence) {
  const AlignmentTask task{&before, &after, from, start};
  std::optional<AffineAlignment> aligned;
  alignAffine(std::span(&task, 1), iterations, convergence, std::span(&aligned, 1));
  return aligned;
}

}  // namespace cartvo::vo
