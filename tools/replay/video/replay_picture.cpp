// Draws points, path and state over the left picture.
#include "tools/replay/video/replay_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "common/units.hpp"
#include "daemon/publish/message_names.hpp"
#include "daemon/publish/odometry_publisher.hpp"
#include "tools/report/axis.hpp"
#include "tools/report/canvas.hpp"

namespace cartvo {
namespace {

constexpr int kMinWidth = 960;                        // px; smaller pictures are enlarged
constexpr double kNearDepth = 2.0, kFarDepth = 60.0;  // m, ends of the colours
constexpr int kLetterSize = 17, kLineHeight = 25, kBarMargin = 9;
constexpr DrawingColour kBlack{0, 0, 0}, kWhite{255, 255, 255}, kGrey{170, 170, 170}, kPath{86, 180, 233},
    kGood{47, 208, 160}, kBad{255, 140, 58};

/// Colour of a depth, on a logarithmic scale: yellow near, blue far (viridis).
DrawingColour depthColour(double depth) {
  static const cv::Mat colours = [] {
    cv::Mat ramp(1, 256, CV_8UC1), coloured;
    for (int i = 0; i < ramp.cols; ++i)
      ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
    cv::applyColorMap(ramp, coloured, cv::COLORMAP_VIRIDIS);
    return coloured;
  }();
  constexpr double kLast = 255.0, kDarkest = 40.0;  // the darkest colours are not seen on a dark picture
  const double share = std::clamp(std::log(depth / kNearDepth) / std::log(kFarDepth / kNearDepth), 0.0, 1.0);
  const auto& colour =
      colours.at<cv::Vec3b>(static_cast<int>(std::lround(kLast - share * (kLast - kDarkest))));
  return {colour[2], colour[1], colour[0]};
}

void fillBox(Canvas& canvas, const cv::Rect2d& box, DrawingColour colour, double opacity) {
  const cv::Point2d low = box.tl(), high = box.br();
  canvas.area({low, {high.x, low.y}, high, {low.x, high.y}}, colour, opacity);
}

/// The left picture in colour, enlarged by a whole number if it is small, with even sides and an empty bar
/// below it. Sets `scale`.
cv::Mat background(const cv::Mat& left, int& scale) {
  scale = std::max(1, (kMinWidth + left.cols - 1) / left.cols);
  cv::Mat large, coloured;
  cv::resize(left, large, left.size() * scale, 0, 0, cv::INTER_LINEAR);
  cv::cvtColor(large, coloured, cv::COLOR_GRAY2BGR);
  const int bar = 3 * kLineHeight + 2 * kBarMargin;
  const int width = coloured.cols / 2 * 2, height = (coloured.rows + bar) / 2 * 2;
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar::all(0));
  coloured(cv::Rect(0, 0, width, coloured.rows)).copyTo(picture(cv::Rect(0, 0, width, coloured.rows)));
  return picture;
}

void drawLandmarks(Canvas& canvas, const vo::LandmarkViews& landmarks, int scale) {
  const auto pixel = [scale](float x, float y) { return cv::Point2d(scale * (x + 0.5), scale * (y + 0.5)); };
  constexpr double kRadius = 3.0;
  for (const vo::LandmarkView& landmark : landmarks) {
    const bool has_depth = landmark.inverse_depth > 0.0F;  // false for NaN
    const DrawingColour colour = has_depth ? depthColour(1.0 / landmark.inverse_depth) : kGrey;
    const cv::Point2d at = pixel(landmark.left_x, landmark.left_y);
    if (!std::isnan(landmark.previous_x)) {
      const cv::Point2d before = pixel(landmark.previous_x, landmark.previous_y);
      canvas.line({before, at}, kBlack, 3.5, 0.6);
      canvas.line({before, at}, colour, 1.7, 1.0);
    }
    canvas.circle(at, kRadius + 1.0, kBlack, 0.0);
    canvas.circle(at, kRadius, colour, 0.0);
  }
}

/// Ramp of the depths' colours in the lower right corner of the picture, whose height is `bottom`.
void drawDepthScale(Canvas& canvas, double right, double bottom) {
  constexpr double kWidth = 150.0, kHeight = 9.0, kPad = 8.0, kSide = 66.0;
  const cv::Rect2d box(right - kWidth - 2.0 * kSide, bottom - 32.0, kWidth + 2.0 * kSide, 32.0);
  fillBox(canvas, box, kBlack, 0.62);
  const double top = box.y + 12.0, left = box.x + kSide;
  constexpr int kSteps = 30;
  for (int i = 0; i < kSteps; ++i) {
    const double depth = kNearDepth * std::pow(kFarDepth / kNearDepth, (i + 0.5) / kSteps);
    fillBox(canvas, {left + kWidth * i / kSteps, top, kWidth / kSteps + 0.5, kHeight}, depthColour(depth),
            1.0);
  }
  canvas.text({left - kPad, box.y + 22.0}, TextAnchor::end, fmt::format("{:.0f} m", kNearDepth), kWhite);
  canvas.text({left + kWidth + kPad, box.y + 22.0}, TextAnchor::start, fmt::format("{:.0f} m", kFarDepth),
              kWhite);
}

/// The path from above in the upper right corner; forward at the start is up.
void drawPath(Canvas& canvas, const std::vector<cv::Point2d>& path, double right) {
  constexpr double kSide = 230.0, kMargin = 16.0, kScaleHeight = 26.0, kMinExtent = 5.0;
  const cv::Rect2d box(right - kSide, 0.0, kSide, kSide + kScaleHeight);
  fillBox(canvas, box, kBlack, 0.62);
  cv::Point2d low = path.front(), high = low;
  for (const cv::Point2d& point : path) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, kMinExtent});
  const double pixels = (kSide - 2.0 * kMargin) / extent;  // per metre
  const cv::Point2d centre = (low + high) / 2.0, middle(box.x + kSide / 2.0, kSide / 2.0);
  const auto place = [&](const cv::Point2d& metres) {
    return cv::Point2d(middle.x + (metres.x - centre.x) * pixels, middle.y - (metres.y - centre.y) * pixels);
  };
  std::vector<cv::Point2d> placed;
  for (const cv::Point2d& point : path)
    placed.push_back(place(point));
  for (const std::vector<cv::Point2d>& part : visibleParts(placed))
    canvas.line(part, kPath, 2.5, 1.0);
  canvas.circle(placed.front(), 4.0, kWhite, 1.5);
  canvas.circle(placed.back(), 5.0, kPath, 0.0);
  const double length = roundStep(extent, 3);
  const cv::Point2d from(box.x + kMargin, box.br().y - 10.0);
  canvas.line({from, from + cv::Point2d(length * pixels, 0.0)}, kWhite, 2.5, 1.0);
  canvas.text(from + cv::Point2d(length * pixels + 8.0, 5.0), TextAnchor::start,
              tickLabel(length, length) + " m", kWhite);
}

std::string motionText(const pipeline::BodyMotion& motion, double distance) {
  const Eigen::Vector3d rates = kDegreesPerRadian * motion.angular_velocity;
  return fmt::format("speed {:.2f} m/s    roll {:+.1f}  pitch {:+.1f}  yaw {:+.1f} deg/s    driven {:.1f} m",
                     motion.velocity.x(), rates.x(), rates.y(), rates.z(), distance);
}

void drawState(Canvas& canvas, const pipeline::PairResult& result, double seconds, double distance,
               double top) {
  const vo::OdometryEstimate& estimate = result.estimate;
  constexpr double kLeft = 14.0;
  double baseline = top + kBarMargin + kLetterSize;
  const bool is_standing = estimate.reasons.has(vo::OdometryReason::zero_velocity);
  const bool is_valid = result.isValid();
  const std::string state =
      is_valid ? (is_standing ? "valid: standstill" : "valid")
               : "not valid: " + daemon::reasonNames(daemon::odometryMessage(result).reasons);
  canvas.circle({kLeft + 6.0, baseline - 6.0}, 7.0, is_valid ? kGood : kBad, 0.0);
  canvas.text({kLeft + 22.0, baseline}, TextAnchor::start,
              fmt::format("{:.2f} s    pair {}    ", seconds, result.sequence) + state,
              is_valid ? kWhite : kBad);
  baseline += kLineHeight;
  canvas.text({kLeft, baseline}, TextAnchor::start,
              is_valid ? motionText(result.motion, distance)
                       : fmt::format("no velocity    driven {:.1f} m", distance),
              kWhite);
  baseline += kLineHeight;
  canvas.text({kLeft, baseline}, TextAnchor::start,
              fmt::format("features {}  tracked {}  inliers {}    right exposure {:+.1f} ms",
                          estimate.counts.detected, estimate.counts.tracked, estimate.counts.inliers,
                          1e-6 * static_cast<double>(result.offset_ns())),
              kGrey);
}

}  // namespace

void ReplayPictures::addToPath(const pipeline::PairResult& result) {
  if (!has_first_) first_ns_ = result.left.exposure_ns;
  has_first_ = true;
  if (result.estimate.reset_counter != epoch_) {
    epoch_ = result.estimate.reset_counter;
    T_first_epoch_ = T_first_body_;
  }
  const Eigen::Vector3d before = T_first_body_.translation();
  if (result.estimate.valid) T_first_body_ = T_first_epoch_ * result.motion.T_world_body;
  const Eigen::Vector3d now = T_first_body_.translation();
  distance_ += (now - before).norm();
  extendPath({-now.y(), now.x()});
}

/// Keeps the path's points apart, and at most kMaxPoints of them.
void ReplayPictures::extendPath(const cv::Point2d& place) {
  constexpr std::size_t kMaxPoints = 4000;
  if (path_.size() > 1 && cv::norm(path_.back() - path_[path_.size() - 2]) < path_spacing_) path_.pop_back();
  path_.push_back(place);
  if (path_.size() < kMaxPoints) return;
  path_spacing_ *= 2.0;
  std::vector<cv::Point2d> kept;
  for (std::size_t i = 0; i < path_.size(); i += 2)
    kept.push_back(path_[i]);
  kept.push_back(place);
  path_ = std::move(kept);
}

cv::Mat ReplayPictures::draw(const pipeline::PairResult& result, const cv::Mat& left,
                             const vo::LandmarkViews& landmarks) {
  addToPath(result);
  int scale = 1;
  Canvas canvas(background(left, scale), kLetterSize);
  drawLandmarks(canvas, landmarks, scale);
  const int even_width = left.cols * scale / 2 * 2;
  const double right = even_width, bottom = left.rows * scale;
  drawDepthScale(canvas, right, bottom);
  drawPath(canvas, path_, right);
  const double seconds = 1e-9 * static_cast<double>(result.left.exposure_ns - first_ns_);
  fillBox(canvas, {0.0, bottom, right, 3.0 * kLineHeight + 2.0 * kBarMargin}, kBlack, 1.0);
  drawState(canvas, result, seconds, distance_, bottom);
  return canvas.picture();
}

}  // namespace cartvo
