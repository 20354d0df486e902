// Printed boards: OpenCV's detectors find each corner at its specified position. Layout of boards on pages.
// The command `cartvo calibrate board`.
#include "tools/calibrate/board/board_print.hpp"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board/board_spec.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/calibrate/board/board_sheet.hpp"

namespace cartvo::calibrate {
namespace {

using testing::HasSubstr;

constexpr double kDotsPerInch = 100.0, kPixelsPerMm = kDotsPerInch / 25.4;
constexpr double kTolerance = 0.15;  // px; 0.04 mm

/// A board's sheet as an image (CV_8UC1).
struct Picture {
  BoardSheet sheet;
  cv::Mat image;

  explicit Picture(const char* board) : sheet(layOutBoard(calib::parseBoardSpec(board), "auto")) {
    const std::string png = printedBoard(sheet, ".png", kDotsPerInch);
    image = cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_GRAYSCALE);
  }

  /// Expected pixel of a point of the board; pixel centres at integers.
  cv::Point2f expected(const Eigen::Vector2d& metres) const {
    return {static_cast<float>((sheet.pattern.x + 1000.0 * metres.x()) * kPixelsPerMm - 0.5),
            static_cast<float>((sheet.pattern.y + 1000.0 * metres.y()) * kPixelsPerMm - 0.5)};
  }

  void expectCorner(const cv::Point2f& found, int id) const {
    const cv::Point2f truth = expected(calib::boardCorners(sheet.board)[static_cast<std::size_t>(id)]);
    EXPECT_LT(cv::norm(found - truth), kTolerance) << "corner " << id << " at " << found << ", not " << truth;
  }
};

void refine(const cv::Mat& image, std::vector<cv::Point2f>& corners) {
  cv::cornerSubPix(image, corners, {5, 5}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-4});
}

struct Markers {
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
};

Markers markersIn(const cv::Mat& image, const calib::BoardSpec& board) {
  const calib::MarkerDictionary markers = calib::markerDictionary(board);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = markers.border_bits;
  Markers found;
  cv::aruco::detectMarkers(image, markers.dictionary, found.corners, found.ids, parameters);
  return found;
}

TEST(PrintedBoard, ChessboardIsDetected) {
  const Picture picture("chessboard:9x6:0.025");
  std::vector<cv::Point2f> corners;
  ASSERT_TRUE(cv::findChessboardCorners(picture.image, {9, 6}, corners));
  refine(picture.image, corners);
  for (int id = 0; id < 54; ++id)
    picture.expectCorner(corners[static_cast<std::size_t>(id)], id);
}

TEST(PrintedBoard, CharucoIsDetected) {
  for (const char* board : {"charuco:9x6:0.028:0.021", "charuco:8x6:0.028:0.021:6x6"}) {
    const Picture picture(board);
    const auto& charuco = std::get<calib::Charuco>(picture.sheet.board);
    const Markers markers = markersIn(picture.image, picture.sheet.board);
    EXPECT_EQ(markers.ids.size(), calib::boardMarkers(picture.sheet.board).size());
    const auto reference = cv::aruco::CharucoBoard::create(
        charuco.columns, charuco.rows, static_cast<float>(charuco.square), static_cast<float>(charuco.marker),
        calib::markerDictionary(picture.sheet.board).dictionary);
    std::vector<cv::Point2f> corners;
    std::vector<int> ids;
    cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, picture.image, reference, corners,
                                         ids);
    ASSERT_EQ(ids.size(), calib::boardCorners(picture.sheet.board).size());
    refine(picture.image, corners);
    for (std::size_t i = 0; i < ids.size(); ++i)
      picture.expectCorner(corners[i], ids[i]);
  }
}

TEST(PrintedBoard, AprilGridIsDetected) {
  const Picture picture("aprilgrid:5x4:0.04:0.3");
  Markers markers = markersIn(picture.image, picture.sheet.board);
  EXPECT_EQ(markers.ids.size(), 20u);
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    refine(picture.image, markers.corners[i]);
    for (int k = 0; k < 4; ++k)
      picture.expectCorner(markers.corners[i][static_cast<std::size_t>(k)], 4 * markers.ids[i] + k);
  }
}

/// Compares the layout with a photograph of a grid printed by Kalibr.
TEST(PrintedBoard, AprilGridHasTheLayoutOfKalibr) {
  CARTVO_NEEDS_DATA(folder, "board_aprilgrid");
  const cv::Mat image = cv::imread((folder / "0_0.jpg").string(), cv::IMREAD_GRAYSCALE);
  const calib::BoardSpec board = calib::parseBoardSpec("aprilgrid:6x6:0.088:0.3");
  const Markers markers = markersIn(image, board);
  ASSERT_GE(markers.ids.size(), 8u);
  const std::vector<Eigen::Vector2d> corners = calib::boardCorners(board);
  std::vector<cv::Point2f> on_board, in_image;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d& corner = corners[4 * static_cast<std::size_t>(markers.ids[i]) + k];
      on_board.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
      in_image.push_back(markers.corners[i][k]);
    }
  }
  const cv::Mat H = cv::findHomography(on_board, in_image);
  EXPECT_GT(cv::determinant(H(cv::Rect(0, 0, 2, 2))), 0.0) << "the board is seen from its printed side";
  std::vector<cv::Point2f> mapped;
  cv::perspectiveTransform(on_board, mapped, H);
  for (std::size_t i = 0; i < mapped.size(); ++i)
    EXPECT_LT(cv::norm(mapped[i] - in_image[i]), 10.0)
        << "lens distortion; a different order would be off by 35 px";
}

TEST(PrintedBoard, IsDeterministic) {
  const BoardSheet sheet = layOutBoard(calib::parseBoardSpec("charuco:9x6:0.028:0.021"), "A4");
  for (const char* extension : {".pdf", ".png"}) {  // cairo numbers the SVGs of a process
    EXPECT_TRUE(printedBoard(sheet, extension, kDotsPerInch) == printedBoard(sheet, extension, kDotsPerInch))
        << extension;
  }
}

TEST(PrintedBoard, IsTrueToScaleInPdfAndSvg) {
  const BoardSheet sheet = layOutBoard(calib::parseBoardSpec("chessboard:9x6:0.025"), "A4");
  EXPECT_THAT(printedBoard(sheet, ".pdf", kDotsPerInch),
              HasSubstr("/MediaBox [ 0 0 841.889764 595.275591 ]"));
  const std::string svg = printedBoard(sheet, ".svg", kDotsPerInch);
  EXPECT_THAT(svg, HasSubstr("width=\"297mm\" height=\"210mm\" viewBox=\"0 0 297 210\""));
}

TEST(PrintedBoard, RefusesAnotherFileType) {
  const BoardSheet sheet = layOutBoard(calib::parseBoardSpec("chessboard:9x6:0.025"), "A4");
  EXPECT_EQ(test::messageOf([&] { printBoard(sheet, "board.jpg", kDotsPerInch); }),
            "a board is written as .pdf, .svg or .png, not '.jpg'");
}

BoardSheet sheetOf(const char* board, const char* page) {
  return layOutBoard(calib::parseBoardSpec(board), page);
}

TEST(BoardSheet, UsesTheSmallestPageInTheFittingOrientation) {
  EXPECT_EQ(sheetOf("chessboard:9x6:0.025", "auto").page.name, "A4");
  EXPECT_EQ(sheetOf("chessboard:9x6:0.025", "auto").page.size, cv::Size2d(297, 210));
  EXPECT_EQ(sheetOf("chessboard:6x9:0.025", "auto").page.size, cv::Size2d(210, 297));
  EXPECT_EQ(sheetOf("charuco:11x8:0.03:0.022", "auto").page.name, "A3");
  EXPECT_EQ(sheetOf("aprilgrid:6x6:0.088:0.3", "auto").page.name, "A0");
}

TEST(BoardSheet, KeepsThePatternSizeAndSeparatesItFromTheRulers) {
  for (const char* page : {"auto", "A2", "700x900"}) {
    const BoardSheet sheet = sheetOf("chessboard:9x6:0.025", page);
    EXPECT_NEAR(sheet.pattern.width, 250.0, 1e-9);
    EXPECT_NEAR(sheet.pattern.height, 175.0, 1e-9);
    const cv::Rect2d paper({0.0, 0.0}, sheet.page.size);
    for (const cv::Rect2d& part : {sheet.pattern, sheet.horizontal_ruler, sheet.vertical_ruler})
      EXPECT_EQ(part & paper, part);
    EXPECT_GE(sheet.horizontal_ruler.y, sheet.pattern.br().y + 4.0);
    EXPECT_LE(sheet.vertical_ruler.br().x, sheet.pattern.x - 4.0);
    EXPECT_EQ(sheet.horizontal_ruler.width, 200.0);
    EXPECT_EQ(sheet.vertical_ruler.height, 170.0);
  }
}

TEST(BoardSheet, RefusesAPageThatIsTooSmallWithTheAvailableSize) {
  EXPECT_EQ(test::messageOf([] { sheetOf("charuco:11x8:0.03:0.022", "A4"); }),
            "the board is 330.0 x 240.0 mm and does not fit on A4, which has room for 273.0 x 178.0 mm");
  EXPECT_THAT(test::messageOf([] { sheetOf("aprilgrid:6x6:0.5:0.3", "auto"); }),
              HasSubstr("does not fit on A0"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "250x175"); }),
              HasSubstr("does not fit on 250x175 mm"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "A7"); }),
              HasSubstr("page 'A7': expected A4, A3, A2, A1, A0, auto, or WIDTHxHEIGHT in mm"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "10x10"); }),
              HasSubstr("each side must have 50 to 5000 mm"));
}

}  // namespace
}  // namespace cartvo::calibrate

namespace cartvo {
namespace {

using testing::HasSubstr;

TEST(CalibrateBoardCommand, WritesABoardAndPrintsInstructions) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.pdf";
  const test::CommandResult run =
      test::runCartvo("calibrate board --board chessboard:9x6:0.025 --output " + file);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("chessboard:9x6:0.025, 250.0 x 175.0 mm on A4. Print it at 100 %"));
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST(CalibrateBoardCommand, PrintsJson) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.svg";
  const auto json = nlohmann::json::parse(
      test::pipeCartvo("calibrate board --board chessboard:9x6:0.025 --json --output " + file).output);
  EXPECT_EQ(json["output"], file);
  EXPECT_EQ(json["paper"], "A4");
  EXPECT_NEAR(json["pattern_mm"][0].get<double>(), 250.0, 1e-9);
}

TEST(CalibrateBoardCommand, RefusesBoardsThatCannotBePrinted) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "board.pdf";
  const test::CommandResult large =
      test::runCartvo("calibrate board --board charuco:11x8:0.03:0.022 --paper A4 --output " + file);
  EXPECT_EQ(large.exit_code, 1);
  EXPECT_THAT(large.output, HasSubstr("does not fit on A4"));
  const test::CommandResult unknown =
      test::runCartvo("calibrate board --board circles:4x11:0.02 --output " + file);
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.output, HasSubstr("unknown kind 'circles'"));
  EXPECT_EQ(test::runCartvo("calibrate board --output " + file).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace cartvo
