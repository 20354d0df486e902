// Regression of the depth of matched features on the rendered depth: Table 5-1 of the thesis.
#include "tools/benchmark/thesis/depth_regression.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/lens.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "lab/render/rendered_world.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/stereo/stereo_matcher.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"

namespace cartvo::benchmark {
namespace {

constexpr double kMaxDisparityError = 2.0;  // px

/// The true depth of rectified pixels, computed from the depth image of the raw camera.
class TrueDepth {
 public:
  TrueDepth(const calib::CameraModel& camera, const calib::Rectification& rectification,
            const cv::Mat& raw_depth)
      : camera_(camera), lens_(camera), rectification_(rectification), depth_(raw_depth) {}

  /// Depth along the axis of the rectified camera, m; nothing if it is ambiguous.
  std::optional<double> at(int x, int y) const {
    const Eigen::Vector3d rectified((x - rectification_.cx) / rectification_.focal_length,
                                    (y - rectification_.cy) / rectification_.focal_length, 1.0);
    const Eigen::Vector3d ray = rectification_.R_rectified_left.transpose() * rectified;
    const calib::NormalisedPoint raw = lens_.distort(ray);
    const std::optional<double> depth =
        rawDepth(camera_.fx * raw.x + camera_.cx, camera_.fy * raw.y + camera_.cy);
    if (!depth) return std::nullopt;
    return *depth / ray.z();  // the ray's own z is 1 in rectified axes
  }

 private:
  /// Fits a plane to the pixels around: the inverse depth of a plane is linear in the image. Pixels that
  /// deviate from the plane indicate an edge, where the depth is ambiguous.
  std::optional<double> rawDepth(double x, double y) const {
    constexpr int kRadius = 2;                     // px
    constexpr double kMaxRelativeResidual = 0.01;  // of the inverse depth
    const int x0 = static_cast<int>(std::lround(x)), y0 = static_cast<int>(std::lround(y));
    if (x0 < kRadius || y0 < kRadius || x0 + kRadius >= depth_.cols || y0 + kRadius >= depth_.rows)
      return std::nullopt;
    const auto around = [&](auto visit) {
      for (int v = -kRadius; v <= kRadius; ++v) {
        for (int u = -kRadius; u <= kRadius; ++u)
          visit(u, v, 1.0 / depth_.at<float>(y0 + v, x0 + u));
      }
    };
    double mean = 0.0, slope_u = 0.0, slope_v = 0.0, squares = 0.0, count = 0.0;
    around([&](int u, int v, double inverse) {  // offset and slopes decouple on a symmetric grid
      mean += inverse;
      slope_u += u * inverse;
      slope_v += v * inverse;
      squares += u * u;
      count += 1.0;
    });
    mean /= count;
    slope_u /= squares;
    slope_v /= squares;
    if (!std::isfinite(mean)) return std::nullopt;  // sky
    double residual = 0.0;
    around([&](int u, int v, double inverse) {
      residual = std::max(residual, std::abs(inverse - mean - slope_u * u - slope_v * v));
    });
    if (residual > kMaxRelativeResidual * mean) return std::nullopt;
    return 1.0 / (mean + slope_u * (x - x0) + slope_v * (y - y0));
  }

  calib::CameraModel camera_;
  calib::Lens lens_;
  calib::Rectification rectification_;
  cv::Mat depth_;
};

/// Adds the samples of one rectified pair.
void addPair(const cv::Mat& left, const cv::Mat& right, const TrueDepth& true_depth,
             const calib::Rectification& rectification, int features, DepthSamples& samples) {
  const vo::OdometrySettings settings;
  const vo::ImagePyramid left_pyramid = vo::buildPyramid(left, settings.tracking.levels);
  const vo::ImagePyramid right_pyramid = vo::buildPyramid(right, 1);
  vo::AdaptiveDetector detector(settings.detection, features, left.size());
  vo::SpacingGrid spacing(left.cols, left.rows, settings.tracking.minimum_distance);
  const double focal_times_baseline = rectification.focal_length * rectification.baseline;
  for (const vo::Corner& corner : detector.detect({left}, {}, spacing)) {
    const std::optional<double> truth = true_depth.at(corner.x, corner.y);
    if (!truth || *truth > kMaxDepth) continue;
    ++samples.features;
    const std::optional<vo::StereoMatch> match =
        vo::matchStereo(left_pyramid, right_pyramid, Eigen::Vector2d(corner.x, corner.y), settings.stereo);
    if (!match) continue;
    if (std::abs(match->disparity - focal_times_baseline / *truth) > kMaxDisparityError) {
      ++samples.wrong;
      continue;
    }
    samples.sub_pixel.push_back({focal_times_baseline / match->disparity, *truth});
    const double whole = std::round(match->disparity);
    if (whole > 0.0) samples.whole_pixel.push_back({focal_times_baseline / whole, *truth});
  }
}

}  // namespace

DepthRegression regressDepth(const std::vector<DepthSample>& samples) {
  const auto count = static_cast<double>(samples.size());
  double mean_x = 0.0, mean_y = 0.0;
  for (const DepthSample& sample : samples) {
    mean_x += sample.truth / count;
    mean_y += sample.measured / count;
  }
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const DepthSample& sample : samples) {
    const double x = sample.truth - mean_x, y = sample.measured - mean_y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  return {samples.size(), xy * xy / (xx * yy), xy / xx};
}

std::size_t closeDepths(const std::vector<DepthSample>& samples) {
  return static_cast<std::size_t>(
      std::count_if(samples.begin(), samples.end(), [](const DepthSample& sample) {
        return std::abs(sample.measured - sample.truth) <= 0.1 * sample.truth;
      }));
}

DepthSamples measureDepths(const world::WorldSettings& settings, int pairs, int features,
                           const simulate::Progress& progress) {
  const world::RenderedWorld world(settings);
  const calib::Rig rig = world.rig();
  const calib::RectificationSettings rectification_settings;
  const calib::Rectifier rectifier(rig, rectification_settings,
                                   calib::buildTables(rig, rectification_settings));
  DepthSamples samples;
  for (int i = 0; i < pairs; ++i) {
    const int index = (2 * i + 1) * world.pairCount() / (2 * pairs);
    cv::Mat raw_left, raw_right, left, right;
    world.images(index, raw_left, raw_right);
    rectifier.rectifyLeft(raw_left, left);
    rectifier.rectifyRight(raw_right, right);
    const TrueDepth true_depth(rig.left, rectifier.rectification(),
                               world.renderDepth(index, capture::CameraSide::left).depth);
    addPair(left, right, true_depth, rectifier.rectification(), features, samples);
    progress(i + 1, pairs);
  }
  return samples;
}

}  // namespace cartvo::benchmark
