// The truth of KITTI's raw recordings, on a made-up drive.
#include "tools/replay/kitti_oxts.hpp"

#include <cmath>
#include <cstdio>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/capture/written_files.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tools/replay/truth.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using test::writeText;
using ::testing::HasSubstr;

constexpr int kPackets = 4;
constexpr std::int64_t kFirst_ns = 1317042145'500'000'000;

/// Four packets at 10 Hz: the unit drives east, 2 m a packet, and has turned left by 90 degrees in the last.
/// The camera looks along the unit's x axis and is 1 m before it.
class KittiDrive : public ::testing::Test {
 protected:
  KittiDrive() {
    constexpr double kLatitude = 49.0, kEarthRadius = 6378137.0;
    const double degrees_per_metre = 180.0 / M_PI / (kEarthRadius * std::cos(kLatitude * M_PI / 180.0));
    std::string times;
    for (int i = 0; i < kPackets; ++i) {
      char packet[128], name[32], time[64];
      std::snprintf(packet, sizeof packet, "%.12f %.12f 110.0 0 0 %.15f 0 0 0\n", kLatitude,
                    8.0 + 2.0 * i * degrees_per_metre, i == kPackets - 1 ? M_PI_2 : 0.0);
      std::snprintf(name, sizeof name, "%010d.txt", i);
      std::snprintf(time, sizeof time, "2011-09-26 13:02:25.%d\n", 5 + i);
      writeText(drive_ / "oxts/data" / name, packet);
      times += time;
    }
    writeText(drive_ / "oxts/timestamps.txt", times);
    const std::string identity = "R: 1 0 0 0 1 0 0 0 1\n";
    writeText(folder_ / "calib_imu_to_velo.txt",
              "calib_time: 25-May-2012 16:47:16\n" + identity + "T: -1 0 0\n");
    writeText(folder_ / "calib_velo_to_cam.txt", "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\n");
    writeText(folder_ / "calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\n");
  }

  const test::TemporaryFolder folder_;
  const fs::path drive_ = folder_ / "drive";
};

TEST_F(KittiDrive, HasThePosesOfTheCamera) {
  for (const fs::path& path : {drive_, drive_ / "oxts", drive_ / ""}) {
    const Trajectory truth = readKittiOxts(path);
    ASSERT_EQ(truth.size(), static_cast<std::size_t>(kPackets));
    EXPECT_EQ(truth[1].time_ns, kFirst_ns + 100'000'000);
    const auto T = [&](std::size_t i) -> Eigen::Isometry3d {
      return truth[0].pose.inverse() * truth[i].pose;
    };
    EXPECT_TRUE(T(2).isApprox(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 4)), 1e-6)) << T(2).matrix();
    // After the turn to the left the camera is 1 m to the left of the unit, no longer 1 m before it.
    EXPECT_TRUE(T(3).translation().isApprox(Eigen::Vector3d(-1, 0, 5), 1e-6)) << T(3).matrix();
    EXPECT_TRUE((T(3).linear() * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitX(), 1e-9));
  }
}

TEST_F(KittiDrive, IsInterpolatedAtThePairs) {
  Replay replay;
  replay.rig.rig.T_body_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (int i = 0; i < 3; ++i) {
    replay.pairs.emplace_back();
    replay.pairs.back().exposure_ns = kFirst_ns + 50'000'000 + 100'000'000 * (i == 2 ? 90 : i);
  }
  const Truth truth = readTruth(drive_, replay);
  ASSERT_EQ(truth.size(), 3U);
  ASSERT_TRUE(truth[0] && truth[1]);
  EXPECT_TRUE(truth[1]->translation().isApprox(Eigen::Vector3d(2, 0, 0), 1e-6)) << "along the body's x axis";
  EXPECT_FALSE(truth[2]) << "after the end";
}

TEST_F(KittiDrive, ReportsWhatIsMissingOrWrong) {
  const auto error = [&] { return test::messageOf([&] { readKittiOxts(drive_); }); };
  writeText(drive_ / "oxts/data/0000000002.txt", "49 8 110 0 0 x\n");
  EXPECT_THAT(error(), HasSubstr("0000000002.txt: expected the 30 numbers of KITTI's oxts"));
  fs::remove(drive_ / "oxts/data/0000000002.txt");
  EXPECT_THAT(error(), HasSubstr("timestamps.txt: has 4 instants for 3 files"));
  writeText(folder_ / "calib_velo_to_cam.txt", "R: 2 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  writeText(drive_ / "oxts/data/0000000002.txt", "49 8 110 0 0 0\n");
  EXPECT_THAT(error(), HasSubstr("calib_velo_to_cam.txt:1: R: expected the rows of a rotation"));
  fs::remove(folder_ / "calib_imu_to_velo.txt");
  EXPECT_THAT(error(), HasSubstr("calib_"));
  fs::remove_all(drive_ / "oxts/data");
  EXPECT_THAT(error(), HasSubstr("contains no truth; expected a raw recording of KITTI"));
}

}  // namespace
}  // namespace cartvo
