#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "vo_core/rigid_motion.hpp"

// Continuous motion of the left camera.

namespace cartvo::vo {

/// Uniform cubic B-splines of position and rotation, the latter cumulative (C. Sommer et al., "Efficient
/// derivative computation for cumulative B-splines on Lie groups", 2020). Four knots, which the curve does
/// not pass through, define it between two instants that are one interval apart.
class Trajectory {
 public:
  static constexpr int kSupport = 4;  ///< knots that an instant depends on

  /// The camera at an instant, and the derivatives of its pose by perturbations of its knots.
  struct Instant {
    int first = 0;                                       ///< index of the first of its knots
    Eigen::Matrix3d rotation;                            ///< of T_world_camera
    Eigen::Vector3d position;                            ///< m, of T_world_camera
    Eigen::Vector3d velocity;                            ///< m/s, in the world's axes
    Eigen::Vector3d rate;                                ///< rad/s, in the camera's axes
    Eigen::Vector3d acceleration;                        ///< m/s^2, in the world's axes
    Eigen::Vector3d angular_acceleration;                ///< rad/s^2, derivative of `rate`
    std::array<double, kSupport> by_knot;                ///< of the position by those of the knots
    std::array<double, kSupport> velocity_by_knot;       ///< 1/s
    std::array<Eigen::Matrix3d, kSupport> turn_by_knot;  ///< of the rotation; perturbations on the right

    Eigen::Isometry3d pose() const;
  };

  Trajectory() = default;
  /// A camera that rests at `pose` from `start` (s) until the end of the first interval (s).
  Trajectory(double start, double interval, const Eigen::Isometry3d& pose);

  /// Instants outside of start() to end() continue the first and the last interval's polynomials.
  Instant at(double time) const;

  double start() const { return start_; }                                                     ///< s
  double end() const { return start_ + interval_ * static_cast<double>(knots_.size() - 3); }  ///< s
  double interval() const { return interval_; }                                               ///< s
  int size() const { return static_cast<int>(knots_.size()); }
  const Eigen::Isometry3d& knot(int i) const { return knots_[static_cast<std::size_t>(i)]; }
  /// s, instant that a knot is nearest to.
  double timeOf(int i) const { return start_ + interval_ * (i - 1); }

  /// Moves a knot by a perturbation: position in the world's axes, rotation on the right; m and rad.
  void move(int i, const Vector6d& step);
  void set(int i, const Eigen::Isometry3d& knot);
  /// Appends knots at constant velocity until end() is at least `time` (s).
  void extendTo(double time);
  void removeOldest(int count);

  /// Factors of a third difference.
  static constexpr std::array<double, kSupport> kThirdDifference{-1.0, 3.0, -3.0, 1.0};
  /// Third differences of four knots from `first` on: those of a constant acceleration are zero. m and rad.
  Vector6d thirdDifferences(int first) const;
  /// Derivatives of those of the rotations by the perturbations of the knots; those of the positions are
  /// kThirdDifference.
  std::array<Eigen::Matrix3d, kSupport> turnDifferencesByKnot(int first) const;

 private:
  /// From one knot to the next.
  struct Turn {
    Eigen::Vector3d vector;   ///< rotation vector
    Eigen::Matrix3d by_next;  ///< derivative by the next knot; transposed and negative, that by the first one
  };
  const Turn& turnFrom(int i) const { return turns_[static_cast<std::size_t>(i)]; }
  void updateTurn(int i);

  double start_ = 0.0, interval_ = 1.0;
  std::vector<Eigen::Isometry3d> knots_;
  std::vector<Turn> turns_;  ///< one less than knots
};

}  // namespace cartvo::vo
