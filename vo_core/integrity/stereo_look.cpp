// Robust regression of the rows of matches on the errors of the right camera, and the tests on it.
#include "vo_core/integrity/stereo_look.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

namespace cartvo::vo {
namespace {

// Causes of row differences: pitch, roll and cross term of the right camera, as RowErrors', rad; and the time
// by which its image lies behind the left one, in units of the time between the left images of row_flow.
constexpr int kCauses = 4;
constexpr int kLag = 3;
using Vector = Eigen::Matrix<double, kCauses, 1>;
using Matrix = Eigen::Matrix<double, kCauses, kCauses>;

// Wide, so that they decide only what the matches leave open.
const Vector kPriorStddev(0.1, 0.1, 0.1, 3.0);
// rad, rotations up to which self-calibration corrects
constexpr double kCorrectableAngle = pitch_search::kMaximumPitch;
// Half-widths of Cauchy's weight, px, in the order of the iterations. The narrow start finds the minimum near
// a correct rig among many mismatches, the wide one that of a wrong rig.
constexpr std::array<double, 6> kNarrow{2.0, 1.0, 1.0, 1.0, 1.0, 1.0};
constexpr std::array<double, 9> kWide{16.0, 16.0, 8.0, 8.0, 4.0, 2.0, 1.0, 1.0, 1.0};

/// Matches and what is known about them.
struct Rows {
  const StereoCamera& camera;
  const std::vector<LookMatch>& matches;
  double expected_lag;
  bool with_lag;  ///< only the matches with row_flow, and the lag is estimated

  bool uses(const LookMatch& match) const { return !with_lag || match.row_flow.has_value(); }
  int count() const {
    return static_cast<int>(
        std::count_if(matches.begin(), matches.end(), [&](const LookMatch& match) { return uses(match); }));
  }

  Vector derivatives(const LookMatch& match) const {
    const double f = camera.focal_length;
    const double x = (match.right.x() - camera.cx) / f;
    const double y = (match.right.y() - camera.cy) / f;
    return {f * (1.0 + y * y), -f * x, -f * x * y, with_lag ? *match.row_flow : 0.0};
  }

  double error(const LookMatch& match, const Vector& causes) const {
    return match.right.y() - match.left.y() - derivatives(match).dot(causes);
  }
};

/// Whether the matches for which counts(match) holds are spread over the image: lettering that a camera
/// writes into its pictures fills one or two bands, and says nothing about the rig.
template <typename Counts>
bool areSpread(const Rows& rows, const Counts& counts) {
  std::array<int, stereo_look::kBands> found{};
  for (const LookMatch& match : rows.matches) {
    if (!rows.uses(match) || !counts(match)) continue;
    const int band = static_cast<int>(match.left.y() / rows.camera.height * stereo_look::kBands);
    ++found[std::clamp(band, 0, stereo_look::kBands - 1)];
  }
  return std::count_if(found.begin(), found.end(), [](int count) {
           return count >= stereo_look::kMinimumInBand;
         }) >= stereo_look::kMinimumBands;
}

struct RowFit {
  Vector causes = Vector::Zero();
  Matrix covariance = Matrix::Zero();
  double agreeing = 0.0;  ///< share of the matches within kRowTolerance
};

/// One step of iteratively reweighted least squares.
void refine(const Rows& rows, double width, RowFit& fit) {
  const Matrix prior = kPriorStddev.cwiseAbs2().cwiseInverse().asDiagonal();
  Matrix information = prior;
  Vector gradient = prior * (Vector(0.0, 0.0, 0.0, rows.expected_lag) - fit.causes);
  double weights = 1.0;
  for (const LookMatch& match : rows.matches) {
    if (!rows.uses(match)) continue;
    const double error = rows.error(match, fit.causes);
    const double weight = 1.0 / (1.0 + error * error / (width * width));
    const Vector row = rows.derivatives(match);
    information += weight * row * row.transpose();
    gradient += weight * error * row;
    weights += weight;
  }
  fit.causes += information.inverse() * gradient;
  // The row noise does not average out: the covariance is that of a single, mean match.
  fit.covariance = stereo_look::kRowNoise * stereo_look::kRowNoise * weights * information.inverse();
}

RowFit fitFrom(const Rows& rows, const double* widths, std::size_t steps) {
  RowFit fit;
  fit.causes[kLag] = rows.expected_lag;
  for (std::size_t i = 0; i < steps; ++i)
    refine(rows, widths[i], fit);
  int agreeing = 0;
  for (const LookMatch& match : rows.matches)
    if (rows.uses(match) && std::abs(rows.error(match, fit.causes)) <= stereo_look::kRowTolerance) ++agreeing;
  fit.agreeing = static_cast<double>(agreeing) / rows.count();
  return fit;
}

RowFit fitRows(const Rows& rows) {
  const RowFit narrow = fitFrom(rows, kNarrow.data(), kNarrow.size());
  const RowFit wide = fitFrom(rows, kWide.data(), kWide.size());
  return wide.agreeing > narrow.agreeing ? wide : narrow;
}

Evidence rowEvidence(const Rows& rows, const RowFit& fit) {
  if (fit.agreeing < stereo_look::kDisagreeingShare) return Evidence::wrong;
  const bool spread = areSpread(rows, [&](const LookMatch& match) {
    return std::abs(rows.error(match, fit.causes)) <= stereo_look::kRowTolerance;
  });
  if (fit.agreeing < stereo_look::kAgreeingShare || !spread) return Evidence::none;
  bool turned = false;
  for (int cause = 0; cause < kLag; ++cause)
    turned = turned ||
             std::abs(fit.causes[cause]) >
                 kCorrectableAngle + stereo_look::kSignificance * std::sqrt(fit.covariance(cause, cause));
  if (!turned) return Evidence::right;
  return fit.agreeing >= stereo_look::kRotatedShare ? Evidence::wrong : Evidence::none;
}

/// Disparities are positive, unless a yaw of the right camera shifts them. Those beyond a yaw that
/// self-calibration corrects, and the disparity of a distant scene, are counted.
Evidence orderEvidence(const Rows& rows, const RowFit& fit) {
  // Disparity over the limit: above 1 if the match is near, below -1 if it is near and exchanged.
  const auto nearness = [&](const LookMatch& match) {
    if (std::abs(rows.error(match, fit.causes)) > stereo_look::kRowTolerance) return 0.0;
    const double x = (match.left.x() - rows.camera.cx) / rows.camera.focal_length;
    const double limit =
        rows.camera.focal_length * (kCorrectableAngle + stereo_look::kDistant) * (1.0 + x * x);
    return (match.left.x() - match.right.x()) / limit;
  };
  const auto near = [&](const LookMatch& match) { return rows.uses(match) && nearness(match) > 1.0; };
  const auto exchanged = [&](const LookMatch& match) { return rows.uses(match) && nearness(match) < -1.0; };
  const auto positive = std::count_if(rows.matches.begin(), rows.matches.end(), near);
  const auto negative = std::count_if(rows.matches.begin(), rows.matches.end(), exchanged);
  if (positive >= stereo_look::kMinimumNear && positive > stereo_look::kOrderMajority * negative &&
      areSpread(rows, near))
    return Evidence::right;
  if (negative >= stereo_look::kMinimumNear && negative > stereo_look::kOrderMajority * positive &&
      areSpread(rows, exchanged))
    return Evidence::wrong;
  return Evidence::none;
}

Evidence lagEvidence(const RowFit& fit, const PairTimes& times) {
  if (fit.agreeing < stereo_look::kAgreeingShare) return Evidence::none;
  const double stddev = stereo_look::kSignificance *
                        std::hypot(std::sqrt(fit.covariance(kLag, kLag)) * times.flow, times.offset_stddev);
  const double error = std::abs(fit.causes[kLag] * times.flow - times.offset);
  if (error - stddev > 0.5 * times.period) return Evidence::wrong;
  return error + stddev < 0.5 * times.period ? Evidence::right : Evidence::none;
}

}  // namespace

StereoLook lookAt(const StereoCamera& camera, const std::vector<LookMatch>& matches, const PairTimes& times) {
  StereoLook look;
  const Rows simultaneous{camera, matches, 0.0, false};
  if (simultaneous.count() < stereo_look::kMinimumMatches) return look;
  const RowFit fit = fitRows(simultaneous);
  look.rows = rowEvidence(simultaneous, fit);
  look.order = orderEvidence(simultaneous, fit);
  const Rows delayed{camera, matches, times.flow > 0.0 ? times.offset / times.flow : 0.0, true};
  if (!(times.flow > 0.0) || delayed.count() < stereo_look::kMinimumMatches) {
    // The motion between the exposures, which is not known, may disturb the rows.
    if (times.offset != 0.0 && look.rows == Evidence::wrong) look.rows = Evidence::none;
    return look;
  }
  const RowFit delayed_fit = fitRows(delayed);
  look.lag = lagEvidence(delayed_fit, times);
  // Rows and disparities that only the motion between the exposures disturbs are no fault of the rig.
  if (look.lag == Evidence::wrong || rowEvidence(delayed, delayed_fit) == Evidence::right) {
    look.rows = rowEvidence(delayed, delayed_fit);
    look.order = Evidence::none;
    if (look.lag != Evidence::wrong) look.order = orderEvidence(delayed, delayed_fit);
  }
  return look;
}

}  // namespace cartvo::vo
