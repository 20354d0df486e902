// The key `mask` of rig files: PNG files, embedded PNG, polygons, and faulty ones.
#include "calib/format/mask_key.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/atomic_file.hpp"
#include "common/input_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::calib {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

const cv::Size kSize(640, 480);  // of rectifiedRig()
const cv::Rect kRoof(0, 0, 640, 40);

/// The rig's text with a line in the left camera, which is line 9.
std::string textWith(const std::string& line) {
  std::string text = rigText(test::rectifiedRig());
  text.replace(text.find("  fx:"), 0, "  " + line + "\n");
  return text;
}

void writePng(const std::filesystem::path& file, const cv::Mat& image) {
  ASSERT_TRUE(cv::imwrite(file.string(), image));
}

cv::Mat roofPicture() {
  cv::Mat image(kSize, CV_8UC1, cv::Scalar(255));
  image(kRoof).setTo(0);
  return image;
}

bool isEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(MaskKey, IsAbsentByDefault) {
  const Rig rig = parseRig(rigText(test::rectifiedRig()), "rig.yaml");
  EXPECT_TRUE(rig.left.mask.empty());
  EXPECT_EQ(maskedShare(rig.left.mask), 0.0);
  EXPECT_THAT(rigText(rig), Not(HasSubstr("mask")));
}

TEST(MaskKey, IsAPngBesideTheRigFile) {
  const test::TemporaryFolder folder;
  writePng(folder / "roof.png", roofPicture());
  writeFileAtomically(folder / "rig.yaml", textWith("mask: roof.png"));
  const Rig rig = readRig(folder / "rig.yaml");
  EXPECT_TRUE(isEqual(rig.left.mask.used, roofPicture()));
  EXPECT_TRUE(rig.right.mask.empty());
  EXPECT_NEAR(maskedShare(rig.left.mask), 1.0 / 12.0, 1e-9);
  validateRig(rig);
}

TEST(MaskKey, IsLeftOutWhereAColouredPictureIsDarkerThanMiddleGrey) {
  const test::TemporaryFolder folder;
  cv::Mat painted(kSize, CV_8UC3, cv::Scalar(200, 210, 220));
  painted(kRoof).setTo(cv::Scalar(20, 10, 40));
  writePng(folder / "roof.png", painted);
  writeFileAtomically(folder / "rig.yaml", textWith("mask: roof.png"));
  EXPECT_TRUE(isEqual(readRig(folder / "rig.yaml").left.mask.used, roofPicture()));
}

TEST(MaskKey, IsPolygonsWithTheirEdges) {
  const Rig rig = parseRig(textWith("mask: [[[0, 0], [639, 0], [639, 39], [0, 39]]]"), "rig.yaml");
  EXPECT_TRUE(isEqual(rig.left.mask.used, roofPicture()));
  const std::string text = rigText(rig);
  EXPECT_THAT(text, HasSubstr("mask: [\n    [[0, 0], [639, 0], [639, 39], [0, 39]]]\n"));
  EXPECT_TRUE(isEqual(parseRig(text, "rig.yaml").left.mask.used, roofPicture()));
}

TEST(MaskKey, MayHaveSeveralPolygonsThatReachTheFarEdgesAndOverlap) {
  const Rig rig = parseRig(textWith("mask: [[[600, 0], [640, 0], [640, 480], [600, 480]], [[590, 0], [640, "
                                    "0], [640, 20]]]"),
                           "rig.yaml");
  const cv::Mat& used = rig.left.mask.used;
  EXPECT_EQ(used.at<unsigned char>(479, 639), 0);
  EXPECT_EQ(used.at<unsigned char>(5, 639), 0);
  EXPECT_EQ(used.at<unsigned char>(1, 595), 0);
  EXPECT_EQ(used.at<unsigned char>(479, 599), 255);
}

TEST(MaskKey, KeepsTheNameOfItsFileWhenTheRigIsWritten) {
  const test::TemporaryFolder folder;
  writePng(folder / "roof.png", roofPicture());
  writeFileAtomically(folder / "rig.yaml", textWith("mask: roof.png"));
  writeRig(folder / "second.yaml", readRig(folder / "rig.yaml"));
  EXPECT_THAT(rigText(readRig(folder / "second.yaml")), HasSubstr("mask: \"data:image/png;base64,"));
  EXPECT_THAT(readInputText(folder / "second.yaml", 1U << 20U), HasSubstr("mask: \"roof.png\"\n"));
  // Elsewhere the name is absolute.
  writeRig(folder / "elsewhere" / "rig.yaml", readRig(folder / "rig.yaml"));
  EXPECT_TRUE(isEqual(readRig(folder / "elsewhere" / "rig.yaml").left.mask.used, roofPicture()));
}

TEST(MaskKey, IsEmbeddedInTextThatStandsForItself) {
  const test::TemporaryFolder folder;
  writePng(folder / "roof.png", roofPicture());
  writeFileAtomically(folder / "rig.yaml", textWith("mask: roof.png"));
  const std::string text = portableRigText(folder / "rig.yaml");
  const Rig rig = parseRig(text, "recording.json");
  EXPECT_TRUE(isEqual(rig.left.mask.used, roofPicture()));
  EXPECT_EQ(rigText(rig), text);
}

TEST(MaskKey, LeavesTheTextOfARigWithoutFilesAsItIs) {
  const test::TemporaryFolder folder;
  const std::string text = "# mine\n" + textWith("mask: [[[0, 0], [639, 0], [639, 39]]]");
  writeFileAtomically(folder / "rig.yaml", text);
  EXPECT_EQ(portableRigText(folder / "rig.yaml"), text);
}

TEST(MaskKey, IsReadFromFilesOfAnyFormatWithIt) {
  const test::TemporaryFolder folder;
  writePng(folder / "roof.png", roofPicture());
  writeFileAtomically(folder / "rig.yaml", textWith("mask: roof.png"));
  EXPECT_FALSE(readRigFiles({folder / "rig.yaml"}).left.mask.empty());
}

TEST(MaskKey, OfAnotherSizeIsNotValid) {
  Rig rig = test::rectifiedRig();
  rig.right.mask = maskOfPolygons({{{0, 0}, {5, 0}, {5, 5}}}, {320, 240});
  EXPECT_EQ(test::messageOf([&] { validateRig(rig); }),
            "rig: the right camera's mask must have the size of the image");
}

/// A faulty picture and its error after "FILE:9: left.mask: ".
struct FaultyPicture {
  const char* name;
  cv::Mat picture;
  const char* error;
};

class FaultyMaskPicture : public testing::TestWithParam<FaultyPicture> {};

TEST_P(FaultyMaskPicture, IsReported) {
  const test::TemporaryFolder folder;
  writePng(folder / "mask.png", GetParam().picture);
  writeFileAtomically(folder / "rig.yaml", textWith("mask: mask.png"));
  const std::string message = test::messageOf([&] { readRig(folder / "rig.yaml"); });
  EXPECT_THAT(message, HasSubstr("rig.yaml:9: left.mask: "));
  EXPECT_THAT(message, HasSubstr(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    MaskKey, FaultyMaskPicture,
    testing::Values(
        FaultyPicture{"OtherSize", cv::Mat(240, 320, CV_8UC1, cv::Scalar(255)),
                      "mask.png is 320x240 px, but the camera's pictures are 640x480 (image_size)"},
        FaultyPicture{"AllBlack", cv::Mat(kSize, CV_8UC1, cv::Scalar(0)),
                      "masks 100 % of the picture, expected at most 75 %: black is not used; are black and "
                      "white exchanged?"}),
    [](const auto& test_case) { return test_case.param.name; });

TEST(MaskKey, ReportsFilesThatAreNoPng) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "rig.yaml", textWith("mask: mask.png"));
  const auto message = [&] { return test::messageOf([&] { readRig(folder / "rig.yaml"); }); };
  EXPECT_THAT(message(),
              HasSubstr("left.mask: " + (folder / "mask.png").string() +
                        ": cannot be read: No such file or directory; expected the name of a PNG"));
  writeFileAtomically(folder / "mask.png", "P5 640 480 255\n");
  EXPECT_THAT(message(), HasSubstr("mask.png is not a PNG; expected the name of a PNG"));
  StaticMask roof;
  roof.used = roofPicture();
  writeFileAtomically(folder / "mask.png", maskPng(roof).substr(0, 40));
  EXPECT_THAT(message(), HasSubstr("mask.png is a damaged PNG"));
  writeFileAtomically(folder / "mask.png", std::string((256U << 10U) + 1, 'x'));
  EXPECT_THAT(message(), HasSubstr("larger than 262144 bytes"));
}

/// A faulty value and the end of its error.
struct FaultyValue {
  const char* name;
  const char* value;
  const char* error;
};

class FaultyMask : public testing::TestWithParam<FaultyValue> {};

TEST_P(FaultyMask, IsReported) {
  const std::string line = std::string("mask: ") + GetParam().value;
  EXPECT_THAT(test::messageOf([&] { parseRig(textWith(line), "rig.yaml"); }), HasSubstr(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    MaskKey, FaultyMask,
    testing::Values(
        FaultyValue{"Map", "{file: a.png}", "rig.yaml:9: left.mask: expected the name of a PNG file, or"},
        FaultyValue{"NoPolygon", "[]", "rig.yaml:9: left.mask: expected the name of a PNG file, or"},
        FaultyValue{"OnePolygonWithoutBrackets", "[[0, 0], [9, 0], [9, 9]]",
                    "rig.yaml:9: left.mask[0][0]: expected a polygon of 3 to 100 points [x, y], whole "
                    "numbers from 0 to 640 and from 0 to 480 px, found '0'"},
        FaultyValue{"TwoPoints", "[[[0, 0], [9, 0]]]", "left.mask[0]: expected a polygon of 3 to 100 points"},
        FaultyValue{"PointOutside", "[[[0, 0], [641, 0], [9, 9]]]",
                    "left.mask[0][1]: expected a polygon of 3 to 100 points"},
        FaultyValue{"PointOfThree", "[[[0, 0], [9, 0, 1], [9, 9]]]", "left.mask[0][1]: expected a polygon"},
        FaultyValue{"PointNotWhole", "[[[0, 0], [9.5, 0], [9, 9]]]", "left.mask[0][1]: expected a polygon"},
        FaultyValue{"FileInARecording", "roof.png",
                    "left.mask: expected polygons or an embedded picture: the text of a recording names no "
                    "files, found 'roof.png'"},
        FaultyValue{"NotBase64", "data:image/png;base64,A", "the embedded picture is not base64"},
        FaultyValue{"NoPng", "data:image/png;base64,Zm9v", "the embedded picture is not a PNG"}),
    [](const auto& test_case) { return test_case.param.name; });

TEST(MaskKey, BoundsPolygonsAndPoints) {
  std::string polygons = "[", points = "[[";
  for (int i = 0; i < 101; ++i) {
    polygons += (i > 0 ? ", " : "") + std::string("[[0, 0], [9, 0], [9, 9]]");
    points += (i > 0 ? ", [" : "[") + std::to_string(i) + ", " + std::to_string(i * i % 97) + "]";
  }
  EXPECT_THAT(test::messageOf([&] { parseRig(textWith("mask: " + polygons + "]"), "rig.yaml"); }),
              HasSubstr("left.mask: expected at most 100 polygons, found a sequence of 101"));
  EXPECT_THAT(test::messageOf([&] { parseRig(textWith("mask: " + points + "]]"), "rig.yaml"); }),
              HasSubstr("left.mask[0]: expected a polygon of 3 to 100 points"));
}

}  // namespace
}  // namespace cartvo::calib
