// Verifies that rendered images agree with their ground truth to a fraction of a pixel.
#include "tests/support/lab/warp.hpp"

#include <cmath>
#include <iostream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

using test::WarpResidual;

world::WorldSettings cleanDrive(world::Scenario scenario, std::uint64_t seed) {
  world::WorldSettings settings;
  settings.scenario = scenario;
  settings.seed = seed;
  settings.seconds = 8.0;
  settings.offset_s = 0.013;
  settings.noise = 0.0;
  settings.edge_samples = 16;
  return settings;
}

struct Summary {
  double mean = 0.0;   ///< mean length of the residuals, px
  double scale = 0.0;  ///< slope of the residual over the flow: relative scale error
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

void expectExact(const std::vector<WarpResidual>& residuals) {
  const Summary summary = summarise(residuals);
  std::cout << residuals.size() << " patches, mean residual " << summary.mean << " px, scale error "
            << summary.scale << "\n";
  ASSERT_GT(residuals.size(), 200U);
  EXPECT_LT(summary.mean, 0.05);
  EXPECT_LT(std::abs(summary.scale), 0.001);
}

/// Parameters: a scenario and a seed.
class RenderedWorldWarp : public testing::TestWithParam<std::tuple<world::Scenario, std::uint64_t>> {
 protected:
  const world::RenderedWorld world_{cleanDrive(std::get<0>(GetParam()), std::get<1>(GetParam()))};
};

TEST_P(RenderedWorldWarp, RightAndNextImageMatchAnImageByDepthAndTruePoses) {
  expectExact(
      test::warpResiduals(world_, {130, capture::CameraSide::left}, {130, capture::CameraSide::right}));
  expectExact(test::warpResiduals(world_, {90, capture::CameraSide::left}, {91, capture::CameraSide::left}));
}

/// Parameters: the readouts of the left and the right camera, s.
class RollingShutterWarp : public testing::TestWithParam<std::tuple<double, double>> {
 protected:
  static world::WorldSettings rollingDrive() {
    world::WorldSettings settings = cleanDrive(world::Scenario::campus, 1);
    std::tie(settings.left_readout, settings.right_readout) = GetParam();
    settings.shake = {8.0, 0.005};
    return settings;
  }

  const world::RenderedWorld world_{rollingDrive()};
};

TEST_P(RollingShutterWarp, RightAndNextImageMatchAnImageByRows) {
  expectExact(
      test::warpResiduals(world_, {110, capture::CameraSide::left}, {110, capture::CameraSide::right}));
  expectExact(
      test::warpResiduals(world_, {110, capture::CameraSide::right}, {111, capture::CameraSide::right}));
}

TEST(LivelyDriveWarp, ImagesMatchByRows) {
  world::WorldSettings settings = cleanDrive(world::Scenario::campus, 2);
  settings.liveliness = 1.0;
  settings.left_readout = settings.right_readout = 0.032;
  const world::RenderedWorld world(settings);
  expectExact(test::warpResiduals(world, {40, capture::CameraSide::left}, {40, capture::CameraSide::right}));
  expectExact(test::warpResiduals(world, {40, capture::CameraSide::left}, {41, capture::CameraSide::left}));
}

INSTANTIATE_TEST_SUITE_P(Readouts, RollingShutterWarp,
                         testing::Values(std::tuple(0.032, 0.038), std::tuple(-0.032, -0.032)),
                         [](const auto& readouts) {
                           return std::get<0>(readouts.param) > 0.0 ? "DownwardUnlike" : "UpwardAlike";
                         });

INSTANTIATE_TEST_SUITE_P(Worlds, RenderedWorldWarp,
                         testing::Combine(testing::Values(world::Scenario::campus, world::Scenario::dusk),
                                          testing::Values(1U, 2U, 3U)),
                         [](const auto& drive) {
                           return std::string(world::scenarioName(std::get<0>(drive.param))) + "Seed" +
                                  std::to_string(std::get<1>(drive.param));
                         });

}  // namespace
}  // namespace cartvo
