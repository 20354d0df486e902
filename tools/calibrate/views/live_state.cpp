// State of a live calibration as JSON, and its camera pictures as JPEG.
#include "tools/calibrate/views/live_state.hpp"

#include <algorithm>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

Json previewState(const CameraPreview& preview) {
  return {{"corners", preview.corners.size()},
          {"coverage", preview.coverage.corners},
          {"covered", preview.coverage.share()}};
}

}  // namespace

Json liveState(const StreamProgress& progress) {
  Json state{{"seconds", progress.seconds},
             {"advice", progress.advice},
             {"next", progress.next_view_advice},
             {"enough_views", kTargetViewCount},
             {"columns", calib::ImageCoverage::kColumns},
             {"rows", calib::ImageCoverage::kRows},
             {"left", previewState(progress.left)},
             {"right", previewState(progress.right)},
             {"tilts",
              {{"left", progress.tilts.to_left},
               {"right", progress.tilts.to_right},
               {"up", progress.tilts.up},
               {"down", progress.tilts.down}}},
             {"views", Json::array()},
             {"rejected", Json::array()}};
  for (const calib::BoardView& view : progress.so_far.views) {
    state["views"].push_back(
        {{"name", view.name}, {"left_corners", view.left.size()}, {"right_corners", view.right.size()}});
  }
  for (const calib::RejectedView& view : progress.so_far.rejected)
    state["rejected"].push_back({{"name", view.name}, {"reason", view.reason}});
  return state;
}

std::string liveJpeg(const CameraPreview& preview) {
  constexpr int kMaxWidth = 960, kQuality = 80, kFractionBits = 4;  // px; percent; of cv::circle
  constexpr double kRadius = 3.0;                                   // px
  if (preview.image.empty()) return {};
  const double scale = std::min(1.0, static_cast<double>(kMaxWidth) / preview.image.cols);
  cv::Mat picture;
  cv::resize(preview.image, picture, {}, scale, scale, cv::INTER_AREA);
  cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  const auto fixed = [](double value) { return cvRound(value * (1 << kFractionBits)); };
  for (const calib::SeenCorner& corner : preview.corners) {
    const Eigen::Vector2d at = scale * (corner.pixel.array() + 0.5).matrix() - Eigen::Vector2d(0.5, 0.5);
    cv::circle(picture, {fixed(at.x()), fixed(at.y())}, fixed(kRadius), {60, 220, 60}, 1, cv::LINE_AA,
               kFractionBits);
  }
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return {};
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace cartvo
