// Board specifications: text, corners, markers and dictionaries.
#include "calib/board/board_spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/aruco/charuco.hpp>

#include "support/error_message.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;

TEST(BoardSpec, IsReadAndWrittenBack) {
  EXPECT_EQ(std::get<Chessboard>(parseBoardSpec("chessboard:9x6:0.025")), (Chessboard{9, 6, 0.025}));
  EXPECT_EQ(std::get<Charuco>(parseBoardSpec("charuco:11x8:0.03:0.022")), (Charuco{11, 8, 0.03, 0.022, 4}));
  EXPECT_EQ(std::get<AprilGrid>(parseBoardSpec("aprilgrid:6x6:0.088:0.3")), (AprilGrid{6, 6, 0.088, 0.3}));
  for (const char* text : {"chessboard:9x6:0.025", "charuco:11x8:0.03:0.022", "charuco:11x8:0.03:0.022:5x5",
                           "aprilgrid:6x6:0.088:0.3", "aprilgrid:7x5:0.0853000001:0.25"}) {
    EXPECT_EQ(boardSpecText(parseBoardSpec(text)), text);
  }
}

TEST(BoardSpec, RefusesFaultyTextWithTheReason) {
  const auto problem = [](const char* text) { return test::messageOf([&] { parseBoardSpec(text); }); };
  EXPECT_THAT(problem("chessbord:9x6:0.025"), HasSubstr("'chessbord:9x6:0.025': unknown kind 'chessbord'; "
                                                        "expected chessboard:COLUMNSxROWS:SQUARE"));
  EXPECT_THAT(problem(""), HasSubstr("unknown kind ''"));
  EXPECT_THAT(problem("chessboard:9x6"), HasSubstr("it has 2 parts"));
  EXPECT_THAT(problem("chessboard:9x6:0.025:1"), HasSubstr("it has 4 parts"));
  EXPECT_THAT(problem("chessboard:9:0.025"), HasSubstr("'9' is not COLUMNSxROWS"));
  EXPECT_THAT(problem("chessboard:9x6x:0.025"), HasSubstr("'9x6x' is not COLUMNSxROWS"));
  EXPECT_THAT(problem("chessboard:9x2:0.025"), HasSubstr("must have 3 to 100"));
  EXPECT_THAT(problem("chessboard:9x6:25"), HasSubstr("a square's side of 25 m must lie in 0.001 to 2 m"));
  EXPECT_THAT(problem("chessboard:9x6:nan"), HasSubstr("a square's side 'nan' is not a number"));
  EXPECT_THAT(problem("chessboard:9x6:25mm"), HasSubstr("'25mm' is not a number"));
  EXPECT_THAT(problem("charuco:11x8:0.03:0.03"), HasSubstr("markers must be smaller than the squares"));
  EXPECT_THAT(problem("charuco:11x8:0.03:0.02:8x8"), HasSubstr("4x4, 5x5, 6x6 or 7x7 bits"));
  EXPECT_THAT(problem("charuco:60x60:0.03:0.02"), HasSubstr("more than the 1000 markers"));
  EXPECT_THAT(problem("aprilgrid:6x6:0.088:0.0264m"), HasSubstr("the spacing '0.0264m' is not a number"));
  EXPECT_THAT(problem("aprilgrid:6x6:0.088:3"), HasSubstr("the spacing must lie in 0.05 to 2"));
  EXPECT_THAT(problem("aprilgrid:30x30:0.088:0.3"), HasSubstr("more than the 587 tags"));
}

TEST(BoardCorners, OfAChessboardAreBetweenItsSquares) {
  const BoardSpec board = parseBoardSpec("chessboard:9x6:0.025");
  const std::vector<Eigen::Vector2d> corners = boardCorners(board);
  ASSERT_EQ(corners.size(), 54u);
  EXPECT_TRUE(corners[0].isApprox(Eigen::Vector2d(0.025, 0.025)));
  EXPECT_TRUE(corners[1].isApprox(Eigen::Vector2d(0.05, 0.025)));
  EXPECT_TRUE(corners[53].isApprox(Eigen::Vector2d(0.225, 0.15)));
  EXPECT_TRUE(boardExtent(board).isApprox(Eigen::Vector2d(0.25, 0.175)));
  EXPECT_TRUE(boardMarkers(board).empty());
}

/// Compares corners and markers, by id, with OpenCV's own board.
TEST(BoardCorners, OfACharucoAgreeWithOpenCv) {
  for (const char* text : {"charuco:5x3:0.04:0.03", "charuco:6x4:0.04:0.03:5x5"}) {
    const BoardSpec board = parseBoardSpec(text);
    const auto& charuco = std::get<Charuco>(board);
    const auto reference = cv::aruco::CharucoBoard::create(
        charuco.columns, charuco.rows, static_cast<float>(charuco.square), static_cast<float>(charuco.marker),
        markerDictionary(board).dictionary);
    const std::vector<Eigen::Vector2d> corners = boardCorners(board);
    ASSERT_EQ(corners.size(), reference->chessboardCorners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_NEAR(corners[i].x(), reference->chessboardCorners[i].x, 1e-6);
      EXPECT_NEAR(corners[i].y(), reference->chessboardCorners[i].y, 1e-6);
    }
    const std::vector<BoardMarker> markers = boardMarkers(board);
    ASSERT_EQ(markers.size(), reference->ids.size());
    for (std::size_t i = 0; i < markers.size(); ++i) {
      EXPECT_EQ(markers[i].id, reference->ids[i]);
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(markers[i].corners[k].x(), reference->objPoints[i][k].x, 1e-6);
        EXPECT_NEAR(markers[i].corners[k].y(), reference->objPoints[i][k].y, 1e-6);
      }
    }
  }
}

TEST(BoardCorners, OfAnAprilGridAreNumberedFromTheBottomLeft) {
  const BoardSpec board = parseBoardSpec("aprilgrid:6x5:0.1:0.3");
  EXPECT_TRUE(boardExtent(board).isApprox(Eigen::Vector2d(6 * 0.13 + 0.03, 5 * 0.13 + 0.03)));
  const std::vector<BoardMarker> tags = boardMarkers(board);
  ASSERT_EQ(tags.size(), 30u);
  EXPECT_TRUE(tags[0].corners[1].isApprox(Eigen::Vector2d(0.03, 0.65))) << "bottom left";
  EXPECT_TRUE(tags[1].corners[1].isApprox(Eigen::Vector2d(0.16, 0.65))) << "to its right";
  EXPECT_TRUE(tags[6].corners[1].isApprox(Eigen::Vector2d(0.03, 0.52))) << "above it";
  const std::vector<Eigen::Vector2d> corners = boardCorners(board);
  ASSERT_EQ(corners.size(), 120u);
  EXPECT_EQ(corners[4 * 7 + 2], tags[7].corners[2]);
}

TEST(MarkerDictionary, IsTheSmallestThatContainsTheBoard) {
  const auto markers = [](const char* text) {
    return markerDictionary(parseBoardSpec(text)).dictionary->bytesList.rows;
  };
  EXPECT_EQ(markers("charuco:10x10:0.03:0.02"), 50);
  EXPECT_EQ(markers("charuco:11x10:0.03:0.02"), 100);
  EXPECT_EQ(markers("charuco:44x44:0.03:0.02:7x7"), 1000);
  EXPECT_EQ(markerDictionary(parseBoardSpec("charuco:11x10:0.03:0.02:6x6")).dictionary->markerSize, 6);
  EXPECT_EQ(markers("aprilgrid:6x6:0.088:0.3"), 587);
  EXPECT_EQ(markerDictionary(parseBoardSpec("aprilgrid:6x6:0.088:0.3")).border_bits, 2);
  EXPECT_THROW(markerDictionary(parseBoardSpec("chessboard:9x6:0.025")), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::calib
