// Calibration of a rig from board views: model selection, outlier rejection and validation checks.
#include "calib/solver/calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <opencv2/core/utility.hpp>

#include "calib/rectification/rectification.hpp"
#include "calib/solver/cross_validation.hpp"
#include "calib/solver/stereo_calibration.hpp"
#include "common/exact_text.hpp"

namespace cartvo::calib {
namespace {

constexpr std::size_t kMinViews = 6;
constexpr int kFolds = 5;

using BoardCorners = std::vector<Eigen::Vector2d>;

void requireViews(std::size_t views, const char* what) {
  if (views >= kMinViews) return;
  throw std::runtime_error("only " + std::to_string(views) + " views " + what + ": at least " +
                           std::to_string(kMinViews) + " are needed, and 20 or more are good");
}

/// Calibrates with the models of one lens, ordered by their number of parameters.
void solveLens(LensModel lens, const std::vector<BoardView>& views, const BoardCorners& board_corners,
               cv::Size image_size, std::vector<CandidateModel>& candidates) {
  std::vector<CandidateModel*> mine;
  std::vector<CalibrationModel> models;
  for (CandidateModel& candidate : candidates) {
    if (lensOf(candidate.model) != lens) continue;
    mine.push_back(&candidate);
    models.push_back(candidate.model);
  }
  if (models.empty()) return;
  try {
    const std::vector<StereoCalibration> solved = calibrateStereo(views, board_corners, image_size, models);
    for (std::size_t i = 0; i < mine.size(); ++i)
      mine[i]->calibration = solved[i];
  } catch (const std::exception& error) {
    for (CandidateModel* const candidate : mine)
      candidate->refusal = error.what();
  }
}

std::vector<CandidateModel> solveAll(const std::vector<BoardView>& views, const BoardCorners& board_corners,
                                     cv::Size image_size, const std::vector<CalibrationModel>& models) {
  std::vector<CandidateModel> candidates(models.size());
  for (std::size_t i = 0; i < models.size(); ++i)
    candidates[i].model = models[i];
  constexpr std::array kLenses{LensModel::brown, LensModel::wide};
  cv::parallel_for_({0, static_cast<int>(kLenses.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i)
      solveLens(kLenses[static_cast<std::size_t>(i)], views, board_corners, image_size, candidates);
  });
  return candidates;
}

/// Whether the rig can be rectified: a lens may fit the corners but fold between them.
bool isUsable(const StereoCalibration& calibration) {
  try {
    computeRectification(calibration.estimate.rig, {});
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// The calibration with the smallest corner noise, among the usable ones if there are any: misfits of a model
/// that will be refused are not outliers of the views.
const StereoCalibration& bestFit(const std::vector<CandidateModel>& candidates) {
  const StereoCalibration* best = nullptr;
  bool is_best_usable = false;
  for (const CandidateModel& candidate : candidates) {
    if (!candidate.calibration) continue;
    const bool is_usable = isUsable(*candidate.calibration);
    const bool is_better =
        best == nullptr ||
        (is_usable == is_best_usable ? candidate.calibration->corner_stddev < best->corner_stddev
                                     : is_usable);
    if (!is_better) continue;
    best = &*candidate.calibration;
    is_best_usable = is_usable;
  }
  if (best == nullptr) throw std::runtime_error(candidates.front().refusal);
  return *best;
}

/// The estimate with the boards of the kept views only.
RigAndBoards keepBoardsOf(const std::vector<BoardView>& kept, const std::vector<BoardView>& all,
                          const RigAndBoards& estimate) {
  RigAndBoards result{estimate.rig, {}};
  for (std::size_t i = 0; i < all.size() && result.T_left_board.size() < kept.size(); ++i) {
    if (all[i].name == kept[result.T_left_board.size()].name)
      result.T_left_board.push_back(estimate.T_left_board[i]);
  }
  return result;
}

/// Rejects outliers of the best fitting candidate and recalibrates, until there are none.
void rejectAllOutliers(const BoardCorners& board_corners, std::vector<CandidateModel>& candidates,
                       Calibration& calibration) {
  constexpr int kMaxRounds = 3;
  for (int round = 0; round < kMaxRounds; ++round) {
    CleanedViews cleaned = rejectOutliers(bestFit(candidates), calibration.views, board_corners);
    if (cleaned.rejected.empty() && cleaned.rejected_corners == 0) return;
    for (CandidateModel& candidate : candidates) {
      if (!candidate.calibration) continue;
      const RigAndBoards start =
          keepBoardsOf(cleaned.views, calibration.views, candidate.calibration->estimate);
      candidate.calibration = calibrateStereoFrom(start, cleaned.views, board_corners, candidate.model);
    }
    calibration.views = std::move(cleaned.views);
    calibration.rejected_corners += cleaned.rejected_corners;
    calibration.rejected.insert(calibration.rejected.end(), cleaned.rejected.begin(), cleaned.rejected.end());
    requireViews(calibration.views.size(), "are left after those that do not fit the others were rejected");
  }
}

void refuseSwappedCameras(const Rig& rig) {
  const Eigen::Vector3d right_in_left = rig.T_right_left.inverse().translation();
  if (right_in_left.x() < 0.0 && -right_in_left.x() > std::abs(right_in_left.y())) {
    throw std::runtime_error("left and right are exchanged: the camera given as the right one is " +
                             std::to_string(std::lround(-1000.0 * right_in_left.x())) +
                             " mm to the left of the other; exchange the two folders, patterns or streams");
  }
}

double relativeFocalLengthStddev(const StereoCalibration& calibration) {
  const ParameterEstimate& focal_length = calibration.parameters.front();
  return focal_length.stddev / focal_length.value;
}

void refuseFlatTilts(const StereoCalibration& calibration) {
  constexpr double kMinSpread = 0.17;          // rad: ten degrees
  constexpr double kMaxRelativeStddev = 0.02;  // of the focal length
  const double spread = tiltsOf(calibration.estimate.T_left_board).spread;
  if (spread >= kMinSpread && relativeFocalLengthStddev(calibration) <= kMaxRelativeStddev) return;
  throw std::runtime_error("the board is parallel to itself in all views (its planes differ by at most " +
                           std::to_string(std::lround(spread * 180.0 / M_PI)) +
                           " degrees), so the focal length cannot be determined: tilt it by 20 to 40 degrees "
                           "in all four directions");
}

void crossValidateCandidate(const BoardCorners& board_corners, const std::vector<BoardView>& views,
                            CandidateModel& candidate) {
  if (!candidate.calibration) return;
  const int folds = std::min(kFolds, static_cast<int>(views.size()) / 2);
  try {
    candidate.validation = crossValidate(*candidate.calibration, views, board_corners, folds);
    if (!std::isfinite(candidate.validation->rms))
      candidate.refusal = "it cannot be fitted to held-out views";
    computeRectification(candidate.calibration->estimate.rig, {});
  } catch (const std::exception& error) {
    candidate.refusal = error.what();
  }
}

std::size_t chooseCandidate(const std::vector<CandidateModel>& candidates) {
  constexpr double kMaxErrorRatio = 1.01;
  double least = std::numeric_limits<double>::infinity();
  for (const CandidateModel& candidate : candidates) {
    if (candidate.refusal.empty()) least = std::min(least, candidate.validation->rms);
  }
  std::size_t best = candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const CandidateModel& candidate = candidates[i];
    if (!candidate.refusal.empty() || candidate.validation->rms > kMaxErrorRatio * least) continue;
    if (best == candidates.size() ||
        candidate.calibration->parameters.size() < candidates[best].calibration->parameters.size())
      best = i;
  }
  if (best == candidates.size()) {
    throw std::runtime_error("no lens model fits these views: " + modelName(candidates.front().model) + ": " +
                             candidates.front().refusal);
  }
  return best;
}

/// Marks models as refused whose held-out error is much larger than that of the chosen one.
void refusePoorModels(std::size_t chosen, std::vector<CandidateModel>& candidates) {
  constexpr double kMaxErrorRatio = 1.5;
  const double least = candidates[chosen].validation->rms;
  for (CandidateModel& candidate : candidates) {
    if (!candidate.refusal.empty() || candidate.validation->rms <= kMaxErrorRatio * least) continue;
    candidate.refusal = "its error on held-out views is " + fixedText(candidate.validation->rms / least, 1) +
                        " times that of " + modelName(candidates[chosen].model);
  }
}

Rig calibratedFromEveryOther(const Calibration& calibration, const BoardCorners& board_corners,
                             std::size_t first) {
  RigAndBoards start{calibration.rig(), {}};
  std::vector<BoardView> views;
  for (std::size_t i = first; i < calibration.views.size(); i += 2) {
    views.push_back(calibration.views[i]);
    start.T_left_board.push_back(calibration.result().estimate.T_left_board[i]);
  }
  return calibrateStereoFrom(start, views, board_corners, calibration.result().model).estimate.rig;
}

constexpr double kMinViewsForHalves = 16;
constexpr double kMaxHalvesDifference = 1.0;  // px

/// Factor of limits in px: errors of lens model and print grow with the resolution.
double limitScale(cv::Size image_size) {
  return std::max(1.0, image_size.width / 1000.0);
}

std::vector<ValidationCheck> checksOf(const Calibration& calibration) {
  constexpr double kRms = 0.5, kRows = 0.25, kRowsP95 = 0.5;  // px
  constexpr double kMinViewsUsed = 8;
  const double scale = limitScale(calibration.image_size);
  const CrossValidation& held_out = calibration.validation();
  const auto at_most = [](std::string name, double value, double limit) {
    return ValidationCheck{std::move(name), value, limit, "px", value <= limit};
  };
  std::vector<ValidationCheck> checks{
      at_most("held-out reprojection error, RMS", held_out.rms, kRms * scale),
      at_most("held-out rectified vertical disparity, RMS", held_out.vertical_disparity_rms, kRows * scale),
      at_most("held-out rectified vertical disparity, 95 of 100", held_out.vertical_disparity_p95,
              kRowsP95 * scale)};
  const auto views = static_cast<double>(calibration.views.size());
  // With fewer views a half is too small for a calibration; then the difference is reported but not checked.
  if (views >= kMinViewsForHalves) {
    checks.push_back(at_most("difference of two halves, 95 of 100 pixels", calibration.halves.projection_p95,
                             kMaxHalvesDifference * scale));
  }
  checks.push_back({"views used", views, kMinViewsUsed, "at least", views >= kMinViewsUsed});
  checks.push_back({"views of a board that moved between the two exposures",
                    static_cast<double>(calibration.sync.opposed_views), 0.25 * views, "views",
                    !calibration.sync.is_fault});
  return checks;
}

}  // namespace

bool Calibration::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const ValidationCheck& check) { return check.passed; });
}

std::vector<std::string> reservationsOf(const Calibration& calibration) {
  constexpr double kMinCoverage = 0.6;
  constexpr double kDistance = 10.0;       // m
  constexpr double kMaxDepthError = 0.05;  // relative, median over the image
  std::vector<std::string> reservations;
  const auto views = static_cast<double>(calibration.views.size());
  if (views < kMinViewsForHalves) {
    reservations.push_back("only " + std::to_string(calibration.views.size()) +
                           " views are used: take at least " +
                           std::to_string(std::lround(kMinViewsForHalves - views)) +
                           " more; with fewer than 16 the comparison of two halves is no check");
  }
  for (const auto& [side, coverage] :
       {std::pair("left", &calibration.left_coverage), std::pair("right", &calibration.right_coverage)}) {
    if (coverage->share() >= kMinCoverage) continue;
    reservations.push_back("corners cover only " + std::to_string(std::lround(100.0 * coverage->share())) +
                           " % of the " + side +
                           " image: the lens is not known in the rest; hold the board there");
  }
  if (views < kMinViewsForHalves &&
      !(calibration.halves.projection_p95 <= kMaxHalvesDifference * limitScale(calibration.image_size))) {
    reservations.push_back("two calibrations, each from every other view, put the same point up to " +
                           pixelText(calibration.halves.projection_p95) + " apart");
  }
  for (const DepthDifference& depth : calibration.halves.depth) {
    if (depth.distance != kDistance || !(depth.median > kMaxDepthError * kDistance)) continue;
    reservations.push_back(std::isfinite(depth.median)
                               ? "depth at 10 m is known to " +
                                     std::to_string(std::lround(100.0 * depth.median / kDistance)) +
                                     " % only: take more views, near and far, in all parts of both images"
                               : "depth at 10 m could not be compared: no point at that distance lies where "
                                 "both images had corners");
  }
  return reservations;
}

std::string pixelText(double pixels) {
  if (!std::isfinite(pixels)) return "not seen";
  return fixedText(pixels, 2) + " px";
}

double scaleStddev(const Calibration& calibration) {
  constexpr double kBoardStddev = 1e-3;     // relative: measurement of the board's squares
  constexpr double kMaxTotalStddev = 0.05;  // relative: bounds the estimate from halves that are too small
  const std::string along = parameterName(kRelativeTranslation, lensOf(calibration.result().model)).name;
  double from_corners = 0.0;
  for (const ParameterEstimate& parameter : calibration.result().parameters)
    if (parameter.name.name == along) from_corners = parameter.stddev / calibration.rig().baseline();
  const double from_views = std::max(from_corners, 0.5 * calibration.halves.baseline);
  const double total = std::hypot(from_views, kBoardStddev);
  return total < kMaxTotalStddev ? total : kMaxTotalStddev;  // also if it is not a number
}

double depthError(double distance, double disparity_error, double focal_length, double baseline) {
  return distance * distance * disparity_error / (focal_length * baseline);
}

Calibration calibrateViews(const std::vector<BoardView>& views, const BoardSpec& board, cv::Size image_size,
                           const std::vector<CalibrationModel>& models) {
  requireViews(views.size(), "show the board to both cameras");
  const BoardCorners board_corners = boardCorners(board);
  Calibration calibration;
  calibration.board = board;
  calibration.image_size = image_size;
  calibration.views = views;
  std::vector<CandidateModel> candidates = solveAll(views, board_corners, image_size, models);
  refuseSwappedCameras(bestFit(candidates).estimate.rig);
  refuseFlatTilts(bestFit(candidates));
  rejectAllOutliers(board_corners, candidates, calibration);
  for (CandidateModel& candidate : candidates)
    crossValidateCandidate(board_corners, calibration.views, candidate);
  calibration.chosen = chooseCandidate(candidates);
  refusePoorModels(calibration.chosen, candidates);
  calibration.candidates = std::move(candidates);

  const RigAndBoards& estimate = calibration.result().estimate;
  for (std::size_t i = 0; i < calibration.views.size(); ++i) {
    calibration.residuals.push_back(
        viewResiduals(estimate.rig, estimate.T_left_board[i], calibration.views[i], board_corners));
  }
  calibration.sync = diagnoseSync(calibration.residuals, calibration.result().corner_stddev);
  calibration.left_coverage = coverageOf(calibration.views, &BoardView::left, image_size);
  calibration.right_coverage = coverageOf(calibration.views, &BoardView::right, image_size);
  calibration.halves =
      compareCalibrations(calibratedFromEveryOther(calibration, board_corners, 0),
                          calibratedFromEveryOther(calibration, board_corners, 1), calibration.left_coverage,
                          calibration.right_coverage, kDepthDistances);
  calibration.tilts = tiltsOf(estimate.T_left_board);
  calibration.checks = checksOf(calibration);
  return calibration;
}

}  // namespace cartvo::calib
