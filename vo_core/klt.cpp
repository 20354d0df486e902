// Pyramidal Kanade-Lucas-Tomasi tracking of one patch.
#include "vo_core/klt.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/patch.hpp"

namespace cartvo {
namespace {

constexpr int kSide = kPatchSide;
/// Of the patch each other row is compared, as in the alignment that follows.
constexpr int kRowStep = 2;
constexpr int kRows = (kSide + kRowStep - 1) / kRowStep;
constexpr double kMinimumTexture = 1.0;  // grey^2 / px^2, smaller eigenvalue of G per pixel
constexpr int kShiftIterations = 5;      // a shift that takes longer is lost
constexpr double kWorthAligning = 0.5;   // correlation after the shift, of which a warp may make a match
constexpr double kCoarse = 0.1;          // px: precise enough for a shift that will be refined
using Values = Patch<kSide, kRows>;
static_assert(Values::kBlocks == 1, "a row is one vector of lanes");
constexpr Patch<kSide, 1> kMask = Values::mask();

/// The patch before, its gradients and the inverse of its structure matrix G (thesis 4.12); from the
/// gradients the mean is taken off where they are summed, which makes the shift blind to a change of
/// brightness. All zero in the padding.
struct Linearisation {
  Values grey;
  Values gradient_x;
  Values gradient_y;
  float mean = 0.0F;
  double norm = 0.0;                                      // of grey, less its mean
  Eigen::Vector2d slope_means = Eigen::Vector2d::Zero();  // of the gradients
  Eigen::Matrix2d inverse_structure = Eigen::Matrix2d::Zero();
  double smaller_eigenvalue = 0.0;  // of G, per pixel
};

template <typename Processor>
void linearise(const PyramidLevel& level, const Eigen::Vector2d& centre, Linearisation& out) {
  sampleGradients<Processor, kRowStep>(level, centre, out.grey, out.gradient_x, out.gradient_y);
  out.mean = removeMean(out.grey);
  Lanes xx{}, xy{}, yy{}, x{}, y{}, grey{};
  for (int row = 0; row < kRows; ++row) {
    const Lanes& along_x = out.gradient_x.lanes(row, 0);
    const Lanes& along_y = out.gradient_y.lanes(row, 0);
    xx += along_x * along_x;
    xy += along_x * along_y;
    yy += along_y * along_y;
    x += along_x;
    y += along_y;
    grey += out.grey.lanes(row, 0) * out.grey.lanes(row, 0);
  }
  std::array<double, 4> squares, sums;
  sumsOf(xx, xy, yy, grey, squares.data());
  sumsOf(x, y, x, y, sums.data());
  out.norm = std::sqrt(squares[3]);
  out.slope_means = Eigen::Vector2d(sums[0], sums[1]) / Values::kSize;
  const double g_xx = squares[0] - sums[0] * out.slope_means.x();
  const double g_xy = squares[1] - sums[0] * out.slope_means.y();
  const double g_yy = squares[2] - sums[1] * out.slope_means.y();
  out.smaller_eigenvalue =
      (0.5 * (g_xx + g_yy) - std::sqrt(0.25 * (g_xx - g_yy) * (g_xx - g_yy) + g_xy * g_xy)) / Values::kSize;
  const double determinant = g_xx * g_yy - g_xy * g_xy;
  if (determinant > 0.0)
    out.inverse_structure << g_yy / determinant, -g_xy / determinant, -g_xy / determinant, g_xx / determinant;
}

/// How the patch after differs.
struct Mismatch {
  Eigen::Vector2d vector = Eigen::Vector2d::Zero();  // b (thesis 4.13)
  double correlation = 0.0;                          // normalised
};

void compare(const Linearisation& before, const Values& after, Mismatch& out) {
  const Lanes& mask = kMask.lanes(0, 0);
  Lanes x{}, y{}, sum{}, squares{}, products{};
  for (int row = 0; row < kRows; ++row) {
    const Lanes value = (after.lanes(row, 0) - before.mean) * mask;  // small, so that little is rounded
    const Lanes& grey = before.grey.lanes(row, 0);
    const Lanes difference = value - grey;
    x += before.gradient_x.lanes(row, 0) * difference;
    y += before.gradient_y.lanes(row, 0) * difference;
    sum += value;
    squares += value * value;
    products += value * grey;
  }
  std::array<double, 4> sums;
  sumsOf(x, y, sum, squares, sums.data());
  const double difference = sums[2];  // the patch before has no mean
  out.vector = Eigen::Vector2d(sums[0], sums[1]) - difference * before.slope_means;
  const double variance = sums[3] - sums[2] * sums[2] / Values::kSize;
  out.correlation = sumOf(products) / (before.norm * std::sqrt(std::max(variance, 1e-6)) + 1e-12);
}

/// What trackShift is asked.
struct Question {
  const ImagePyramid& before;
  const ImagePyramid& after;
  const Eigen::Vector2d& from;
  const Eigen::Vector2d& guess;
  const PyramidLevels& levels;
  double minimum_correlation;
};

template <typename Processor>
std::optional<Eigen::Vector2d> answer(const Question& asked) {
  const ImagePyramid &before = asked.before, &after = asked.after;
  if (!before.grey.front().contains(asked.from)) return std::nullopt;
  Linearisation patch;
  Values moved;
  Mismatch mismatch;
  Eigen::Vector2d shift = asked.guess - asked.from;  // px of the full image
  const int available = static_cast<int>(std::min(before.grey.size(), after.grey.size()));
  for (int index = std::min(asked.levels.coarsest, available - 1); index >= asked.levels.finest; --index) {
    const bool finest = index == asked.levels.finest;
    const double scale = 1.0 / (1 << index);
    const PyramidLevel& target = after.grey[index];
    const Eigen::Vector2d centre = asked.from * scale;
    // In a small level the centre of a pixel near the right or lower edge may lie beyond the last pixel.
    const bool usable = before.grey[index].contains(centre);
    if (usable) linearise<Processor>(before.grey[index], centre, patch);
    if (!usable || patch.smaller_eigenvalue < kMinimumTexture) {
      if (finest) return std::nullopt;
      continue;
    }
    Eigen::Vector2d position = centre + shift * scale;
    for (int iteration = 0; iteration < kShiftIterations; ++iteration) {
      if (!target.contains(position)) break;
      samplePatch<Processor, kRowStep>(target, position, moved);
      compare(patch, moved, mismatch);
      const Eigen::Vector2d step = patch.inverse_structure * mismatch.vector;
      position -= step;
      if (step.squaredNorm() < kCoarse * kCoarse) break;
    }
    if (target.contains(position))
      shift = (position - centre) / scale;
    else if (finest)
      return std::nullopt;
    // The last step, if it was short, hardly changes the correlation that was found before it.
    if (finest && mismatch.correlation < asked.minimum_correlation) return std::nullopt;
  }
  const Eigen::Vector2d position = asked.from + shift;
  if (!after.grey.front().contains(position)) return std::nullopt;
  return position;
}

CARTVO_VECTOR_CLONES
std::optional<Eigen::Vector2d> answerAnywhere(const Question& asked) {
  return answer<AnyProcessor>(asked);
}

#ifdef CARTVO_BYTE_SHUFFLES
CARTVO_BYTE_SHUFFLES
std::optional<Eigen::Vector2d> answerByShuffles(const Question& asked) {
  return answer<ByteShufflingProcessor>(asked);
}
#endif

}  // namespace

std::optional<Eigen::Vector2d> trackShift(const ImagePyramid& before, const ImagePyramid& after,
                                          const Eigen::Vector2d& from, const Eigen::Vector2d& guess,
                                          const PyramidLevels& levels, double minimum_correlation) {
  const Question asked{before, after, from, guess, levels, minimum_correlation};
#ifdef CARTVO_BYTE_SHUFFLES
  if (shufflesBytes()) return answerByShuffles(asked);
#endif
  return answerAnywhere(asked);
}

KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings) {
  KltResult result;
  const auto shifted = trackShift(before, after, from, guess, {0, levels - 1},
                                  std::min(kWorthAligning, settings.minimum_correlation));
  if (!shifted) return result;
  AffineAlignment start;
  start.position = *shifted;
  const auto aligned = alignAffine(before.grey.front(), after.grey.front(), from, start, WarpModel::affine,
                                   settings.iterations, settings.convergence);
  if (!aligned) return result;
  result.position = aligned->position;
  result.correlation = aligned->correlation;
  result.found = result.correlation >= settings.minimum_correlation;
  return result;
}

}  // namespace cartvo
