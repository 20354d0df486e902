// Motion between two pairs from the points that both observed: random subsets, then iteratively reweighted
// Horn alignment.
#include "vo_core/thesis/motion_estimator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "vo_core/rigid_motion.hpp"
#include "vo_core/thesis/absolute_orientation.hpp"
#include "vo_core/thesis/median_pose.hpp"
#include "vo_core/thesis/prediction_error.hpp"

namespace cartvo::vo {
namespace {

constexpr double kBestFraction =
    0.25;  // fraction of the subsets' poses, the best ones, whose median is taken
constexpr double kConvergedStep =
    1e-5;  // m and rad, change of the pose that ends the iterations of the weights

/// The matches and the quantities that depend on the rotation between them.
class Problem {
 public:
  Problem(const std::vector<PointMatch>& matches, const Eigen::Matrix3d& rotation) : matches_(matches) {
    for (const PointMatch& match : matches) {
      const Eigen::Matrix3d covariance =
          match.reference_covariance + rotation * match.current_covariance * rotation.transpose();
      information_.emplace_back(covariance.inverse());
      precision_.push_back(match.weight / covariance.trace());
    }
  }

  std::size_t size() const { return matches_.size(); }
  double precision(std::size_t i) const { return precision_[i]; }

  PointPair pair(std::size_t i, double weight) const {
    return {matches_[i].current, matches_[i].reference, weight};
  }

  /// Prediction errors c of all matches under a motion, in standard deviations.
  void errors(const Eigen::Isometry3d& T_reference_current, std::vector<double>& out) const {
    out.resize(size());
    for (std::size_t i = 0; i < size(); ++i)
      out[i] =
          normalisedError(matches_[i].reference - T_reference_current * matches_[i].current, information_[i]);
  }

 private:
  const std::vector<PointMatch>& matches_;
  std::vector<Eigen::Matrix3d> information_;
  std::vector<double> precision_;  // inverse variance times history weight
};

/// Draws subsets of distinct matches, precise points (near ones) more often than imprecise ones.
class SubsetSampler {
 public:
  SubsetSampler(const Problem& problem, SubsetRandom& random) : random_(random) {
    double sum = 0.0;
    for (std::size_t i = 0; i < problem.size(); ++i)
      cumulative_.push_back(sum += std::sqrt(problem.precision(i)));
  }

  /// Draws fewer than `size` only if the same matches are drawn again and again.
  void draw(int size, std::vector<std::size_t>& subset) {
    subset.clear();
    for (int attempt = 0; attempt < 4 * size && static_cast<int>(subset.size()) < size; ++attempt) {
      const double place = random_.uniform() * cumulative_.back();
      const auto at = std::upper_bound(cumulative_.begin(), cumulative_.end(), place) - cumulative_.begin();
      const std::size_t index = std::min(static_cast<std::size_t>(at), cumulative_.size() - 1);
      if (std::find(subset.begin(), subset.end(), index) == subset.end()) subset.push_back(index);
    }
  }

 private:
  SubsetRandom& random_;
  std::vector<double> cumulative_;
};

struct ScoredPose {
  Eigen::Isometry3d pose;
  double cost;  // sum of truncated errors
};

/// The median pose of the better subsets.
std::optional<Eigen::Isometry3d> subsetsPose(const Problem& problem, const MotionSettings& settings,
                                             SubsetRandom& random) {
  SubsetSampler sampler(problem, random);
  std::vector<ScoredPose> poses;
  std::vector<std::size_t> subset;
  std::vector<PointPair> pairs;
  std::vector<double> errors;
  for (int i = 0; i < settings.subsets; ++i) {
    sampler.draw(settings.subset_size, subset);
    pairs.clear();
    for (const std::size_t index : subset)
      pairs.push_back(problem.pair(index, problem.precision(index)));
    const auto pose = absoluteOrientation(pairs);
    if (!pose) continue;
    problem.errors(*pose, errors);
    const double limit = 2.0 * settings.radius;  // a subset's pose is imprecise
    const double cost = std::accumulate(errors.begin(), errors.end(), 0.0,
                                        [&](double sum, double c) { return sum + std::min(c, limit); });
    poses.push_back({*pose, cost});
  }
  if (poses.empty()) return std::nullopt;
  std::stable_sort(poses.begin(), poses.end(),
                   [](const ScoredPose& a, const ScoredPose& b) { return a.cost < b.cost; });
  const auto better =
      std::max<std::size_t>(static_cast<std::size_t>(kBestFraction * static_cast<double>(poses.size())), 1);
  std::vector<Eigen::Isometry3d> best;
  for (std::size_t i = 0; i < better; ++i)
    best.push_back(poses[i].pose);
  return medianPose(best);
}

}  // namespace

std::optional<EstimatedMotion> estimateMotion(const std::vector<PointMatch>& matches,
                                              const MotionSettings& settings, SubsetRandom& random) {
  if (static_cast<int>(matches.size()) < std::max(settings.subset_size, 3)) return std::nullopt;
  const auto start = subsetsPose(Problem(matches, Eigen::Matrix3d::Identity()), settings, random);
  if (!start) return std::nullopt;

  const Problem problem(matches, start->linear());
  EstimatedMotion motion;
  motion.T_reference_current = *start;
  std::vector<double> errors;
  std::vector<PointPair> pairs;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    problem.errors(motion.T_reference_current, errors);
    motion.scale = errorScale(errors);
    pairs.clear();
    for (std::size_t i = 0; i < problem.size(); ++i) {
      const double weight = errorWeight(errors[i] / motion.scale, settings.radius);
      if (weight > 0.0) pairs.push_back(problem.pair(i, weight * problem.precision(i)));
    }
    const auto next = absoluteOrientation(pairs);
    if (!next) break;
    const Vector6d change = vectorFromMotion(motion.T_reference_current.inverse() * *next);
    motion.T_reference_current = *next;
    if (change.lpNorm<Eigen::Infinity>() < kConvergedStep) break;
  }

  problem.errors(motion.T_reference_current, errors);
  motion.scale = errorScale(errors);
  motion.inlier.resize(problem.size());
  for (std::size_t i = 0; i < problem.size(); ++i) {
    motion.inlier[i] = errors[i] < motion.scale * settings.radius;
    motion.inliers += motion.inlier[i] ? 1 : 0;
  }
  return motion;
}

}  // namespace cartvo::vo
