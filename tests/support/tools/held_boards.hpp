#pragma once

#include <cmath>
#include <random>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "support/calib/board_scene.hpp"
#include "tools/simulate/content.hpp"

namespace cartvo::test {

/// Content of two small distorted cameras in front of which a board is held still for 1.5 seconds in each of
/// ten places.
class HeldBoards : public simulate::Content {
 public:
  static constexpr double kFrameRate = 15.0;  // Hz
  static constexpr int kPlaces = 10, kPairsEach = 23, kPairs = kPlaces * kPairsEach;

  static calib::BoardSpec board() { return calib::Chessboard{8, 5, 0.05}; }

  static calib::Rig rigOfBoards() {
    calib::Rig rig;
    rig.name = "held boards";
    rig.left.size = rig.right.size = {320, 240};
    rig.left.fx = rig.left.fy = 240.0;
    rig.left.cx = 160.5;
    rig.left.cy = 118.25;
    rig.left.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    rig.right = rig.left;
    rig.right.fx = rig.right.fy = 238.5;
    rig.T_right_left.linear() = Eigen::Quaterniond(1.0, 0.003, -0.004, 0.002).normalized().toRotationMatrix();
    rig.T_right_left.translation() = Eigen::Vector3d(-0.115, 0.002, -0.001);
    rig.T_body_camera = calib::forwardLookingMount();
    return rig;
  }

  HeldBoards() : left_(kPlaces), right_(kPlaces) {
    const calib::Rig rig = rigOfBoards();
    const std::vector<Eigen::Isometry3d> poses = wholePoses(rig);
    cv::parallel_for_({0, 2 * kPlaces}, [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) {
        const auto place = static_cast<std::size_t>(i / 2);
        if (i % 2 == 0) {
          left_[place] = renderBoard(rig.left, poses[place], board(), 0.05);
        } else {
          right_[place] = renderBoard(rig.right, rig.T_right_left * poses[place], board(), 0.05);
        }
      }
    });
  }

  calib::Rig rig() const override { return rigOfBoards(); }
  double frameRate() const override { return kFrameRate; }
  int pairCount() const override { return kPairs; }
  std::int64_t leftInstant(int index) const override { return std::llround(index * 1e9 / kFrameRate); }
  /// The cameras are not synchronised: the right one is exposed 25 ms later.
  std::int64_t rightInstant(int index) const override { return leftInstant(index) + 25'000'000; }
  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    const auto place = static_cast<std::size_t>(index / kPairsEach);
    left = left_[place];
    right = right_[place];
  }
  Trajectory truth() const override { return {}; }
  std::string cacheKey() const override { return "held boards"; }

 private:
  /// Poses at which both cameras see the whole board, as the detection of a chessboard requires.
  static std::vector<Eigen::Isometry3d> wholePoses(const calib::Rig& rig) {
    constexpr int kMany = 60;
    std::mt19937 random;
    std::vector<Eigen::Isometry3d> whole;
    for (const Eigen::Isometry3d& pose : boardPoses(board(), 0.7, kMany)) {
      const calib::BoardView view = boardViews(rig, board(), {pose}, 0.0, random)[0];
      const bool is_whole = view.left.size() == 40 && view.right.size() == 40;
      if (is_whole && whole.size() < kPlaces) whole.push_back(pose);
    }
    return whole;
  }

  std::vector<cv::Mat> left_, right_;
};

}  // namespace cartvo::test
