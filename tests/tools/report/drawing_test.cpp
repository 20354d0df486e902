// Tests of drawings as SVG and as pictures.
#include "tools/report/drawing.hpp"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr DrawingColour kRed{200, 0, 0};

Drawing example() {
  Drawing drawing(120, 80);
  drawing.addLine({{10, 20}, {110, 20}}, kRed, 4.0);
  drawing.addLine({{10, 40}, {110, 40}}, kRed, 4.0, 0.5);
  drawing.addText({5, 75}, TextAnchor::start, "a < b & c");
  return drawing;
}

TEST(Drawing, SvgHasAllElementsAndEscapesText) {
  EXPECT_THAT(example().svg(), AllOf(StartsWith("<svg"), EndsWith("</svg>\n"),
                                     HasSubstr("M10.0 20.0L110.0 20.0"), HasSubstr("stroke=\"#c80000\""),
                                     HasSubstr("stroke-opacity=\"0.5\""), HasSubstr("a &lt; b &amp; c")));
}

TEST(Drawing, PictureHasTheSameElements) {
  const cv::Mat picture = example().picture();
  ASSERT_EQ(picture.size(), cv::Size(120, 80));
  EXPECT_EQ(picture.at<cv::Vec3b>(20, 60), cv::Vec3b(0, 0, 200));
  EXPECT_NEAR(picture.at<cv::Vec3b>(40, 60)[0], 128, 1) << "opacity mixes with white";
  EXPECT_EQ(picture.at<cv::Vec3b>(5, 60), cv::Vec3b(255, 255, 255));
}

TEST(Drawing, IsWrittenInTheFormatOfItsName) {
  const test::TemporaryFolder folder;
  writeDrawing(folder / "a.png", example());
  EXPECT_EQ(cv::imread((folder / "a.png").string()).size(), cv::Size(240, 160));
  writeDrawing(folder / "a.svg", example());
  EXPECT_THROW(writeDrawing(folder / "a.pdf", example()), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.pdf"));
}

}  // namespace
}  // namespace cartvo
