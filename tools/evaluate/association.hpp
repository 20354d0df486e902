#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

inline double seconds(std::int64_t time_ns) {
  return 1e-9 * static_cast<double>(time_ns);
}

/// How the poses of the estimate were associated with the truth.
enum class AssociationMethod : std::uint8_t { rows, time };

/// How an estimate is compared; as options of evo, which has the same names for them.
struct ComparisonSettings {
  std::int64_t offset_ns = 0;   ///< added to the estimate's instants
  bool aligns = false;          ///< rotation and translation of the world, and rotation of the axes
  bool corrects_scale = false;  ///< scale of the path
};

/// Estimate and truth at the same times, pose by pose. Both are poses of the same frame (left camera or
/// body), each in its own world.
struct AssociatedTrajectories {
  AssociationMethod method = AssociationMethod::rows;
  Trajectory estimate;
  Trajectory truth;                   ///< as many poses as `estimate`
  std::size_t unmatched = 0;          ///< poses of the estimate without a truth
  bool is_aligned = false;            ///< the estimate was fitted to the truth's world, see fitEstimate
  bool clocks_differ = false;         ///< as one of the problems says
  double scale = 1.0;                 ///< by which the estimate's path was multiplied
  std::vector<std::string> problems;  ///< of clocks and frames, with the remedies
};

/// True poses at any time, by interpolation between neighbours that are close enough.
class InterpolatedTruth {
 public:
  /// `truth` must be sorted by time, not be empty, and outlive this object.
  explicit InterpolatedTruth(const Trajectory& truth);

  /// Pose at a time; empty outside the truth (by more than 1 ms) and in wide gaps, see associateByTime.
  std::optional<StampedPose> at(std::int64_t time_ns) const;

  /// Median time between the truth's poses, ns; 0 for a single one.
  std::int64_t period_ns() const { return period_ns_; }

  /// Widest gap between two poses that is interpolated, ns.
  std::int64_t maxGapNs() const { return max_gap_ns_; }

 private:
  const Trajectory& truth_;
  std::int64_t period_ns_ = 0, max_gap_ns_ = 0;
};

/// Interpolates the truth at the estimate's times: translation linearly, rotation by slerp, between
/// neighbours at most 0.25 s or three of the truth's median periods apart, whichever is longer. Poses outside
/// the truth (by more than 1 ms) or in wider gaps are omitted and counted. Neither trajectory may be empty.
/// Throws std::runtime_error if fewer than two poses remain. Says if the clocks differ.
AssociatedTrajectories associateByTime(const Trajectory& estimate, const Trajectory& truth);

/// Associates row by row. Throws std::runtime_error unless both have the same number of rows, at least two.
AssociatedTrajectories associateByRows(const Trajectory& estimate, const Trajectory& truth);

/// The problem of a comparison of these frames; empty: none. Throws if both files state their frame, the
/// frames differ and no alignment is asked for. `estimated`: the frame of the estimate's poses.
std::string frameProblem(const std::filesystem::path& estimate, TrajectoryFrame estimated,
                         const std::filesystem::path& truth, bool aligns);

/// Reads both files and associates them: by time if both are TUM, by rows if one is KITTI, which has no
/// times; then fits the estimate. Throws if the files state different frames and are not aligned. Errors name
/// the files.
AssociatedTrajectories associateFiles(const std::filesystem::path& estimate,
                                      const std::filesystem::path& truth, const ComparisonSettings& settings);

}  // namespace cartvo
