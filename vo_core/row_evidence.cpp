// Vertical disparities regressed on the right camera's rotation and its motion in the image.
#include "vo_core/row_evidence.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "vo_core/lane_order.hpp"
#include "vo_core/median.hpp"
#include "vo_core/reprojection_lanes.hpp"

namespace cartvo {
namespace {

using Vector = RowErrors::Vector;
using Matrix = RowErrors::Matrix;

constexpr std::size_t kFewestMatches = 30;
constexpr int kIterations = 4;  // of weights and noise; each takes half of what is left of the first guess's
constexpr double kLeastNoise = 0.02;  // px, of a row
constexpr double kRobustWidth = 2.0;  // standard deviations at which a row has half its weight
// Standard deviations that keep what a pair does not tell near zero: rad, rad, rad, s.
const Vector kConceivable(1e-2, 1e-2, 1e-2, 1e-1);
// rad/s: how well the rates between two pairs' exposures are known. Between left and right exposure the rig
// turns by this times the offset more or less than the poses say.
constexpr double kRateDoubt = 0.02;
constexpr double kUnknownRate = 0.3;  // where nothing is known: 3 m/s turn what is 10 m away by so much

/// Stereo matches of one host, a lane each.
struct RowBlock {
  int host = 0;
  PlaceLanes place{};
  DoubleLanes x{}, y{};    // where the right camera saw them, at z = 1
  DoubleLanes residual{};  // px, measured vertical disparity minus predicted
  DoubleLanes counted{};   // 1 for what both cameras have in front of them
  DoubleLanes weight{};    // zero for the rest
  DoubleLanes by_errors[RowErrors::kSize]{};
};

/// A problem's stereo matches of its newest pair.
class RowBlocks {
 public:
  void take(const BundleProblem& problem);

  std::vector<RowBlock> blocks;

 private:
  LaneOrder order_;
  std::vector<const BundleLandmark*> matched_;  // of the problem at hand
};

/// With what was measured alone for a residual.
void RowBlocks::take(const BundleProblem& problem) {
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  matched_.clear();
  matched_.reserve(problem.landmarks.capacity());
  for (const BundleLandmark& landmark : problem.landmarks)
    if (const BundleSighting& last = landmark.sightings.back(); last.pose == newest && last.stereo)
      matched_.push_back(&landmark);
  order_.reserve(matched_.capacity());
  order_.sort(problem.poses.size(), matched_.size(),
              [&](std::size_t i) { return matched_[i]->sightings.front().pose; });
  blocks.clear();
  blocks.reserve(order_.mostBlocks());
  order_.forEachBlock([&](int host, const int* indices, int count) {
    RowBlock& block = blocks.emplace_back();
    block.host = host;
    for (int lane = 0; lane < count; ++lane) {
      const BundleLandmark& landmark = *matched_[indices[lane]];
      const BundleSighting& sighting = landmark.sightings.back();
      for (int axis = 0; axis < 3; ++axis)
        block.place.bearing[axis][lane] = landmark.bearing[axis];
      block.place.inverse_depth[lane] = landmark.inverse_depth;
      const Eigen::Vector3d seen = bearingOf(problem.camera, sighting.right);
      block.x[lane] = seen.x();
      block.y[lane] = seen.y();
      block.residual[lane] = sighting.left.y() - sighting.right.y();
      block.weight[lane] = landmark.weight;
      block.counted[lane] = 1.0;
    }
  });
}

/// The two cameras as seen from a host.
struct RowCameras {
  Eigen::Isometry3d T_left_host, T_right_host;
};
using RowCamerasOfHosts = FixedVector<RowCameras, kMostWindowPairs>;

CARTVO_VECTOR_CLONES
void linearise(double f, const RowCamerasOfHosts& cameras, const Vector6d& right_by_offset,
               std::vector<RowBlock>& blocks) {
  for (RowBlock& block : blocks) {
    const RayLanes left_ray = rayOf(cameras[block.host].T_left_host, block.place);
    const RayLanes right_ray = rayOf(cameras[block.host].T_right_host, block.place);
    for (const RayLanes* ray : {&left_ray, &right_ray}) {
      BitLanes behind;
      findNegative(ray->z - kNearestRay, behind);
      keepWhere(~behind, block.counted);
    }
    block.weight *= block.counted;
    const ViewLanes left = viewOf(left_ray), right = viewOf(right_ray);
    block.residual -= f * (left.y - right.y);
    block.by_errors[RowErrors::kPitch] = -f * (1.0 + block.y * block.y);
    block.by_errors[RowErrors::kRoll] = f * block.x;
    block.by_errors[RowErrors::kKeystone] = f * block.x * block.y;
    const PoseLanes by_right = rowByCamera(right, block.place);
    DoubleLanes& by_delay = block.by_errors[RowErrors::kDelay] = DoubleLanes{};
    for (int i = 0; i < 6; ++i)
      by_delay -= f * right_by_offset[i] * by_right.value[i];
  }
}

/// Takes off what the motion explains.
void linearise(const BundleProblem& problem, std::vector<RowBlock>& blocks) {
  const int newest = static_cast<int>(problem.poses.size()) - 1;
  const RightCamera right = rightCameraOf(problem.poses, newest, problem.camera.baseline);
  const Eigen::Isometry3d left_inverse = problem.poses.back().T_world_camera.inverse();
  const Eigen::Isometry3d right_inverse = right.T_world_camera.inverse();
  RowCamerasOfHosts cameras;
  for (const TimedPose& host : problem.poses)
    cameras.push_back({left_inverse * host.T_world_camera, right_inverse * host.T_world_camera});
  linearise(problem.camera.focal_length, cameras, right.by_offset, blocks);
}

/// What the errors leave over, px.
inline void findRest(const RowBlock& block, const Vector& errors, DoubleLanes& rest) {
  rest = block.residual;
  for (int i = 0; i < RowErrors::kSize; ++i)
    rest -= errors[i] * block.by_errors[i];
}

CARTVO_VECTOR_CLONES
void collectSizes(const std::vector<RowBlock>& blocks, const Vector& errors, std::vector<double>& sizes) {
  sizes.clear();
  sizes.reserve(kDoubleLanes * blocks.capacity());
  for (const RowBlock& block : blocks) {
    DoubleLanes rest;
    findRest(block, errors, rest);
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      if (block.counted[lane] > 0.0) sizes.push_back(std::abs(rest[lane]));
  }
}

/// Normal equations, in px.
struct RowSums {
  DoubleLanes products[RowErrors::kSize][RowErrors::kSize]{};  // the lower triangle
  DoubleLanes gradient[RowErrors::kSize]{};
  DoubleLanes weights{};
};

CARTVO_VECTOR_CLONES
void addRows(const std::vector<RowBlock>& blocks, const Vector& errors, double noise, RowSums& sums) {
  const double gentleness = 1.0 / (kRobustWidth * kRobustWidth * noise * noise);
  for (const RowBlock& block : blocks) {
    DoubleLanes rest;
    findRest(block, errors, rest);
    const DoubleLanes weight = block.weight / (1.0 + gentleness * (rest * rest));
    sums.weights += weight;
    for (int i = 0; i < RowErrors::kSize; ++i) {
      const DoubleLanes weighted = weight * block.by_errors[i];
      sums.gradient[i] += weighted * block.residual;
      for (int j = 0; j <= i; ++j)
        sums.products[i][j] += weighted * block.by_errors[j];
    }
  }
}

}  // namespace

struct RowRegression::Work {
  RowBlocks rows;
  std::vector<double> sizes;
};

RowRegression::RowRegression() : work_(std::make_unique<Work>()) {}
RowRegression::RowRegression(RowRegression&&) noexcept = default;
RowRegression& RowRegression::operator=(RowRegression&&) noexcept = default;
RowRegression::~RowRegression() = default;

RowEvidence rowEvidence(const BundleProblem& adjusted) {
  return RowRegression().evidence(adjusted);
}

RowEvidence RowRegression::evidence(const BundleProblem& adjusted) {
  RowEvidence evidence;
  auto& [rows, sizes] = *work_;
  rows.take(adjusted);
  linearise(adjusted, rows.blocks);
  const Matrix prior = kConceivable.cwiseAbs2().cwiseInverse().asDiagonal();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    collectSizes(rows.blocks, evidence.errors, sizes);
    if (sizes.size() < kFewestMatches) return {};
    const double noise = std::max(deviationOf(sizes), kLeastNoise);
    RowSums sums;
    addRows(rows.blocks, evidence.errors, noise, sums);
    const double weights = sumOf(sums.weights);
    if (!(weights > 0.0)) return {};
    Matrix products;
    Vector gradient;
    for (int i = 0; i < RowErrors::kSize; ++i) {
      gradient[i] = sumOf(sums.gradient[i]);
      for (int j = 0; j <= i; ++j)
        products(i, j) = products(j, i) = sumOf(sums.products[i][j]);
    }
    evidence.information = products / (noise * noise);
    evidence.leverage = products / weights;
    evidence.errors = (evidence.information + prior).ldlt().solve(gradient / (noise * noise));
  }
  // (I^-1 + D)^-1 = (1 + I D)^-1 I, where I may be singular.
  const double doubt = (adjusted.poses.size() > 1 ? kRateDoubt : kUnknownRate) * adjusted.poses.back().offset;
  const Matrix doubts = Vector(doubt * doubt, doubt * doubt, 0.0, 0.0).asDiagonal();
  evidence.information =
      (Matrix::Identity() + evidence.information * doubts).inverse() * evidence.information.eval();
  if (!evidence.errors.allFinite() || !evidence.information.allFinite()) return {};
  return evidence;
}

}  // namespace cartvo
