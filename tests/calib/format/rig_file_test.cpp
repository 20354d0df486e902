// Rig files: round trips, and errors for faulty files.
#include "calib/format/rig_file.hpp"

#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/rig_validation.hpp"
#include "common/atomic_file.hpp"
#include "common/strict_yaml.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::calib {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

void expectEqual(const CameraModel& a, const CameraModel& b) {
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.fx, b.fx);
  EXPECT_EQ(a.fy, b.fy);
  EXPECT_EQ(a.cx, b.cx);
  EXPECT_EQ(a.cy, b.cy);
  EXPECT_EQ(a.lens, b.lens);
  EXPECT_EQ(a.distortion, b.distortion);
}

TEST(RigFile, ReturnsWhatWasWrittenToTheLastBit) {
  const test::TemporaryFolder folder;
  Rig rig = test::cartRig();
  rig.name = "roof \"A\" \\ 2";
  rig.left.fx = 480.0 + 1.0 / 3.0;
  writeRig(folder / "rig.yaml", rig);
  const Rig read = readRig(folder / "rig.yaml");
  EXPECT_EQ(read.name, rig.name);
  expectEqual(read.left, rig.left);
  expectEqual(read.right, rig.right);
  EXPECT_EQ(read.T_right_left.matrix(), rig.T_right_left.matrix());
  EXPECT_EQ(read.T_body_camera.matrix(), rig.T_body_camera.matrix());
}

TEST(RigFile, ReturnsWideLensFreeScalingAndScaleStddev) {
  const test::TemporaryFolder folder;
  Rig rig = test::wideRig();
  rig.rectification.free_scaling = 0.25;
  rig.scale_stddev = 0.002;
  writeRig(folder / "rig.yaml", rig);
  const Rig read = readRig(folder / "rig.yaml");
  expectEqual(read.left, rig.left);
  expectEqual(read.right, rig.right);
  EXPECT_EQ(read.rectification.free_scaling, 0.25);
  EXPECT_EQ(read.scale_stddev, 0.002);
}

TEST(RigFile, ReturnsTheReadouts) {
  Rig rig = test::cartRig();
  rig.left.readout = 0.0321;
  const std::string text = rigText(rig);
  EXPECT_EQ(parseRig(text, "rig.yaml").left.readout, 0.0321);
  EXPECT_EQ(parseRig(text, "rig.yaml").right.readout, std::nullopt);
  rig.left.readout = 0.0;
  rig.right.readout = -0.0384;
  EXPECT_EQ(parseRig(rigText(rig), "rig.yaml").left.readout, 0.0);
  EXPECT_EQ(parseRig(rigText(rig), "rig.yaml").right.readout, -0.0384);
}

TEST(RigFile, IsNotWrittenWithAReadoutOutOfRange) {
  const test::TemporaryFolder folder;
  Rig rig = test::cartRig();
  rig.right.readout = 32.0;
  EXPECT_THROW(writeRig(folder / "rig.yaml", rig), std::invalid_argument);
}

TEST(RigFile, DefaultsToBrownLensAndCropping) {
  const std::string text = rigText(test::cartRig());
  ASSERT_THAT(text, ::testing::Not(HasSubstr("\n  lens:")));
  const Rig read = parseRig(text.substr(0, text.find("free_scaling:")), "rig.yaml");
  EXPECT_EQ(read.left.lens, LensModel::brown);
  EXPECT_EQ(read.rectification.free_scaling, 0.0);
  EXPECT_EQ(read.scale_stddev, 0.0);
}

TEST(RigFile, DefaultsToAForwardLookingMount) {
  const test::TemporaryFolder folder;
  const std::string text = rigText(test::cartRig());
  writeFileAtomically(folder / "rig.yaml", text.substr(0, text.find("T_body_camera:")));
  EXPECT_EQ(readRig(folder / "rig.yaml").T_body_camera.matrix(), forwardLookingMount().matrix());
}

TEST(RigFile, HasNoMountUntilOneIsMeasured) {
  Rig rig = test::cartRig();
  EXPECT_TRUE(hasMount(rig));
  EXPECT_THAT(rigText(rig), HasSubstr("\nT_body_camera:\n"));
  rig.T_body_camera = forwardLookingMount();
  EXPECT_FALSE(hasMount(rig));
  EXPECT_THAT(rigText(rig), ::testing::Not(HasSubstr("\nT_body_camera:")));
  EXPECT_EQ(parseRig(rigText(rig), "rig.yaml").T_body_camera.matrix(), forwardLookingMount().matrix());
  rig.T_body_camera.translation().x() = 1.55;
  EXPECT_FALSE(hasMount(rig)) << "no height";
  EXPECT_EQ(parseRig(rigText(rig), "rig.yaml").T_body_camera.translation().x(), 1.55)
      << "is kept all the same";
}

TEST(RigFile, RefusesUnusualGeometryThatIsNotConfirmed) {
  const auto finding = [](auto change) {
    Rig rig = test::cartRig();
    change(rig);
    rig.unusual_geometry = true;
    EXPECT_EQ(test::messageOf([&] { parseRig(rigText(rig), "rig.yaml"); }), "") << "confirmed";
    rig.unusual_geometry = false;
    return test::messageOf([&] { parseRig(rigText(rig), "rig.yaml"); });
  };
  EXPECT_EQ(finding([](Rig& rig) { rig.right.cx = 12.5; }),
            "rig.yaml: the right camera's cx is 12.5 px (expected 183.6 to 496.4): is the image's size "
            "right, are the "
            "numbers in order, is the matrix transposed? If the rig is really so, add the line "
            "'unusual_geometry: true' to the file");
  EXPECT_THAT(finding([](Rig& rig) { rig.left.fx = 4.2; }), HasSubstr("is it in millimetres"));
  EXPECT_THAT(finding([](Rig& rig) { rig.right.fx = rig.right.fy = 800.0; }),
              HasSubstr("the ratio of the left and the right fx is 0.6003"));
  EXPECT_THAT(finding([](Rig& rig) { rig.left.fy = 240.0; }), HasSubstr("fx/fy is 2.0"));
  EXPECT_THAT(finding([](Rig& rig) { rig.T_right_left.translation() *= 50.0; }),
              HasSubstr("the baseline is 5.751 m (expected 0.02 to 1.5)"));
  EXPECT_THAT(finding([](Rig& rig) { rig.left.distortion[3] = 0.1; }), HasSubstr("p2 is 0.1"));
  EXPECT_THAT(finding([](Rig& rig) {
                rig.T_right_left.linear() =
                    Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
              }),
              HasSubstr("the angle between the two cameras is 28.65 degrees"));
}

TEST(RigFile, IsUnchangedIfTheRigIsInvalid) {
  const test::TemporaryFolder folder;
  writeRig(folder / "rig.yaml", test::cartRig());
  Rig bad = test::cartRig();
  bad.T_right_left.translation() *= 1000.0;
  EXPECT_EQ(test::messageOf([&] { writeRig(folder / "rig.yaml", bad); }),
            "rig: the baseline is 115.022 m, expected 0.005 m to 10 m; was the board's square given in "
            "millimetres?");
  EXPECT_EQ(readRig(folder / "rig.yaml").name, "cart");
}

TEST(RigFile, ValidatesTheSameRangesWhenReadingAndWriting) {
  const std::vector<double CameraModel::*> members = {&CameraModel::fx, &CameraModel::fy, &CameraModel::cx,
                                                      &CameraModel::cy};
  for (double CameraModel::*const member : members) {
    for (const double value : {-1e4, 0.5, 2e5, 4e6}) {
      Rig rig = test::cartRig();
      rig.unusual_geometry = true;
      rig.right.*member = value;
      const bool is_valid = test::messageOf([&] { validateRig(rig); }).empty();
      const bool is_read = test::messageOf([&] { parseRig(rigText(rig), "rig.yaml"); }).empty();
      EXPECT_EQ(is_valid, is_read) << value;
    }
  }
}

/// A fault in an otherwise valid file and the error it must cause.
struct Fault {
  std::string name;
  std::string replace;
  std::string by;
  std::string message;  ///< after "FILE:"
};

void PrintTo(const Fault& fault, std::ostream* stream) {
  *stream << fault.name;
}

class FaultyRigFile : public ::testing::TestWithParam<Fault> {};

TEST_P(FaultyRigFile, IsRefusedNamingLineKeyAndExpectedValue) {
  const Fault& fault = GetParam();
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "rig.yaml";
  std::string text = rigText(test::rectifiedRig());
  const std::size_t at = text.find(fault.replace);
  ASSERT_NE(at, std::string::npos);
  writeFileAtomically(file, text.replace(at, fault.replace.size(), fault.by));
  EXPECT_EQ(test::messageOf([&] { readRig(file); }), file.string() + ":" + fault.message);
}

INSTANTIATE_TEST_SUITE_P(
    , FaultyRigFile,
    ::testing::Values(
        Fault{"UnknownKey", "name:", "nmae: x\nname:",
              "3: nmae: expected one of the keys cartvo_rig, name, image_size, left, right, T_right_left, "
              "T_body_camera, free_scaling, scale_deviation, unusual_geometry, found 'nmae'"},
        Fault{"UnknownKeyInside", "  fx: 500.5", "  fx: 500.5\n  skew: 0",
              "10: left.skew: expected one of the keys fx, fy, cx, cy, lens, distortion, readout, mask, "
              "found 'skew'"},
        Fault{"UnknownLens", "  fx: 500.5", "  lens: narrow\n  fx: 500.5",
              "9: left.lens: expected brown or wide, found 'narrow'"},
        Fault{"WideWithBrownsCoefficients", "  fx: 500.5", "  lens: wide\n  fx: 500.5",
              "14: left.distortion: expected a sequence of 4 numbers, found a sequence of 8 [0, 0, 0, 0, 0, "
              "0, 0, "
              "0]"},
        Fault{"ReadoutInMilliseconds", "  fx: 500.5", "  readout: 32\n  fx: 500.5",
              "9: left.readout: expected a number from -0.2 to 0.2, found '32'"},
        Fault{"ScalingBeyondOne", "free_scaling: 0", "free_scaling: 1.5",
              "38: free_scaling: expected a number from 0 to 1, found '1.5'"},
        Fault{"ScaleStddevTooLarge", "scale_deviation: 0", "scale_deviation: 1",
              "41: scale_deviation: expected a number from 0 to 0.1, found '1'"},
        Fault{"RepeatedKey", "name:", "name: x\nname:", "4: name: expected each key once, found 'name'"},
        Fault{"MissingKey", "  cx: 320.25\n", "", "9: left.cx is missing"},
        Fault{"WrongVersion", "cartvo_rig: 1", "cartvo_rig: 2",
              "2: cartvo_rig: expected an integer from 1 to 1, found '2'"},
        Fault{"TextForNumber", "fx: 500.5", "fx: wide",
              "9: left.fx: expected a number from 1 to 100000, found 'wide'"},
        Fault{"NotANumber", "fx: 500.5", "fx: nan",
              "9: left.fx: expected a number from 1 to 100000, found 'nan'"},
        Fault{"MapForNumber", "fx: 500.5", "fx: {a: 1}",
              "9: left.fx: expected a number from 1 to 100000, found a map"},
        Fault{"NumberOutOfRange", "fx: 500.5", "fx: -500.5",
              "9: left.fx: expected a number from 1 to 100000, found '-500.5'"},
        Fault{"PrincipalPointFarAway", "cy: 240.75", "cy: 2400",
              "12: left.cy: expected a number from -480 to 960, found '2400'"},
        Fault{"DistortionTooShort", "distortion: [0, 0, 0, 0, 0, 0, 0, 0]", "distortion: [0, 0]",
              "13: left.distortion: expected a sequence of 8 numbers, found a sequence of 2 [0, 0]"},
        Fault{"DistortionNoNumber", "distortion: [0, 0, 0, 0, 0, 0, 0, 0]",
              "distortion: [0, 0, 0, 0, 0, 0, 0, k]",
              "13: left.distortion: expected a sequence of 8 numbers, found a sequence of 8 [0, 0, 0, 0, 0, "
              "0, 0, k]"},
        Fault{"SizeNotWhole", "image_size: [640, 480]", "image_size: [640.5, 480]",
              "5: image_size: expected [width, height], two integers from 16 to 8192, found a sequence of 2 "
              "[640.5, 480]"},
        Fault{"SizeTooLarge", "image_size: [640, 480]", "image_size: [640000, 480]",
              "5: image_size: expected [width, height], two integers from 16 to 8192, found a sequence of 2 "
              "[640000, 480]"},
        Fault{
            "RotationNotOrthonormal", "- [1, 0, 0]", "- [1, 0.1, 0]",
            "24: T_right_left.rotation: expected three orthonormal rows of a right-handed rotation, found a "
            "sequence of 3"},
        Fault{
            "RotationMirrored", "- [1, 0, 0]", "- [-1, 0, 0]",
            "24: T_right_left.rotation: expected three orthonormal rows of a right-handed rotation, found a "
            "sequence of 3"},
        Fault{"BaselineInMillimetres", "translation: [-0.12, 0, 0]", "translation: [-120, 0, 0]",
              "27: T_right_left.translation: expected a baseline of 0.005 m to 10 m, found a sequence of 3 "
              "[-120, 0, 0]"},
        Fault{"IndentedByTab", "  fx: 500.5", "\tfx: 500.5",
              "9: is not YAML: this line is indented by a tab; indent it by spaces"},
        Fault{"NotYaml", "left:", "left: [", "10: is not YAML: a '[' is not closed by ']'"}),
    [](const auto& test_case) { return test_case.param.name; });

TEST(RigFile, ReportsAMissingFile) {
  EXPECT_EQ(test::messageOf([] { readRig("/no/such/rig.yaml"); }),
            "/no/such/rig.yaml: cannot be read: No such file or directory");
}

TEST(RigFile, ReportsAnUnknownFormat) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "rig.yaml", "cameras: 2\n");
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "rig.yaml"); }),
              HasSubstr("is neither a cartvo rig file (key cartvo_rig) nor an OpenCV FileStorage"));
  writeFileAtomically(folder / "rig.yaml", "just text\n");
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "rig.yaml"); }),
              EndsWith("rig.yaml:1: expected a map of keys and values, found 'just text'"));
}

TEST(RigFile, RefusesAFileAbove1MiB) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "rig.yaml", std::string((1 << 20) + 1, '#'));
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "rig.yaml"); }),
              HasSubstr("rig.yaml: is larger than 1 MiB"));
}

TEST(RigFile, RefusesUnboundedNesting) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "rig.yaml", std::string(100'000, '['));
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "rig.yaml"); }),
              StartsWith((folder / "rig.yaml").string()));
}

TEST(RigFile, RefusesAliasesThatExpandToABillionNumbers) {
  const test::TemporaryFolder folder;
  std::string text = "a: &l0 [0, 0, 0, 0, 0, 0, 0, 0]\n";
  for (int level = 0; level < 10; ++level) {
    const std::string alias = "*l" + std::to_string(level);
    text += "b" + std::to_string(level) + ": &l" + std::to_string(level + 1) + " [" + alias + ", " + alias +
            ", " + alias + ", " + alias + ", " + alias + ", " + alias + ", " + alias + ", " + alias + "]\n";
  }
  writeFileAtomically(folder / "rig.yaml", text);
  EXPECT_THAT(test::messageOf([&] { StrictYaml::readFile(folder / "rig.yaml")["b9"].numbers(); }),
              HasSubstr("b9: expected a sequence of numbers"));
}

}  // namespace
}  // namespace cartvo::calib
