// Check of a rig by the vertical disparities of matched points.
#include "tools/calibrate/check/row_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "calib/solver/calibration.hpp"
#include "common/statistics.hpp"
#include "common/units.hpp"
#include "tools/calibrate/plan/stereo_design.hpp"
#include "tools/report/counted.hpp"

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

struct RotationFit {
  Eigen::Vector4d terms = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< per px^2 of the error of a single, mean match
};

RotationFit fitRotation(const std::vector<RectifiedMatch>& matches,
                        const calib::Rectification& rectification) {
  constexpr int kIterations = 30;
  RotationFit fit;
  Eigen::Vector4d& rotation = fit.terms;
  std::vector<double> errors(matches.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < matches.size(); ++i)
      errors[i] =
          std::abs(matches[i].verticalDisparity() - rotationTerms(matches[i], rectification).dot(rotation));
    const double scale = std::max(0.02, 2.385 * 1.4826 * quantile(errors, 0.5));  // px
    Eigen::Matrix4d H = 1e-9 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    double weights = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Eigen::Vector4d terms = rotationTerms(matches[i], rectification);
      const double weight = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
      H += weight * terms * terms.transpose();
      weights += weight;
      g += weight * matches[i].verticalDisparity() * terms;
    }
    rotation = H.ldlt().solve(g);
    fit.covariance = weights * H.inverse();
  }
  return fit;
}

/// Whether an angle of the turn is larger than its error.
bool isSeen(const RowCheck& check, int angle) {
  constexpr double kSignificance = 3.0;
  return std::abs(check.turn[angle]) > kSignificance * check.turn_stddev[angle];
}

std::string turnText(const RowCheck& check) {
  constexpr std::array<const char*, 3> kNames{"pitch", "yaw", "roll"};
  std::string seen, unseen;
  for (int i = 0; i < 3; ++i) {
    const double stddev = kDegreesPerRadian * check.turn_stddev[i];
    if (isSeen(check, i)) {
      seen += format("%s%s %+.3f +- %.3f", seen.empty() ? "" : ", ", kNames[i],
                     kDegreesPerRadian * check.turn[i], stddev);
    } else {
      unseen += format("%s%s (+- %.3f)", unseen.empty() ? "" : ", ", kNames[i], stddev);
    }
  }
  if (!seen.empty()) seen = ": " + seen + " degrees";
  return unseen.empty() ? seen : seen + "; these rows do not show its " + unseen + " degrees";
}

std::string verdictOf(const RowChecks& checks, double max_rms) {
  const RowCheck& check = checks.check;
  if (checks.cannotTell(max_rms)) {
    return "CANNOT TELL: what the pictures show repeats itself, as a board does: most points that contradict "
           "the rig file fit as well at a place that agrees with it. Take pictures of a scene with texture, "
           "near and far";
  }
  if (checks.areExchanged(max_rms)) {
    const std::string proof =
        checks.exchanged ? format("; exchanged, rows differ by %.2f px (RMS)", checks.exchanged->rms) : "";
    return "FAIL: LEFT and RIGHT are exchanged, or the cameras of the rig file are" + proof;
  }
  if (check.rms <= max_rms) return format("PASS: rows agree within %.2f px (RMS)", max_rms);
  if (isSlightlyTurned(check, max_rms)) {
    return format(
               "PASS, with a remark: rows differ by %.2f px (RMS), and by %.2f px after a small turn of the "
               "right camera",
               check.rms, check.scatter) +
           turnText(check) +
           ". cartvod and replay measure and correct this turn while driving; until they have, the first "
           "seconds "
           "are less accurate. To have it in the rig file, calibrate again";
  }
  return format(
      "FAIL: rows differ by more than %.2f px (RMS): the rig file does not belong to these images, or a "
      "camera has moved; calibrate again",
      max_rms);
}

}  // namespace

RowCheck checkRows(const std::vector<RectifiedMatch>& matches, int pairs,
                   const calib::Rectification& rectification) {
  constexpr std::size_t kMinMatches = 30;
  constexpr double kMinGate = 0.5, kGate = 5.0;  // px; standard deviations
  const auto require = [](std::size_t count) {
    if (count < kMinMatches) {
      throw std::runtime_error(
          "only " + std::to_string(count) +
          " consistent points were found in both images, which is too few for a check; take "
          "images of a scene with texture, near and far");
    }
  };
  require(matches.size());
  const RotationFit fit = fitRotation(matches, rectification);
  const Eigen::Vector4d& rotation = fit.terms;
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
  // A rotation of the right camera's points moves their rows by -f (1 + y^2) pitch, f x y yaw and f x roll.
  check.turn = Eigen::Vector3d(rotation[0], -rotation[2], -rotation[1]) / rectification.focal_length;
  constexpr double kMinRowNoise = 0.1;  // px, of good lenses
  const Eigen::Vector4d stddev = std::max(kMinRowNoise, check.scatter) *
                                 fit.covariance.diagonal().cwiseSqrt() / rectification.focal_length;
  check.turn_stddev = Eigen::Vector3d(stddev[0], stddev[2], stddev[1]);
  check.in_front = in_front / static_cast<double>(rows.size());
  return check;
}

bool seemsSwapped(const RowCheck& check) {
  constexpr double kMinShare = 0.5;
  return check.in_front < kMinShare;
}

bool isSlightlyTurned(const RowCheck& check, double max_rms) {
  constexpr double kMaxTurn = 0.1 / kDegreesPerRadian;  // rad; SelfCheck reports larger ones as a fault
  // The term of yaw contains that of the tangential distortion p2. The odometry corrects 1e-2 rad of yaw and
  // 3e-3 of p2 (SelfCalibrationSettings).
  constexpr double kMaxYaw = 1e-2 + 2.0 * 3e-3;
  const Eigen::Vector3d max_turn(kMaxTurn, kMaxYaw, kMaxTurn);
  return check.rms > max_rms && check.scatter <= max_rms &&
         (check.turn.cwiseAbs().array() <= max_turn.array()).all();
}

bool passes(const RowCheck& check, double max_rms) {
  return !seemsSwapped(check) && (check.rms <= max_rms || isSlightlyTurned(check, max_rms));
}

bool RowChecks::areExchanged(double max_rms) const {
  if (cannotTell(max_rms)) return false;
  return seemsSwapped(check) || (!passes(check, max_rms) && exchanged && passes(*exchanged, max_rms));
}

std::string rowCheckText(const RowChecks& checks, const calib::Rectification& rectification, double max_rms) {
  const RowCheck& check = checks.check;
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  std::string text = counted(static_cast<std::uint64_t>(check.matches), "point") + " in " +
                     counted(static_cast<std::uint64_t>(check.pairs), "pair") +
                     format(" (%.0f %% of the matches left out)\n", 100.0 * check.outliers) +
                     format("vertical disparity  RMS %.3f px, 95 %% below %.3f px, median %+.3f px\n",
                            check.rms, check.p95, check.median) +
                     format(
                         "residual  %.3f px (RMS) after a fitted rotation of the right camera; roll %+.3f px "
                         "over the image's "
                         "width\n",
                         check.scatter, check.slope) +
                     "depth error if the rows' error were along the row:\n";
  for (const double range : calib::kDepthDistances)
    text += format("  at %4.0f m  %.3g m\n", range, depthError(design, check.rms, range));
  return text + verdictOf(checks, max_rms) + "\n";
}

nlohmann::ordered_json rowCheckJson(const RowChecks& checks, const calib::Rectification& rectification,
                                    double max_rms) {
  const RowCheck& check = checks.check;
  const StereoDesign design{rectification.baseline, rectification.focal_length,
                            static_cast<double>(rectification.size.width)};
  nlohmann::ordered_json depth = nlohmann::ordered_json::array();
  for (const double range : calib::kDepthDistances)
    depth.push_back({{"range_m", range}, {"error_m", depthError(design, check.rms, range)}});
  return {{"pass", passes(check, max_rms)},
          {"cannot_tell", checks.cannotTell(max_rms)},
          {"swapped", checks.areExchanged(max_rms)},
          {"slightly_turned", isSlightlyTurned(check, max_rms)},
          {"verdict", verdictOf(checks, max_rms)},
          {"pairs", check.pairs},
          {"matches", check.matches},
          {"outlier_share", check.outliers},
          {"vertical_disparity_px",
           {{"rms", check.rms},
            {"p95", check.p95},
            {"median", check.median},
            {"roll_over_width", check.slope},
            {"unexplained_rms", check.scatter}}},
          {"turn_deg",
           {{"pitch", kDegreesPerRadian * check.turn.x()},
            {"yaw", kDegreesPerRadian * check.turn.y()},
            {"roll", kDegreesPerRadian * check.turn.z()}}},
          {"turn_deviation_deg",
           {{"pitch", kDegreesPerRadian * check.turn_stddev.x()},
            {"yaw", kDegreesPerRadian * check.turn_stddev.y()},
            {"roll", kDegreesPerRadian * check.turn_stddev.z()}}},
          {"largest_rms_px", max_rms},
          {"in_front_share", check.in_front},
          {"depth_error", depth}};
}

}  // namespace cartvo::calibrate
