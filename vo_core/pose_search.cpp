// The pose that most of the landmarks agree on.
#include "vo_core/pose_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/pose_residuals.hpp"

namespace cartvo {
namespace {

constexpr int kSubset = 4;         // points; three would do, the fourth steadies the steps
constexpr int kSubsetSteps = 4;    // Gauss-Newton steps of a subset
constexpr int kPolishSteps = 4;    // and of all that a pose explains
constexpr double kSettled = 1e-5;  // m and rad
constexpr double kNeverExplained = 1e3;
static_assert(kSubset <= kDoubleLanes);

using Transforms = FixedVector<Eigen::Isometry3d, kMostWindowPairs>;

/// A pose as the blocks need it.
Transforms fromHosts(const PoseProblem& problem, const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  Transforms T_camera_host;
  for (const Eigen::Isometry3d& T_world_host : problem.hosts)
    T_camera_host.push_back(T_camera_world * T_world_host);
  return T_camera_host;
}

/// Of all points within the gate.
CARTVO_VECTOR_CLONES
void addEquations(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                  const Transforms& T_camera_host, double gate, PoseEquations& equations) {
  const double gentleness = 1.0 / (gate * gate);
  for (const PointBlock& block : blocks) {
    const PointResiduals at = residualsOf(problem, T_camera_host[block.host], block);
    const DoubleLanes scaled = gentleness * at.square;
    DoubleLanes weight = at.in_front * block.weight / (1.0 + scaled);
    BitLanes within;
    findNegative(scaled - 1.0, within);
    keepWhere(within, weight);
    equations.add(problem, block, at, weight);
  }
}

/// Of a few points of any hosts.
CARTVO_VECTOR_CLONES
void addEquations(const PoseProblem& problem, const PointBlock& block, const TransformLanes& T_camera_host,
                  PoseEquations& equations) {
  const PointResiduals at = residualsOf(problem, T_camera_host, block);
  equations.add(problem, block, at, at.in_front * block.weight);
}

/// Weight of what a pose explains, a point counting the less the worse it fits.
CARTVO_VECTOR_CLONES
double supportOf(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                 const Transforms& T_camera_host, double gate) {
  DoubleLanes sum{};
  for (const PointBlock& block : blocks) {
    const PointResiduals at = residualsOf(problem, T_camera_host[block.host], block);
    DoubleLanes fit = 1.0 - at.square / (gate * gate);
    raiseTo(0.0, fit);
    sum += block.weight * at.in_front * fit;
  }
  return sumOf(sum);
}

/// One number of each lane of the blocks.
struct SquareLanes {
  DoubleLanes value;
};

CARTVO_VECTOR_CLONES
void findSquares(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                 const Transforms& T_camera_host, std::vector<SquareLanes>& squares) {
  squares.reserve(blocks.capacity());
  squares.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const PointResiduals at = residualsOf(problem, T_camera_host[blocks[i].host], blocks[i]);
    squares[i].value = at.in_front > 0.0 ? at.square : kNeverExplained * kNeverExplained + DoubleLanes{};
  }
}

/// `use(point, error)` gets each point's index and its normalised error under a pose. `squares`: memory.
template <typename Use>
void forEachError(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                  const Eigen::Isometry3d& T_world_camera, std::vector<SquareLanes>& squares,
                  const Use& use) {
  findSquares(problem, blocks, fromHosts(problem, T_world_camera), squares);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (int lane = 0; lane < blocks[i].count; ++lane)
      use(blocks[i].point[lane], std::sqrt(squares[i].value[lane]));
}

/// Gauss-Newton steps from a pose, nothing if the points leave it open. `build(pose, equations)`.
template <typename Build>
std::optional<Eigen::Isometry3d> iterate(Eigen::Isometry3d pose, int steps, const Build& build) {
  for (int i = 0; i < steps; ++i) {
    PoseEquations equations;
    build(pose, equations);
    const Eigen::LDLT<Matrix6d> factor(equations.hessian());
    const auto pivots = factor.vectorD();
    if (factor.info() != Eigen::Success || !(pivots.minCoeff() > 1e-10 * pivots.maxCoeff()))
      return std::nullopt;
    const Vector6d change = factor.solve(equations.gradient());
    if (!change.allFinite()) return std::nullopt;
    pose = orthonormalised(pose * motionFromVector(change));
    if (change.lpNorm<Eigen::Infinity>() < kSettled) break;
  }
  return pose;
}

class Search {
 public:
  Search(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
         const PoseSearchSettings& settings, SubsetRandom& random)
      : problem_(problem), blocks_(blocks), settings_(settings), random_(random), start_(problem.start) {
    for (const PosePoint& point : problem.points)
      weight_ += point.weight;
  }

  /// The pose; nothing if none explains anything.
  std::optional<Eigen::Isometry3d> run() {
    consider(start_);
    if (const auto polished = polish(start_, 3.0 * settings_.gate)) consider(*polished);
    if (best_support_ < settings_.enough * weight_) drawSubsets();
    if (best_support_ < 0.0) return std::nullopt;
    for (const double gate : {2.0 * settings_.gate, settings_.gate})
      if (const auto polished = polish(best_, gate); polished && admissible(*polished)) best_ = *polished;
    return best_;
  }

  /// Of all points.
  double weight() const { return weight_; }

 private:
  /// On all points within the gate.
  std::optional<Eigen::Isometry3d> polish(const Eigen::Isometry3d& pose, double gate) const {
    return iterate(pose, kPolishSteps, [&](const Eigen::Isometry3d& T, PoseEquations& equations) {
      addEquations(problem_, blocks_, fromHosts(problem_, T), gate, equations);
    });
  }

  void drawSubsets() {
    const int count = static_cast<int>(problem_.points.size());
    std::array<int, kSubset> subset;
    for (int i = 0; i < settings_.subsets; ++i) {
      for (auto next = subset.begin(); next != subset.end();) {
        *next = std::min(static_cast<int>(random_.uniform() * count), count - 1);
        if (std::find(subset.begin(), next, *next) == next) ++next;
      }
      if (const auto pose = poseOf(subset)) consider(*pose);
    }
  }

  std::optional<Eigen::Isometry3d> poseOf(const std::array<int, kSubset>& subset) const {
    PointBlock block = blockOf(problem_, subset.data(), kSubset);
    for (int lane = 0; lane < kSubset; ++lane)
      block.weight[lane] = 1.0;  // they count alike
    return iterate(start_, kSubsetSteps, [&](const Eigen::Isometry3d& pose, PoseEquations& equations) {
      const Eigen::Isometry3d T_camera_world = pose.inverse();
      TransformLanes T_camera_host{};
      for (int lane = 0; lane < kSubset; ++lane) {
        const Eigen::Isometry3d T = T_camera_world * problem_.hosts[problem_.points[subset[lane]].host];
        for (int row = 0; row < 3; ++row)
          for (int column = 0; column < 4; ++column)
            T_camera_host.value[row][column][lane] = T(row, column);
      }
      addEquations(problem_, block, T_camera_host, equations);
    });
  }

  void consider(const Eigen::Isometry3d& pose) {
    if (!admissible(pose)) return;
    const double gate = 2.0 * settings_.gate;  // a subset's pose is blunt
    const double found = supportOf(problem_, blocks_, fromHosts(problem_, pose), gate);
    if (found <= best_support_) return;
    best_support_ = found;
    best_ = pose;
  }

  bool admissible(const Eigen::Isometry3d& pose) const {
    if (!problem_.admissible_change) return true;
    const Vector6d change = vectorFromMotion(start_.inverse() * pose);
    return (change.cwiseAbs().array() <= problem_.admissible_change->array()).all();
  }

  const PoseProblem& problem_;
  const std::vector<PointBlock>& blocks_;
  const PoseSearchSettings& settings_;
  SubsetRandom& random_;
  Eigen::Isometry3d start_;
  double weight_ = 0.0;
  double best_support_ = -1.0;
  Eigen::Isometry3d best_ = Eigen::Isometry3d::Identity();
};

}  // namespace

struct PoseFinder::Work {
  PointBlocks points;
  std::vector<SquareLanes> squares;
};

PoseFinder::PoseFinder() : work_(std::make_unique<Work>()) {}
PoseFinder::PoseFinder(PoseFinder&&) noexcept = default;
PoseFinder& PoseFinder::operator=(PoseFinder&&) noexcept = default;
PoseFinder::~PoseFinder() = default;

std::optional<FoundPose> PoseFinder::find(PoseProblem& problem, const PoseSearchSettings& settings,
                                          SubsetRandom& random) {
  if (static_cast<int>(problem.points.size()) <= kSubset) return std::nullopt;
  auto& [points, squares] = *work_;
  points.take(problem);
  Search search(problem, points.blocks, settings, random);
  const auto pose = search.run();
  if (!pose) return std::nullopt;
  FoundPose found{*pose};
  forEachError(problem, points.blocks, *pose, squares,
               [&](int point, double error) { problem.points[point].inlier = error < settings.gate; });
  for (const PosePoint& point : problem.points) {
    if (!point.inlier) continue;
    ++found.inliers;
    found.weight += point.weight;
  }
  found.share = search.weight() > 0.0 ? found.weight / search.weight() : 0.0;
  return found;
}

}  // namespace cartvo
