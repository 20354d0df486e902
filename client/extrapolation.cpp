// Motion of a constant twist on SE(3), with its covariance.

#include <algorithm>
#include <array>
#include <cmath>

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

using Vector3 = std::array<double, 3>;
using Quaternion = std::array<double, 4>;  // w x y z
using Matrix6 = std::array<double, 36>;    // row-major

constexpr int kSide = 6;
/// Terms of the exponential series. With 10 rad of rotation, the most that OdometryLimits admit, the
/// remainder is below 1e-13.
constexpr int kTerms = 48;

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector3 scaled(const Vector3& a, double factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}

Vector3 sum(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Vector3 rotate(const Quaternion& q, const Vector3& v) {
  const Vector3 axis{q[1], q[2], q[3]};
  const Vector3 twice = scaled(cross(axis, v), 2.0);
  return sum(v, sum(scaled(twice, q[0]), cross(axis, twice)));
}

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion normalized(const Quaternion& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm};
}

Quaternion rotationBy(const Vector3& angle) {
  const double norm = std::sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2]);
  const double factor = norm > 1e-9 ? std::sin(0.5 * norm) / norm : 0.5;
  return {std::cos(0.5 * norm), factor * angle[0], factor * angle[1], factor * angle[2]};
}

/// Translation of the exponential of (shift, angle): the sum of [angle]x^k shift / (k + 1)!.
Vector3 translationBy(const Vector3& shift, const Vector3& angle) {
  Vector3 term = shift, translation = shift;
  for (int k = 1; k < kTerms; ++k) {
    term = scaled(cross(angle, term), 1.0 / (k + 1));
    translation = sum(translation, term);
  }
  return translation;
}

Matrix6 product(const Matrix6& a, const Matrix6& b) {
  Matrix6 c{};
  for (int i = 0; i < kSide; ++i) {
    for (int k = 0; k < kSide; ++k) {
      for (int j = 0; j < kSide; ++j)
        c[i * kSide + j] += a[i * kSide + k] * b[k * kSide + j];
    }
  }
  return c;
}

/// A C A^T.
Matrix6 propagated(const Matrix6& a, const Matrix6& covariance) {
  Matrix6 transposed{};
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j)
      transposed[j * kSide + i] = a[i * kSide + j];
  }
  return product(product(a, covariance), transposed);
}

Matrix6 identity() {
  Matrix6 matrix{};
  for (int i = 0; i < kSide; ++i)
    matrix[i * kSide + i] = 1.0;
  return matrix;
}

/// The negative adjoint of the twist (shift, angle): -[[angle]x, [shift]x; 0, [angle]x].
Matrix6 negativeAdjoint(const Vector3& shift, const Vector3& angle) {
  Matrix6 matrix{};
  const auto set = [&matrix](int row, int column, const Vector3& v) {
    const std::array<double, 9> negative{0, v[2], -v[1], -v[2], 0, v[0], v[1], -v[0], 0};
    for (int i = 0; i < 9; ++i)
      matrix[(row + i / 3) * kSide + column + i % 3] = negative[i];
  };
  set(0, 0, angle);
  set(0, 3, shift);
  set(3, 3, angle);
  return matrix;
}

/// How errors before a motion and of its twist appear after it, both on the right side.
struct ErrorTransition {
  Matrix6 of_pose = identity();   ///< adjoint of the inverse motion: sum of (-ad)^k / k!
  Matrix6 of_twist = identity();  ///< right Jacobian: sum of (-ad)^k / (k + 1)!
};

ErrorTransition errorTransition(const Vector3& shift, const Vector3& angle) {
  const Matrix6 adjoint = negativeAdjoint(shift, angle);
  ErrorTransition transition;
  Matrix6 term = identity();
  for (int k = 1; k < kTerms; ++k) {
    term = product(term, adjoint);
    double largest = 0.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      term[i] /= k;
      transition.of_pose[i] += term[i];
      transition.of_twist[i] += term[i] / (k + 1);
      largest = std::max(largest, std::abs(term[i]));
    }
    if (largest < 1e-18) break;
  }
  return transition;
}

template <typename Array, std::size_t Count>
Array toArray(const double (&values)[Count]) {
  Array array{};
  std::copy(values, values + Count, array.begin());
  return array;
}

/// Adds the variances of translation and rotation to the diagonal.
void addVariances(Matrix6& covariance, double translation_stddev, double rotation_stddev) {
  for (int i = 0; i < kSide; ++i) {
    const double stddev = i < 3 ? translation_stddev : rotation_stddev;
    covariance[i * kSide + i] += stddev * stddev;
  }
}

}  // namespace

Motion extrapolate(const odometry_t& message, std::int64_t utime, const MotionNoise& noise) {
  const std::int64_t age = std::max<std::int64_t>(ageUs(message, utime), 0);
  const double dt = 1e-6 * static_cast<double>(age);
  Motion motion;
  motion.utime = message.utime + age;
  motion.velocity = toArray<Vector3>(message.velocity_body);
  motion.angular_velocity = toArray<Vector3>(message.angular_velocity_body);
  const Vector3 shift = scaled(motion.velocity, dt), angle = scaled(motion.angular_velocity, dt);

  const Quaternion start = normalized(toArray<Quaternion>(message.orientation_world_body));
  motion.position =
      sum(toArray<Vector3>(message.position_world_body), rotate(start, translationBy(shift, angle)));
  motion.orientation = normalized(product(start, rotationBy(angle)));

  const ErrorTransition transition = errorTransition(shift, angle);
  const Matrix6 twist_covariance = toArray<Matrix6>(message.twist_covariance_body);
  const Matrix6 of_pose = propagated(transition.of_pose, toArray<Matrix6>(message.pose_covariance_body));
  const Matrix6 of_twist = propagated(transition.of_twist, twist_covariance);
  for (int i = 0; i < kSide * kSide; ++i)
    motion.pose_covariance[i] = of_pose[i] + of_twist[i] * dt * dt;
  addVariances(motion.pose_covariance, 0.5 * noise.acceleration * dt * dt,
               0.5 * noise.angular_acceleration * dt * dt);
  motion.twist_covariance = twist_covariance;
  addVariances(motion.twist_covariance, noise.acceleration * dt, noise.angular_acceleration * dt);
  return motion;
}

}  // namespace cartvo::client
