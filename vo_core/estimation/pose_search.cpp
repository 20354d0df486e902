// RANSAC and Gauss-Newton refinement of a camera pose from landmarks.
#include "vo_core/estimation/pose_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "vo_core/estimation/pose_residuals.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/image_cells.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {
namespace {

constexpr int kSubsetSize = 4;              // points; three suffice, the fourth stabilises the steps
constexpr int kSubsetSteps = 4;             // Gauss-Newton steps on a subset
constexpr int kRefinementSteps = 4;         // Gauss-Newton steps on all inliers
constexpr double kConvergedStep = 1e-5;     // m and rad
constexpr double kBehindCameraError = 1e3;  // normalised error of a point behind the camera
static_assert(kSubsetSize <= kDoubleLanes);

using Transforms = FixedVector<Eigen::Isometry3d, kMaximumWindowPairs>;

/// Transforms from each anchor to the camera.
Transforms fromAnchors(const PoseProblem& problem, const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  Transforms T_camera_anchor;
  for (const Eigen::Isometry3d& T_world_anchor : problem.anchors)
    T_camera_anchor.push_back(T_camera_world * T_world_anchor);
  return T_camera_anchor;
}

/// Adds all points within the gate, with Cauchy weights.
CARTVO_TARGET_CLONES
void addEquations(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                  const Transforms& T_camera_anchor, double gate, PoseEquations& equations) {
  const double inverse_square_gate = 1.0 / (gate * gate);
  for (const PointBlock& block : blocks) {
    const PointResiduals at = residualsOf(problem, T_camera_anchor[block.anchor], block);
    const DoubleLanes scaled = inverse_square_gate * at.square;
    DoubleLanes weight = at.in_front * block.weight / (1.0 + scaled);
    BitLanes within;
    findNegative(scaled - 1.0, within);
    keepWhere(within, weight);
    equations.add(problem, block, at, weight);
  }
}

/// Adds a block whose points have different anchors.
CARTVO_TARGET_CLONES
void addEquations(const PoseProblem& problem, const PointBlock& block, const TransformLanes& T_camera_anchor,
                  PoseEquations& equations) {
  const PointResiduals at = residualsOf(problem, T_camera_anchor, block);
  equations.add(problem, block, at, at.in_front * block.weight);
}

/// Sum of the weights of the points within the gate, each reduced linearly with its squared error, and by the
/// factor 1 / (1 + sharpness * squared error).
CARTVO_TARGET_CLONES
double sumOfFits(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                 const Transforms& T_camera_anchor, double gate, double sharpness) {
  DoubleLanes sum{};
  for (const PointBlock& block : blocks) {
    const PointResiduals at = residualsOf(problem, T_camera_anchor[block.anchor], block);
    DoubleLanes fit = 1.0 - at.square / (gate * gate);
    clampToMinimum(0.0, fit);
    sum += block.weight * at.in_front * fit / (1.0 + sharpness * at.square);
  }
  return sumOf(sum);
}

/// Squared error of each point of a block.
struct SquareLanes {
  DoubleLanes value;
};

CARTVO_TARGET_CLONES
void findSquares(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                 const Transforms& T_camera_anchor, std::vector<SquareLanes>& squares) {
  squares.reserve(blocks.capacity());
  squares.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const PointResiduals at = residualsOf(problem, T_camera_anchor[blocks[i].anchor], blocks[i]);
    squares[i].value =
        at.in_front > 0.0 ? at.square : kBehindCameraError * kBehindCameraError + DoubleLanes{};
  }
}

/// Calls use(point, error) with each point's index and normalised error. `squares` is a buffer.
template <typename Use>
void forEachError(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
                  const Eigen::Isometry3d& T_world_camera, std::vector<SquareLanes>& squares,
                  const Use& use) {
  findSquares(problem, blocks, fromAnchors(problem, T_world_camera), squares);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (int lane = 0; lane < blocks[i].count; ++lane)
      use(blocks[i].point[lane], std::sqrt(squares[i].value[lane]));
}

/// Performs Gauss-Newton steps with equations from build(pose, equations). Returns nothing if they are
/// singular.
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
    if (change.lpNorm<Eigen::Infinity>() < kConvergedStep) break;
  }
  return pose;
}

bool isInlier(const PosePoint& point) {
  return point.inlier;
}

/// Weight of the points that fulfil a condition.
template <typename Condition>
double weightWhere(const PoseProblem& problem, const Condition& condition) {
  double weight = 0.0;
  for (const PosePoint& point : problem.points)
    if (condition(point)) weight += point.weight;
  return weight;
}

/// Copies the problem with the points that fulfil a condition.
template <typename Condition>
void copyWhere(const PoseProblem& problem, const Condition& condition, PoseProblem& part) {
  part.points.reserve(problem.points.capacity());
  part.moved.reserve(problem.moved.capacity());
  part = problem;
  std::erase_if(part.points, std::not_fn(condition));
}

/// Share of the inliers in an image cell, mean of the cells with points or, if wanted, with what has moved.
double meanCellRatio(const PoseProblem& problem, bool count_moved) {
  std::array<int, kCells> all{}, inliers{};
  for (const PosePoint& point : problem.points) {
    const int cell = cellOf(problem.camera, point.left);
    ++all[cell];
    inliers[cell] += point.inlier ? 1 : 0;
  }
  if (count_moved)
    for (const Eigen::Vector2d& pixel : problem.moved)
      ++all[cellOf(problem.camera, pixel)];
  double sum = 0.0;
  int occupied = 0;
  for (int cell = 0; cell < kCells; ++cell) {
    if (all[cell] == 0) continue;
    sum += static_cast<double>(inliers[cell]) / all[cell];
    ++occupied;
  }
  return occupied > 0 ? sum / occupied : 0.0;
}

/// One RANSAC search.
class Search {
 public:
  Search(const PoseProblem& problem, const std::vector<PointBlock>& blocks,
         const PoseSearchSettings& settings, SubsetRandom& random)
      : problem_(problem), blocks_(blocks), settings_(settings), random_(random), start_(problem.start) {
    for (const PosePoint& point : problem.points)
      weight_ += point.weight;
  }

  /// Returns the best pose, or nothing if no pose within the motion gate was scored.
  std::optional<Eigen::Isometry3d> run() {
    explore(start_);
    if (const auto refined = refine(start_, 3.0 * settings_.gate)) explore(*refined);
    if (highest_support_ < kUnambiguousShare * weight_) drawSubsets();
    if (highest_score_ < 0.0) return std::nullopt;
    return best_;
  }

  /// Returns the weight of all points.
  double weight() const { return weight_; }

 private:
  /// Refines a pose on all points within the gate.
  std::optional<Eigen::Isometry3d> refine(const Eigen::Isometry3d& pose, double gate) const {
    return iterate(pose, kRefinementSteps, [&](const Eigen::Isometry3d& T, PoseEquations& equations) {
      addEquations(problem_, blocks_, fromAnchors(problem_, T), gate, equations);
    });
  }

  void drawSubsets() {
    const int count = static_cast<int>(problem_.points.size());
    std::array<int, kSubsetSize> subset;
    for (int i = 0; i < settings_.subsets; ++i) {
      for (auto next = subset.begin(); next != subset.end();) {
        *next = std::min(static_cast<int>(random_.uniform() * count), count - 1);
        if (std::find(subset.begin(), next, *next) == next) ++next;
      }
      const auto pose = poseOf(subset);
      if (!pose || !explore(*pose)) continue;
      if (const auto rough = refine(*pose, kWideGate * settings_.gate))
        consider(refine(*rough, settings_.gate));
    }
  }

  std::optional<Eigen::Isometry3d> poseOf(const std::array<int, kSubsetSize>& subset) const {
    PointBlock block = blockOf(problem_, subset.data(), kSubsetSize);
    for (int lane = 0; lane < kSubsetSize; ++lane)
      block.weight[lane] = 1.0;  // equal weights
    return iterate(start_, kSubsetSteps, [&](const Eigen::Isometry3d& pose, PoseEquations& equations) {
      const Eigen::Isometry3d T_camera_world = pose.inverse();
      TransformLanes T_camera_anchor{};
      for (int lane = 0; lane < kSubsetSize; ++lane) {
        const Eigen::Isometry3d T = T_camera_world * problem_.anchors[problem_.points[subset[lane]].anchor];
        for (int row = 0; row < 3; ++row)
          for (int column = 0; column < 4; ++column)
            T_camera_anchor.value[row][column][lane] = T(row, column);
      }
      addEquations(problem_, block, T_camera_anchor, equations);
    });
  }

  /// Sum of the weights of the points that a pose fits roughly: the pose of a subset is inaccurate.
  double supportOf(const Eigen::Isometry3d& pose) const {
    return sumOfFits(problem_, blocks_, fromAnchors(problem_, pose), kWideGate * settings_.gate, 0.0);
  }

  /// Score of a refined pose, with the kernel of S. Geman and D. McClure (1987), which falls to a half at one
  /// standard deviation: a pose that fits a part of the points exactly wins over one that fits all of them
  /// badly, as between a standing world and trees that sway in the wind.
  double scoreOf(const Eigen::Isometry3d& pose) const {
    return sumOfFits(problem_, blocks_, fromAnchors(problem_, pose), settings_.gate, 1.0);
  }

  /// Refines a pose if it has more support than all before (local optimisation: O. Chum, J. Matas, J.
  /// Kittler, "Locally optimized RANSAC", 2003). Returns whether it has.
  bool explore(const Eigen::Isometry3d& pose) {
    if (!isAdmissible(pose)) return false;
    const double support = supportOf(pose);
    if (support <= highest_support_) return false;
    highest_support_ = support;
    consider(pose);
    consider(refine(pose, settings_.gate));
    return true;
  }

  /// Keeps the admissible pose with the highest score.
  void consider(const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose || !isAdmissible(*pose)) return;
    const double score = scoreOf(*pose);
    if (score <= highest_score_) return;
    highest_score_ = score;
    best_ = *pose;
  }

  bool isAdmissible(const Eigen::Isometry3d& pose) const {
    if (!problem_.admissible_change) return true;
    const Vector6d change = vectorFromMotion(problem_.expected.inverse() * pose);
    return (change.cwiseAbs().array() <= problem_.admissible_change->array()).all();
  }

  const PoseProblem& problem_;
  const std::vector<PointBlock>& blocks_;
  const PoseSearchSettings& settings_;
  SubsetRandom& random_;
  Eigen::Isometry3d start_;
  double weight_ = 0.0;
  double highest_support_ = -1.0;
  double highest_score_ = -1.0;
  Eigen::Isometry3d best_ = Eigen::Isometry3d::Identity();
};

}  // namespace

int countStillInliers(const PoseProblem& searched) {
  const auto& points = searched.points;
  return static_cast<int>(std::count_if(points.begin(), points.end(),
                                        [](const PosePoint& point) { return point.inlier && point.still; }));
}

bool isFixedToImage(const PoseProblem& searched, const FoundPose& found) {
  constexpr double kNearlyAll = 0.9;
  const int still = countStillInliers(searched);
  // A camera that turns a little moves some landmarks by more than others.
  const bool none_moves = still > kNearlyAll * found.inliers;
  return still > kMajority * found.inliers && meanCellRatio(searched, none_moves) < kMajority;
}

struct PoseFinder::Work {
  PointBlocks points;
  std::vector<SquareLanes> squares;
  PoseProblem part;  ///< of findAlternative()
};

PoseFinder::PoseFinder() : work_(std::make_unique<Work>()) {}
PoseFinder::PoseFinder(PoseFinder&&) noexcept = default;
PoseFinder& PoseFinder::operator=(PoseFinder&&) noexcept = default;
PoseFinder::~PoseFinder() = default;

std::optional<FoundPose> PoseFinder::find(PoseProblem& problem, const PoseSearchSettings& settings,
                                          SubsetRandom& random) {
  if (static_cast<int>(problem.points.size()) <= kSubsetSize) return std::nullopt;
  work_->points.reset(problem);
  Search search(problem, work_->points.blocks, settings, random);
  const auto pose = search.run();
  if (!pose) return std::nullopt;
  setFlags(problem, *pose, settings.gate);
  const auto inliers = std::count_if(problem.points.begin(), problem.points.end(), isInlier);
  const double ratio = search.weight() > 0.0 ? weightWhere(problem, isInlier) / search.weight() : 0.0;
  return FoundPose{*pose, static_cast<int>(inliers), ratio};
}

Matrix6d PoseFinder::covarianceOf(const PoseProblem& searched, const FoundPose& found) {
  PoseProblem& part = work_->part;
  copyWhere(searched, isInlier, part);
  work_->points.reset(part);
  const Transforms T_camera_anchor = fromAnchors(part, found.T_world_camera);
  PoseEquations equations;
  DoubleLanes squares{};
  for (const PointBlock& block : work_->points.blocks) {
    const PointResiduals at = residualsOf(part, T_camera_anchor[block.anchor], block);
    const DoubleLanes weight = at.in_front * block.weight;
    squares += weight * at.square;
    equations.add(part, block, at, weight);
  }
  const double weight = weightWhere(part, isInlier);
  const double shared = 1.0 + landmark_errors::kSharedVariance * weight;
  return shared * (sumOf(squares) / weight) * equations.hessian().inverse();
}

std::optional<AlternativePose> PoseFinder::findAlternative(const PoseProblem& searched,
                                                           const PoseSearchSettings& settings,
                                                           int minimum_inliers, SubsetRandom& random) {
  PoseProblem& part = work_->part;
  copyWhere(searched, std::not_fn(isInlier), part);
  const auto found = find(part, settings, random);
  if (!found || found->inliers < minimum_inliers) return std::nullopt;
  AlternativePose other{found->T_world_camera, weightWhere(part, isInlier)};
  copyWhere(searched, isInlier, part);
  work_->points.reset(part);
  setFlags(part, other.T_world_camera, settings.gate);
  other.weight_of_found = weightWhere(part, std::not_fn(isInlier));
  other.still_of_found =
      weightWhere(part, [](const PosePoint& point) { return !point.inlier && point.still; });
  return other;
}

/// Sets the flags of the points, which are those of work_->points, at a pose.
void PoseFinder::setFlags(PoseProblem& problem, const Eigen::Isometry3d& T_world_camera, double gate) {
  forEachError(problem, work_->points.blocks, T_world_camera, work_->squares, [&](int index, double error) {
    PosePoint& point = problem.points[index];
    point.inlier = error < gate;
    point.outlier = error > kWideGate * gate;
  });
}

}  // namespace cartvo::vo
