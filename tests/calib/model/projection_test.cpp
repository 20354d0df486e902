// Projection and its derivatives, compared with Lens and with finite differences.
#include "calib/model/projection.hpp"

#include <gtest/gtest.h>

#include "calib/model/lens.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::calib {
namespace {

class Projection : public ::testing::TestWithParam<LensModel> {
 protected:
  static CameraModel camera() {
    if (GetParam() == LensModel::wide) return test::wideRig().left;
    CameraModel brown = test::cartRig().left;
    brown.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01, 0.02, 0.01, -0.003};
    return brown;
  }
};

TEST_P(Projection, AgreesWithLens) {
  const Eigen::Vector3d point(0.4, -0.3, 1.2);
  const NormalisedPoint distorted = Lens(camera()).distort(point);
  const Eigen::Vector2d pixel = project(camera(), point)->pixel;
  EXPECT_NEAR(pixel.x(), camera().fx * distorted.x + camera().cx, 1e-9);
  EXPECT_NEAR(pixel.y(), camera().fy * distorted.y + camera().cy, 1e-9);
}

TEST_P(Projection, DerivativesAgreeWithFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.4, -0.3, 1.2), {-0.7, 0.1, 0.8}, {1e-12, 0.0, 2.0}}) {
    const LensProjection projection = *project(camera(), point);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d difference =
          (project(camera(), point + step)->pixel - project(camera(), point - step)->pixel) / (2.0 * kStep);
      EXPECT_LT((projection.J_point.col(k) - difference).norm(), 1e-4) << point.transpose() << " by " << k;
    }
    const int parameters = GetParam() == LensModel::wide ? 8 : kCameraParameters;
    for (int k = 0; k < parameters; ++k) {
      CameraModel more = camera(), less = camera();
      const CameraParameters step = kStep * CameraParameters::Unit(k);
      setParameters(parametersOf(camera()) + step, more);
      setParameters(parametersOf(camera()) - step, less);
      const Eigen::Vector2d difference =
          (project(more, point)->pixel - project(less, point)->pixel) / (2.0 * kStep);
      EXPECT_LT((projection.J_camera.col(k) - difference).norm(), 1e-4) << point.transpose() << " by " << k;
    }
  }
}

TEST_P(Projection, IsUndefinedBehindTheCamera) {
  EXPECT_FALSE(project(camera(), {0.0, 0.0, -1.0}));
}

INSTANTIATE_TEST_SUITE_P(, Projection, ::testing::Values(LensModel::brown, LensModel::wide),
                         [](const auto& lens) { return lens.param == LensModel::wide ? "Wide" : "Brown"; });

}  // namespace
}  // namespace cartvo::calib
