// Measures the readout of a rolling shutter from the bands of a lamp on the mains.
//
// The lamp's brightness varies with F = 100 or 120 Hz. In a picture taken at t, a row with the share s of the
// readout T (s from -1/2 to 1/2) is exposed at t + s T, so that its brightness over the mean brightness of
// that row is 1 + a cos(2 pi (F t + n s) + const), with n = F T bands across the picture. n is measured; the
// bands move by F times the frame period between two pictures, down or up, which gives the sign of T.
#include "tools/calibrate/readout/mains_bands.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "common/statistics.hpp"
#include "tools/calibrate/readout/band_fit.hpp"

namespace cartvo::calibrate {
namespace {

constexpr int kBlocks = 8;
constexpr std::size_t kMinPictures = 40;
constexpr double kTwoPi = 6.283185307179586;
/// Movement between two pictures, in bands, whose distance from 0 or 1/2 (modulo 1) is at least this.
constexpr double kMinMovement = 0.04;
constexpr double kMinCoherence = 0.6;  ///< of the movement with that of mains light, 1: the same
constexpr double kMaxPause = 0.5;      ///< s, between two pictures whose bands are compared
constexpr double kMaxRelativeStddev = 0.02;
constexpr double kMainsStddev = 0.001;    ///< relative, of the mains frequency
constexpr double kMinSignificance = 4.0;  ///< standard deviations, of the direction

const char* const kAdvice =
    "let the camera stand before a lamp on the mains, or a wall lit by it, with a short exposure (1/250 s or "
    "shorter), without daylight, at 18 frames a second; many LED lamps do not flicker: try a halogen or an "
    "older fluorescent lamp";

std::string rounded(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double framePeriod(const std::vector<RowProfile>& profiles) {
  std::vector<double> periods;
  for (std::size_t k = 1; k < profiles.size(); ++k)
    periods.push_back(profiles[k].time - profiles[k - 1].time);
  return median(periods);
}

/// Throws if the movement of the bands at this frame period does not show their direction.
void checkFrameRate(double period, double flicker) {
  const double movement = flicker * period - std::floor(flicker * period);
  const std::string rate = rounded(1.0 / period, "%.1f");
  const std::string light = rounded(flicker, "%.0f");
  if (std::min(movement, 1.0 - movement) < kMinMovement)
    throw std::runtime_error("at " + rate + " frames a second the bands of a light of " + light +
                             " Hz stand still, and cannot be told from the scene: set 18 frames a second");
  if (std::abs(movement - 0.5) < kMinMovement)
    throw std::runtime_error(
        "at " + rate + " frames a second the bands of a light of " + light +
        " Hz move by half a band from picture to picture, so that their direction cannot "
        "be told: set 18 frames a second");
}

/// Agreement of the movement of the bands with that of a light: mean cosine of the phase difference.
struct Agreement {
  double mean = 0.0;
  double stddev = 0.0;  ///< of the mean
};

/// `direction`: 1 if the rows are exposed from top to bottom, else -1. `other_direction` subtracts the
/// agreement with the opposite movement.
Agreement agreement(const std::vector<BandAdvance>& advances, double flicker, double direction,
                    bool other_direction) {
  double sum = 0.0, squares = 0.0, size = 0.0;
  std::size_t count = 0;
  for (const BandAdvance& advance : advances) {
    if (advance.period > kMaxPause) continue;
    const double phase = direction * kTwoPi * flicker * advance.period;
    double value = (advance.product * std::polar(1.0, -phase)).real();
    if (other_direction) value -= (advance.product * std::polar(1.0, phase)).real();
    sum += value;
    squares += value * value;
    size += std::abs(advance.product);
    ++count;
  }
  if (count == 0 || !(size > 0.0)) return {};
  const double mean = sum / static_cast<double>(count);
  const double variance = std::max(0.0, squares / static_cast<double>(count) - mean * mean);
  const double unit = size / static_cast<double>(count);
  return {mean / unit, std::sqrt(variance / static_cast<double>(count)) / unit};
}

/// The direction in which the rows are exposed, 1 or -1. Throws if the bands do not move as those of the
/// light.
double directionOf(const std::vector<BandAdvance>& advances, double mains_frequency) {
  const double flicker = 2.0 * mains_frequency, other_mains = mains_frequency == 50.0 ? 60.0 : 50.0;
  const auto best = [&](double frequency) {
    return std::max(agreement(advances, frequency, 1.0, false).mean,
                    agreement(advances, frequency, -1.0, false).mean);
  };
  const double coherence = best(flicker), other_coherence = best(2.0 * other_mains);
  if (std::max(coherence, other_coherence) < kMinCoherence)
    throw std::runtime_error(std::string("there are no bands of a lamp in the pictures, or their time stamps "
                                         "scatter by more than 2 ms: ") +
                             kAdvice);
  if (other_coherence > coherence + 0.05)
    throw std::runtime_error("the bands move as those of mains of " + rounded(other_mains, "%.0f") +
                             " Hz, not of " + rounded(mains_frequency, "%.0f") + " Hz: give --mains " +
                             rounded(other_mains, "%.0f") + ", or check the time stamps of the pictures");
  const Agreement downwards = agreement(advances, flicker, 1.0, true);
  if (std::abs(downwards.mean) < kMinSignificance * downwards.stddev)
    throw std::runtime_error(std::string("the direction in which the bands move is not certain: ") + kAdvice);
  return downwards.mean > 0.0 ? 1.0 : -1.0;
}

}  // namespace

RowProfile rowProfile(const cv::Mat& image, double time) {
  RowProfile profile{time, Eigen::MatrixXd::Zero(image.rows, kBlocks)};
  for (int row = 0; row < image.rows; ++row) {
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(row);
    for (int block = 0; block < kBlocks; ++block) {
      const int begin = image.cols * block / kBlocks, end = image.cols * (block + 1) / kBlocks;
      double sum = 0.0;
      for (int column = begin; column < end; ++column)
        sum += pixels[column];
      profile.means(row, block) = sum / std::max(1, end - begin);
    }
  }
  return profile;
}

ReadoutMeasurement measureReadout(const std::vector<RowProfile>& profiles, double mains_frequency) {
  if (profiles.size() < kMinPictures)
    throw std::runtime_error("there are only " + std::to_string(profiles.size()) + " pictures; " +
                             std::to_string(kMinPictures) + " are needed");
  const double flicker = 2.0 * mains_frequency;
  checkFrameRate(framePeriod(profiles), flicker);
  BandFit fit(profiles);
  const double direction = directionOf(fit.advances(), mains_frequency);
  const Estimate bands = fit.refine();
  ReadoutMeasurement measurement;
  measurement.bands = bands.value;
  measurement.amplitude = fit.amplitude();
  measurement.pictures = profiles.size();
  const double readout = bands.value / flicker;
  measurement.readout = {direction * readout, std::hypot(bands.stddev / flicker, kMainsStddev * readout)};
  if (!(measurement.readout.stddev < kMaxRelativeStddev * readout))
    throw std::runtime_error("the bands are too weak (" + rounded(100.0 * measurement.amplitude, "%.2f") +
                             " % of the brightness) to measure the readout: " + kAdvice);
  return measurement;
}

}  // namespace cartvo::calibrate
