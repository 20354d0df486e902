// Replays of one drive in the layouts of other data sets: the results do not depend on the layout. The
// readouts in the summary of a replay.
#include <cstdio>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/capture/written_files.hpp"
#include "support/pipeline/alert_limits.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/summary.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

constexpr int kPairs = 4;

fs::path imageOf(const fs::path& sequence, const char* camera, int index) {
  char name[16];
  std::snprintf(name, sizeof name, "%06d.png", index);
  return fs::canonical(sequence / camera / name);
}

/// An instant since 1970 in seconds; the pairs are 0.1 s apart.
std::string instantOf(int index) {
  return "1225719884." + std::to_string(100 * (index + 1)) + "000";
}

Replay replayed(ReplaySettings settings) {
  settings.odometry.features = 400;
  settings.alert_limits = test::kNoAlertLimits;
  return replaySource(settings, [](const pipeline::PairResult&, std::size_t) {});
}

void expectEqualPoses(const Replay& one, const Replay& other) {
  ASSERT_EQ(one.pairs.size(), static_cast<std::size_t>(kPairs));
  ASSERT_EQ(other.pairs.size(), one.pairs.size());
  EXPECT_TRUE(one.pairs.back().valid);
  for (std::size_t i = 0; i < one.pairs.size(); ++i)
    EXPECT_TRUE(one.pairs[i].T_first_left.isApprox(other.pairs[i].T_first_left, 1e-9)) << "pair " << i;
}

/// The first pairs of kitti_06 in KITTI's layout and in another one.
class ReplayedLayout : public ::testing::Test {
 protected:
  void SetUp() override {
    CARTVO_NEEDS_DATA(sequence, "kitti_06");
    sequence_ = sequence;
    std::string times;
    for (int i = 0; i < kPairs; ++i) {
      for (const char* camera : {"image_0", "image_1"}) {
        const fs::path image = imageOf(sequence, camera, i);
        fs::create_directories(folder_ / "kitti" / camera);
        fs::create_symlink(image, folder_ / "kitti" / camera / image.filename());
      }
      times += instantOf(i) + "\n";
    }
    test::writeText(folder_ / "kitti/times.txt", times);
    fs::copy(sequence / "calib.txt", folder_ / "kitti/calib.txt");
  }

  void makeNewCollege() const {
    for (int i = 0; i < kPairs; ++i) {
      for (const auto& [camera, side] : {std::pair("image_0", "left"), std::pair("image_1", "right")}) {
        fs::create_directories(folder_ / "data/new_college/StereoImages");
        fs::create_symlink(imageOf(sequence_, camera, i),
                           folder_ / "data/new_college/StereoImages" /
                               ("StereoImage__" + instantOf(i) + "-" + side + ".png"));
      }
    }
    fs::copy(sequence_ / "calib.txt", folder_ / "data/new_college/calib.txt");
  }

  const test::TemporaryFolder folder_;
  fs::path sequence_;
};

TEST_F(ReplayedLayout, OfNewCollegeGivesTheSamePoses) {
  makeNewCollege();
  for (const vo::Estimator estimator : {vo::Estimator::thesis, vo::Estimator::reprojection}) {
    ReplaySettings settings;
    settings.odometry.estimator = estimator;
    settings.source = folder_ / "kitti";
    const Replay kitti = replayed(settings);
    settings.source = folder_ / "data/new_college";
    expectEqualPoses(replayed(settings), kitti);
  }
}

TEST_F(ReplayedLayout, SideBySideGivesTheSamePoses) {
  for (int i = 0; i < kPairs; ++i) {
    cv::Mat both;
    cv::hconcat(cv::imread(imageOf(sequence_, "image_0", i).string(), cv::IMREAD_GRAYSCALE),
                cv::imread(imageOf(sequence_, "image_1", i).string(), cv::IMREAD_GRAYSCALE), both);
    test::writePicture(folder_ / "both/images" / (instantOf(i) + ".pgm"), both);
  }
  fs::copy(sequence_ / "calib.txt", folder_ / "both/calib.txt");
  ReplaySettings settings;
  settings.source = folder_ / "kitti";
  const Replay kitti = replayed(settings);
  settings.source = folder_ / "both";
  settings.side_by_side = true;
  expectEqualPoses(replayed(settings), kitti);
}

TEST(ReplaySummary, HasTheReadoutsOfTheRigAndTheLastEstimates) {
  Replay replay;
  replay.rig.rig.left.readout = 0.03;
  replay.pairs.resize(3);
  replay.pairs[1].readouts = vo::ReadoutEstimates{{0.0321, 1e-4}, {-0.0384, 2e-4}};
  const nlohmann::ordered_json readouts = replaySummary({}, replay)["readouts"];
  EXPECT_NEAR(readouts["rig_left_ms"].get<double>(), 30.0, 1e-9);
  EXPECT_TRUE(readouts["rig_right_ms"].is_null());
  EXPECT_NEAR(readouts["left_ms"]["value"].get<double>(), 32.1, 1e-9);
  EXPECT_NEAR(readouts["right_ms"]["deviation"].get<double>(), 0.2, 1e-9);
}

}  // namespace
}  // namespace cartvo
