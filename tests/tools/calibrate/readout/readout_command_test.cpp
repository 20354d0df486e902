// `cartvo calibrate readout` with simulated H.264 streams of a lamp on the mains.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/image_folder.hpp"
#include "support/tools/mains_light.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kFrameRate = 18.0;

void encode(const test::MainsLight& light, const std::filesystem::path& file) {
  simulate::StreamEncoder encoder({}, light.size, kFrameRate);
  std::ofstream stream(file, std::ios::binary);
  for (int i = 0; i < 90; ++i) {
    const simulate::EncodedPicture picture = encoder.encode(light.image(i / kFrameRate));
    stream.write(reinterpret_cast<const char*>(picture.data.data()),
                 static_cast<std::streamsize>(picture.data.size()));
  }
}

TEST(CalibrateReadout, WritesTheReadoutsOfTwoVideosToTheRigFile) {
  const test::TemporaryFolder folder;
  test::MainsLight left, right;
  right.readout = -0.0384;
  encode(left, folder / "left.h264");
  encode(right, folder / "right.h264");
  const calib::Rig before = test::cartRig();
  calib::writeRig(folder / "rig.yaml", before);
  const std::string files = (folder / "left.h264").string() + " " + (folder / "right.h264").string();
  const test::CommandResult result = test::runCartvo(
      "calibrate readout " + files + " --frame-rate 18 --output " + (folder / "rig.yaml").string());
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("rows from bottom to top"));
  const calib::Rig rig = calib::readRig(folder / "rig.yaml");
  ASSERT_TRUE(rig.left.readout && rig.right.readout);
  EXPECT_NEAR(*rig.left.readout, 0.032, 0.01 * 0.032);
  EXPECT_NEAR(*rig.right.readout, -0.0384, 0.01 * 0.0384);
  EXPECT_EQ(rig.name, before.name);
  EXPECT_EQ(rig.T_body_camera.matrix(), before.T_body_camera.matrix());
}

TEST(CalibrateReadout, PrintsPlainLinesOfProgressIntoPipes) {
  const test::TemporaryFolder folder;
  const test::MainsLight light;
  constexpr int kPairs = 60;
  test::writeImageFolder(folder.path(), kPairs, kFrameRate,
                         [&](int /*side*/, int index) { return light.image(index / kFrameRate); });
  const std::string output = test::runWithAllProgress("calibrate readout " + folder.path().string()).output;
  EXPECT_THAT(output, HasSubstr("] 1/120 pictures, "));
  EXPECT_THAT(output, ContainsRegex("120/120 pictures, [0-9.]+/s, 0:00 left\n"));
  EXPECT_THAT(output, Not(HasSubstr("\033")));
}

TEST(CalibrateReadout, KeepsTheRigFileIfItRefuses) {
  const test::TemporaryFolder folder;
  test::MainsLight dark;
  dark.depth = 0.0;
  encode(dark, folder / "left.h264");
  calib::writeRig(folder / "rig.yaml", test::cartRig());
  const std::string arguments = "calibrate readout " + (folder / "left.h264").string() +
                                " --frame-rate 18 --output " + (folder / "rig.yaml").string();
  EXPECT_THAT(test::runCartvo(arguments).output, HasSubstr("--camera left"));
  const test::CommandResult result = test::runCartvo(arguments + " --camera left");
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("the left camera: there are no bands of a lamp"));
  EXPECT_FALSE(calib::readRig(folder / "rig.yaml").left.readout);
}

}  // namespace
}  // namespace cartvo
