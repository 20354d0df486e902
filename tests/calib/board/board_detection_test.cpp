// Board detection and view quality on rendered boards.
#include "calib/board/board_detection.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "calib/board/view_coverage.hpp"
#include "support/calib/board_scene.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Pose of a tilted board in front of the left camera; its centre is `sideways` (m) from the optical axis.
Eigen::Isometry3d tilted(const BoardSpec& board, double distance, double sideways) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.6, 0.8, 0.0)).toRotationMatrix();
  const Eigen::Vector2d middle = 0.5 * boardExtent(board);
  pose.translation() =
      Eigen::Vector3d(sideways, 0.0, distance) - pose.linear() * Eigen::Vector3d(middle.x(), middle.y(), 0.0);
  return pose;
}

/// RMS distance between detected and true corners, px; infinite if a detected corner does not exist.
double errorOf(const std::vector<SeenCorner>& seen, const CameraModel& camera, const Eigen::Isometry3d& pose,
               const BoardSpec& board) {
  Rig rig;
  rig.left = rig.right = camera;
  std::mt19937 random;
  const std::vector<BoardView> truth = test::boardViews(rig, board, {pose}, 0.0, random);
  double squares = 0.0;
  for (const SeenCorner& corner : seen) {
    const auto there = std::find_if(truth[0].left.begin(), truth[0].left.end(),
                                    [&](const SeenCorner& other) { return other.id == corner.id; });
    if (there == truth[0].left.end()) return std::numeric_limits<double>::infinity();
    squares += (corner.pixel - there->pixel).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(seen.size()));
}

TEST(BoardDetection, LocatesCornersToATenthOfAPixel) {
  const CameraModel camera = test::cartRig().left, fisheye = test::wideRig().left;
  const struct {
    const char* board;
    const CameraModel& camera;
    double distance, sideways;  ///< see tilted()
    double cell;                ///< m
    std::size_t least, most;    ///< corners
  } cases[] = {{"chessboard:9x6:0.024", camera, 0.4, 0.02, 0.024, 54, 54},
               {"charuco:7x5:0.04:0.03", fisheye, 0.22, 0.02, 0.005, 20, 24},
               {"charuco:7x5:0.04:0.03", camera, 0.4, 0.25, 0.005, 6, 23},  // cut off
               {"aprilgrid:4x3:0.05:0.3", camera, 0.4, 0.0, 0.005, 40, 48}};
  for (const auto& shown : cases) {
    const BoardSpec board = parseBoardSpec(shown.board);
    const Eigen::Isometry3d pose = tilted(board, shown.distance, shown.sideways);
    const std::vector<SeenCorner> seen =
        detectBoard(test::renderBoard(shown.camera, pose, board, shown.cell), board);
    EXPECT_GE(seen.size(), shown.least) << shown.board;
    EXPECT_LE(seen.size(), shown.most) << shown.board;
    EXPECT_LT(errorOf(seen, shown.camera, pose, board), 0.1) << shown.board;
  }
}

TEST(BoardDetection, NumbersTheCornersOfAnUpsideDownChessboardFromItsTop) {
  const BoardSpec board = Chessboard{9, 6, 0.024};
  const CameraModel camera = test::cartRig().left;
  const Eigen::Vector2d extent = boardExtent(board);
  const Eigen::Isometry3d pose = tilted(board, 0.4, 0.02) *
                                 Eigen::Translation3d(extent.x(), extent.y(), 0.0) *
                                 Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  const std::vector<SeenCorner> seen = detectBoard(test::renderBoard(camera, pose, board, 0.024), board);
  ASSERT_EQ(seen.size(), 54U);
  EXPECT_LT(errorOf(seen, camera, pose, board), 0.1);
}

TEST(BoardDetection, FindsNothingInAnEmptyImageAndNamesAnotherBoard) {
  const BoardSpec board = Chessboard{9, 6, 0.024};
  const CameraModel camera = test::cartRig().left;
  const cv::Mat image = test::renderBoard(camera, tilted(board, 0.4, 0.02), board, 0.024);
  EXPECT_THAT(detectBoard(cv::Mat(420, 680, CV_8UC1, cv::Scalar(90)), board), IsEmpty());
  const BoardSpec miscounted = Chessboard{10, 7, 0.024};
  EXPECT_THAT(detectBoard(image, miscounted), IsEmpty());
  EXPECT_THAT(describeOtherBoard(image, miscounted), HasSubstr("9x6 inner corners"));
}

TEST(BoardDetection, NamesALargerChessboardOfWhichTheGivenOneIsAPart) {
  const BoardSpec board = Chessboard{9, 6, 0.024};
  const cv::Mat image = test::renderBoard(test::cartRig().left, tilted(board, 0.4, 0.02), board, 0.024);
  EXPECT_THAT(describeLargerBoard(image, Chessboard{8, 6, 0.024}), HasSubstr("9x6 inner corners"));
  EXPECT_THAT(describeLargerBoard(image, board), IsEmpty());
}

/// Boards that look the same upside down, held upright: left and right may be numbered from opposite corners.
TEST(BoardDetection, NumbersBothImagesAlikeForBoardsThatAreTheirOwnTurn) {
  for (const Chessboard& board : {Chessboard{8, 6, 0.02}, Chessboard{7, 5, 0.02}, Chessboard{6, 6, 0.02}}) {
    BoardView view{"upright", {}, {}};
    for (int row = 0; row < board.rows; ++row) {
      for (int column = 0; column < board.columns; ++column) {
        const int id = row * board.columns + column;
        view.left.push_back({id, {100.0 - 10.0 * row, 100.0 + 10.0 * column}});
        view.right.push_back({id, {80.0 - 10.0 * row - 0.2 * column, 100.0 + 10.0 * column}});
      }
    }
    const std::vector<SeenCorner> expected = view.right;
    matchNumbering(board, view);
    EXPECT_EQ(view.right, expected) << "already alike";
    for (std::size_t i = 0; i < expected.size(); ++i)
      view.right[i].pixel = expected[expected.size() - 1 - i].pixel;
    matchNumbering(board, view);
    EXPECT_EQ(view.right, expected) << board.columns << "x" << board.rows;
  }
}

TEST(ViewQuality, DetectsBlurDarknessAndOverexposure) {
  const BoardSpec board = Chessboard{9, 6, 0.024};
  const CameraModel camera = test::cartRig().left;
  const Eigen::Isometry3d pose = tilted(board, 0.4, 0.02);
  const cv::Mat sharp = test::renderBoard(camera, pose, board, 0.024);
  const std::vector<SeenCorner> seen = detectBoard(sharp, board);
  const ViewQuality quality = viewQuality(sharp, seen, boardCorners(board));
  EXPECT_THAT(qualityProblem(quality, quality.edge_width), IsEmpty());
  cv::Mat blurred;
  cv::GaussianBlur(sharp, blurred, {0, 0}, 2.5);
  EXPECT_THAT(qualityProblem(viewQuality(blurred, seen, boardCorners(board)), quality.edge_width),
              HasSubstr("blurred"));
  EXPECT_THAT(qualityProblem(viewQuality(0.1 * sharp, seen, boardCorners(board)), quality.edge_width),
              HasSubstr("too dark"));
  EXPECT_THAT(qualityProblem(viewQuality(0.1 * sharp + 200, seen, boardCorners(board)), quality.edge_width),
              HasSubstr("overexposed"));
}

TEST(ViewQuality, DetectsExcessiveTiltAndCollinearCorners) {
  const BoardSpec board = Chessboard{9, 6, 0.024};
  const CameraModel camera = test::cartRig().left;
  const auto problem_at = [&](double tilt, int corners) {
    Rig rig;
    rig.left = rig.right = camera;
    std::mt19937 random;
    Eigen::Isometry3d pose(Eigen::AngleAxisd(tilt * M_PI / 180.0, Eigen::Vector3d::UnitX()));
    pose.translation() = Eigen::Vector3d(-0.1, 0.0, 0.5);
    std::vector<SeenCorner> seen = test::boardViews(rig, board, {pose}, 0.0, random)[0].left;
    seen.resize(static_cast<std::size_t>(corners));
    ViewQuality quality =
        viewQuality(cv::Mat(camera.size, CV_8UC1, cv::Scalar(0)), seen, boardCorners(board));
    quality.contrast = 200.0;
    quality.edge_width = 1.0;
    return qualityProblem(quality, 1.0);
  };
  EXPECT_THAT(problem_at(0.0, 54), IsEmpty());
  EXPECT_THAT(problem_at(60.0, 54), IsEmpty());
  EXPECT_THAT(problem_at(80.0, 54), HasSubstr("tilted too far: its squares look"));
  EXPECT_THAT(problem_at(0.0, 9), HasSubstr("lie on one line"));
}

}  // namespace
}  // namespace cartvo::calib
