// Samples of pairs; the last minute and the path, as the status page plots them.
#include "daemon/page/page_history.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace cartvo::daemon {
namespace {

constexpr int kDigits = 6;          // of a measured number
constexpr int kIntegerDigits = 17;  // of times in us
constexpr std::size_t kFirstMeasured = 5;

Eigen::Quaterniond orientationOf(const odometry_t& message) {
  const double* q = message.orientation_world_body;
  return {q[0], q[1], q[2], q[3]};
}

/// Standard deviation of the element on the diagonal of a 6x6 covariance.
double stddev(const double (&covariance)[36], int element) {
  return std::sqrt(std::max(covariance[7 * element], 0.0));
}

template <typename Iterator>
std::string arrayJson(Iterator begin, Iterator end) {
  std::string json = "[";
  for (Iterator sample = begin; sample != end; ++sample) {
    if (sample != begin) json += ',';
    appendJson(*sample, json);
  }
  return json + "]";
}

}  // namespace

PageSample pageSample(const odometry_t& message, double process) {
  const Eigen::Matrix3d R = orientationOf(message).toRotationMatrix();
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> pose(message.pose_covariance_body);
  const Eigen::Matrix3d position = R * pose.topLeftCorner<3, 3>() * R.transpose();
  const bool has_times = message.arrival_utime != 0 && message.publication_utime != 0;
  const double latency_ms =
      has_times ? 1e-3 * static_cast<double>(message.publication_utime - message.arrival_utime) : NAN;
  const double* v = message.velocity_body;
  const double* w = message.angular_velocity_body;
  const auto& twist = message.twist_covariance_body;
  return {{static_cast<double>(message.sequence),
           static_cast<double>(message.utime),
           message.status == odometry_t::VALID ? 1.0 : 0.0,
           static_cast<double>(message.reasons),
           static_cast<double>(message.reset_counter),
           message.position_world_body[0],
           message.position_world_body[1],
           message.position_world_body[2],
           std::atan2(R(1, 0), R(0, 0)),
           position(0, 0),
           position(0, 1),
           position(1, 1),
           v[0],
           stddev(twist, 0),
           w[0],
           stddev(twist, 3),
           w[1],
           stddev(twist, 4),
           w[2],
           stddev(twist, 5),
           latency_ms,
           1e3 * process,
           1e-3 * static_cast<double>(message.offset_us),
           static_cast<double>(message.features),
           static_cast<double>(message.tracked),
           static_cast<double>(message.inliers),
           static_cast<double>(message.quality),
           message.velocity_bound[0],
           message.angular_rate_bound[0],
           message.angular_rate_bound[1],
           message.angular_rate_bound[2],
           *std::max_element(std::begin(message.motion_bound), std::end(message.motion_bound)),
           *std::max_element(std::begin(message.rotation_bound), std::end(message.rotation_bound))}};
}

void appendNumber(double value, int digits, std::string& json) {
  if (!std::isfinite(value)) {
    json += "null";
    return;
  }
  fmt::format_to(std::back_inserter(json), "{:.{}g}", value, digits);
}

void appendJson(const PageSample& sample, std::string& json) {
  json += '[';
  for (std::size_t i = 0; i < sample.values.size(); ++i) {
    if (i > 0) json += ',';
    appendNumber(sample.values[i], i < kFirstMeasured ? kIntegerDigits : kDigits, json);
  }
  json += ']';
}

void PageHistory::add(const PageSample& sample) {
  // A clock that was set back begins a new minute.
  if (!samples_.empty() && sample.utime() < samples_.back().utime() - kSpan_us) samples_.clear();
  samples_.push_back(sample);
  while (samples_.size() > kMaxSamples || samples_.front().utime() < sample.utime() - kSpan_us)
    samples_.pop_front();
  if (sample.isValid()) addToPath(sample);
}

void PageHistory::addToPath(const PageSample& sample) {
  if (!path_.empty() && path_.back().epoch() == sample.epoch() &&
      std::hypot(sample.x() - path_.back().x(), sample.y() - path_.back().y()) < spacing_)
    return;
  path_.push_back(sample);
  if (path_.size() <= kMaxPathPoints) return;
  spacing_ *= 2.0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < path_.size(); i += 2)
    path_[kept++] = path_[i];
  path_.resize(kept);
}

std::string PageHistory::newestJson(std::size_t count) const {
  const auto begin = samples_.end() - static_cast<std::ptrdiff_t>(std::min(count, samples_.size()));
  return arrayJson(begin, samples_.end());
}

std::string PageHistory::json() const {
  return "{\"samples\":" + arrayJson(samples_.begin(), samples_.end()) +
         ",\"path\":" + arrayJson(path_.begin(), path_.end()) + "}";
}

}  // namespace cartvo::daemon
