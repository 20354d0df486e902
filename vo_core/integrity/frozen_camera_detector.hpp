#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "vo_core/integrity/standstill.hpp"

namespace cartvo::vo {

/// The right camera, localised by its own image.
struct RightDisplacement {
  Eigen::Isometry3d motion;                ///< from its place by the left camera's pose to its own pose
  int landmarks = 0;                       ///< number of inliers
  Matrix6d covariance = Matrix6d::Zero();  ///< of a perturbation on the right, m and rad
};

/// Motion of the right camera while the left image shows a standstill.
enum class RightMotion : std::uint8_t {
  unknown,
  moves,  ///< has moved relative to the left camera, or cannot be localised while the left image repeats
  stays,  ///< has stayed in place for the duration of a standstill
};

/// Compares left images that show a standstill with the right camera. It must stay in place relative to the
/// left one; if it moves, the left camera is frozen and continues to send.
class FrozenCameraDetector {
 public:
  explicit FrozenCameraDetector(const StandstillSettings& settings);

  /// Discards the right camera's place.
  void reset() { start_.reset(); }
  /// Whether the right camera's place is known.
  bool isActive() const { return start_.has_value(); }

  /// Begins at the pair before the left image showed a standstill. `slack`: maximum motion (m and rad) of the
  /// right camera's place if the cart has stopped since: at its own exposure it was extrapolated from a
  /// motion that has ended.
  void start(const RightDisplacement& displacement, std::int64_t exposure_ns, const Vector6d& slack);

  /// Compares the next pair with the right camera's place at the start, or after it has moved.
  /// `displacement`: empty if the right camera cannot be localised.
  RightMotion update(const std::optional<RightDisplacement>& displacement, std::int64_t exposure_ns,
                     bool left_repeats);

 private:
  struct Start {
    RightDisplacement displacement;
    std::int64_t since_ns;
    std::optional<Vector6d> departure;  ///< of the last pair, if that showed a motion by itself
  };

  bool hasMoved(const RightDisplacement& now);

  StandstillSettings settings_;
  StandstillDetector limits_;
  std::optional<Start> start_;
};

}  // namespace cartvo::vo
