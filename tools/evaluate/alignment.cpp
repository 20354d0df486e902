// Fits an estimate to the truth.
#include "tools/evaluate/alignment.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "calib/model/rotation.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace cartvo {
namespace {

Eigen::Vector3d centreOf(const Trajectory& trajectory) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const StampedPose& stamped : trajectory)
    sum += stamped.pose.translation();
  return sum / static_cast<double>(trajectory.size());
}

/// The similarity that fits the positions best (S. Umeyama, "Least-squares estimation of transformation
/// parameters between two point patterns", 1991).
struct Fit {
  Eigen::Vector3d from, to;                            ///< the centres
  double estimate_squares = 0.0, truth_squares = 0.0;  ///< sums about the centres
  Eigen::Matrix3d R = Eigen::Matrix3d::Zero();
  double scale = 1.0;

  Eigen::Vector3d apply(const StampedPose& estimate) const {
    return scale * (R * (estimate.pose.translation() - from)) + to;
  }
};

Fit fitOf(const AssociatedTrajectories& associated, bool with_scale) {
  Fit fit{centreOf(associated.estimate), centreOf(associated.truth)};
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < associated.estimate.size(); ++i) {
    const Eigen::Vector3d estimate = associated.estimate[i].pose.translation() - fit.from,
                          truth = associated.truth[i].pose.translation() - fit.to;
    products += truth * estimate.transpose();
    fit.estimate_squares += estimate.squaredNorm();
    fit.truth_squares += truth.squaredNorm();
  }
  fit.R = calib::bestRotation(products);
  if (with_scale) fit.scale = fit.R.cwiseProduct(products).sum() / fit.estimate_squares;
  return fit;
}

/// The constant rotation from the estimate's axes to the truth's that fits all orientations best.
Eigen::Matrix3d axesBetween(const AssociatedTrajectories& associated) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < associated.estimate.size(); ++i)
    sum += associated.estimate[i].pose.linear().transpose() * associated.truth[i].pose.linear();
  return calib::bestRotation(sum);
}

}  // namespace

double alignedError(const AssociatedTrajectories& associated) {
  const Fit fit = fitOf(associated, false);
  double squares = 0.0;
  for (std::size_t i = 0; i < associated.estimate.size(); ++i)
    squares += (fit.apply(associated.estimate[i]) - associated.truth[i].pose.translation()).squaredNorm();
  return std::sqrt(squares / static_cast<double>(associated.estimate.size()));
}

void fitEstimate(const ComparisonSettings& settings, AssociatedTrajectories& associated) {
  if (!settings.aligns && !settings.corrects_scale) return;
  const Fit fit = fitOf(associated, settings.corrects_scale);
  constexpr double kMinExtent = 0.1;  // m, RMS about the centre
  if (std::min(fit.estimate_squares, fit.truth_squares) <
      kMinExtent * kMinExtent * static_cast<double>(associated.estimate.size()))
    throw std::runtime_error("a standstill has no path to fit; leave out --align and --correct-scale");
  associated.scale = fit.scale;
  associated.is_aligned = settings.aligns;
  for (StampedPose& stamped : associated.estimate) {
    stamped.pose.translation() =
        settings.aligns ? fit.apply(stamped) : Eigen::Vector3d(fit.scale * stamped.pose.translation());
    if (settings.aligns) stamped.pose.linear() = fit.R * stamped.pose.linear();
  }
  if (!settings.aligns) return;
  const Eigen::Matrix3d axes = axesBetween(associated);
  for (StampedPose& stamped : associated.estimate)
    stamped.pose.linear() = stamped.pose.linear() * axes;
}

Trajectory placedEstimate(const AssociatedTrajectories& associated) {
  if (associated.is_aligned) return associated.estimate;
  return startingAt(associated.truth.front().pose, associated.estimate);
}

const char* placementName(const AssociatedTrajectories& associated) {
  return associated.is_aligned ? "aligned" : "starts coincide";
}

}  // namespace cartvo
