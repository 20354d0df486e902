#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <string>

#include <opencv2/core/mat.hpp>

// Light and texture of a camera's picture: whether it can show a scene at all. Used by cartvod and doctor.

namespace cartvo::pipeline {

/// Measures of a picture.
struct PictureLight {
  double mean = 128.0;                  ///< grey value, 0 to 255
  double black = 0.0, saturated = 0.0;  ///< shares of the pixels without detail, at either end
  double texture = 1.0;                 ///< share of the blocks of 8 x 8 px that differ from the next one
};

/// Measures a picture (CV_8UC1) where `used` (CV_8UC1 of the same size, may be empty: everywhere) is not 0.
PictureLight measureLight(const cv::Mat& picture, const cv::Mat& used);

/// Fault of a picture's light.
enum class LightFault : std::uint8_t {
  none,
  dark,    ///< night, or a covered lens
  blank,   ///< hardly any texture: covered, fogged, dirty
  bright,  ///< too much of it is white
};
LightFault lightFault(const PictureLight& light);

/// Limits of a picture without fault, for people.
std::string lightLimits();

/// "the picture is dark"; empty without a fault.
const char* lightFaultText(LightFault fault);
/// The operator's remedy; empty without a fault.
const char* lightAdvice(LightFault fault);

/// Whether a picture shows so little that its matches say nothing about the rig.
bool lacksTexture(const PictureLight& light);

/// Whether the light can be why a pair is INVALID for these reasons (bits of vo::OdometryReason). Of a wrong
/// stereo geometry it is only if the texture is missing; instants, sizes and damages are no question of
/// light.
bool mayExplain(const PictureLight& light, std::uint32_t reasons);

/// Takes bright and dark bands out of a camera's pictures, which lamps on the mains make with a rolling
/// shutter. They run through the picture otherwise than the scene, and differ between left and right. Not
/// thread-safe.
class LampBands {
 public:
  /// The picture (CV_8UC1) without its bands, in memory of this object until the next call; the picture
  /// itself if it has none. Bands are known from the eighth picture on, unless they stand still.
  cv::Mat without(const cv::Mat& picture);

 private:
  std::deque<Eigen::VectorXd> profiles_;  ///< logarithms of the rows' mean brightness, of the latest pictures
  cv::Mat levelled_;
};

}  // namespace cartvo::pipeline
