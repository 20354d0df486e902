// Tests of shift tracking by itself; its accuracy together with the alignment is tested in klt_test.cpp.
#include "vo_core/image/shift_tracking.hpp"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

constexpr int kWidth = 320, kHeight = 240, kLevels = 4;
const Eigen::Vector2d kMove(6.4, -3.7);  // px
constexpr double kLeastCorrelation = 0.5;

struct TestImages {
  ImagePyramid before, after;

  TestImages() {
    const test::WaveTexture texture(5);
    before = buildPyramid(test::draw(kWidth, kHeight, texture), kLevels);
    after =
        buildPyramid(test::draw(kWidth, kHeight,
                                [&](double x, double y) { return texture(x - kMove.x(), y - kMove.y()); }),
                     kLevels);
  }
  ShiftTask task(const Eigen::Vector2d& from, const PyramidLevels& levels) const {
    return {&before, &after, from, from, levels};
  }
};

TEST(ShiftTracking, IsMoreAccurateTheFinerItsLastLevel) {
  const TestImages images;
  for (const int finest : {0, 1, 2}) {
    test::Statistics error;
    for (int x = 50; x < kWidth - 50; x += 9) {
      const Eigen::Vector2d from(x + 0.3, 118.6);
      const auto shifted = trackShift(images.task(from, {finest, kLevels - 1}), kLeastCorrelation);
      if (shifted) error.add((*shifted - from - kMove).norm());
    }
    EXPECT_GT(error.count(), 15) << finest;
    EXPECT_LT(error.mean(), 0.15 * (1 << finest)) << finest;
  }
}

TEST(ShiftTracking, GivesTheSameResultsTogetherAsAlone) {
  const TestImages images;
  const PyramidLevels several[] = {{0, 3}, {1, 1}, {2, 3}, {1, 3}, {0, 9}, {5, 6}};
  std::vector<ShiftTask> tasks;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector2d from(3.3 + 12.7 * i, 20.6 + 7.0 * i);  // the last ones lie outside
    tasks.push_back(images.task(from, several[i % 6]));
    tasks.back().guess += Eigen::Vector2d(i % 4, 2.0 - i % 3);
  }
  int found = 0;
  for (const std::size_t count : {0UL, 1UL, 3UL, 4UL, 6UL, tasks.size()}) {
    std::vector<std::optional<Eigen::Vector2d>> together(count);
    trackShifts(std::span(tasks).first(count), kLeastCorrelation, together);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(together[i], trackShift(tasks[i], kLeastCorrelation)) << i << " of " << count;
      found += together[i] ? 1 : 0;
    }
  }
  EXPECT_GT(found, 20);
}

}  // namespace
}  // namespace cartvo::vo
