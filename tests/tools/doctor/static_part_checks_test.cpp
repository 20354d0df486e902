// Static parts of a made-up drive past a wall, in an image folder.
#include "tools/doctor/static_part_checks.hpp"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "support/calib/rigs.hpp"
#include "support/doctor/findings.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/wall_drive.hpp"

namespace cartvo::doctor {
namespace {

using test::Saw;
using ::testing::HasSubstr;

const std::atomic<bool> kNotInterrupted{false};

/// A folder with pairs at 4 Hz; the left camera sees the bonnet.
class WallDriveFolder : public ::testing::Test {
 protected:
  void write(int pairs, bool stands) {
    test::WallDrive left, right;
    left.showBonnet();
    for (const char* camera : {"image_0", "image_1"})
      std::filesystem::create_directory(folder_ / camera);
    std::string times;
    cv::Mat left_image = left.next(), right_image = right.next();
    for (int i = 0; i < pairs; ++i) {
      const std::string name = std::to_string(100 + i) + ".png";
      ASSERT_TRUE(cv::imwrite((folder_ / "image_0" / name).string(), left_image));
      ASSERT_TRUE(cv::imwrite((folder_ / "image_1" / name).string(), right_image));
      if (stands) continue;
      left_image = left.next();
      right_image = right.next();
    }
  }

  Findings checked(const calib::Rig* rig, const std::atomic<bool>& interrupted = kNotInterrupted) const {
    capture::SourceSettings settings;
    settings.frame_rate = 4.0;
    capture::StereoSource source = capture::openSource(folder_.path(), settings);
    FindingList findings("pictures");
    checkStaticParts(source, rig, interrupted, findings);
    return findings.take();
  }

  test::TemporaryFolder folder_;
};

TEST_F(WallDriveFolder, ShowsTheBonnetInTheLeftCamera) {
  write(40, false);
  const Findings findings = checked(nullptr);
  EXPECT_THAT(test::findingOf(findings, "left camera, static parts"),
              Saw(Verdict::look_at, "% of the picture keeps its place, at x "));
  EXPECT_THAT(test::findingOf(findings, "left camera, static parts").advice,
              HasSubstr("'cartvo calibrate mask'"));
  EXPECT_THAT(test::findingOf(findings, "right camera, static parts"),
              Saw(Verdict::ok, "0.0 % of the picture keeps its place"));
}

TEST_F(WallDriveFolder, IsInOrderWithAMask) {
  write(40, false);
  calib::Rig rig = test::rectifiedRig();
  rig.left.mask = calib::maskOfPolygons({{{40, 150}, {280, 150}, {280, 199}, {40, 199}}}, test::kWallView);
  EXPECT_THAT(test::findingOf(checked(&rig), "left camera, static parts"),
              Saw(Verdict::ok, "19 % of the picture is masked"));
}

TEST_F(WallDriveFolder, SaysNothingAtAStandstill) {
  write(40, true);
  EXPECT_THAT(test::findingOf(checked(nullptr), "left camera, static parts"),
              Saw(Verdict::not_checked, "pictures that differ from the one before: 1"));
}

TEST_F(WallDriveFolder, IsNotReadOnceInterrupted) {
  write(40, false);
  const std::atomic<bool> interrupted{true};
  EXPECT_THAT(test::findingOf(checked(nullptr, interrupted), "left camera, static parts"),
              Saw(Verdict::not_checked, "pictures that differ from the one before: 1"));
}

}  // namespace
}  // namespace cartvo::doctor
