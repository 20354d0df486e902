// The readout from simulated pictures of a lamp on the mains. `cartvo calibrate readout` with simulated
// H.264 streams of a lamp on the mains.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/image_folder.hpp"
#include "support/tools/mains_light.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/calibrate/readout/mains_bands.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo::calibrate {
namespace {

using testing::HasSubstr;

/// Profiles of 90 pictures. `drift`: of the mains frequency, relative.
std::vector<RowProfile> profilesOf(const test::MainsLight& light, double frame_rate = 18.0,
                                   double drift = 0.0) {
  std::vector<RowProfile> profiles;
  for (int i = 0; i < 90; ++i)
    profiles.push_back(rowProfile(light.image((1.0 + drift) * (0.3 + i / frame_rate)), i / frame_rate));
  return profiles;
}

void expectMeasured(const test::MainsLight& light, double frame_rate = 18.0, double drift = 0.0) {
  const ReadoutMeasurement measured = measureReadout(profilesOf(light, frame_rate, drift), light.mains);
  EXPECT_NEAR(measured.readout.value, light.readout, 0.005 * std::abs(light.readout));
  EXPECT_NEAR(measured.readout.value, light.readout, 4.0 * measured.readout.stddev);
  EXPECT_LT(measured.readout.stddev, 0.01 * std::abs(light.readout));
}

TEST(MainsBands, MeasureTheReadout) {
  for (const double readout : {0.016, 0.0271, 0.032, 0.0384, -0.032}) {
    SCOPED_TRACE(readout);
    test::MainsLight light;
    light.readout = readout;
    expectMeasured(light);
  }
}

TEST(MainsBands, MeasureTheReadoutUnder60Hz) {
  test::MainsLight light;
  light.mains = 60.0;
  light.readout = -0.0305;
  expectMeasured(light);
}

TEST(MainsBands, MeasureTheReadoutAtOtherFrameRates) {
  expectMeasured(test::MainsLight{}, 15.0);
  expectMeasured(test::MainsLight{}, 30.0);
}

TEST(MainsBands, MeasureTheReadoutWhileTheMainsFrequencyDrifts) {
  expectMeasured(test::MainsLight{}, 18.0, 2e-4);
}

TEST(MainsBands, MeasureTheReadoutFromWeakBandsOfALampThatLightsPartOfTheWall) {
  test::MainsLight light;
  light.depth = 0.06;
  light.lit_rows = 0.6;
  expectMeasured(light);
}

TEST(MainsBands, LeaveOutPartsOfPicturesThatChange) {
  const test::MainsLight light;
  std::vector<RowProfile> profiles = profilesOf(light);
  for (int i = 30; i < 45; ++i)
    profiles[static_cast<std::size_t>(i)].means.block(60 + 6 * (i - 30), 2, 70, 2).setConstant(250.0);
  EXPECT_NEAR(measureReadout(profiles, 50.0).readout.value, light.readout, 0.01 * light.readout);
}

std::string refusalOf(const std::vector<RowProfile>& profiles, double mains) {
  return test::messageOf([&] { measureReadout(profiles, mains); });
}

TEST(MainsBands, AreRefusedWithoutALamp) {
  test::MainsLight light;
  light.depth = 0.0;
  EXPECT_THAT(refusalOf(profilesOf(light), 50.0), HasSubstr("no bands of a lamp"));
}

TEST(MainsBands, AreRefusedForAGlobalShutter) {
  test::MainsLight light;
  light.readout = 0.0;
  EXPECT_THAT(refusalOf(profilesOf(light), 50.0), HasSubstr("no bands of a lamp"));
}

TEST(MainsBands, AreRefusedIfTheyStandStill) {
  EXPECT_THAT(refusalOf(profilesOf(test::MainsLight{}, 25.0), 50.0), HasSubstr("set 18 frames a second"));
  test::MainsLight light;
  light.mains = 60.0;
  EXPECT_THAT(refusalOf(profilesOf(light, 16.0), 60.0), HasSubstr("half a band"));
}

TEST(MainsBands, AreRefusedForTheOtherMainsFrequency) {
  test::MainsLight light;
  light.mains = 60.0;
  EXPECT_THAT(refusalOf(profilesOf(light), 50.0), HasSubstr("--mains 60"));
  EXPECT_THAT(refusalOf(profilesOf(test::MainsLight{}), 60.0), HasSubstr("--mains 50"));
}

TEST(MainsBands, AreRefusedOfFewPictures) {
  std::vector<RowProfile> profiles = profilesOf(test::MainsLight{});
  profiles.resize(20);
  EXPECT_THAT(refusalOf(profiles, 50.0), HasSubstr("only 20 pictures; 40 are needed"));
}

}  // namespace
}  // namespace cartvo::calibrate

namespace cartvo {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

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
