// Raw rows of rectified pixels, compared with the rectification tables.
#include "calib/rectification/row_shares.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "calib/rectification/rectification_tables.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::calib {
namespace {

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
