#pragma once

#include <string>

#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::test {

inline const cv::Size kWallView(320, 200);  ///< px
inline const cv::Rect kBonnet(40, 150, 240, 50);

/// A drive past a textured wall, with the noise of a camera.
class WallDrive {
 public:
  cv::Mat next() {
    const cv::Point from(static_cast<int>(30 + 700 * noise_.uniform()),
                         static_cast<int>(100 * noise_.uniform()));
    cv::Mat picture = wall_(cv::Rect(from, kWallView)).clone();
    if (bonnet_) bonnet_texture_.copyTo(picture(kBonnet));
    if (!lettering_.empty())
      cv::putText(picture, lettering_, {10, 20}, cv::FONT_HERSHEY_PLAIN, 1.0, cv::Scalar(255), 1);
    for (unsigned char& grey : cv::Mat_<unsigned char>(picture))
      grey = cv::saturate_cast<unsigned char>(light_ * grey + 2.0 * noise_.gaussian());
    return picture;
  }

  void showBonnet() { bonnet_ = true; }
  void showLettering(const std::string& text) { lettering_ = text; }
  void setLight(double factor) { light_ = factor; }

 private:
  Noise noise_{5};
  cv::Mat wall_ = draw(1100, 320, WaveTexture(3));
  cv::Mat bonnet_texture_ = draw(kBonnet.width, kBonnet.height, WaveTexture(8));
  bool bonnet_ = false;
  std::string lettering_;
  double light_ = 1.0;
};

}  // namespace cartvo::test
