// The odometry's shutters, made from the rig.
#include "pipeline/shutters.hpp"

#include <gtest/gtest.h>

#include "calib/model/lens.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::pipeline {
namespace {

vo::StereoShutters shuttersOf(const calib::Rig& rig, AbsentReadout absent) {
  return stereoShutters(rig, calib::computeRectification(rig, rig.rectification), absent);
}

TEST(Shutters, TakeTheReadoutsOfTheRig) {
  calib::Rig rig = test::cartRig();
  rig.left.readout = 0.03;
  rig.right.readout = -0.0384;
  const vo::StereoShutters shutters = shuttersOf(rig, AbsentReadout::unknown);
  EXPECT_EQ(shutters.left.readout, 0.03);
  EXPECT_EQ(shutters.left.readout_stddev, 0.0);
  EXPECT_EQ(shutters.right.readout, -0.0384);
  EXPECT_EQ(shutters.right.readout_stddev, 0.0);
}

TEST(Shutters, StartAtTheUsualReadoutIfItIsUnknown) {
  calib::Rig rig = test::cartRig();
  rig.right.readout = 0.0;
  const vo::StereoShutters shutters = shuttersOf(rig, AbsentReadout::unknown);
  EXPECT_NEAR(shutters.left.readout, 0.032, 1e-9);
  EXPECT_NEAR(shutters.left.readout_stddev, 0.0128, 1e-9);
  EXPECT_FALSE(shutters.right.isRolling());
}

TEST(Shutters, AreGlobalForImageFoldersWithoutReadout) {
  EXPECT_FALSE(shuttersOf(test::cartRig(), absentReadoutOf(capture::SourceKind::kitti)).areRolling());
  EXPECT_FALSE(shuttersOf(test::cartRig(), absentReadoutOf(capture::SourceKind::videos)).areRolling());
  EXPECT_TRUE(shuttersOf(test::cartRig(), absentReadoutOf(capture::SourceKind::recording)).areRolling());
}

TEST(Shutters, KnowTheRawRowOfARectifiedPixel) {
  const calib::Rig rig = test::cartRig();
  const calib::Rectification rectification = calib::computeRectification(rig, rig.rectification);
  const vo::StereoShutters shutters = shuttersOf(rig, AbsentReadout::unknown);
  const calib::Lens lens(rig.right);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(3.0, 2.0), {340.0, 210.0}, {677.5, 418.2}}) {
    const Eigen::Vector3d ray((pixel.x() - rectification.cx) / rectification.focal_length,
                              (pixel.y() - rectification.cy) / rectification.focal_length, 1.0);
    const double row =
        rig.right.fy * lens.distort(rectification.R_rectified_right.transpose() * ray).y + rig.right.cy;
    EXPECT_NEAR(shutters.right.rows.at(pixel, 420), (row + 0.5) / 420.0 - 0.5, 0.2 / 420.0);
  }
}

TEST(Shutters, TakeTheRowItselfOfRectifiedImages) {
  const vo::StereoShutters shutters = shuttersOf(test::rectifiedRig(), AbsentReadout::unknown);
  EXPECT_NEAR(shutters.left.rows.at({20.0, 100.0}, 480), 100.5 / 480.0 - 0.5, 1e-9);
}

}  // namespace
}  // namespace cartvo::pipeline
