// Translation-only Lucas-Kanade tracking, coarse to fine, four patches per SIMD block.
#include "vo_core/image/shift_tracking.hpp"

#include <algorithm>
#include <array>

#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/image/patch_comparison.hpp"
#include "vo_core/image/patch_sums.hpp"
#include "vo_core/simd/double_lanes.hpp"

namespace cartvo::vo {
namespace {

constexpr std::size_t kBatchSize = kDoubleLanes;
constexpr double kMinimumTexture = 1.0;  // grey^2 / px^2, smaller eigenvalue of G per pixel
constexpr int kIterations = 5;           // per level; a shift that needs more is lost
constexpr double kConvergedStep =
    0.1;  // px, step that ends the iterations: precise enough for a shift that is refined later

using OfTemplate = TemplateSums<kShiftParameters>;
using OfComparison = ComparisonSums<kShiftParameters>;

/// Shift equations of four patches, one SIMD lane each. The mean is removed from every sum, so that
/// brightness does not matter.
class ShiftEquations {
 public:
  /// Sets up the templates. `textured`: lanes whose texture constrains a shift.
  void setUp(const SumsOfFour<OfTemplate>& sums, MaskLanes& textured) {
    constexpr int kX = OfTemplate::slope(0), kY = OfTemplate::slope(1);
    greys_ = sums[OfTemplate::kGreys];
    const DoubleLanes mean = greys_ / kSize;
    norm_ = sums[OfTemplate::kSquares] - mean * greys_;
    replaceBySquareRoots(norm_);
    mean_x_ = sums[kX] / kSize;
    mean_y_ = sums[kY] / kSize;
    grey_x_ = sums[OfTemplate::slopeGrey(0)] - mean * sums[kX];
    grey_y_ = sums[OfTemplate::slopeGrey(1)] - mean * sums[kY];
    const DoubleLanes xx = sums[OfTemplate::normal(0, 0)] - sums[kX] * mean_x_,
                      xy = sums[OfTemplate::normal(1, 0)] - sums[kX] * mean_y_,
                      yy = sums[OfTemplate::normal(1, 1)] - sums[kY] * mean_y_;
    DoubleLanes root = 0.25 * (xx - yy) * (xx - yy) + xy * xy;
    replaceBySquareRoots(root);
    textured = 0.5 * (xx + yy) - root >= kSize * kMinimumTexture * kGreyUnits * kGreyUnits;
    const DoubleLanes determinant = xx * yy - xy * xy;
    inverse_xx_ = yy / determinant;
    inverse_xy_ = -xy / determinant;
    inverse_yy_ = xx / determinant;
  }

  /// One Gauss-Newton step of each lane, px, and the correlation before it.
  void solve(const SumsOfFour<OfComparison>& sums, DoubleLanes& step_x, DoubleLanes& step_y,
             LaneValues& correlation) const {
    const DoubleLanes& values = sums[OfComparison::kValues];
    const DoubleLanes x = sums[OfComparison::slope(0)] - values * mean_x_ - grey_x_;
    const DoubleLanes y = sums[OfComparison::slope(1)] - values * mean_y_ - grey_y_;
    step_x = inverse_xx_ * x + inverse_xy_ * y;
    step_y = inverse_xy_ * x + inverse_yy_ * y;
    const DoubleLanes mean = values / kSize;
    DoubleLanes deviation = sums[OfComparison::kSquares] - values * mean;
    clampToMinimum(1e-6, deviation);
    replaceBySquareRoots(deviation);
    correlation.lanes() = (sums[OfComparison::kWithGrey] - mean * greys_) / (norm_ * deviation + 1e-12);
  }

 private:
  static constexpr double kSize = kAlignedSize;

  DoubleLanes greys_, norm_;     // of the grey values: sum, and norm of their deviations from the mean
  DoubleLanes mean_x_, mean_y_;  // means of the gradients
  DoubleLanes grey_x_, grey_y_;  // sums of gradient times grey less its mean
  DoubleLanes inverse_xx_, inverse_xy_, inverse_yy_;  // inverse of the structure matrix G (thesis 4.12)
};

/// Tracks up to four tasks at once, one SIMD lane each.
class FourShifts {
 public:
  FourShifts(std::span<const ShiftTask> tasks, double minimum_correlation)
      : tasks_(tasks), minimum_correlation_(minimum_correlation) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const ShiftTask& task = tasks[i];
      const Eigen::Vector2d shift = task.guess - task.from;
      x_.value[i] = shift.x();
      y_.value[i] = shift.y();
      const std::size_t available = std::min(task.before->grey.size(), task.after->grey.size());
      coarsest_[i] = std::min(task.levels.coarsest, static_cast<int>(available) - 1);
      alive_[i] = task.before->grey.front().contains(task.from) ? -1 : 0;
    }
  }

  void track() {
    int finest = tasks_.front().levels.finest;
    for (const ShiftTask& task : tasks_)
      finest = std::min(finest, task.levels.finest);
    for (int level = *std::max_element(coarsest_.begin(), coarsest_.end()); level >= finest; --level)
      trackIn(level);
  }

  void writeResults(std::span<std::optional<Eigen::Vector2d>> shifted) const {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      shifted[i].reset();
      const Eigen::Vector2d position = tasks_[i].from + Eigen::Vector2d(x_.value[i], y_.value[i]);
      if (alive_[i] != 0 && tasks_[i].after->grey.front().contains(position)) shifted[i] = position;
    }
  }

 private:
  void trackIn(int level) {
    MaskLanes here{}, last{};  // lanes that use this level; lanes whose finest level it is
    std::array<SumsOfPatch<OfTemplate>, kBatchSize> sums{};
    const double scale = 1.0 / levelScale(level);
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      const PyramidLevels levels{tasks_[i].levels.finest, coarsest_[i]};
      if (alive_[i] == 0 || level < levels.finest || level > levels.coarsest) continue;
      last[i] = level == levels.finest ? -1 : 0;
      const PyramidLevel &before = tasks_[i].before->grey[level], &after = tasks_[i].after->grey[level];
      const Eigen::Vector2d centre = tasks_[i].from * scale;
      // In a small level the centre of a pixel near the right or lower edge may lie beyond the last pixel.
      if (!before.contains(centre)) continue;
      here[i] = -1;
      after_[i] = &after;
      centre_x_.value[i] = centre.x();
      centre_y_.value[i] = centre.y();
      bounds_.set(i, after);
      buildTemplate(before, centre, templates_[i], sums[i]);
    }
    SumsOfFour<OfTemplate> lanes;
    gatherLanes(sums, lanes);
    MaskLanes textured, inside;
    equations_.setUp(lanes, textured);
    here &= textured;
    iterate(scale, here, inside);
    const MaskLanes arrived = here & inside;
    x_.replace(arrived, (position_x_.lanes() - centre_x_.lanes()) / scale);
    y_.replace(arrived, (position_y_.lanes() - centre_y_.lanes()) / scale);
    // The correlation dates from before the last step; a short step hardly changes it.
    alive_ &= ~last | (arrived & (correlation_.lanes() >= minimum_correlation_));
  }

  void iterate(double scale, const MaskLanes& here, MaskLanes& inside) {
    position_x_.lanes() = centre_x_.lanes() + x_.lanes() * scale;
    position_y_.lanes() = centre_y_.lanes() + y_.lanes() * scale;
    bounds_.findInside(position_x_, position_y_, inside);
    MaskLanes active = here & inside;
    for (int iteration = 0; iteration < kIterations && any(active); ++iteration) {
      for (std::size_t i = 0; i < kBatchSize; ++i) {
        if (active[i] == 0) continue;
        AlignedPatch now;
        samplePatch(*after_[i], {position_x_.value[i], position_y_.value[i]}, now);
        comparePatches(templates_[i], now, sums_[i]);
      }
      SumsOfFour<OfComparison> lanes;
      gatherLanes(sums_, lanes);
      DoubleLanes step_x, step_y;
      equations_.solve(lanes, step_x, step_y, correlation_);
      position_x_.replace(active, position_x_.lanes() - step_x);
      position_y_.replace(active, position_y_.lanes() - step_y);
      bounds_.findInside(position_x_, position_y_, inside);
      active &= inside & (step_x * step_x + step_y * step_y >= kConvergedStep * kConvergedStep);
    }
  }

  std::span<const ShiftTask> tasks_;
  double minimum_correlation_;
  std::array<int, kBatchSize> coarsest_{};
  MaskLanes alive_{};
  LaneValues x_, y_;                    // the shift, px of the image
  LaneValues centre_x_, centre_y_;      // of the patch before, px of the level
  LaneValues position_x_, position_y_;  // of the patch after, px of the level
  LevelBounds bounds_;                  // of the level after
  LaneValues correlation_;
  std::array<const PyramidLevel*, kBatchSize> after_{};
  std::array<AlignedTemplate<kShiftParameters>, kBatchSize> templates_;
  std::array<SumsOfPatch<OfComparison>, kBatchSize> sums_{};
  ShiftEquations equations_;
};

/// Arguments of trackShifts().
struct ShiftRequest {
  std::span<const ShiftTask> tasks;
  double minimum_correlation;
  std::span<std::optional<Eigen::Vector2d>> results;
};

void trackAll(const ShiftRequest& request) {
  for (std::size_t first = 0; first < request.tasks.size(); first += kBatchSize) {
    const std::size_t count = std::min(kBatchSize, request.tasks.size() - first);
    FourShifts four(request.tasks.subspan(first, count), request.minimum_correlation);
    four.track();
    four.writeResults(request.results.subspan(first, count));
  }
}

CARTVO_TARGET_CLONES void dispatchShifts(const ShiftRequest& request) {
  return trackAll(request);
}

}  // namespace

void trackShifts(std::span<const ShiftTask> tasks, double minimum_correlation,
                 std::span<std::optional<Eigen::Vector2d>> shifted) {
  dispatchShifts({tasks, minimum_correlation, shifted});
}

std::optional<Eigen::Vector2d> trackShift(const ShiftTask& task, double minimum_correlation) {
  std::optional<Eigen::Vector2d> shifted;
  trackShifts(std::span(&task, 1), minimum_correlation, std::span(&shifted, 1));
  return shifted;
}

}  // namespace cartvo::vo
