// Remapping, compared with bilinear interpolation in double precision.
#include "calib/rectification/remap.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace cartvo::calib {
namespace {

cv::Mat noise(cv::Size size) {
  cv::Mat image(size, CV_8UC1);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

/// Random positions all over a source of this size, including its last row and column.
PixelSources randomSources(cv::Size source, int count) {
  cv::RNG random(11);
  PixelSources sources;
  for (int i = 0; i < count; ++i) {
    sources.column.push_back(static_cast<std::uint16_t>(random.uniform(0, source.width - 1)));
    sources.row.push_back(static_cast<std::uint16_t>(random.uniform(0, source.height - 1)));
    sources.column_fraction.push_back(static_cast<std::uint8_t>(random.uniform(0, 256)));
    sources.row_fraction.push_back(static_cast<std::uint8_t>(random.uniform(0, 256)));
  }
  return sources;
}

/// Positions in a source that is rotated, enlarged and cut at its border, as in a rectification: neighbouring
/// pixels have neighbouring sources.
PixelSources turnedSources(cv::Size source, cv::Size target, double degrees) {
  const double c = std::cos(degrees * M_PI / 180.0), s = std::sin(degrees * M_PI / 180.0);
  PixelSources sources;
  for (int y = 0; y < target.height; ++y) {
    for (int x = 0; x < target.width; ++x) {
      const double dx = 1.1 * (x - 0.5 * target.width), dy = 1.1 * (y - 0.5 * target.height);
      const double u = std::clamp(0.5 * source.width + c * dx - s * dy, 0.0, source.width - 1.001);
      const double v = std::clamp(0.5 * source.height + s * dx + c * dy, 0.0, source.height - 1.001);
      sources.column.push_back(static_cast<std::uint16_t>(u));
      sources.row.push_back(static_cast<std::uint16_t>(v));
      sources.column_fraction.push_back(static_cast<std::uint8_t>(256.0 * (u - std::floor(u))));
      sources.row_fraction.push_back(static_cast<std::uint8_t>(256.0 * (v - std::floor(v))));
    }
  }
  return sources;
}

double interpolated(const cv::Mat& source, double x, double y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double dx = x - column, dy = y - row;
  const auto at = [&](int v, int u) { return static_cast<double>(source.at<std::uint8_t>(v, u)); };
  return (1 - dy) * ((1 - dx) * at(row, column) + dx * at(row, column + 1)) +
         dy * ((1 - dx) * at(row + 1, column) + dx * at(row + 1, column + 1));
}

void expectInterpolated(const cv::Mat& source, const PixelSources& sources, cv::Size size) {
  cv::Mat target(size, CV_8UC1);
  remap(source, sources, target);
  for (int i = 0; i < size.area(); ++i) {
    const double expected = interpolated(source, sources.column[i] + sources.column_fraction[i] / 256.0,
                                         sources.row[i] + sources.row_fraction[i] / 256.0);
    ASSERT_LE(std::abs(target.at<std::uint8_t>(i / size.width, i % size.width) - expected), 0.5) << i;
  }
}

TEST(Remap, IsBilinearInterpolationRoundedOnce) {
  const cv::Mat source = noise({203, 97});
  // Widths below one block, of whole blocks, and of blocks with a remainder.
  for (const cv::Size size : {cv::Size(5, 3), cv::Size(128, 20), cv::Size(199, 90)})
    expectInterpolated(source, randomSources(source.size(), size.area()), size);
}

TEST(Remap, IsTheSameForNeighbouringSources) {
  const cv::Mat source = noise({203, 97});
  const cv::Size size(199, 90);
  for (const double degrees : {0.0, 1.0, -7.0, 30.0, 170.0})
    expectInterpolated(source, turnedSources(source.size(), size, degrees), size);
}

TEST(Remap, ReadsSourcesWithPaddedRows) {
  const cv::Mat padded = noise({256, 64});
  const cv::Mat view = padded(cv::Rect(13, 5, 150, 50));
  const PixelSources sources = randomSources(view.size(), 150 * 50);
  cv::Mat from_view(50, 150, CV_8UC1), from_copy(50, 150, CV_8UC1);
  remap(view, sources, from_view);
  remap(view.clone(), sources, from_copy);
  EXPECT_EQ(cv::norm(from_view, from_copy, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace cartvo::calib
