// Detection of ChArUco boards and AprilGrids by their markers.
#include "calib/board/marker_detection.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/corner_refinement.hpp"

namespace cartvo::calib {
namespace {

using MarkerCorners = std::array<Eigen::Vector2d, 4>;  ///< px of the full image, ordered as in BoardMarker
using SeenMarkers = std::map<int, MarkerCorners>;

constexpr std::size_t kMinMarkers = 2;

void addMarkers(const cv::Mat& image, const SearchImage& search, const MarkerDictionary& markers,
                SeenMarkers& seen) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->markerBorderBits = markers.border_bits;
  parameters->minMarkerPerimeterRate = 0.01;  // for a distant board
  std::vector<std::vector<cv::Point2f>> quadrangles;
  std::vector<int> ids;
  cv::aruco::detectMarkers(image, markers.dictionary, quadrangles, ids, parameters);
  std::set<int> once, twice;
  for (const int id : ids)
    (once.insert(id).second ? once : twice).insert(id);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (twice.contains(ids[i])) continue;  // ambiguous: at most one of them is on the board
    MarkerCorners corners;
    for (std::size_t k = 0; k < corners.size(); ++k)
      corners[k] = search.toFullImage(quadrangles[i][k]);
    seen.emplace(ids[i], corners);
  }
}

/// Detects all markers of the board's dictionary, by id.
SeenMarkers detectMarkers(const cv::Mat& grey, const BoardSpec& board) {
  constexpr double kMaxSide = 1600.0;  // px
  const SearchImage search(grey, kMaxSide);
  const MarkerDictionary markers = markerDictionary(board);
  SeenMarkers seen;
  if (std::holds_alternative<AprilGrid>(board)) {
    // The small squares at the corners connect neighbouring tags: dilating white separates them.
    cv::Mat dilated;
    cv::dilate(search.image, dilated, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
    addMarkers(dilated, search, markers, seen);
  }
  addMarkers(search.image, search, markers, seen);
  return seen;
}

double shortestSide(const MarkerCorners& corners) {
  double shortest = (corners[3] - corners[0]).norm();
  for (std::size_t k = 0; k < 3; ++k)
    shortest = std::min(shortest, (corners[k + 1] - corners[k]).norm());
  return shortest;
}

/// The markers of a ChArUco board whose squares touch an inner corner.
std::vector<const BoardMarker*> markersBeside(const Eigen::Vector2d& corner, const Charuco& board,
                                              const std::vector<BoardMarker>& markers) {
  std::vector<const BoardMarker*> beside;
  for (const BoardMarker& marker : markers) {
    const Eigen::Vector2d centre = 0.5 * (marker.corners[0] + marker.corners[2]);
    if ((centre - corner).cwiseAbs().maxCoeff() < board.square) beside.push_back(&marker);
  }
  return beside;
}

/// The position in the image of a point on the board, by the homography of the detected ones among these
/// markers.
std::optional<Eigen::Vector2d> predictPosition(const Eigen::Vector2d& point,
                                               const std::vector<const BoardMarker*>& markers,
                                               const SeenMarkers& seen) {
  std::vector<cv::Point2f> printed, imaged;
  for (const BoardMarker* const marker : markers) {
    const auto found = seen.find(marker->id);
    if (found == seen.end()) continue;
    for (std::size_t k = 0; k < marker->corners.size(); ++k) {
      printed.emplace_back(static_cast<float>(marker->corners[k].x()),
                           static_cast<float>(marker->corners[k].y()));
      imaged.emplace_back(static_cast<float>(found->second[k].x()), static_cast<float>(found->second[k].y()));
    }
  }
  if (printed.empty()) return std::nullopt;
  const cv::Mat H = cv::findHomography(printed, imaged);
  if (H.empty()) return std::nullopt;
  const cv::Matx33d homography(H.ptr<double>());
  const cv::Vec3d place = homography * cv::Vec3d(point.x(), point.y(), 1.0);
  return Eigen::Vector2d(place[0] / place[2], place[1] / place[2]);
}

}  // namespace

std::vector<SeenCorner> detectCharuco(const cv::Mat& grey, const Charuco& board) {
  const SeenMarkers seen = detectMarkers(grey, board);
  const std::vector<BoardMarker> markers = boardMarkers(board);
  const std::vector<Eigen::Vector2d> corners = boardCorners(board);
  std::vector<SeenCorner> result;
  if (seen.size() < kMinMarkers) return result;
  for (std::size_t id = 0; id < corners.size(); ++id) {
    const std::vector<const BoardMarker*> beside = markersBeside(corners[id], board, markers);
    const std::optional<Eigen::Vector2d> predicted = predictPosition(corners[id], beside, seen);
    if (!predicted) continue;
    double side = std::numeric_limits<double>::infinity();
    for (const BoardMarker* const marker : beside) {
      if (const auto found = seen.find(marker->id); found != seen.end())
        side = std::min(side, shortestSide(found->second));
    }
    // Distance from the corner to the markers, px.
    const double room = side / board.marker * (board.square - board.marker) / 2.0;
    if (const auto refined = refineCorner(grey, *predicted, room))
      result.push_back({static_cast<int>(id), *refined});
  }
  return result;
}

std::vector<SeenCorner> detectAprilGrid(const cv::Mat& grey, const AprilGrid& board) {
  constexpr double kBorder = 0.2;  // two bits of ten: the black border's width in sides of a tag
  const SeenMarkers seen = detectMarkers(grey, board);
  std::vector<SeenCorner> result;
  if (seen.size() < kMinMarkers) return result;
  for (const auto& [id, corners] : seen) {
    if (id >= board.columns * board.rows) continue;
    const double room = std::min(kBorder, board.spacing) * shortestSide(corners);
    for (int k = 0; k < 4; ++k) {
      if (const auto refined = refineCorner(grey, corners[static_cast<std::size_t>(k)], room))
        result.push_back({4 * id + k, *refined});
    }
  }
  return result;
}

std::string describeUnknownMarker(const cv::Mat& grey, const BoardSpec& board) {
  const SeenMarkers seen = detectMarkers(grey, board);
  if (seen.empty() || seen.rbegin()->first < static_cast<int>(boardMarkers(board).size())) return {};
  return "a marker with the number " + std::to_string(seen.rbegin()->first);
}

}  // namespace cartvo::calib
