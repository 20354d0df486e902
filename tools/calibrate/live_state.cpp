#include "tools/calibrate/live_state.hpp"

#include <algorithm>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

Json sightState(const StreamSight& sight) {
  return {{"corners", sight.corners.size()},
          {"coverage", sight.coverage.corners},
          {"covered", sight.coverage.share()}};
}

}  // namespace

Json liveState(const StreamProgress& progress) {
  Json state{{"seconds", progress.seconds},
             {"advice", progress.advice},
             {"next", progress.what_to_show},
             {"enough_views", kEnoughViews},
             {"columns", ImageCoverage::kColumns},
             {"rows", ImageCoverage::kRows},
             {"left", sightState(progress.left)},
             {"right", sightState(progress.right)},
             {"tilts",
              {{"left", progress.tilts.to_left},
               {"right", progress.tilts.to_right},
               {"up", progress.tilts.up},
               {"down", progress.tilts.down}}},
             {"views", Json::array()},
             {"rejected", Json::array()}};
  for (const BoardView& view : progress.so_far.views) {
    state["views"].push_back(
        {{"name", view.name}, {"left_corners", view.left.size()}, {"right_corners", view.right.size()}});
  }
  for (const RejectedView& view : progress.so_far.rejected)
    state["rejected"].push_back({{"name", view.name}, {"reason", view.reason}});
  return state;
}

std::string liveJpeg(const StreamSight& sight) {
  constexpr int kWidest = 960, kQuality = 80, kFractionBits = 4;
  constexpr double kRadius = 3.0;  // px
  if (sight.image.empty()) return {};
  const double scale = std::min(1.0, static_cast<double>(kWidest) / sight.image.cols);
  cv::Mat picture;
  cv::resize(sight.image, picture, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  const auto fixed = [](double value) { return cvRound(value * (1 << kFractionBits)); };
  for (const SeenCorner& corner : sight.corners) {
    const Eigen::Vector2d at = scale * (corner.pixel.array() + 0.5).matrix() - Eigen::Vector2d(0.5, 0.5);
    cv::circle(picture, {fixed(at.x()), fixed(at.y())}, fixed(kRadius), {60, 220, 60}, 1, cv::LINE_AA,
               kFractionBits);
  }
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return {};
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace cartvo
