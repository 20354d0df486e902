#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tools/trajectory/trajectory.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {

/// Velocity and rates of the body at any instant, from true poses alone: cubic splines through positions and
/// unit quaternions. Poses closer together than 20 ms are thinned to that, because the noise of a position
/// (sigma) becomes one of the velocity (1.2 sigma / spacing). At a spacing h the error of an oscillation's
/// velocity is 0.1 % of its amplitude at 0.10 / h, 1 % at 0.18 / h and 10 % at 0.30 / h (5.3 Hz for poses at
/// 18 Hz, 15 Hz for those of 20 ms); faster motions are not resolved.
class TrueTwist {
 public:
  /// `truth` must be sorted by time.
  explicit TrueTwist(const Trajectory& truth);

  /// Velocity (m/s) and rates (rad/s) in body axes. Empty before the second and behind the last pose but one
  /// (by more than 1 ms), where the slope at the end counts too much, and in gaps, see InterpolatedTruth.
  std::optional<vo::Vector6d> at(std::int64_t time_ns) const;

 private:
  /// Position and quaternion (w, x, y, z).
  using Values = std::array<double, 7>;
  struct Knot {
    std::int64_t time_ns = 0;
    Values value{}, slope{};  ///< slope: per second
  };

  /// Adds the poses [first, last) of `truth`, between which there is no gap.
  void addPiece(const Trajectory& truth, std::size_t first, std::size_t last);

  std::vector<std::vector<Knot>> pieces_;
};

}  // namespace cartvo
