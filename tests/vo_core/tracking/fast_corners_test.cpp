// Tests of FAST-9, of its score and of its non-maximum suppression.
#include "vo_core/tracking/fast_corners.hpp"

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

TEST(FastCorners, ScoreIsTheSumOfAbsoluteDifferencesOnTheCircle) {
  cv::Mat image(20, 20, CV_8UC1, cv::Scalar(50));
  image.at<unsigned char>(10, 10) = 200;  // a bright dot: all sixteen pixels of its circle are darker by 150
  EXPECT_EQ(fastScore(image, 10, 10, 40), 16 * 150);
  EXPECT_EQ(fastScore(image, 10, 10, 150), 0);
  EXPECT_EQ(fastScore(image, 5, 5, 40), 0);
}

TEST(FastCorners, NeedsNineContiguousPixels) {
  cv::Mat half(20, 20, CV_8UC1, cv::Scalar(50));
  half(cv::Rect(10, 0, 10, 20))
      .setTo(200);  // on a straight edge seven to nine pixels differ, not an arc of nine
  EXPECT_EQ(fastScore(half, 10, 10, 40), 0);
  cv::Mat corner(20, 20, CV_8UC1, cv::Scalar(50));
  corner(cv::Rect(10, 10, 10, 10)).setTo(200);
  EXPECT_GT(fastScore(corner, 10, 10, 40), 0);
}

cv::Mat noiseImage(int width, int height, std::uint64_t seed) {
  test::Noise noise(seed);
  return test::draw(width, height, [&](int, int) { return 255.0 * noise.uniform(); });
}

/// Reference: local maxima by their definition, pixel by pixel.
std::vector<Corner> expectedMaxima(const cv::Mat& image, const cv::Range& rows,
                                   const WindowThresholds& thresholds) {
  const auto score = [&](int x, int y) {
    const bool inside =
        x >= kFastRadius && y >= kFastRadius && x < image.cols - kFastRadius && y < image.rows - kFastRadius;
    return inside ? fastScore(image, x, y, thresholds.row(y)[x]) : 0;
  };
  std::vector<Corner> maxima;
  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int here = score(x, y);
      bool greatest = here > 0;
      for (int dy = -1; greatest && dy <= 1; ++dy)
        for (int dx = -1; greatest && dx <= 1; ++dx) {
          const bool before = dy < 0 || (dy == 0 && dx < 0);
          const int other = dx == 0 && dy == 0 ? 0 : score(x + dx, y + dy);
          greatest = before ? here > other : here >= other;
        }
      if (greatest) maxima.push_back({x, y, static_cast<std::uint16_t>(here)});
    }
  }
  return maxima;
}

void expectEqual(const std::vector<Corner>& found, const std::vector<Corner>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].x, expected[i].x) << i;
    EXPECT_EQ(found[i].y, expected[i].y) << i;
    EXPECT_EQ(found[i].score, expected[i].score) << i;
  }
}

TEST(FastCorners, AgreeWithOpenCV) {
  for (const int threshold : {0, 1, 6, 30, 80, 200}) {
    const cv::Mat image = noiseImage(90, 60, 5);
    std::vector<cv::KeyPoint> expected;
    cv::FAST(image, expected, threshold, /*nonmaxSuppression=*/false);
    std::size_t next = 0;
    for (int y = kFastRadius; y < image.rows - kFastRadius; ++y)
      for (int x = kFastRadius; x < image.cols - kFastRadius; ++x) {
        const bool corner = next < expected.size() && cv::Point(expected[next].pt) == cv::Point(x, y);
        if (corner) ++next;
        ASSERT_EQ(fastScore(image, x, y, threshold) > 0, corner) << x << ", " << y << ", " << threshold;
      }
    EXPECT_EQ(next, expected.size());
  }
}

TEST(CornerFinder, FindsTheMaximaOfImagesOfAllWidths) {
  CornerFinder finder;
  for (const int width : {6, 7, 20, 69, 70, 71, 133, 134, 135, 200}) {
    for (const int threshold : {0, 1, 10, 40, 100, 254}) {
      cv::Mat image = noiseImage(width, 31, width);
      if (threshold < 40) cv::GaussianBlur(image, image, cv::Size(5, 5), 1.0);
      WindowThresholds thresholds(image.size(), 1);
      thresholds.set({0, 0, width, image.rows}, static_cast<std::uint8_t>(threshold));
      const cv::Range all(0, image.rows);
      SCOPED_TRACE(testing::Message() << "width " << width << ", threshold " << threshold);
      expectEqual(finder.find(image, all, thresholds), expectedMaxima(image, all, thresholds));
    }
  }
}

TEST(CornerFinder, UsesEachWindowsThresholdAndSuppressesAcrossWindowEdges) {
  const cv::Mat parent = noiseImage(250, 100, 9);
  const cv::Mat image = parent(cv::Rect(11, 7, 230, 89));  // rows lie apart in memory
  constexpr int kRows = 4, kColumns = 5;
  WindowThresholds thresholds(image.size(), kRows);
  int corners = 0;
  CornerFinder finder;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const cv::Point from(column * image.cols / kColumns, row * image.rows / kRows);
      const cv::Point to((column + 1) * image.cols / kColumns, (row + 1) * image.rows / kRows);
      const bool searched = (row + column) % 3 != 0;
      thresholds.set({from, to}, searched ? static_cast<std::uint8_t>(20 + 5 * column + row) : kNoCorners);
    }
  for (int row = 0; row < kRows; ++row) {
    const cv::Range rows(row * image.rows / kRows, (row + 1) * image.rows / kRows);
    const auto& found = finder.find(image, rows, thresholds);
    expectEqual(found, expectedMaxima(image, rows, thresholds));
    corners += static_cast<int>(found.size());
  }
  EXPECT_GT(corners, 100);
}

TEST(CornerFinder, KeepsTheFirstOfEqualNeighbours) {
  cv::Mat image(40, 100, CV_8UC1, cv::Scalar(50));
  image(cv::Rect(60, 20, 2, 2)).setTo(200);  // four corners of the same score
  WindowThresholds thresholds(image.size(), 1);
  thresholds.set({0, 0, image.cols, image.rows}, 40);
  CornerFinder finder;
  const auto& found = finder.find(image, {0, image.rows}, thresholds);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].x, 60);
  EXPECT_EQ(found[0].y, 20);
  EXPECT_EQ(found[0].score, 16 * 150);
}

}  // namespace
}  // namespace cartvo::vo
