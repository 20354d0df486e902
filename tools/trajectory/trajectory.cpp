// Reads and writes trajectories in TUM and KITTI format.

#include "tools/trajectory/trajectory.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kTumNumbers = 8, kKittiNumbers = 12;

/// One line of a trajectory file: its place and its words.
struct Row {
  std::string place;  ///< "FILE:LINE: "
  std::vector<std::string> words;
};

[[noreturn]] void fail(const Row& row, const std::string& what) {
  throw std::runtime_error(row.place + what);
}

double number(const Row& row, std::size_t index) {
  const std::string& word = row.words[index];
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    fail(row, "expected a number in column " + std::to_string(index + 1) + ", found '" + word + "'");
  }
  return value;
}

/// Coordinate in metres. Rejects larger values than 1e9 m, which could not be written back with nine
/// decimals.
double coordinate(const Row& row, std::size_t index) {
  constexpr double kMaxCoordinate = 1e9;
  const double value = number(row, index);
  if (std::abs(value) > kMaxCoordinate)
    fail(row, "expected metres in column " + std::to_string(index + 1) + ", at most 1e9");
  return value;
}

/// Parses decimal seconds to ns exactly: a double resolves times since 1970 only to 0.2 us.
std::int64_t nanoseconds(const Row& row) {
  const std::string& word = row.words.front();
  const double seconds = number(row, 0);
  constexpr double kMaxSeconds = 9e9;  // limit of ns in an int64
  if (std::abs(seconds) > kMaxSeconds) fail(row, "expected an instant in seconds, found '" + word + "'");
  const std::size_t point = word.find('.');
  const std::string_view whole = std::string_view(word).substr(0, point);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), value);
  const bool is_plain = error == std::errc{} && end == whole.data() + whole.size() && word.front() != '-' &&
                        word.find_first_of("eE") == std::string::npos;
  if (!is_plain) return std::llround(seconds * static_cast<double>(kNanosecondsPerSecond));
  std::string decimals = point == std::string::npos ? "" : word.substr(point + 1);
  decimals.resize(9, '0');
  return value * kNanosecondsPerSecond + std::stoll(decimals);
}

StampedPose readTumRow(const Row& row) {
  StampedPose stamped;
  stamped.time_ns = nanoseconds(row);
  for (int axis = 0; axis < 3; ++axis)
    stamped.pose.translation()[axis] = coordinate(row, 1 + axis);
  const Eigen::Quaterniond rotation(number(row, 7), number(row, 4), number(row, 5), number(row, 6));
  constexpr double kTolerance = 1e-2;
  if (std::abs(rotation.norm() - 1.0) > kTolerance) {
    fail(row, "expected a unit quaternion (qx qy qz qw) in columns 5 to 8");
  }
  stamped.pose.linear() = rotation.normalized().toRotationMatrix();
  return stamped;
}

StampedPose readKittiRow(const Row& row, std::size_t index) {
  StampedPose stamped;
  stamped.time_ns = static_cast<std::int64_t>(index);
  Eigen::Matrix3d R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      R(i, j) = number(row, 4 * i + j);
    stamped.pose.translation()[i] = coordinate(row, 4 * i + 3);
  }
  constexpr double kTolerance = 1e-3;
  if (!(R * R.transpose()).isIdentity(kTolerance) || R.determinant() < 0.0) {
    fail(row, "expected the rows of a 3x4 pose; its left 3x3 part is not a rotation");
  }
  stamped.pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return stamped;
}

/// Reads all rows that are not empty, without comments.
std::vector<Row> readRows(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw std::runtime_error(file.string() +
                             ": cannot be read; expected a trajectory in TUM or KITTI format");
  }
  std::vector<Row> rows;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    Row row{file.string() + ":" + std::to_string(number) + ": ", {}};
    for (std::string word; words >> word;)
      row.words.push_back(word);
    if (row.words.empty()) continue;
    const std::size_t count = row.words.size();
    if (count != kTumNumbers && count != kKittiNumbers) {
      fail(row, "expected 8 numbers (TUM: seconds x y z qx qy qz qw) or 12 (KITTI: a 3x4 matrix), found " +
                    std::to_string(count));
    }
    if (!rows.empty() && count != rows.front().words.size()) {
      fail(row, "expected " + std::to_string(rows.front().words.size()) +
                    " numbers as in the rows before, found " + std::to_string(count));
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw std::runtime_error(file.string() + ": contains no poses");
  return rows;
}

bool isKitti(const std::vector<Row>& rows) {
  return rows.front().words.size() == kKittiNumbers;
}

/// The start of the first line of a file that states its frame.
std::string frameText(TrajectoryFrame frame) {
  const char* axes =
      frame == TrajectoryFrame::body ? " (x forward, y left, z up)" : " (x right, y down, z forward)";
  return std::string("# poses of ") + frameName(frame) + axes;
}

/// The first line of a file.
std::string firstLine(TrajectoryFrame frame, const char* columns) {
  return (frame == TrajectoryFrame::unknown ? "# " : frameText(frame) + ": ") + columns + "\n";
}

}  // namespace

const char* frameName(TrajectoryFrame frame) {
  switch (frame) {
    case TrajectoryFrame::left_camera:
      return "the left camera";
    case TrajectoryFrame::body:
      return "the cart's body";
    case TrajectoryFrame::unknown:
      break;
  }
  return "an unknown frame";
}

TrajectoryFrame frameOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  for (const TrajectoryFrame frame : {TrajectoryFrame::left_camera, TrajectoryFrame::body}) {
    if (line.starts_with(frameText(frame))) return frame;
  }
  return TrajectoryFrame::unknown;
}

Trajectory readTrajectory(const std::filesystem::path& file) {
  const std::vector<Row> rows = readRows(file);
  Trajectory trajectory;
  trajectory.reserve(rows.size());
  for (const Row& row : rows) {
    const StampedPose stamped = isKitti(rows) ? readKittiRow(row, trajectory.size()) : readTumRow(row);
    if (!trajectory.empty() && stamped.time_ns <= trajectory.back().time_ns) {
      fail(row, "expected instants that increase from row to row");
    }
    trajectory.push_back(stamped);
  }
  return trajectory;
}

bool isKittiTrajectory(const std::filesystem::path& file) {
  return isKitti(readRows(file));
}

void writeTum(const std::filesystem::path& file, const Trajectory& trajectory, TrajectoryFrame frame) {
  std::string text = firstLine(frame, "seconds x y z qx qy qz qw");
  char row[256];
  for (const auto& [time_ns, pose] : trajectory) {
    const Eigen::Quaterniond q(pose.linear());
    const Eigen::Vector3d t = pose.translation();
    const bool is_negative = time_ns < 0;
    const std::uint64_t distance = is_negative ? -static_cast<std::uint64_t>(time_ns) : time_ns;
    std::snprintf(row, sizeof row, "%s%lld.%09lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  is_negative ? "-" : "", static_cast<long long>(distance / kNanosecondsPerSecond),
                  static_cast<long long>(distance % kNanosecondsPerSecond), t.x(), t.y(), t.z(), q.x(), q.y(),
                  q.z(), q.w());
    text += row;
  }
  writeResultFile(file, text);
}

void writeKitti(const std::filesystem::path& file, const Trajectory& trajectory, TrajectoryFrame frame) {
  std::string text;
  if (frame != TrajectoryFrame::unknown) text = firstLine(frame, "3x4 matrix, row by row");
  char word[32];
  for (const auto& [time_ns, pose] : trajectory) {
    for (int element = 0; element < 12; ++element) {
      std::snprintf(word, sizeof word, "%s%.9e", element == 0 ? "" : " ",
                    pose.matrix()(element / 4, element % 4));
      text += word;
    }
    text += '\n';
  }
  writeResultFile(file, text);
}

}  // namespace cartvo
