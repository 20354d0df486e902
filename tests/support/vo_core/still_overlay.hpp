#pragma once

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/odometry_estimate.hpp"

namespace cartvo::test {

/// Draws a textured part of the cart into both images: over `place` in the left one and, nearer by
/// `disparity` px, in the right one.
inline void drawStillOverlay(vo::StereoImages& images, const cv::Rect& place, int disparity) {
  const WaveTexture texture(7);
  const auto paint = [&](cv::Mat& image, int shift) {
    image = image.clone();
    draw(place.width, place.height, [&](double x, double y) {
      return texture(x, y);
    }).copyTo(image(place - cv::Point(shift, 0)));
  };
  paint(images.left, 0);
  paint(images.right, disparity);
}

}  // namespace cartvo::test
