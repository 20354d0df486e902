// Light of a picture from its grey values, texture from means of small blocks, bands of lamps.
#include "pipeline/picture_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

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

constexpr std::size_t kPictures = 8;  // over which bands that run average out
constexpr int kParts = 96;            // of the rows
// Bands across the picture: readouts of 15 ms and more at 100 Hz, of 64 ms and less at 120 Hz.
constexpr double kLeastBands = 1.5, kMostBands = 8.0, kStep = 0.25;
constexpr double kLeastAmplitude = 0.04;  // of the brightness; weaker ones change no match
constexpr double kLeastShare = 0.8;       // of the changes' power: scenes that move have many frequencies

Eigen::VectorXd profileOf(const cv::Mat& picture) {
  cv::Mat rows, parts;
  cv::reduce(picture, rows, 1, cv::REDUCE_AVG, CV_32F);
  cv::resize(rows, parts, cv::Size(1, kParts), 0.0, 0.0, cv::INTER_AREA);
  Eigen::VectorXd profile(kParts);
  for (int i = 0; i < kParts; ++i)
    profile[i] = std::log(std::max(1.0F, parts.at<float>(i)));
  return profile;
}

/// A number of bands, with its cosine and sine at the parts of the rows.
struct Waves {
  double bands;
  Eigen::MatrixX2d at;
};

const std::vector<Waves>& allWaves() {
  static const std::vector<Waves> all = [] {
    std::vector<Waves> waves;
    for (double bands = kLeastBands; bands <= kMostBands; bands += kStep) {
      const Eigen::ArrayXd phases =
          (Eigen::ArrayXd::LinSpaced(kParts, 0.5, kParts - 0.5) / kParts) * (2.0 * std::numbers::pi * bands);
      Waves& added = waves.emplace_back(Waves{bands, Eigen::MatrixX2d(kParts, 2)});
      added.at.col(0) = phases.cos();
      added.at.col(1) = phases.sin();
    }
    return waves;
  }();
  return all;
}

/// Changes of each profile against their mean, without those of the exposure: a constant and a slope.
Eigen::MatrixXd changesOf(const std::deque<Eigen::VectorXd>& profiles) {
  Eigen::MatrixXd changes(kParts, static_cast<Eigen::Index>(profiles.size()));
  for (std::size_t i = 0; i < profiles.size(); ++i)
    changes.col(static_cast<Eigen::Index>(i)) = profiles[i];
  changes.colwise() -= changes.rowwise().mean().eval();
  changes.rowwise() -= changes.colwise().mean().eval();
  const Eigen::VectorXd slope = Eigen::VectorXd::LinSpaced(kParts, -1.0, 1.0).normalized();
  changes -= slope * (slope.transpose() * changes).eval();
  return changes;
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

cv::Mat LampBands::without(const cv::Mat& picture) {
  profiles_.push_back(profileOf(picture));
  if (profiles_.size() > kPictures) profiles_.pop_front();
  if (profiles_.size() < kPictures) return picture;
  const Eigen::MatrixXd changes = changesOf(profiles_);
  const double power = changes.squaredNorm();
  if (power < 0.5 * kLeastAmplitude * kLeastAmplitude * static_cast<double>(changes.size())) return picture;

  double most = 0.0;
  const Waves* found = nullptr;
  for (const Waves& waves : allWaves()) {
    const double of_waves = (waves.at.transpose() * changes).squaredNorm() * (2.0 / kParts);
    if (of_waves <= most) continue;
    most = of_waves;
    found = &waves;
  }
  if (found == nullptr || most < kLeastShare * power) return picture;
  const Eigen::Vector2d wave = found->at.transpose() * changes.col(changes.cols() - 1) * (2.0 / kParts);
  levelled_.create(picture.size(), picture.type());
  for (int y = 0; y < picture.rows; ++y) {
    const double phase = 2.0 * std::numbers::pi * found->bands * (y + 0.5) / picture.rows;
    const double change = wave[0] * std::cos(phase) + wave[1] * std::sin(phase);
    picture.row(y).convertTo(levelled_.row(y), CV_8U, std::exp(-change));
  }
  return levelled_;
}

}  // namespace cartvo::pipeline
