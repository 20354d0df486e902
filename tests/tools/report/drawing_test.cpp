// Axes: round steps. Reduction of long curves. Tests of drawings as SVG and as pictures.
#include "tools/report/drawing.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "support/temporary_folder.hpp"
#include "tools/report/axis.hpp"

namespace cartvo {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Axis, HasRoundSteps) {
  EXPECT_DOUBLE_EQ(roundStep(10.0, 5), 2.0);
  EXPECT_DOUBLE_EQ(roundStep(0.07, 7), 0.01);
  EXPECT_DOUBLE_EQ(roundStep(33.0, 10), 5.0);
  EXPECT_EQ(tickLabel(0.5, 0.25), "0.5");
  EXPECT_EQ(tickLabel(-1e-12, 0.1), "0.0");
}

TEST(SeriesReduction, KeepsExtremesOfAColumnAndInterruptions) {
  std::vector<cv::Point2d> pixels;
  for (int i = 0; i < 1000; ++i)
    pixels.emplace_back(0.01 * i, i == 500 ? 100.0 : std::sin(i));
  pixels[700].y = kNaN;
  const auto parts = visibleParts(pixels);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_LE(parts[0].size() + parts[1].size(), 4u * 23u);
  const bool has_peak =
      std::any_of(parts[0].begin(), parts[0].end(), [](const auto& point) { return point.y == 100.0; });
  EXPECT_TRUE(has_peak);
}

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
