#include "tools/calibrate/row_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "calib/calibration.hpp"
#include "calib/quantile.hpp"
#include "tools/calibrate/stereo_design.hpp"

namespace cartvo::calibrate {
namespace {

std::string format(const char* pattern, auto... values) {
  char text[300];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

double rmsOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// How vertical disparities follow a small turn of the right camera: an offset by its pitch, a slope over the
/// columns by its roll, and a product of both and a square by the perspective of yaw and pitch.
Eigen::Vector4d turnTerms(const RectifiedMatch& match, const Rectification& rectification) {
  const double x = (match.right.x - rectification.cx) / rectification.focal_length;
  const double y = (match.right.y - rectification.cy) / rectification.focal_length;
  return {1.0 + y * y, x, x * y, y};
}

/// The turn that explains most of the vertical disparities, by iteratively reweighted least squares with
/// Cauchy's weights (P. W. Holland, R. E. Welsch, "Robust regression using iteratively reweighted
/// least-squares", 1977).
Eigen::Vector4d fitTurn(const std::vector<RectifiedMatch>& matches, const Rectification& rectification) {
  constexpr int kIterations = 30;
  Eigen::Vector4d turn = Eigen::Vector4d::Zero();
  std::vector<double> errors(matches.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < matches.size(); ++i)
      errors[i] = std::abs(matches[i].verticalDisparity() - turnTerms(matches[i], rectification).dot(turn));
    const double scale = std::max(0.02, 2.385 * 1.4826 * quantile(errors, 0.5));  // px
    Eigen::Matrix4d H = 1e-9 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector4d terms = turnTerms(matches[i], rectification);
      const double weight = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
      H += weight * terms * terms.transpose();
      g += weight * matches[i].verticalDisparity() * terms;
    }
    turn = H.ldlt().solve(g);
  }
  return turn;
}

std::string verdictOf(const RowCheck& check, double largest_rms) {
  if (seemsSwapped(check)) {
    return "FAIL: most things lie behind infinity: LEFT and RIGHT are exchanged, or the rig file's cameras "
           "are";
  }
  if (!passes(check, largest_rms)) {
    return format(
        "FAIL: rows differ by more than %.2f px (RMS): the rig file is not that of these images, or a "
        "camera was moved; calibrate anew",
        largest_rms);
  }
  return format("PASS: rows agree within %.2f px (RMS)", largest_rms);
}

}  // namespace

RowCheck checkRows(const std::vector<RectifiedMatch>& matches, int pairs,
                   const Rectification& rectification) {
  constexpr std::size_t kFewest = 30;
  constexpr double kLeastBound = 0.5, kDeviations = 5.0;  // px
  constexpr double kBehind = -1.0;                        // px: clearly behind infinity
  const auto require = [](std::size_t count) {
    if (count < kFewest) {
      throw std::runtime_error("only " + std::to_string(count) +
                               " points were found in both images that agree: too few to judge by; take "
                               "pictures of something with texture, near and far");
    }
  };
  require(matches.size());
  const Eigen::Vector4d turn = fitTurn(matches, rectification);
  const auto unexplained = [&](const RectifiedMatch& match) {
    return match.verticalDisparity() - turnTerms(match, rectification).dot(turn);
  };
  std::vector<double> errors;
  for (const RectifiedMatch& match : matches)
    errors.push_back(std::abs(unexplained(match)));
  const double bound = std::max(kLeastBound, kDeviations * 1.4826 * quantile(errors, 0.5));
  std::vector<double> rows, magnitudes, remaining;
  double in_front = 0.0;
  for (const RectifiedMatch& match : matches) {
    if (std::abs(unexplained(match)) > bound) continue;
    rows.push_back(match.verticalDisparity());
    magnitudes.push_back(std::abs(match.verticalDisparity()));
    remaining.push_back(unexplained(match));
    if (match.disparity() > kBehind) in_front += 1.0;
  }
  require(rows.size());
  RowCheck check;
  check.pairs = pairs;
  check.matches = static_cast<int>(rows.size());
  check.outliers = 1.0 - static_cast<double>(rows.size()) / static_cast<double>(matches.size());
  check.rms = rmsOf(rows);
  check.p95 = quantile(magnitudes, 0.95);
  check.median = quantile(rows, 0.5);
  check.slope = turn[1] * rectification.size.width / rectification.focal_length;
  check.scatter = rmsOf(remaining);
  check.in_front = in_front / static_cast<double>(rows.size());
  return check;
}

bool seemsSwapped(const RowCheck& check) {
  constexpr double kMost = 0.5;
  return check.in_front < kMost;
}

bool passes(const RowCheck& check, double largest_rms) {
  return !seemsSwapped(check) && check.rms <= largest_rms;
}

std::string rowCheckText(const RowCheck& check, const Rectification& rectification, double largest_rms) {
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  std::string text =
      format("%d points in %d pairs (%.0f %% of the matches left out)\n", check.matches, check.pairs,
             100.0 * check.outliers) +
      format("vertical disparity  RMS %.3f px, 95 %% below %.3f px, median %+.3f px\n", check.rms, check.p95,
             check.median) +
      format(
          "of which  a turned right camera explains all but %.3f px; %+.3f px of roll over the image's "
          "width\n",
          check.scatter, check.slope) +
      "an error of that size along the rows would mean, in depth:\n";
  for (const double range : kDepthDistances)
    text += format("  at %4.0f m  %.3g m\n", range, depthError(design, check.rms, range));
  return text + verdictOf(check, largest_rms) + "\n";
}

nlohmann::ordered_json rowCheckJson(const RowCheck& check, const Rectification& rectification,
                                    double largest_rms) {
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  nlohmann::ordered_json depth = nlohmann::ordered_json::array();
  for (const double range : kDepthDistances)
    depth.push_back({{"range_m", range}, {"error_m", depthError(design, check.rms, range)}});
  return {{"pass", passes(check, largest_rms)},
          {"swapped", seemsSwapped(check)},
          {"verdict", verdictOf(check, largest_rms)},
          {"pairs", check.pairs},
          {"matches", check.matches},
          {"outlier_share", check.outliers},
          {"vertical_disparity_px",
           {{"rms", check.rms},
            {"p95", check.p95},
            {"median", check.median},
            {"roll_over_width", check.slope},
            {"unexplained_rms", check.scatter}}},
          {"largest_rms_px", largest_rms},
          {"in_front_share", check.in_front},
          {"depth_error", depth}};
}

}  // namespace cartvo::calibrate
