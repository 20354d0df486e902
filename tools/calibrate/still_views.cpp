#include "tools/calibrate/still_views.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "calib/board_detection.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kBetweenLooksNs = 200'000'000;
constexpr std::int64_t kStillNs = 1'000'000'000;
constexpr std::int64_t kApartNs = 500'000'000;  ///< so far may the two cameras' last looks be apart
constexpr double kStill = 0.3;                  ///< px
constexpr double kMovedOn = 8.0;                ///< px

/// The mean distance between corners that both show; infinite if there is none.
double meanMotion(const std::vector<SeenCorner>& from, const std::vector<SeenCorner>& to) {
  double sum = 0.0;
  int count = 0;
  auto other = to.begin();
  for (const SeenCorner& corner : from) {
    while (other != to.end() && other->id < corner.id)
      ++other;
    if (other == to.end() || other->id != corner.id) continue;
    sum += (corner.pixel - other->pixel).norm();
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

}  // namespace

StillViews::StillViews(const BoardSpec& board) : board_(board) {}

/// For how long, up to the newest look, no look differs from the newest one.
std::int64_t StillViews::stillNs(const std::deque<Look>& looks) {
  std::int64_t still = 0;
  for (auto look = looks.rbegin(); look != looks.rend(); ++look) {
    if (!(meanMotion(looks.back().corners, look->corners) < kStill)) break;
    still = looks.back().time_ns - look->time_ns;
  }
  return still;
}

/// Whether both show a board that has been still for long enough, in a place that was not taken before.
bool StillViews::isStill() const {
  if (!last_taken_.empty() || left_.empty() || right_.empty()) return false;
  if (std::abs(left_.back().time_ns - right_.back().time_ns) > kApartNs) return false;
  return std::min(stillNs(left_), stillNs(right_)) >= kStillNs;
}

const std::vector<SeenCorner>& StillViews::corners(CameraSide side) const {
  static const std::vector<SeenCorner> none;
  return looks(side).empty() ? none : looks(side).back().corners;
}

cv::Mat StillViews::image(CameraSide side) const {
  return looks(side).empty() ? cv::Mat() : looks(side).back().image;
}

std::string StillViews::advice() const {
  const bool in_left = corners(CameraSide::left).size() >= kFewestCorners,
             in_right = corners(CameraSide::right).size() >= kFewestCorners;
  if (!in_left && !in_right) return "neither image shows the board";
  if (!in_left || !in_right)
    return std::string("only the ") + (in_left ? "left" : "right") +
           " image shows the board: move it to where both see it";
  if (!last_taken_.empty()) return "taken: move the board on";
  const std::int64_t still = std::min(stillNs(left_), stillNs(right_));
  return fmt::format("hold it still: {:.1f} of 1 s", 1e-9 * static_cast<double>(std::min(still, kStillNs)));
}

DetectedView StillViews::take() {
  const auto means = [](const std::deque<Look>& looks) {
    std::map<int, std::pair<Eigen::Vector2d, int>> sums;
    for (const Look& look : looks) {
      for (const SeenCorner& corner : look.corners) {
        auto& [sum, count] = sums.try_emplace(corner.id, Eigen::Vector2d::Zero(), 0).first->second;
        sum += corner.pixel;
        ++count;
      }
    }
    std::vector<SeenCorner> corners;
    for (const auto& [id, sum] : sums) {
      if (2 * sum.second > static_cast<int>(looks.size())) corners.push_back({id, sum.first / sum.second});
    }
    return corners;
  };
  const double seconds = 1e-9 * static_cast<double>(left_.back().time_ns - first_ns_);
  DetectedView taken;
  taken.view = {fmt::format("{} at {:.1f} s", ++taken_, seconds), means(left_), means(right_)};
  const std::vector<Eigen::Vector2d> board_corners = boardCorners(board_);
  taken.left = viewQuality(left_.back().image, taken.view.left, board_corners);
  taken.right = viewQuality(right_.back().image, taken.view.right, board_corners);
  taken.left_image = left_.back().image.clone();
  taken.right_image = right_.back().image.clone();
  last_taken_ = taken.view.left;
  return taken;
}

StillViews::Looked StillViews::look(CameraSide side, const cv::Mat& grey, std::int64_t time_ns) {
  if (first_ns_ == 0) first_ns_ = time_ns;
  std::deque<Look>& looks = side == CameraSide::left ? left_ : right_;
  if (!looks.empty() && time_ns - looks.back().time_ns < kBetweenLooksNs) return {};
  looks.push_back({time_ns, detectBoard(grey, board_), grey.clone()});
  while (looks.size() > 1 && looks[1].time_ns <= time_ns - kStillNs)
    looks.pop_front();
  if (side == CameraSide::left && meanMotion(last_taken_, looks.back().corners) > kMovedOn)
    last_taken_.clear();
  return {true, isStill() ? std::optional(take()) : std::nullopt};
}

}  // namespace cartvo
