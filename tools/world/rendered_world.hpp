#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <opencv2/core/mat.hpp>

#include "capture/pair_synchroniser.hpp"
#include "tools/simulate/content.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// What one camera sees at one instant, for judging images against.
struct DepthImage {
  cv::Mat depth;   ///< CV_32FC1: along the camera's z axis through the pixel's centre, m; 0: sky
  cv::Mat moving;  ///< CV_8UC1: 255 where the pixel shows a moving object, else 0
};

/// A golf cart's drive over a procedural campus, with exact ground truth. The cameras are raw (distorted as
/// rig() says), and each is rendered at its own instant. The images are a function of the settings alone.
class RenderedWorld final : public simulate::Content {
 public:
  /// Throws std::invalid_argument naming the setting that is out of range.
  explicit RenderedWorld(const WorldSettings& settings);
  ~RenderedWorld() override;
  RenderedWorld(const RenderedWorld&) = delete;
  RenderedWorld& operator=(const RenderedWorld&) = delete;

  Rig rig() const override;
  double frameRate() const override;
  int pairCount() const override;
  std::int64_t leftInstant(int index) const override;
  std::int64_t rightInstant(int index) const override;
  /// May be called from any thread; calls render one after the other, each on `threads` threads.
  void images(int index, cv::Mat& left, cv::Mat& right) const override;
  Trajectory truth() const override;
  std::string cacheKey() const override;

  const WorldSettings& settings() const;

  /// One camera's image only.
  cv::Mat image(int index, CameraSide side) const;

  /// The light behind that image, CV_32FC1, in the unit of light(): before the sensor's blur, exposure,
  /// noise, tone curve and rounding. For judging the renderer.
  cv::Mat radiance(int index, CameraSide side) const;

  /// Depth and moving objects of that image, one ray through each pixel's centre.
  DepthImage renderDepth(int index, CameraSide side) const;

  /// The mean light of the left camera's view at `seconds`, before any exposure (1: a white surface that
  /// faces the midday sun).
  double light(double seconds) const;

  /// The cart's exact pose at `seconds` after the content's start; the world is the body axes at 0. Clamped
  /// to the drive's ends.
  Eigen::Isometry3d T_world_body(double seconds) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::world
