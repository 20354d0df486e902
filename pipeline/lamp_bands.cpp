// Finds one frequency over the rows in the changes of their brightness, and divides the rows by it.
#include "pipeline/lamp_bands.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace cartvo::pipeline {
namespace {

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
