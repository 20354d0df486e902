// Simulated and rendered views of boards.
#include "support/calib/board_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/model/lens.hpp"

namespace cartvo::test {
namespace {

constexpr int kGround = 110, kMarginCells = 4;

Eigen::Vector2d pixelOf(const calib::CameraModel& camera, const calib::Lens& lens,
                        const Eigen::Vector3d& point) {
  const calib::NormalisedPoint distorted = lens.distort(point);
  return {camera.fx * distorted.x + camera.cx, camera.fy * distorted.y + camera.cy};
}

std::vector<calib::SeenCorner> seenCorners(const calib::CameraModel& camera,
                                           const Eigen::Isometry3d& T_camera_board,
                                           const std::vector<Eigen::Vector2d>& corners, double noise,
                                           std::mt19937& random) {
  const calib::Lens lens(camera);
  std::normal_distribution<double> scatter(0.0, 1.0);
  std::vector<calib::SeenCorner> seen;
  for (std::size_t id = 0; id < corners.size(); ++id) {
    const Eigen::Vector3d point = T_camera_board * Eigen::Vector3d(corners[id].x(), corners[id].y(), 0.0);
    const Eigen::Vector2d off(scatter(random), scatter(random));
    const Eigen::Vector2d pixel = pixelOf(camera, lens, point) + noise * off;
    const bool is_inside = pixel.x() > 3.0 && pixel.y() > 3.0 && pixel.x() < camera.size.width - 4.0 &&
                           pixel.y() < camera.size.height - 4.0;
    if (point.z() > 0.1 && is_inside) seen.push_back({static_cast<int>(id), pixel});
  }
  return seen;
}

/// White paper with a margin around the printed pattern; one pixel per cell.
cv::Mat printedPaper(const calib::BoardSpec& board, double cell) {
  const Eigen::Vector2d extent = calib::boardExtent(board);
  const auto cells = [&](double length) { return static_cast<int>(std::lround(length / cell)); };
  cv::Mat image(cells(extent.y()) + 2 * kMarginCells, cells(extent.x()) + 2 * kMarginCells, CV_8UC1,
                cv::Scalar(230));
  for (const cv::Rect2d& black : calib::boardBlackRectangles(board)) {
    const cv::Point first(cells(black.x) + kMarginCells, cells(black.y) + kMarginCells);
    const cv::Point last(cells(black.x + black.width) + kMarginCells,
                         cells(black.y + black.height) + kMarginCells);
    image(cv::Rect(first, last)).setTo(25);
  }
  return image;
}

/// The rays through the corners of the pixels.
std::vector<Eigen::Vector3d> cornerRays(const calib::CameraModel& camera) {
  const calib::Lens lens(camera);
  std::vector<Eigen::Vector3d> rays;
  for (int row = 0; row <= camera.size.height; ++row) {
    for (int column = 0; column <= camera.size.width; ++column) {
      rays.push_back(
          lens.undistort({(column - 0.5 - camera.cx) / camera.fx, (row - 0.5 - camera.cy) / camera.fy}));
    }
  }
  return rays;
}

/// The paper on grey ground, as rays in the axes of the board see it.
class PaperInView {
 public:
  PaperInView(cv::Mat printed, const Eigen::Isometry3d& T_camera_board, double cell)
      : printed_(std::move(printed)), eye_(T_camera_board.inverse().translation()), cell_(cell) {}

  /// The cell that a ray meets. Left of the paper all are column -1, and so on. The rays of a cell are a
  /// convex cone: if the rays through the corners of a pixel meet one cell, all rays of the pixel do.
  cv::Point cellOf(const Eigen::Vector3d& ray) const {
    const double distance = -eye_.z() / ray.z();
    if (std::abs(ray.z()) < 1e-9 || distance <= 0.0) return {-2, -2};
    const double column = std::floor((eye_.x() + distance * ray.x()) / cell_) + kMarginCells,
                 row = std::floor((eye_.y() + distance * ray.y()) / cell_) + kMarginCells;
    return {static_cast<int>(std::clamp<double>(column, -1.0, printed_.cols)),
            static_cast<int>(std::clamp<double>(row, -1.0, printed_.rows))};
  }

  double shade(const cv::Point& cell) const {
    const bool is_paper = cell.x >= 0 && cell.y >= 0 && cell.x < printed_.cols && cell.y < printed_.rows;
    return is_paper ? printed_.at<std::uint8_t>(cell.y, cell.x) : kGround;
  }

 private:
  cv::Mat printed_;
  Eigen::Vector3d eye_;
  double cell_;
};

}  // namespace

std::vector<Eigen::Isometry3d> boardPoses(const calib::BoardSpec& board, double nearest, int count) {
  const Eigen::Vector2d middle = 0.5 * calib::boardExtent(board);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const double turn = 2.4 * i;  // the golden angle, so that tilts and positions are uncorrelated
    const double tilt = (15.0 + 12.5 * (i % 3)) * M_PI / 180.0;
    const Eigen::Vector3d axis(std::cos(turn), std::sin(turn), 0.0);
    const double distance = nearest * (1.0 + 0.35 * (i % 4));
    const double across = (i % 5 - 2) * 0.24, down = (i / 5 % 3 - 1) * 0.18;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() =
        (Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(0.15 * (i % 7 - 3), Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    pose.translation() = Eigen::Vector3d(across * distance + 0.0575, down * distance, distance) -
                         pose.linear() * Eigen::Vector3d(middle.x(), middle.y(), 0.0);
    poses.push_back(pose);
  }
  return poses;
}

std::vector<calib::BoardView> boardViews(const calib::Rig& rig, const calib::BoardSpec& board,
                                         const std::vector<Eigen::Isometry3d>& T_left_board, double noise,
                                         std::mt19937& random) {
  const std::vector<Eigen::Vector2d> corners = calib::boardCorners(board);
  std::vector<calib::BoardView> views;
  for (std::size_t i = 0; i < T_left_board.size(); ++i) {
    views.push_back({"view" + std::to_string(i),
                     seenCorners(rig.left, T_left_board[i], corners, noise, random),
                     seenCorners(rig.right, rig.T_right_left * T_left_board[i], corners, noise, random)});
  }
  return views;
}

cv::Mat renderBoard(const calib::CameraModel& camera, const Eigen::Isometry3d& T_camera_board,
                    const calib::BoardSpec& board, double cell) {
  constexpr int kSamples = 8;
  const PaperInView paper(printedPaper(board, cell), T_camera_board, cell);
  std::vector<Eigen::Vector3d> rays = cornerRays(camera);
  std::vector<cv::Point> cells;
  for (Eigen::Vector3d& ray : rays) {
    ray = T_camera_board.linear().transpose() * ray;
    cells.push_back(paper.cellOf(ray));
  }
  cv::Mat image(camera.size, CV_32FC1);
  const int stride = camera.size.width + 1;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const auto at = static_cast<std::size_t>(row) * stride + column;
      const bool is_in_one_cell = cells[at] == cells[at + 1] && cells[at] == cells[at + stride] &&
                                  cells[at] == cells[at + stride + 1];
      double sum = kSamples * kSamples * paper.shade(cells[at]);
      if (!is_in_one_cell) {
        sum = 0.0;
        for (int down = 0; down < kSamples; ++down) {
          const double y = (down + 0.5) / kSamples;
          const Eigen::Vector3d left = (1.0 - y) * rays[at] + y * rays[at + stride];
          const Eigen::Vector3d right = (1.0 - y) * rays[at + 1] + y * rays[at + stride + 1];
          for (int across = 0; across < kSamples; ++across) {
            const double x = (across + 0.5) / kSamples;
            sum += paper.shade(paper.cellOf((1.0 - x) * left + x * right));
          }
        }
      }
      image.at<float>(row, column) = static_cast<float>(sum / (kSamples * kSamples));
    }
  }
  cv::GaussianBlur(image, image, {0, 0}, 0.6);
  cv::Mat grey;
  image.convertTo(grey, CV_8UC1);
  return grey;
}

}  // namespace cartvo::test
