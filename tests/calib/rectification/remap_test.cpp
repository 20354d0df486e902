// Remapping, compared with bilinear interpolation in double precision. Raw rows of rectified pixels,
// compared with the rectification tables.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "support/calib/rigs.hpp"

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

constexpr int kStep = 16;

/// Bilinear interpolation between the nodes of a grid.
double shareAt(const RowShareGrid& grid, int column, int row) {
  const int node_column = std::min(column / kStep, grid.columns - 2);
  const int last_row = static_cast<int>(grid.nodes.size()) / grid.columns - 1;
  const int node_row = std::min(row / kStep, last_row - 1);
  const double right = static_cast<double>(column) / kStep - node_column;
  const double lower = static_cast<double>(row) / kStep - node_row;
  const auto node = [&](int i, int j) { return grid.nodes[i * grid.columns + j]; };
  return (1.0 - lower) *
             ((1.0 - right) * node(node_row, node_column) + right * node(node_row, node_column + 1)) +
         lower *
             ((1.0 - right) * node(node_row + 1, node_column) + right * node(node_row + 1, node_column + 1));
}

/// Largest difference between a grid and the tables over the pixels whose source lies in the raw image, in
/// raw rows.
double largestDifference(const RowShareGrid& grid, const PixelSources& sources, cv::Size size) {
  double largest = 0.0;
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * size.width + column;
      const double raw_row = sources.row[i] + sources.row_fraction[i] / 256.0;
      if (raw_row <= 0.0 || raw_row >= size.height - 1.01) continue;
      const double share = (raw_row + 0.5) / size.height - 0.5;
      largest = std::max(largest, size.height * std::abs(shareAt(grid, column, row) - share));
    }
  }
  return largest;
}

void expectAgreement(const Rig& rig, double max_rows) {
  const StereoRowShares shares = rowShares(rig, computeRectification(rig, rig.rectification), kStep);
  const RectificationTables tables = buildTables(rig, rig.rectification);
  EXPECT_EQ(shares.left.columns, 44);  // nodes from 0 to 688 px
  EXPECT_EQ(shares.left.nodes.size(), 44U * 28U);
  EXPECT_LT(largestDifference(shares.left, tables.left, rig.left.size), max_rows);
  EXPECT_LT(largestDifference(shares.right, tables.right, rig.left.size), max_rows);
}

// 1 of 420 rows is 0.08 ms of a readout of 32 ms.
TEST(RowShares, AgreeWithTheTables) {
  expectAgreement(test::cartRig(), 0.2);
}

TEST(RowShares, AgreeWithTheTablesOfAWideLens) {
  expectAgreement(test::wideRig(), 0.5);
}

TEST(RowShares, AgreeUpToTheEdgeOfTheRawImageIfNoPixelIsLost) {
  Rig rig = test::cartRig();
  rig.rectification.free_scaling = 1.0;
  expectAgreement(rig, 0.2);
}

TEST(RowShares, NeedNoGridForRectifiedImages) {
  const Rig rig = test::rectifiedRig();
  const StereoRowShares shares = rowShares(rig, computeRectification(rig, {}), kStep);
  EXPECT_EQ(shares.left.columns, 0);
  EXPECT_TRUE(shares.left.nodes.empty());
  EXPECT_TRUE(shares.right.nodes.empty());
}

TEST(RowShares, DoNotChangeTheFingerprintOfTheTables) {
  Rig rig = test::cartRig();
  const std::uint64_t fingerprint = tablesFingerprint(rig, {});
  rig.left.readout = 0.032;
  EXPECT_EQ(tablesFingerprint(rig, {}), fingerprint);
}

}  // namespace
}  // namespace cartvo::calib
