// Counts corners per image and detection window with fixed and with adaptive thresholds.
#include "tools/benchmark/thesis/feature_counts.hpp"

#include <cmath>
#include <numeric>

#include "capture/dataset/image_folder.hpp"
#include "vo_core/tracking/adaptive_detector.hpp"

namespace cartvo::benchmark {
namespace {

struct Statistics {
  double mean = 0.0;
  double stddev = 0.0;
};

Statistics statisticsOf(const std::vector<int>& values) {
  const auto count = static_cast<double>(values.size());
  Statistics statistics;
  statistics.mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  for (const int value : values)
    statistics.stddev += (value - statistics.mean) * (value - statistics.mean) / count;
  statistics.stddev = std::sqrt(statistics.stddev);
  return statistics;
}

}  // namespace

FeatureCountSeries countFeatures(const std::filesystem::path& folder, const vo::DetectionSettings& settings,
                                 int features) {
  const std::vector<std::filesystem::path> images = capture::readImageFolder(folder).left.images;
  vo::AdaptiveDetector detector(settings, features, capture::readGreyImage(images.front()).size());
  std::vector<std::vector<int>> over_images(static_cast<std::size_t>(detector.windowCount()));
  FeatureCountSeries series;
  series.window_target = detector.cornerTarget();
  for (const std::filesystem::path& file : images) {
    const cv::Mat image = capture::readGreyImage(file);
    vo::SpacingGrid spacing(image.cols, image.rows, vo::TrackingSettings{}.minimum_distance);
    series.features.push_back(static_cast<int>(detector.detect({image}, {}, spacing).size()));
    std::vector<int> windows;
    for (int window = 0; window < detector.windowCount(); ++window) {
      windows.push_back(detector.cornerCount(window));
      over_images[static_cast<std::size_t>(window)].push_back(windows.back());
      if (windows.back() < 0.5 * series.window_target) series.starved += 1.0;
    }
    series.corners.push_back(std::accumulate(windows.begin(), windows.end(), 0));
    series.window_stddev += statisticsOf(windows).stddev / static_cast<double>(images.size());
  }
  for (const std::vector<int>& counts : over_images)
    series.window_stddev_over_images += statisticsOf(counts).stddev / detector.windowCount();
  const Statistics corners = statisticsOf(series.corners);
  series.corners_mean = corners.mean;
  series.corners_stddev = corners.stddev;
  series.features_mean = statisticsOf(series.features).mean;
  series.window_mean = corners.mean / detector.windowCount();
  series.starved /= static_cast<double>(images.size()) * detector.windowCount();
  return series;
}

vo::DetectionSettings withFixedThreshold(vo::DetectionSettings settings) {
  constexpr int kUsualThreshold = 20;  // of FAST (Rosten and Drummond 2006)
  settings.minimum_threshold = settings.maximum_threshold = kUsualThreshold;
  return settings;
}

}  // namespace cartvo::benchmark
