// Reads the messages of a replay from odometry.csv.
#include "tools/evaluate/odometry_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1U << 30U;
constexpr std::size_t kMaxColumns = 1000;
constexpr std::size_t kTriangle = 21;  // values of a symmetric 6x6 matrix
constexpr std::string_view kFirstColumns = "pair,utime_us,";

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  Words words;
  while (words.size() < kMaxColumns) {
    const std::size_t comma = line.find(',');
    words.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  return words;
}

/// Indices of the columns that are read.
struct Columns {
  std::size_t count, utime, valid, reasons, reset_counter, position, orientation, velocity, rates,
      pose_covariance, twist_covariance, velocity_bound, rate_bound, motion_bound, rotation_bound;
};

/// Reads lines into rows.
class Reader {
 public:
  explicit Reader(std::string name) : name_(std::move(name)) {}

  std::vector<OdometryRow> read(std::string_view text) {
    std::vector<OdometryRow> rows;
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++line_;
      if (line_ == 1) {
        readHeader(line);
      } else if (!line.empty()) {
        rows.push_back(readRow(line));
        if (rows.size() > 1 && rows.back().time_ns < rows[rows.size() - 2].time_ns) is_sorted_ = false;
      }
    }
    if (rows.empty()) fail("has no rows; expected the odometry.csv that 'cartvo replay' writes");
    if (!is_sorted_) fail("its times decrease: the camera's clock was set back, which cannot be evaluated");
    return rows;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(name_ + ": " + what); }
  [[noreturn]] void failInLine(const std::string& what) const {
    throw std::runtime_error(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  /// Index of the first of `length` columns that belong together.
  std::size_t columnOf(const Words& names, std::string_view name, std::size_t length) const {
    for (std::size_t i = 0; i + length <= names.size(); ++i) {
      if (names[i] == name) return i;
    }
    failInLine("has no column '" + std::string(name) +
               "'; expected the odometry.csv that 'cartvo replay' writes");
  }

  void readHeader(std::string_view line) {
    const Words names = split(line);
    columns_ = {names.size(),
                columnOf(names, "utime_us", 1),
                columnOf(names, "valid", 1),
                columnOf(names, "reasons", 1),
                columnOf(names, "reset_counter", 1),
                columnOf(names, "x_m", 3),
                columnOf(names, "qw", 4),
                columnOf(names, "vx_m_s", 3),
                columnOf(names, "wx_rad_s", 3),
                columnOf(names, "pose_covariance_x_x", kTriangle),
                columnOf(names, "twist_covariance_vx_vx", kTriangle),
                columnOf(names, "velocity_bound_x", 3),
                columnOf(names, "angular_rate_bound_x", 3),
                columnOf(names, "motion_bound_x", 3),
                columnOf(names, "rotation_bound_x", 3)};
  }

  template <typename Value>
  Value number(const Words& words, std::size_t column) const {
    const std::string_view word = words[column];
    Value value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      failInLine("expected a number in column " + std::to_string(column + 1) + ", found '" +
                 printableExcerpt(word) + "'");
    }
    return value;
  }

  /// A number, or NaN for an empty cell.
  double valueOrNaN(const Words& words, std::size_t column) const {
    return words[column].empty() ? std::numeric_limits<double>::quiet_NaN() : number<double>(words, column);
  }

  Eigen::Vector3d readVector(const Words& words, std::size_t column) const {
    return {valueOrNaN(words, column), valueOrNaN(words, column + 1), valueOrNaN(words, column + 2)};
  }

  Eigen::Isometry3d readPose(const Words& words) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < 3; ++i)
      pose.translation()[static_cast<Eigen::Index>(i)] = number<double>(words, columns_.position + i);
    const std::size_t w = columns_.orientation;
    const Eigen::Quaterniond rotation(number<double>(words, w), number<double>(words, w + 1),
                                      number<double>(words, w + 2), number<double>(words, w + 3));
    constexpr double kTolerance = 1e-2;
    if (!(std::abs(rotation.norm() - 1.0) <= kTolerance) || !pose.translation().allFinite())
      failInLine("expected a position and a unit quaternion (qw qx qy qz)");
    pose.linear() = rotation.normalized().toRotationMatrix();
    return pose;
  }

  vo::Matrix6d readCovariance(const Words& words, std::size_t column) const {
    vo::Matrix6d covariance;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j)
        covariance(i, j) = covariance(j, i) = valueOrNaN(words, column++);
    }
    return covariance;
  }

  OdometryRow readRow(std::string_view line) const {
    const Words words = split(line);
    if (words.size() != columns_.count) {
      failInLine("expected " + std::to_string(columns_.count) + " columns, found " +
                 std::to_string(words.size()));
    }
    OdometryRow row;
    const auto utime = number<std::int64_t>(words, columns_.utime);
    constexpr std::int64_t kLatest_us = 9'000'000'000'000'000;  // ns fit into an int64
    if (utime < -kLatest_us || utime > kLatest_us) failInLine("expected utime_us in us since 1970");
    row.time_ns = 1000 * utime;
    row.valid = number<int>(words, columns_.valid) != 0;
    row.reasons = number<std::int32_t>(words, columns_.reasons);
    row.reset_counter = number<std::int32_t>(words, columns_.reset_counter);
    row.T_world_body = readPose(words);
    row.twist << readVector(words, columns_.velocity), readVector(words, columns_.rates);
    row.pose_covariance = readCovariance(words, columns_.pose_covariance);
    row.twist_covariance = readCovariance(words, columns_.twist_covariance);
    row.bound = {readVector(words, columns_.velocity_bound), readVector(words, columns_.rate_bound),
                 readVector(words, columns_.motion_bound), readVector(words, columns_.rotation_bound)};
    return row;
  }

  std::string name_;
  std::size_t line_ = 0;
  bool is_sorted_ = true;
  Columns columns_{};
};

}  // namespace

std::vector<OdometryRow> readOdometryFile(const std::filesystem::path& file) {
  return Reader(file.string()).read(readInputText(file, kMaxFileBytes));
}

bool isOdometryFile(const std::filesystem::path& file) {
  std::string begin(kFirstColumns.size(), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return stream && begin == kFirstColumns;
}

Trajectory bodyTrajectory(const std::vector<OdometryRow>& rows) {
  Trajectory trajectory;
  std::optional<std::int32_t> epoch;
  Eigen::Isometry3d T_first_epoch = Eigen::Isometry3d::Identity(), T_first_body = T_first_epoch;
  for (const OdometryRow& row : rows) {
    if (row.hasEstimate() && row.reset_counter != epoch) {
      epoch = row.reset_counter;
      T_first_epoch = T_first_body;
    }
    if (row.hasEstimate()) T_first_body = T_first_epoch * row.T_world_body;
    if (trajectory.empty() || row.time_ns > trajectory.back().time_ns)
      trajectory.push_back({row.time_ns, T_first_body});
  }
  return trajectory;
}

}  // namespace cartvo
