// Calibration from simulated board views of rigs with known truth.
#include "calib/solver/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/solver/cross_validation.hpp"
#include "common/units.hpp"
#include "support/calib/board_scene.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<CalibrationModel> kAll{CalibrationModel::brown2, CalibrationModel::brown4,
                                         CalibrationModel::brown5, CalibrationModel::brown8,
                                         CalibrationModel::wide};

const BoardSpec& board() {
  static const BoardSpec spec = Chessboard{12, 9, 0.03};
  return spec;
}

/// Distance at which the board fills about half of the image width, m.
double nearest(const Rig& rig) {
  return rig.left.lens == LensModel::wide ? 0.28 : 0.5;
}

std::vector<BoardView> thirtyViews(const Rig& rig, double noise) {
  std::mt19937 random(7);
  return test::boardViews(rig, board(), test::boardPoses(board(), nearest(rig), 30), noise, random);
}

/// Errors of a rig relative to the truth.
struct Errors {
  double focal_length = 0.0;     ///< the largest of four, relative
  double principal_point = 0.0;  ///< the largest of four, px
  double baseline = 0.0;         ///< m
  double rotation = 0.0;         ///< degrees
  double rows = 0.0;             ///< vertical disparity of noise-free corners, px RMS
};

Errors errorsOf(const Rig& found, const Rig& truth) {
  Errors errors;
  for (const auto& [camera, true_camera] :
       {std::pair(found.left, truth.left), std::pair(found.right, truth.right)}) {
    for (const double share : {camera.fx / true_camera.fx, camera.fy / true_camera.fy})
      errors.focal_length = std::max(errors.focal_length, std::abs(share - 1.0));
    for (const double difference : {camera.cx - true_camera.cx, camera.cy - true_camera.cy})
      errors.principal_point = std::max(errors.principal_point, std::abs(difference));
  }
  errors.baseline = std::abs(found.baseline() - truth.baseline());
  const Eigen::AngleAxisd turn(found.T_right_left.linear() * truth.T_right_left.linear().transpose());
  errors.rotation = turn.angle() * kDegreesPerRadian;
  const RectifiedPoints rectified(found);
  double squares = 0.0, count = 0.0;
  for (const BoardView& view : thirtyViews(truth, 0.0)) {
    for (const double disparity : verticalDisparities(rectified, view)) {
      squares += disparity * disparity;
      count += 1.0;
    }
  }
  errors.rows = std::sqrt(squares / count);
  return errors;
}

/// Checks the error limits for rigs with known truth: 680x420, wide-angle, 30 views, corner noise of 0.1 px.
void expectTruth(const Rig& found, const Rig& truth, double max_degrees) {
  const Errors errors = errorsOf(found, truth);
  EXPECT_LE(errors.focal_length, 1e-3);
  EXPECT_LE(errors.principal_point, 0.5);
  EXPECT_LE(errors.baseline, 2e-4);
  EXPECT_LE(errors.rotation, max_degrees);
  EXPECT_LE(errors.rows, 0.1);
}

TEST(Calibration, EstimatesBrownRigFromNoisyCorners) {
  const Rig truth = test::cartRig();
  const Calibration calibration = calibrateViews(thirtyViews(truth, 0.1), board(), truth.left.size, kAll);
  expectTruth(calibration.rig(), truth, 0.01);
  EXPECT_EQ(calibration.rig().left.lens, LensModel::brown);
  EXPECT_NEAR(calibration.result().corner_stddev, 0.1, 0.01);
  EXPECT_TRUE(calibration.passed());
  EXPECT_LE(calibration.validation().vertical_disparity_rms, 0.2);
}

TEST(Calibration, EstimatesWideRigAndRefusesBrownModels) {
  const Rig truth = test::wideRig();
  const Calibration calibration = calibrateViews(thirtyViews(truth, 0.1), board(), truth.left.size, kAll);
  EXPECT_EQ(calibration.result().model, CalibrationModel::wide);
  expectTruth(calibration.rig(), truth, 0.02);  // a pixel covers twice the angle
  EXPECT_TRUE(calibration.passed());
}

/// Cramer-Rao bound of the standard deviation of the rotation angle, from the information of the solution,
/// degrees.
double rotationBound(const StereoCalibration& calibration) {
  double variance = 0.0;
  for (const ParameterEstimate& parameter : calibration.parameters) {
    if (parameter.name.name.starts_with("rotation")) variance += parameter.stddev * parameter.stddev;
  }
  return std::sqrt(variance) * kDegreesPerRadian;
}

/// A rig, and a board in front of it at `distance` times the usual distance.
struct KnownTruth {
  Rig truth;
  CalibrationModel model;
  BoardSpec board;
  double distance;
  int times;
};

/// Uses different noise in each run. --gtest_filter='*CramerRaoBound*' prints the numbers of
/// docs/architecture.md. The rotation compensates an error of the principal point: with 12x9 corners per view
/// it cannot be determined to 0.01 degrees, with 24x17 corners on a nearer board of the same size it can.
TEST(Calibration, ReachesTheCramerRaoBound) {
  const BoardSpec fine = Chessboard{24, 17, 0.015};
  for (const KnownTruth& setup : {KnownTruth{test::cartRig(), CalibrationModel::brown5, board(), 1.0, 8},
                                  KnownTruth{test::wideRig(), CalibrationModel::wide, board(), 1.0, 8},
                                  KnownTruth{test::cartRig(), CalibrationModel::brown5, fine, 0.75, 2},
                                  KnownTruth{test::wideRig(), CalibrationModel::wide, fine, 0.75, 2}}) {
    const double distance = setup.distance * nearest(setup.truth);
    Errors worst;
    double squares = 0.0, bound = 0.0;
    for (int time = 0; time < setup.times; ++time) {
      std::mt19937 random(100 + time);
      const std::vector<BoardView> views = test::boardViews(
          setup.truth, setup.board, test::boardPoses(setup.board, distance, 30), 0.1, random);
      const StereoCalibration found =
          calibrateStereo(views, boardCorners(setup.board), setup.truth.left.size, {setup.model}).front();
      const Errors errors = errorsOf(found.estimate.rig, setup.truth);
      worst.focal_length = std::max(worst.focal_length, errors.focal_length);
      worst.principal_point = std::max(worst.principal_point, errors.principal_point);
      worst.baseline = std::max(worst.baseline, errors.baseline);
      worst.rotation = std::max(worst.rotation, errors.rotation);
      worst.rows = std::max(worst.rows, errors.rows);
      squares += errors.rotation * errors.rotation;
      bound = rotationBound(found);
    }
    const double rotation_rms = std::sqrt(squares / setup.times);
    std::printf(
        "%s, %s, the worst of %d: focal length %.4f %%, principal point %.3f px, baseline %.3f mm, "
        "rotation %.4f deg (RMS %.4f, bound %.4f), rows %.3f px RMS\n",
        modelName(setup.model).c_str(), boardSpecText(setup.board).c_str(), setup.times,
        100.0 * worst.focal_length, worst.principal_point, 1000.0 * worst.baseline, worst.rotation,
        rotation_rms, bound, worst.rows);
    EXPECT_LE(worst.focal_length, 1e-3);
    EXPECT_LE(worst.principal_point, 0.5);
    EXPECT_LE(worst.baseline, 2e-4);
    EXPECT_LE(worst.rows, 0.1);
    EXPECT_LE(rotation_rms, setup.distance < 1.0 ? 0.01 : 1.5 * bound);
  }
}

TEST(Calibration, StddevsMatchTheErrors) {
  const Rig truth = test::cartRig();
  const Calibration calibration =
      calibrateViews(thirtyViews(truth, 0.1), board(), truth.left.size, {CalibrationModel::brown5});
  double squares = 0.0;
  for (const ParameterEstimate& parameter : calibration.result().parameters) {
    if (parameter.name.name == "left fx")
      squares += std::pow((parameter.value - truth.left.fx) / parameter.stddev, 2.0);
    if (parameter.name.name == "translation x")
      squares += std::pow((parameter.value - truth.T_right_left.translation().x()) / parameter.stddev, 2.0);
  }
  EXPECT_GT(squares, 0.0);
  EXPECT_LT(squares, 14.0);  // for two normal values exceeded once in a thousand

  const double scale = calibration.rig().baseline() / truth.baseline() - 1.0;
  EXPECT_LT(std::abs(scale), 3.0 * scaleStddev(calibration));
  EXPECT_GE(scaleStddev(calibration), 1e-3) << "uncertainty of the board's squares";
  Calibration poor = calibration;
  poor.halves.baseline = 0.02;
  EXPECT_NEAR(scaleStddev(poor), 0.01, 1e-3);
}

TEST(Calibration, IsDeterministic) {
  const Rig truth = test::cartRig();
  const std::vector<BoardView> views = thirtyViews(truth, 0.1);
  const std::vector<CalibrationModel> models{CalibrationModel::brown2};
  const Calibration first = calibrateViews(views, board(), truth.left.size, models);
  const Calibration second = calibrateViews(views, board(), truth.left.size, models);
  EXPECT_EQ(first.rig().T_right_left.matrix(), second.rig().T_right_left.matrix());
  EXPECT_EQ(first.rig().left.distortion, second.rig().left.distortion);
}

TEST(Calibration, RejectsOutlierCornerAndOutlierView) {
  const Rig truth = test::cartRig();
  std::vector<BoardView> views = thirtyViews(truth, 0.1);
  views[3].left[5].pixel.x() += 3.0;
  for (SeenCorner& corner : views[8].right)
    corner.pixel += Eigen::Vector2d(corner.id % 2 == 0 ? 3.0 : -3.0, 2.0);
  const Calibration calibration = calibrateViews(views, board(), truth.left.size, {CalibrationModel::brown5});
  ASSERT_EQ(calibration.rejected.size(), 1U);
  EXPECT_EQ(calibration.rejected[0].name, "view8");
  EXPECT_THAT(calibration.rejected[0].reason, HasSubstr("the RMS error of its corners is"));
  EXPECT_EQ(calibration.rejected_corners, 1U);
  expectTruth(calibration.rig(), truth, 0.02);
}

TEST(Calibration, DetectsABoardThatMovedBetweenTheExposures) {
  const Rig truth = test::cartRig();
  std::vector<BoardView> views = thirtyViews(truth, 0.1);
  for (std::size_t i = 0; i < views.size(); ++i) {
    // The board moved between the exposures, in a different direction in each view.
    const double direction = 2.0 * static_cast<double>(i);
    const Eigen::Vector2d moved(std::cos(direction), std::sin(direction));
    for (SeenCorner& corner : views[i].right)
      corner.pixel += moved;
  }
  const Calibration calibration = calibrateViews(views, board(), truth.left.size, {CalibrationModel::brown2});
  EXPECT_TRUE(calibration.sync.is_fault);
  EXPECT_FALSE(calibration.passed());
  const Calibration still =
      calibrateViews(thirtyViews(truth, 0.1), board(), truth.left.size, {CalibrationModel::brown2});
  EXPECT_EQ(still.sync.opposed_views, 0);
}

TEST(Calibration, RefusesExchangedCameras) {
  const Rig truth = test::cartRig();
  std::vector<BoardView> views = thirtyViews(truth, 0.1);
  for (BoardView& view : views)
    std::swap(view.left, view.right);
  EXPECT_THAT(
      test::messageOf([&] { calibrateViews(views, board(), truth.left.size, {CalibrationModel::brown2}); }),
      HasSubstr("left and right are exchanged: the camera given as the right one is 115 mm to the left"));
}

TEST(Calibration, RefusesABoardWithoutTilt) {
  const Rig truth = test::cartRig();
  std::vector<Eigen::Isometry3d> poses = test::boardPoses(board(), nearest(truth), 20);
  for (Eigen::Isometry3d& pose : poses)
    pose.linear() = Eigen::Matrix3d::Identity();
  std::mt19937 random(3);
  const std::vector<BoardView> views = test::boardViews(truth, board(), poses, 0.1, random);
  EXPECT_THAT(
      test::messageOf([&] { calibrateViews(views, board(), truth.left.size, {CalibrationModel::brown2}); }),
      HasSubstr("the board is parallel to itself in all views"));
}

TEST(Calibration, RefusesTooFewViews) {
  const Rig truth = test::cartRig();
  std::vector<BoardView> views = thirtyViews(truth, 0.1);
  views.resize(3);
  EXPECT_THAT(
      test::messageOf([&] { calibrateViews(views, board(), truth.left.size, {CalibrationModel::brown2}); }),
      HasSubstr("only 3 views show the board to both cameras: at least 6 are needed"));
}

TEST(CalibrationDifference, MeasuresBaselineAndRotationByProjectionAndDepth) {
  const Rig a = test::rectifiedRig();
  ImageCoverage all;
  all.corners.fill(1);
  EXPECT_LT(compareCalibrations(a, a, all, all, {10.0}).projection_p95, 1e-9);
  EXPECT_LT(compareCalibrations(a, a, all, all, {10.0}).depth[0].p95, 1e-6);
  Rig b = a;
  b.T_right_left.translation().x() *= 1.02;  // depths grow by 2 %
  EXPECT_LT(compareCalibrations(a, b, all, all, {10.0}).projection_p95, 1e-9);
  EXPECT_NEAR(compareCalibrations(a, b, all, all, {10.0}).depth[0].median, 0.2, 1e-3);
  EXPECT_NEAR(compareCalibrations(b, a, all, all, {10.0}).baseline, 0.02, 1e-9);
  Rig turned = a;
  turned.T_right_left.linear() = Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  // A rotation of 1 mrad about the vertical axis is half a pixel of disparity: a depth error of Z^2 / b * 1
  // mrad.
  EXPECT_NEAR(compareCalibrations(a, turned, all, all, {5.0}).depth[0].median, 5.0 * 5.0 * 1e-3 / 0.12, 0.06);
}

TEST(CalibrationDifference, IsInfiniteWithoutCommonCoverage) {
  const Rig a = test::rectifiedRig();
  ImageCoverage all, none;
  all.corners.fill(1);
  EXPECT_TRUE(std::isinf(compareCalibrations(a, a, none, none, {}).projection_p95));
  EXPECT_TRUE(std::isinf(compareCalibrations(a, a, none, none, {}).projection_rms));
  // The right image has no corners in the common field of view.
  const CalibrationDifference apart = compareCalibrations(a, a, all, none, {10.0});
  EXPECT_TRUE(std::isfinite(apart.projection_p95));
  EXPECT_TRUE(std::isinf(apart.depth[0].median));
  EXPECT_TRUE(std::isinf(apart.depth[0].p95));
}

TEST(ViewCoverage, GivesAdviceUntilCoverageIsSufficient) {
  const Rig rig = test::cartRig();
  const std::vector<BoardView> few = {thirtyViews(rig, 0.0).front()};
  const ImageCoverage left = coverageOf(few, &BoardView::left, rig.left.size);
  EXPECT_THAT(nextViewAdvice(left, left, tiltsOf({})), HasSubstr("show the board in the"));
  ImageCoverage full;
  full.corners.fill(1);
  EXPECT_THAT(nextViewAdvice(full, full, tiltsOf({Eigen::Isometry3d::Identity()})),
              HasSubstr("turn the board"));
  EXPECT_THAT(nextViewAdvice(full, full, tiltsOf(test::boardPoses(board(), 0.5, 12))), IsEmpty());
}

}  // namespace
}  // namespace cartvo::calib
