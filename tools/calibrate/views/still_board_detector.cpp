// Detection of boards that are held still in front of two unsynchronised cameras.
#include "tools/calibrate/views/still_board_detector.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "calib/board/board_detection.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kDetectionIntervalNs = 200'000'000;
constexpr std::int64_t kStillDurationNs = 1'000'000'000;
constexpr std::int64_t kMaxTimeDifferenceNs =
    500'000'000;                           // between the newest detections of the two cameras
constexpr double kMaxStillMotion = 0.3;    // px
constexpr double kMinNewViewMotion = 8.0;  // px

/// The mean distance between common corners, px; infinite if there are none.
double meanMotion(const std::vector<calib::SeenCorner>& from, const std::vector<calib::SeenCorner>& to) {
  double sum = 0.0;
  int count = 0;
  auto other = to.begin();
  for (const calib::SeenCorner& corner : from) {
    while (other != to.end() && other->id < corner.id)
      ++other;
    if (other == to.end() || other->id != corner.id) continue;
    sum += (corner.pixel - other->pixel).norm();
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

}  // namespace

StillBoardDetector::StillBoardDetector(const calib::BoardSpec& board) : board_(board) {}

/// Duration, up to the newest detection, in which all detections agree with the newest one, ns.
std::int64_t StillBoardDetector::stillNs(const std::deque<Detection>& detections) {
  std::int64_t still = 0;
  for (auto detection = detections.rbegin(); detection != detections.rend(); ++detection) {
    if (!(meanMotion(detections.back().corners, detection->corners) < kMaxStillMotion)) break;
    still = detections.back().time_ns - detection->time_ns;
  }
  return still;
}

/// Whether both cameras see a board that has been still long enough and has moved since the last view.
bool StillBoardDetector::isStill() const {
  if (!last_taken_.empty() || left_.empty() || right_.empty()) return false;
  if (std::abs(left_.back().time_ns - right_.back().time_ns) > kMaxTimeDifferenceNs) return false;
  return std::min(stillNs(left_), stillNs(right_)) >= kStillDurationNs;
}

const std::vector<calib::SeenCorner>& StillBoardDetector::corners(capture::CameraSide side) const {
  static const std::vector<calib::SeenCorner> none;
  return detections(side).empty() ? none : detections(side).back().corners;
}

cv::Mat StillBoardDetector::image(capture::CameraSide side) const {
  return detections(side).empty() ? cv::Mat() : detections(side).back().image;
}

std::string StillBoardDetector::advice() const {
  const bool in_left = corners(capture::CameraSide::left).size() >= kMinCornersPerImage,
             in_right = corners(capture::CameraSide::right).size() >= kMinCornersPerImage;
  if (!in_left && !in_right) return "neither image shows the board";
  if (!in_left || !in_right)
    return std::string("only the ") + (in_left ? "left" : "right") +
           " image shows the board: move it to where both see it";
  if (!last_taken_.empty()) return "taken: move the board on";
  const std::int64_t still = std::min(stillNs(left_), stillNs(right_));
  return fmt::format("hold it still: {:.1f} of 1 s",
                     1e-9 * static_cast<double>(std::min(still, kStillDurationNs)));
}

DetectedView StillBoardDetector::takeView() {
  const auto means = [](const std::deque<Detection>& detections) {
    std::map<int, std::pair<Eigen::Vector2d, int>> sums;
    for (const Detection& detection : detections) {
      for (const calib::SeenCorner& corner : detection.corners) {
        auto& [sum, count] = sums.try_emplace(corner.id, Eigen::Vector2d::Zero(), 0).first->second;
        sum += corner.pixel;
        ++count;
      }
    }
    std::vector<calib::SeenCorner> corners;
    for (const auto& [id, sum] : sums) {
      if (2 * sum.second > static_cast<int>(detections.size()))
        corners.push_back({id, sum.first / sum.second});
    }
    return corners;
  };
  const double seconds = 1e-9 * static_cast<double>(left_.back().time_ns - first_ns_);
  DetectedView taken;
  taken.view = {fmt::format("{} at {:.1f} s", ++taken_, seconds), means(left_), means(right_)};
  calib::matchNumbering(board_, taken.view);
  const std::vector<Eigen::Vector2d> board_corners = calib::boardCorners(board_);
  taken.left = calib::viewQuality(left_.back().image, taken.view.left, board_corners);
  taken.right = calib::viewQuality(right_.back().image, taken.view.right, board_corners);
  taken.left_image = left_.back().image.clone();
  taken.right_image = right_.back().image.clone();
  last_taken_ = taken.view.left;
  return taken;
}

StillBoardDetector::UpdateResult StillBoardDetector::update(capture::CameraSide side, const cv::Mat& grey,
                                                            std::int64_t time_ns) {
  if (first_ns_ == 0) first_ns_ = time_ns;
  std::deque<Detection>& detections = side == capture::CameraSide::left ? left_ : right_;
  if (!detections.empty() && time_ns - detections.back().time_ns < kDetectionIntervalNs) return {};
  detections.push_back({time_ns, calib::detectBoard(grey, board_), grey.clone()});
  while (detections.size() > 1 && detections[1].time_ns <= time_ns - kStillDurationNs)
    detections.pop_front();
  if (side == capture::CameraSide::left &&
      meanMotion(last_taken_, detections.back().corners) > kMinNewViewMotion)
    last_taken_.clear();
  return {true, isStill() ? std::optional(takeView()) : std::nullopt};
}

}  // namespace cartvo
