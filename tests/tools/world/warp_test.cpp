#include "tests/tools/world/warp.hpp"

#include <iostream>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

using test::WarpResidual;

world::WorldSettings cleanDrive() {
  world::WorldSettings settings;
  settings.seed = 3;
  settings.seconds = 8.0;
  settings.offset_s = 0.013;
  settings.noise = 0.0;
  settings.edge_samples = 16;
  return settings;
}

struct Summary {
  double mean = 0.0;   ///< of the residuals' length, px
  double scale = 0.0;  ///< slope of the residual over the flow
};

Summary summarise(const std::vector<WarpResidual>& residuals) {
  Summary summary;
  double flow2 = 0.0;
  double product = 0.0;
  for (const WarpResidual& r : residuals) {
    summary.mean += r.residual.norm() / static_cast<double>(residuals.size());
    flow2 += r.flow.squaredNorm();
    product += r.flow.dot(r.residual);
  }
  summary.scale = product / flow2;
  return summary;
}

void append(std::vector<WarpResidual>& all, const std::vector<WarpResidual>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

void expectExact(const std::vector<WarpResidual>& residuals) {
  const Summary summary = summarise(residuals);
  std::cout << residuals.size() << " patches, mean residual " << summary.mean << " px, scale error "
            << summary.scale << "\n";
  ASSERT_GT(residuals.size(), 200U);
  EXPECT_LT(summary.mean, 0.05);
  EXPECT_LT(std::abs(summary.scale), 0.001);
}

TEST(RenderedWorldWarp, LeftMeetsRightThroughDepthAndTruth) {
  const world::RenderedWorld world(cleanDrive());
  std::vector<WarpResidual> residuals;
  for (const int index : {10, 130}) {
    append(residuals, test::warpResiduals(world, {index, CameraSide::left}, {index, CameraSide::right}));
  }
  expectExact(residuals);
}

TEST(RenderedWorldWarp, EachImageMeetsTheNextThroughDepthAndTruth) {
  const world::RenderedWorld world(cleanDrive());
  std::vector<WarpResidual> residuals;
  for (const int index : {90, 130}) {
    append(residuals, test::warpResiduals(world, {index, CameraSide::left}, {index + 1, CameraSide::left}));
  }
  expectExact(residuals);
}

}  // namespace
}  // namespace cartvo
