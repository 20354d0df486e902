// Light of a picture from its grey values, texture from the means of small blocks.
#include "pipeline/picture_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <opencv2/imgproc.hpp>

#include "vo_core/odometry_reason.hpp"

namespace cartvo::pipeline {
namespace {

constexpr int kBlock = 8;           // px: noise and hot pixels hardly change the mean of a block
constexpr double kContrast = 6.0;   // grey values: the least contrast of a corner
constexpr double kBlackGrey = 8.0;  // video's limited range reaches neither 0 nor 255
constexpr double kWhiteGrey = 247.0;
constexpr double kDarkMean = 40.0;     // grey values: noise and the codec hide weak corners
constexpr double kMaxBlack = 0.5;      // share: more than deep shade
constexpr double kMaxSaturated = 0.3;  // share: more than a bright sky
constexpr double kMinTexture = 0.02;   // share of the blocks; roads by day have more than a fifth

double shareOf(const cv::Mat& part, const cv::Mat& used) {
  return cv::mean(part, used)[0] / 255.0;
}

/// Share of the blocks whose mean differs from that of their right or lower neighbour.
double textureOf(const cv::Mat& picture, const cv::Mat& used) {
  const cv::Size blocks(std::max(2, picture.cols / kBlock), std::max(2, picture.rows / kBlock));
  cv::Mat means, shares, across, down;
  cv::resize(picture, means, blocks, 0.0, 0.0, cv::INTER_AREA);
  const cv::Rect inner(0, 0, blocks.width - 1, blocks.height - 1);
  cv::absdiff(means(inner), means(inner + cv::Point(1, 0)), across);
  cv::absdiff(means(inner), means(inner + cv::Point(0, 1)), down);
  const cv::Mat textured = cv::max(across, down) >= kContrast;
  if (used.empty()) return shareOf(textured, {});
  // The edge of a mask is none of the scene: both neighbours of a block are to be used, too.
  cv::resize(used, shares, blocks, 0.0, 0.0, cv::INTER_AREA);
  const cv::Mat all = cv::min(cv::min(shares(inner), shares(inner + cv::Point(1, 0))),
                              shares(inner + cv::Point(0, 1))) == 255.0;
  return shareOf(textured, all);
}

struct FaultWords {
  const char* text;
  const char* advice;
};

const FaultWords& wordsOf(LightFault fault) {
  static constexpr std::array<FaultWords, 4> kWords{{
      {"", ""},
      {"the picture is dark",
       "is the lens covered, or is it dark? Uncover and clean it, add light, or allow more gain"},
      {"the picture shows hardly any texture",
       "is the lens covered, dirty, fogged or out of focus, or is there a plain wall before it? Uncover, "
       "clean and focus it"},
      {"the picture is too bright", "reduce the exposure, or turn the camera away from the light"},
  }};
  return kWords[static_cast<std::size_t>(fault)];
}

}  // namespace

PictureLight measureLight(const cv::Mat& picture, const cv::Mat& used) {
  return {cv::mean(picture, used)[0], shareOf(picture <= kBlackGrey, used),
          shareOf(picture >= kWhiteGrey, used), textureOf(picture, used)};
}

bool lacksTexture(const PictureLight& light) {
  return light.texture < kMinTexture;
}

LightFault lightFault(const PictureLight& light) {
  if (light.mean < kDarkMean || light.black > kMaxBlack) return LightFault::dark;
  if (light.saturated > kMaxSaturated) return LightFault::bright;
  return lacksTexture(light) ? LightFault::blank : LightFault::none;
}

std::string lightLimits() {
  const auto number = [](double value) { return std::to_string(std::lround(value)); };
  return "mean above " + number(kDarkMean) + ", at most " + number(100.0 * kMaxBlack) + " % black and " +
         number(100.0 * kMaxSaturated) + " % white, texture in at least " + number(100.0 * kMinTexture) +
         " %";
}

const char* lightFaultText(LightFault fault) {
  return wordsOf(fault).text;
}

const char* lightAdvice(LightFault fault) {
  return wordsOf(fault).advice;
}

bool mayExplain(const PictureLight& light, std::uint32_t reasons) {
  using enum vo::OdometryReason;
  const auto has = [&](vo::OdometryReason reason) {
    return (reasons & static_cast<std::uint32_t>(reason)) != 0;
  };
  if (has(wrong_stereo_geometry)) return lacksTexture(light);
  constexpr std::array kByPictures{
      too_few_features,   too_few_matches,     too_few_inliers, high_residual,
      implausible_motion, degenerate_geometry, bound,           repeated_picture};
  return lightFault(light) != LightFault::none && std::any_of(kByPictures.begin(), kByPictures.end(), has);
}

}  // namespace cartvo::pipeline
