#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// How an estimate's poses found their true ones.
enum class AssociationMethod : std::uint8_t { rows, time };

/// An estimate and the truth at the same instants, pose by pose. Both are poses of one and the same frame
/// (the left camera, or the body), each in a world of its own.
struct AssociatedTrajectories {
  AssociationMethod method = AssociationMethod::rows;
  Trajectory estimate;
  Trajectory truth;           ///< as many poses as `estimate`
  std::size_t unmatched = 0;  ///< poses of the estimate for which there is no truth
};

/// The truth at the estimate's instants: between the samples before and after, the translation linearly and
/// the rotation by slerp, where the two are no further apart than 0.25 s or three of the truth's periods.
/// Poses outside (by more than 1 ms) are left out and counted. Neither may be empty. Throws
/// std::runtime_error if fewer than two remain.
AssociatedTrajectories associateByTime(const Trajectory& estimate, const Trajectory& truth);

/// Row by row. Throws std::runtime_error unless both have as many rows, at least two.
AssociatedTrajectories associateByRows(const Trajectory& estimate, const Trajectory& truth);

/// Reads both files and associates them: by time if both are TUM, by rows if one is KITTI, whose rows have no
/// instants. Errors name the files.
AssociatedTrajectories associateFiles(const std::filesystem::path& estimate,
                                      const std::filesystem::path& truth);

}  // namespace cartvo
