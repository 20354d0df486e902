// Gauss-Newton on poses and inverse depths.
#include "vo_core/bundle_adjustment.hpp"

#include <Eigen/Cholesky>

#include "vo_core/held_poses.hpp"
#include "vo_core/late_right.hpp"
#include "vo_core/parallel_loop.hpp"
#include "vo_core/residual_sizes.hpp"
#include "vo_core/rig_system.hpp"

namespace cartvo {
namespace {

constexpr double kNotSeen = 1e3;  // error of a landmark behind a camera

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
void takeStep(const ReducedSystem& system, const PoseVector& step, BundleBlocks& blocks) {
  system.takeStep(step, blocks);
}

/// By the step's size in standard deviations of what it changes.
bool isSettled(const PoseVector& step, const ReducedSystem& system, double convergence) {
  const auto unknowns = static_cast<double>(step.size());
  return step.dot(system.hessian * step) < convergence * convergence * unknowns;
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
  Conclusions conclusions;
};

BundleAdjuster::BundleAdjuster() : work_(std::make_unique<Work>()) {}
BundleAdjuster::BundleAdjuster(BundleAdjuster&&) noexcept = default;
BundleAdjuster& BundleAdjuster::operator=(BundleAdjuster&&) noexcept = default;
BundleAdjuster::~BundleAdjuster() = default;

BundleResult adjustBundle(BundleProblem& problem, const BundleSettings& settings) {
  return BundleAdjuster().adjust(problem, settings);
}

BundleResult BundleAdjuster::adjust(BundleProblem& problem, const BundleSettings& settings) {
  BundleResult result;
  auto& [blocks, cameras, held, system, conclusions] = *work_;
  blocks.take(problem);
  cameras.take(problem);
  held.reset(problem);
  system.reset(problem, blocks);
  const BlockResiduals residuals(problem, cameras, settings.robust_width);
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    buildEquations(blocks, residuals, system);
    system.conclude();
    held.pull(problem, system);
    const Eigen::LDLT<PoseMatrix> factor(system.hessian);
    const auto pivots = factor.vectorD();
    if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) return result;
    const PoseVector step = factor.solve(system.gradient);
    if (!step.allFinite()) return result;
    takeStep(system, step, blocks);
    movePoses(step, problem);
    cameras.update(problem);
    if (isSettled(step, system, settings.convergence)) break;
  }
  conclusions.reset(problem, cameras, blocks);
  buildConclusions(blocks, residuals, system, conclusions);
  system.conclude();
  held.pull(problem, system);
  handBack(blocks, system, conclusions.sizes, problem);
  const Eigen::LDLT<PoseMatrix> factor(system.hessian);
  result.covariance = factor.solve(PoseMatrix::Identity(system.hessian.rows(), system.hessian.cols()));
  if (!result.covariance.allFinite()) return result;
  conclusions.sizes.conclude(result);
  conclusions.rig.conclude(system, factor, result);
  conclusions.late_right.conclude(factor, system, held, blocks, problem);
  result.converged = true;
  return result;
}

}  // namespace cartvo
