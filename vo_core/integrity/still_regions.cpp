// Detection of what stands still in the image.
#include "vo_core/integrity/still_regions.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/image_cells.hpp"
#include "vo_core/geometry/reprojection.hpp"

namespace cartvo::vo {
namespace {

constexpr std::size_t kMaximumRegions = 8;  // reported

/// How the last motion moves landmarks through the image.
class ExpectedFlow {
 public:
  ExpectedFlow(const StereoCamera& camera, const std::vector<WindowFrame>& window)
      : camera_(camera),
        window_(window),
        T_now_world_(window.back().T_world_camera.inverse()),
        T_before_world_(window[window.size() - 2].T_world_camera.inverse()) {}

  /// Length (px) of the landmark's way, at infinity if it has no depth; 0 if unknown.
  double of(const Landmark& landmark) const {
    const WindowFrame* anchor = findFrame(window_, landmark.anchor().frame);
    if (anchor == nullptr) return 0.0;
    const Eigen::Vector3d bearing = bearingOf(camera_, landmark.anchor().leftAtExposure());
    const double inverse_depth = landmark.hasDepth() ? landmark.inverse_depth : 0.0;
    const auto pixel = [&](const Eigen::Isometry3d& T_camera_world) {
      return projectLandmark(camera_, T_camera_world * anchor->T_world_camera, bearing, inverse_depth);
    };
    const Projection now = pixel(T_now_world_), before = pixel(T_before_world_);
    return now.valid && before.valid ? (now.pixel - before.pixel).norm() : 0.0;
  }

 private:
  const StereoCamera& camera_;
  const std::vector<WindowFrame>& window_;
  Eigen::Isometry3d T_now_world_, T_before_world_;
};

}  // namespace

StillRegions::StillRegions(const StereoCamera& camera)
    : camera_(camera), cells_(kCells), still_(kCells), moved_(kCells) {}

void StillRegions::update(const std::vector<Landmark>& landmarks, const std::vector<WindowFrame>& window) {
  if (window.size() < 2) return;
  std::fill(still_.begin(), still_.end(), 0);
  std::fill(moved_.begin(), moved_.end(), 0);
  const ExpectedFlow expected(camera_, window);
  for (const Landmark& landmark : landmarks) {
    if (landmark.observations.size() < 2 || landmark.last().frame != window.back().index) continue;
    const double flow = landmark.lastFlow();
    const int cell = cellOf(camera_, landmark.last().left);
    if (flow > still_regions::kMovedFlow)
      ++moved_[cell];
    else if (flow < kStillFlow && expected.of(landmark) > still_regions::kExpectedFlow)
      ++still_[cell];
  }
  const int still = std::accumulate(still_.begin(), still_.end(), 0);
  const int moved = std::accumulate(moved_.begin(), moved_.end(), 0);
  if (still > still_regions::kMaximumShare * (still + moved)) return;
  bool changed = false;
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (still_[i] + moved_[i] > 0) changed = addPair(cells_[i], moved_[i] > 0) || changed;
  if (changed) findRegions();
}

/// Adds a pair to a cell of it. Returns whether the cell becomes still or ceases to be.
bool StillRegions::addPair(Cell& cell, bool moved) {
  cell.still = still_regions::kMemory * cell.still + (moved ? 0.0 : 1.0);
  cell.moving = still_regions::kMemory * cell.moving + (moved ? 1.0 : 0.0);
  const bool was_still = cell.is_still;
  if (was_still) {
    cell.is_still = cell.still > cell.moving;
  } else {
    const auto known = std::count_if(cells_.begin(), cells_.end(), [](const Cell& c) { return c.is_still; });
    cell.is_still =
        cell.still >= still_regions::kMinimumPairs &&
        cell.still > still_regions::kMinimumRatio * cell.moving &&
        static_cast<double>(known) < still_regions::kMaximumShare * static_cast<double>(cells_.size());
  }
  return cell.is_still != was_still;
}

bool StillRegions::contains(const Eigen::Vector2d& pixel) const {
  return cells_[cellOf(camera_, pixel)].is_still;
}

void StillRegions::findRegions() {
  regions_.clear();
  cv::Mat_<unsigned char> map(kCellRows, kCellColumns);
  std::transform(cells_.begin(), cells_.end(), map.begin(),
                 [](const Cell& cell) -> unsigned char { return cell.is_still ? 1 : 0; });
  cv::Mat labels, boxes, centres;
  const int count = cv::connectedComponentsWithStats(map, labels, boxes, centres);
  std::vector<int> order(count - 1);
  std::iota(order.begin(), order.end(), 1);  // 0 is the background
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return boxes.at<int>(a, cv::CC_STAT_AREA) > boxes.at<int>(b, cv::CC_STAT_AREA);
  });
  for (const int i : order) {
    if (regions_.size() == kMaximumRegions) break;
    const auto scaled = [](int cells, int size, int all) { return cells * size / all; };
    const int x = boxes.at<int>(i, cv::CC_STAT_LEFT), y = boxes.at<int>(i, cv::CC_STAT_TOP);
    const int right = x + boxes.at<int>(i, cv::CC_STAT_WIDTH),
              bottom = y + boxes.at<int>(i, cv::CC_STAT_HEIGHT);
    ImageRegion region;
    region.x = scaled(x, camera_.width, kCellColumns);
    region.y = scaled(y, camera_.height, kCellRows);
    region.width = scaled(right, camera_.width, kCellColumns) - region.x;
    region.height = scaled(bottom, camera_.height, kCellRows) - region.y;
    regions_.push_back(region);
  }
}

}  // namespace cartvo::vo
