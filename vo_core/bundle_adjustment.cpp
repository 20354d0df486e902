// Gauss-Newton on poses and inverse depths.
#include "vo_core/bundle_adjustment.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>

#include "vo_core/held_poses.hpp"
#include "vo_core/late_right.hpp"
#include "vo_core/parallel_loop.hpp"
#include "vo_core/residual_sizes.hpp"
#include "vo_core/rig_system.hpp"

namespace cartvo {
namespace {

constexpr double kNotSeen = 1e3;  // error of a landmark behind a camera
constexpr double kNearly = 3.0;   // times the size of a step that ends the iterations: the next one should

/// An iteration needs nothing but the equations.
struct NoVisit {
  void begin(const LandmarkBlock&) {}
  void add(const BlockView&, const SightingRows&) {}
  void eliminate(const LandmarkBlock&, const DepthBlock&, const PoseLanes*) {}
};

/// What is asked of the residuals at the end.
struct Conclusions {
  RigSystem rig;
  LateRight late_right;
  ResidualSizes sizes;

  void reset(const BundleProblem& problem, const BundleCameras& cameras, const BundleBlocks& blocks) {
    rig = RigSystem(problem);
    late_right.reset(problem, cameras, blocks);
    sizes.reset(blocks);
  }

  void begin(const LandmarkBlock& block) {
    rig.begin();
    late_right.begin(block);
    sizes.begin(block);
  }
  void add(const BlockView& view, const SightingRows& rows) {
    rig.add(view, rows.row[SightingRows::kDisparity]);
    late_right.add(view, rows);
    sizes.add(view, rows);
  }
  void eliminate(const LandmarkBlock&, const DepthBlock& depth, const PoseLanes* by_poses) {
    rig.eliminate(depth, by_poses);
    late_right.eliminate(depth, by_poses);
  }
};

CARTVO_VECTOR_CLONES
void buildPart(const BundleBlocks& blocks, const BlockResiduals& residuals, std::size_t part,
               ReducedSystem& system) {
  NoVisit visit;
  system.build(blocks, residuals, part, visit);
}

void buildEquations(const BundleBlocks& blocks, const BlockResiduals& residuals, ReducedSystem& system) {
  forEachIndex(ReducedSystem::kParts, [&](std::size_t part) { buildPart(blocks, residuals, part, system); });
}

CARTVO_VECTOR_CLONES
void buildConclusions(const BundleBlocks& blocks, const BlockResiduals& residuals, ReducedSystem& system,
                      Conclusions& conclusions) {
  for (std::size_t part = 0; part < ReducedSystem::kParts; ++part)
    system.build(blocks, residuals, part, conclusions);
}

CARTVO_VECTOR_CLONES
void moveDepths(const ReducedSystem& system, const PoseVector& step, BundleBlocks& blocks) {
  system.takeStep(step, blocks);
}

/// In standard deviations of what it changes: mean of squares, root.
double sizeOf(const PoseVector& step, const ReducedSystem& system) {
  return std::sqrt(step.dot(system.hessian * step) / static_cast<double>(step.size()));
}

void movePoses(const PoseVector& step, BundleProblem& problem) {
  for (std::size_t i = problem.fixed; i < problem.poses.size(); ++i) {
    Eigen::Isometry3d& pose = problem.poses[i].T_world_camera;
    pose = orthonormalised(pose * motionFromVector(step.segment<6>(6 * (i - problem.fixed))));
  }
}

/// The blocks' results, to where their landmarks came from.
void handBack(const BundleBlocks& blocks, const ReducedSystem& system, const ResidualSizes& sizes,
              BundleProblem& problem) {
  for (std::size_t i = 0; i < blocks.landmarks.size(); ++i) {
    const LandmarkBlock& block = blocks.landmarks[i];
    for (int lane = 0; lane < block.count; ++lane) {
      BundleLandmark& landmark = problem.landmarks[block.landmark[lane]];
      const bool in_front = system.depths[i].in_front[lane] > 0.0;
      landmark.inverse_depth = block.place.inverse_depth[lane];
      landmark.information = system.depths[i].hessian[lane];
      landmark.error = in_front ? sizes.lastError(i, lane) : kNotSeen;
    }
  }
}

}  // namespace

struct BundleAdjuster::Work {
  BundleBlocks blocks;
  BundleCameras cameras;
  HeldPoses held;
  ReducedSystem system;
  Eigen::LDLT<PoseMatrix> factor;
  Conclusions conclusions;

  void take(const BundleProblem& problem) {
    blocks.take(problem);
    cameras.take(problem);
    held.reset(problem);
    system.reset(problem, blocks);
  }
  std::optional<double> takeStep(const BlockResiduals& residuals, bool may_end, BundleProblem& problem);
  void conclude(BundleProblem& problem, BundleResult& result) const;
};

/// The step's size; nothing if the equations do not hold it. If it may be the last one, what is asked at the
/// end is asked on the way.
std::optional<double> BundleAdjuster::Work::takeStep(const BlockResiduals& residuals, bool may_end,
                                                     BundleProblem& problem) {
  if (may_end) {
    conclusions.reset(problem, cameras, blocks);
    buildConclusions(blocks, residuals, system, conclusions);
  } else {
    buildEquations(blocks, residuals, system);
  }
  system.conclude();
  held.pull(problem, system);
  factor.compute(system.hessian);
  const auto pivots = factor.vectorD();
  if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) return std::nullopt;
  const PoseVector step = factor.solve(system.gradient);
  if (!step.allFinite()) return std::nullopt;
  moveDepths(system, step, blocks);
  movePoses(step, problem);
  cameras.update(problem);
  return sizeOf(step, system);
}

void BundleAdjuster::Work::conclude(BundleProblem& problem, BundleResult& result) const {
  handBack(blocks, system, conclusions.sizes, problem);
  result.covariance = factor.solve(PoseMatrix::Identity(system.hessian.rows(), system.hessian.cols()));
  if (!result.covariance.allFinite()) return;
  conclusions.sizes.conclude(result);
  conclusions.rig.conclude(system, factor, result);
  conclusions.late_right.conclude(factor, system, held, blocks, problem);
  result.converged = true;
}

BundleAdjuster::BundleAdjuster() : work_(std::make_unique<Work>()) {}
BundleAdjuster::BundleAdjuster(BundleAdjuster&&) noexcept = default;
BundleAdjuster& BundleAdjuster::operator=(BundleAdjuster&&) noexcept = default;
BundleAdjuster::~BundleAdjuster() = default;

BundleResult BundleAdjuster::adjust(BundleProblem& problem, const BundleSettings& settings) {
  BundleResult result;
  work_->take(problem);
  const BlockResiduals residuals(problem, work_->cameras, settings.robust_width);
  double size = std::numeric_limits<double>::infinity();
  for (int iteration = 1; iteration <= settings.iterations; ++iteration) {
    const bool may_end = iteration == settings.iterations || size < kNearly * settings.convergence;
    const auto step = work_->takeStep(residuals, may_end, problem);
    if (!step) return result;
    size = *step;
    if (may_end && size < settings.convergence) break;
  }
  work_->conclude(problem, result);
  return result;
}

}  // namespace cartvo
