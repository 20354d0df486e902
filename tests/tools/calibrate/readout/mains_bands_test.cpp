// The readout from simulated pictures of a lamp on the mains.
#include "tools/calibrate/readout/mains_bands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/tools/mains_light.hpp"

namespace cartvo::calibrate {
namespace {

using ::testing::HasSubstr;

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
