// Bundle adjustment: Gauss-Newton iterations on poses and inverse depths.
#include "vo_core/estimation/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/estimation/pose_priors.hpp"
#include "vo_core/estimation/residual_sizes.hpp"
#include "vo_core/estimation/rig_system.hpp"
#include "vo_core/estimation/time_offset_sensitivity.hpp"

namespace cartvo::vo {
namespace {

constexpr double kBehindCameraError = 1e3;  // normalised error of a landmark behind a camera
// A step below this multiple of the convergence limit makes the next iteration the probable last one.
constexpr double kLastIterationFactor = 3.0;

/// Visitor of an iteration that needs only the normal equations.
struct NoVisitor {
  void begin(const LandmarkBlock&) {}
  void add(const BlockView&, const ObservationRows&) {}
  void eliminate(const LandmarkBlock&, const DepthBlock&, const PoseLanes*) {}
};

/// Visitor of the last iteration: statistics, rig calibration and sensitivity to the time offset.
struct Conclusions {
  RigSystem rig;
  TimeOffsetSensitivity time_offset_sensitivity;
  ResidualSizes sizes;

  void reset(const BundleProblem& problem, const BundleCameras& cameras, const BundleBlocks& blocks) {
    rig = RigSystem(problem);
    time_offset_sensitivity.reset(problem, cameras, blocks);
    sizes.reset(blocks);
  }

  void begin(const LandmarkBlock& block) {
    rig.begin();
    time_offset_sensitivity.begin(block);
    sizes.begin(block);
  }
  void add(const BlockView& view, const ObservationRows& rows) {
    rig.add(view, rows.row[ObservationRows::kDisparity]);
    time_offset_sensitivity.add(view, rows);
    sizes.add(view, rows);
  }
  void eliminate(const LandmarkBlock&, const DepthBlock& depth, const PoseLanes* by_poses) {
    rig.eliminate(depth, by_poses);
    time_offset_sensitivity.eliminate(depth, by_poses);
  }
};

CARTVO_TARGET_CLONES
void buildPart(const BundleBlocks& blocks, const BlockResiduals& residuals, std::size_t part,
               ReducedSystem& system) {
  NoVisitor visitor;
  system.build(blocks, residuals, part, visitor);
}

void buildEquations(const BundleBlocks& blocks, const BlockResiduals& residuals, ReducedSystem& system) {
  forEachIndex(ReducedSystem::kParts, [&](std::size_t part) { buildPart(blocks, residuals, part, system); });
}

CARTVO_TARGET_CLONES
void buildConclusions(const BundleBlocks& blocks, const BlockResiduals& residuals, ReducedSystem& system,
                      Conclusions& conclusions) {
  for (std::size_t part = 0; part < ReducedSystem::kParts; ++part)
    system.build(blocks, residuals, part, conclusions);
}

CARTVO_TARGET_CLONES
void updateDepths(const ReducedSystem& system, const PoseVector& step, BundleBlocks& blocks) {
  system.updateDepths(step, blocks);
}

/// RMS of a step in standard deviations of the poses.
double stepSize(const PoseVector& step, const ReducedSystem& system) {
  return std::sqrt(step.dot(system.hessian * step) / static_cast<double>(step.size()));
}

void updatePoses(const PoseVector& step, BundleProblem& problem) {
  for (std::size_t i = problem.fixed; i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_world_camera;
    pose = orthonormalised(pose * motionFromVector(step.segment<6>(6 * (i - problem.fixed))));
  }
}

/// Copies the results from the blocks to the landmarks of the problem.
void writeLandmarks(const BundleBlocks& blocks, const ReducedSystem& system, const ResidualSizes& sizes,
                    BundleProblem& problem) {
  for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
    const LandmarkBlock& block = blocks.landmarks[i];
    for (int lane = 0; lane < block.count; ++lane) {
      BundleLandmark& landmark = problem.landmarks[block.landmark[lane]];
      const bool in_front = system.depths[i].in_front[lane] > 0.0;
      landmark.inverse_depth = block.place.inverse_depth[lane];
      landmark.information = system.depths[i].hessian[lane];
      landmark.error = in_front ? sizes.lastError(i, lane) : kBehindCameraError;
    }
  }
}

}  // namespace

struct BundleAdjuster::Work {
  BundleBlocks blocks;
  BundleCameras cameras;
  PosePriors priors;
  ReducedSystem system;
  Eigen::LDLT<PoseMatrix> factor;
  Conclusions conclusions;

  void reset(const BundleProblem& problem) {
    blocks.reset(problem);
    cameras.reset(problem);
    priors.reset(problem);
    system.reset(problem, blocks);
  }
  std::optional<double> iterate(const BlockResiduals& residuals, bool may_be_last, BundleProblem& problem);
  void conclude(BundleProblem& problem, BundleResult& result) const;
};

/// Performs one iteration and returns its stepSize(), or nothing if the equations are singular. An iteration
/// that may be the last one also collects the conclusions.
std::optional<double> BundleAdjuster::Work::iterate(const BlockResiduals& residuals, bool may_be_last,
                                                    BundleProblem& problem) {
  if (may_be_last) {
    conclusions.reset(problem, cameras, blocks);
    buildConclusions(blocks, residuals, system, conclusions);
  } else {
    buildEquations(blocks, residuals, system);
  }
  system.sumParts();
  priors.addTo(system, problem);
  factor.compute(system.hessian);
  const auto pivots = factor.vectorD();
  if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) return std::nullopt;
  const PoseVector step = factor.solve(system.gradient);
  if (!step.allFinite()) return std::nullopt;
  updateDepths(system, step, blocks);
  updatePoses(step, problem);
  cameras.update(problem);
  return stepSize(step, system);
}

void BundleAdjuster::Work::conclude(BundleProblem& problem, BundleResult& result) const {
  writeLandmarks(blocks, system, conclusions.sizes, problem);
  result.covariance = factor.solve(PoseMatrix::Identity(system.hessian.rows(), system.hessian.cols()));
  if (!result.covariance.allFinite()) return;
  conclusions.sizes.conclude(result);
  conclusions.rig.conclude(system, factor, result);
  conclusions.time_offset_sensitivity.conclude(factor, system, priors, blocks, problem);
  result.converged = true;
}

BundleAdjuster::BundleAdjuster() : work_(std::make_unique<Work>()) {}
BundleAdjuster::BundleAdjuster(BundleAdjuster&&) noexcept = default;
BundleAdjuster& BundleAdjuster::operator=(BundleAdjuster&&) noexcept = default;
BundleAdjuster::~BundleAdjuster() = default;

BundleResult BundleAdjuster::adjust(BundleProblem& problem, const BundleSettings& settings) {
  BundleResult result;
  work_->reset(problem);
  const BlockResiduals residuals(problem, work_->cameras, settings.robust_width);
  double size = std::numeric_limits<double>::infinity();
  for (int iteration = 1; iteration <= settings.iterations; ++iteration) {
    const bool may_be_last =
        iteration == settings.iterations || size < kLastIterationFactor * settings.convergence;
    const auto step = work_->iterate(residuals, may_be_last, problem);
    if (!step) return result;
    size = *step;
    if (may_be_last && size < settings.convergence) break;
  }
  work_->conclude(problem, result);
  return result;
}

}  // namespace cartvo::vo
