// The last step of tracking: the patch may stretch and shear.
#include "vo_core/affine_alignment.hpp"

#include <algorithm>
#include <array>

#include "vo_core/affine_equations.hpp"
#include "vo_core/patch_comparison.hpp"
#include "vo_core/patch_sums.hpp"

namespace cartvo {
namespace {

constexpr int kFour = kDoubleLanes;
constexpr int kPatience = 1;       // iterations after which a patch that is still hopeless is given up
constexpr double kHopeless = 0.6;  // correlation

/// What alignAffine is asked.
struct Question {
  std::span<const AlignmentTask> tasks;
  WarpModel model;
  int iterations;
  double convergence;
  std::span<std::optional<AffineAlignment>> answers;
};

/// Up to four tasks, each step of all of them at once.
template <typename Processor, int Parameters>
class FourAlignments {
 public:
  explicit FourAlignments(std::span<const AlignmentTask> tasks) : tasks_(tasks) {
    for (std::size_t i = 0; i < kFour; ++i) {
      const AlignmentTask& task = tasks[std::min(i, tasks.size() - 1)];
      warps_.set(i, task.start.position, task.start.warp);
      bounds_.start_x.value[i] = task.start.position.x();
      bounds_.start_y.value[i] = task.start.position.y();
      bounds_.level.set(i, *task.after);
    }
    bounds_.findInside(warps_, busy_);
    for (std::size_t i = tasks.size(); i < kFour; ++i)
      busy_[i] = 0;
    std::array<SumsOfPatch<TemplateSums<Parameters>>, kFour> sums{};
    for (std::size_t i = 0; i < kFour; ++i)
      if (busy_[i] != 0) takeTemplate<Processor>(*tasks[i].before, tasks[i].from, templates_[i], sums[i]);
    SumsOfFour<TemplateSums<Parameters>> lanes;
    gatherLanes(sums, lanes);
    MaskLanes regular;
    equations_.setUp(lanes, regular);
    busy_ &= regular;
  }

  void align(int iterations, double convergence) {
    for (int iteration = 0; iteration < iterations && any(busy_); ++iteration) {
      compare();
      if (iteration >= kPatience) busy_ &= at_.correlation.lanes() >= kHopeless;
      MaskLanes settled, inside;
      equations_.improve(at_, convergence, busy_, warps_, settled);
      bounds_.findInside(warps_, inside);
      busy_ &= inside;
      // A step so short hardly changes the correlation that was found before it.
      done_ |= busy_ & settled;
      busy_ &= ~settled;
    }
    done_ |= busy_;
  }

  void answer(std::span<std::optional<AffineAlignment>> answers) const {
    std::array<SumsOfPatch<ReturnSums>, kFour> sums{};
    for (std::size_t i = 0; i < kFour; ++i)
      if (done_[i] != 0) compareBothWays<Processor>(templates_[i], now_[i], sums[i]);
    SumsOfFour<ReturnSums> lanes;
    gatherLanes(sums, lanes);
    Column misses, variance_x, variance_y;
    returnMisses(lanes, at_, equations_.mean(), misses);
    equations_.findVariances(at_, variance_x, variance_y);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      answers[i].reset();
      if (done_[i] != 0)
        answers[i] = {warps_.position(i),
                      warps_.warp(i),
                      at_.correlation.value[i],
                      {variance_x.value[i], variance_y.value[i]},
                      misses.value[i]};
    }
  }

 private:
  /// Of those that are not busy all stays as it was.
  void compare() {
    for (std::size_t i = 0; i < kFour; ++i) {
      if (busy_[i] == 0) continue;
      samplePatch<Processor>(*tasks_[i].after, warps_.position(i), warps_.warp(i), now_[i]);
      comparePatches<Processor>(templates_[i], now_[i], sums_[i]);
    }
    SumsOfFour<ComparisonSums<Parameters>> lanes;
    gatherLanes(sums_, lanes);
    equations_.compare(lanes, at_);
  }

  std::span<const AlignmentTask> tasks_;
  MaskLanes busy_{}, done_{};
  std::array<AlignedTemplate<Parameters>, kFour> templates_;
  std::array<AlignedPatch, kFour> now_;
  std::array<SumsOfPatch<ComparisonSums<Parameters>>, kFour> sums_{};
  AlignmentEquations<Parameters> equations_;
  FourComparisons at_;
  FourWarps warps_;
  WarpBounds bounds_;
};

template <typename Processor, int Parameters>
void answerWith(const Question& asked) {
  // Warped by at most 1.6 in each of two directions, the patch reaches 22.4 px: the border holds it.
  constexpr int kSpan = kPatchSide - 1;
  static_assert(kSpan * (1.0 + kMaximumStretch) < PyramidLevel::kBorder - 1);
  for (std::size_t first = 0; first < asked.tasks.size(); first += kFour) {
    const std::size_t count = std::min<std::size_t>(kFour, asked.tasks.size() - first);
    FourAlignments<Processor, Parameters> four(asked.tasks.subspan(first, count));
    four.align(asked.iterations, asked.convergence);
    four.answer(asked.answers.subspan(first, count));
  }
}

template <typename Processor>
void answer(const Question& asked) {
  if (asked.model == WarpModel::stereo) return answerWith<Processor, kStereoParameters>(asked);
  answerWith<Processor, kAffineParameters>(asked);
}

CARTVO_BY_PROCESSOR(void, answerAll, (const Question& asked), (asked), answer)

}  // namespace

void alignAffine(std::span<const AlignmentTask> tasks, WarpModel model, int iterations, double convergence,
                 std::span<std::optional<AffineAlignment>> aligned) {
  answerAll({tasks, model, iterations, convergence, aligned});
}

std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           WarpModel model, int iterations, double convergence) {
  const AlignmentTask task{&before, &after, from, start};
  std::optional<AffineAlignment> aligned;
  alignAffine(std::span(&task, 1), model, iterations, convergence, std::span(&aligned, 1));
  return aligned;
}

}  // namespace cartvo
