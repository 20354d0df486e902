// Check of a rig by the vertical disparities of matched points.
#include "tools/calibrate/check/row_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "calib/solver/calibration.hpp"
#include "common/statistics.hpp"
#include "tools/calibrate/plan/stereo_design.hpp"

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

/// Derivatives of the vertical disparity by a small rotation of the right camera: an offset and a quadratic
/// term for pitch, a slope over the columns for roll, a product of row and column for yaw, and a slope over
/// the rows.
Eigen::Vector4d rotationTerms(const RectifiedMatch& match, const calib::Rectification& rectification) {
  const double x = (match.right.x - rectification.cx) / rectification.focal_length;
  const double y = (match.right.y - rectification.cy) / rectification.focal_length;
  return {1.0 + y * y, x, x * y, y};
}

/// Fits the rotation to the vertical disparities by iteratively reweighted least squares with Cauchy's
/// weights (P. W. Holland, R. E. Welsch, "Robust regression using iteratively reweighted least-squares",
/// 1977).
Eigen::Vector4d fitRotation(const std::vector<RectifiedMatch>& matches,
                            const calib::Rectification& rectification) {
  constexpr int kIterations = 30;
  Eigen::Vector4d rotation = Eigen::Vector4d::Zero();
  std::vector<double> errors(matches.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < matches.size(); ++i)
      errors[i] =
          std::abs(matches[i].verticalDisparity() - rotationTerms(matches[i], rectification).dot(rotation));
    const double scale = std::max(0.02, 2.385 * 1.4826 * quantile(errors, 0.5));  // px
    Eigen::Matrix4d H = 1e-9 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector4d terms = rotationTerms(matches[i], rectification);
      const double weight = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
      H += weight * terms * terms.transpose();
      g += weight * matches[i].verticalDisparity() * terms;
    }
    rotation = H.ldlt().solve(g);
  }
  return rotation;
}

std::string verdictOf(const RowCheck& check, double max_rms) {
  if (seemsSwapped(check)) {
    return "FAIL: most disparities are negative: LEFT and RIGHT are exchanged, or the cameras of the rig "
           "file "
           "are";
  }
  if (!passes(check, max_rms)) {
    return format(
        "FAIL: rows differ by more than %.2f px (RMS): the rig file does not belong to these images, or a "
        "camera has moved; calibrate again",
        max_rms);
  }
  return format("PASS: rows agree within %.2f px (RMS)", max_rms);
}

}  // namespace

RowCheck checkRows(const std::vector<RectifiedMatch>& matches, int pairs,
                   const calib::Rectification& rectification) {
  constexpr std::size_t kMinMatches = 30;
  constexpr double kMinGate = 0.5, kGate = 5.0;  // px; standard deviations
  constexpr double kMinDisparity = -1.0;         // px: smaller ones are clearly negative
  const auto require = [](std::size_t count) {
    if (count < kMinMatches) {
      throw std::runtime_error(
          "only " + std::to_string(count) +
          " consistent points were found in both images, which is too few for a check; take "
          "images of a scene with texture, near and far");
    }
  };
  require(matches.size());
  const Eigen::Vector4d rotation = fitRotation(matches, rectification);
  const auto residual = [&](const RectifiedMatch& match) {
    return match.verticalDisparity() - rotationTerms(match, rectification).dot(rotation);
  };
  std::vector<double> errors;
  for (const RectifiedMatch& match : matches)
    errors.push_back(std::abs(residual(match)));
  const double gate = std::max(kMinGate, kGate * 1.4826 * quantile(errors, 0.5));
  std::vector<double> rows, magnitudes, residuals;
  double in_front = 0.0;
  for (const RectifiedMatch& match : matches) {
    if (std::abs(residual(match)) > gate) continue;
    rows.push_back(match.verticalDisparity());
    magnitudes.push_back(std::abs(match.verticalDisparity()));
    residuals.push_back(residual(match));
    if (match.disparity() > kMinDisparity) in_front += 1.0;
  }
  require(rows.size());
  RowCheck check;
  check.pairs = pairs;
  check.matches = static_cast<int>(rows.size());
  check.outliers = 1.0 - static_cast<double>(rows.size()) / static_cast<double>(matches.size());
  check.rms = rmsOf(rows);
  check.p95 = quantile(magnitudes, 0.95);
  check.median = quantile(rows, 0.5);
  check.slope = rotation[1] * rectification.size.width / rectification.focal_length;
  check.scatter = rmsOf(residuals);
  check.in_front = in_front / static_cast<double>(rows.size());
  return check;
}

bool seemsSwapped(const RowCheck& check) {
  constexpr double kMinShare = 0.5;
  return check.in_front < kMinShare;
}

bool passes(const RowCheck& check, double max_rms) {
  return !seemsSwapped(check) && check.rms <= max_rms;
}

std::string rowCheckText(const RowCheck& check, const calib::Rectification& rectification, double max_rms) {
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  std::string text = format("%d points in %d pairs (%.0f %% of the matches left out)\n", check.matches,
                            check.pairs, 100.0 * check.outliers) +
                     format("vertical disparity  RMS %.3f px, 95 %% below %.3f px, median %+.3f px\n",
                            check.rms, check.p95, check.median) +
                     format(
                         "residual  %.3f px (RMS) after a fitted rotation of the right camera; roll %+.3f px "
                         "over the image's "
                         "width\n",
                         check.scatter, check.slope) +
                     "depth error if the disparity error is of the same size:\n";
  for (const double range : calib::kDepthDistances)
    text += format("  at %4.0f m  %.3g m\n", range, depthError(design, check.rms, range));
  return text + verdictOf(check, max_rms) + "\n";
}

nlohmann::ordered_json rowCheckJson(const RowCheck& check, const calib::Rectification& rectification,
                                    double max_rms) {
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  nlohmann::ordered_json depth = nlohmann::ordered_json::array();
  for (const double range : calib::kDepthDistances)
    depth.push_back({{"range_m", range}, {"error_m", depthError(design, check.rms, range)}});
  return {{"pass", passes(check, max_rms)},
          {"swapped", seemsSwapped(check)},
          {"verdict", verdictOf(check, max_rms)},
          {"pairs", check.pairs},
          {"matches", check.matches},
          {"outlier_share", check.outliers},
          {"vertical_disparity_px",
           {{"rms", check.rms},
            {"p95", check.p95},
            {"median", check.median},
            {"roll_over_width", check.slope},
            {"unexplained_rms", check.scatter}}},
          {"largest_rms_px", max_rms},
          {"in_front_share", check.in_front},
          {"depth_error", depth}};
}

}  // namespace cartvo::calibrate
