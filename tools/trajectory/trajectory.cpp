// Reads and writes trajectories in TUM and KITTI format.

#include "tools/trajectory/trajectory.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "common/ascii_text.hpp"
#include "common/atomic_file.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::size_t kTumNumbers = 8, kKittiNumbers = 12;
constexpr std::size_t kEurocNumbers = 17;  // pose, velocity, biases; 8 without the last nine
constexpr std::uintmax_t kMaxFileBytes = 1U << 30U;

enum class Format : std::uint8_t { tum, kitti, euroc };

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
    fail(row, "expected a number in column " + std::to_string(index + 1) + ", found '" +
                  printableExcerpt(word) + "'");
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
  if (std::abs(seconds) > kMaxSeconds) {
    fail(row,
         "expected an instant in seconds, found '" + printableExcerpt(word) +
             "': in milliseconds, microseconds or nanoseconds? (nanoseconds are read in EuRoC's files, which "
             "separate columns by commas)");
  }
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

/// Position and rotation in the columns from the second on.
Eigen::Isometry3d readPose(const Row& row, bool is_w_first) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int axis = 0; axis < 3; ++axis)
    pose.translation()[axis] = coordinate(row, 1 + axis);
  const std::size_t w = is_w_first ? 4 : 7, x = is_w_first ? 5 : 4;
  const Eigen::Quaterniond rotation(number(row, w), number(row, x), number(row, x + 1), number(row, x + 2));
  constexpr double kTolerance = 1e-2;
  if (std::abs(rotation.norm() - 1.0) > kTolerance) {
    fail(row, std::string("expected a unit quaternion (") + (is_w_first ? "qw qx qy qz" : "qx qy qz qw") +
                  ") in columns 5 to 8");
  }
  pose.linear() = rotation.normalized().toRotationMatrix();
  return pose;
}

StampedPose readEurocRow(const Row& row) {
  std::int64_t time_ns = 0;
  const std::string& word = row.words.front();
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), time_ns);
  if (error != std::errc{} || end != word.data() + word.size())
    fail(row, "expected an instant in nanoseconds, found '" + printableExcerpt(word) + "'");
  return {time_ns, readPose(row, true)};
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

/// The rows of a file, and what its comments say about them.
struct Rows {
  std::vector<Row> rows;
  Format format = Format::tum;
  bool is_w_first = false;  ///< of quaternions in TUM's format
};

/// Whether a comment or header names a quaternion's columns with w before x, such as "# t px py pz qw qx qy
/// qz".
bool namesWFirst(const std::string& text) {
  const std::string comment = lowerCase(text);
  for (const auto& [w, x] : {std::pair("qw", "qx"), std::pair("q_w", "q_x"), std::pair("q_rs_w", "q_rs_x"),
                             std::pair("orientation.w", "orientation.x")}) {
    const std::size_t at_w = comment.find(w), at_x = comment.find(x);
    if (at_w != std::string::npos && at_x != std::string::npos) return at_w < at_x;
  }
  return false;
}

/// EuRoC's rows are separated by commas and begin with an integer, ns since 1970.
bool isEurocRow(const Row& row, bool has_commas) {
  constexpr std::int64_t kMinNanoseconds = 100'000'000'000'000;
  std::int64_t value = 0;
  const std::string& word = row.words.front();
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_integer = error == std::errc{} && end == word.data() + word.size();
  return row.words.size() == kEurocNumbers ||
         (row.words.size() == kTumNumbers && has_commas && is_integer && value >= kMinNanoseconds);
}

/// The usual meaning of rows with as many numbers, and what to do.
const char* hintOf(std::size_t numbers) {
  switch (numbers) {
    case 1:
      return ": messages as text, as of 'ros2 topic echo'? Save them as TUM's rows, as by 'evo_traj "
             "--save_as_tum'";
    case 4:
      return ": positions only, or latitude and longitude? Poses in metres with rotations are needed";
    case 7:
      return ": Euler angles? Write quaternions, or is the instant missing?";
    case 16:
      return ": a 4x4 matrix? Leave out its last row; decimal commas? Write points";
    default:
      return "";
  }
}

Format formatOf(const Row& row, bool has_commas) {
  if (isEurocRow(row, has_commas)) return Format::euroc;
  if (row.words.size() == kKittiNumbers) return Format::kitti;
  if (row.words.size() == kTumNumbers) return Format::tum;
  fail(row,
       "expected 8 numbers (TUM: seconds x y z qx qy qz qw), 12 (KITTI: a 3x4 matrix), or 8 or 17 after "
       "commas "
       "(EuRoC: ns x y z qw qx qy qz ...), found " +
           std::to_string(row.words.size()) + hintOf(row.words.size()));
}

/// Where a line's comment begins: at '#', or at its start if it begins with '%' or '//', or is a header of
/// names in front of the rows. Its length if it has none.
std::size_t beginOfComment(const std::string& line, bool is_in_front) {
  const std::size_t first = std::min(line.find_first_not_of(" \t\""), line.size());
  const std::string_view content = std::string_view(line).substr(first);
  const std::string word = lowerCase(content.substr(0, content.find_first_of(" \t,;")));
  const bool is_header = is_in_front && !word.empty() && word.front() >= 'a' && word.front() <= 'z' &&
                         word != "nan" && word != "inf";
  if (is_header || content.starts_with('%') || content.starts_with("//")) return 0;
  return std::min(line.find('#'), line.size());
}

/// Makes blanks of the separators: semicolons, with commas as decimal points, or else commas. Whether there
/// was one.
bool replaceSeparators(std::string& line) {
  const bool has_semicolons = line.find(';') != std::string::npos;
  if (has_semicolons) std::replace(line.begin(), line.end(), ',', '.');
  const char separator = has_semicolons ? ';' : ',';
  const bool is_found = line.find(separator) != std::string::npos;
  std::replace(line.begin(), line.end(), separator, ' ');
  return is_found;
}

/// Reads all rows that are not empty, without comments. Blanks, commas or semicolons separate the columns.
Rows readRows(const std::filesystem::path& file) {
  std::istringstream stream(readInputText(file, kMaxFileBytes));
  Rows read;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::size_t comment = beginOfComment(line, read.rows.empty());
    read.is_w_first = read.is_w_first || namesWFirst(line.substr(comment));
    line.resize(comment);
    const bool has_commas = replaceSeparators(line);
    std::istringstream words(line);
    Row row{file.string() + ":" + std::to_string(number) + ": ", {}};
    for (std::string word; words >> word;)
      row.words.push_back(word);
    if (row.words.empty()) continue;
    const std::size_t count = row.words.size();
    if (read.rows.empty()) read.format = formatOf(row, has_commas);
    if (!read.rows.empty() && count != read.rows.front().words.size()) {
      fail(row, "expected " + std::to_string(read.rows.front().words.size()) +
                    " numbers as in the rows before, found " + std::to_string(count));
    }
    read.rows.push_back(std::move(row));
  }
  if (read.rows.empty()) throw std::runtime_error(file.string() + ": contains no poses");
  return read;
}

StampedPose readRow(const Rows& read, const Row& row, std::size_t index) {
  if (read.format == Format::kitti) return readKittiRow(row, index);
  if (read.format == Format::euroc) return readEurocRow(row);
  return {nanoseconds(row), readPose(row, read.is_w_first)};
}

/// The start of the first line of a file that states its frame.
std::string frameText(TrajectoryFrame frame) {
  const char* axes =
      frame == TrajectoryFrame::left_camera ? " (x right, y down, z forward)" : " (x forward, y left, z up)";
  return std::string("# poses of ") + frameName(frame) + axes;
}

}  // namespace

/// In the order of the enumeration.
const char* frameName(TrajectoryFrame frame) {
  static constexpr std::array kNames{"an unknown frame", "the left camera", "the left camera, mount unknown",
                                     "the cart's body"};
  return kNames.at(static_cast<std::size_t>(frame));
}

TrajectoryFrame frameOf(const std::filesystem::path& file) {
  const std::string text = readInputText(file, kMaxFileBytes);
  for (const TrajectoryFrame frame :
       {TrajectoryFrame::left_camera, TrajectoryFrame::unmounted_camera, TrajectoryFrame::body}) {
    if (text.starts_with(frameText(frame))) return frame;
  }
  return isKittiTrajectory(file) ? TrajectoryFrame::left_camera : TrajectoryFrame::unknown;
}

Trajectory readTrajectory(const std::filesystem::path& file) {
  const Rows read = readRows(file);
  Trajectory trajectory;
  trajectory.reserve(read.rows.size());
  for (const Row& row : read.rows) {
    const StampedPose stamped = readRow(read, row, trajectory.size());
    if (!trajectory.empty() && stamped.time_ns <= trajectory.back().time_ns) {
      fail(row, "expected instants that increase from row to row");
    }
    trajectory.push_back(stamped);
  }
  return trajectory;
}

bool isKittiTrajectory(const std::filesystem::path& file) {
  return readRows(file).format == Format::kitti;
}

double pathLength(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    length += (trajectory[i].pose.translation() - trajectory[i - 1].pose.translation()).norm();
  return length;
}

void writeTum(const std::filesystem::path& file, const Trajectory& trajectory, TrajectoryFrame frame) {
  std::string text =
      (frame == TrajectoryFrame::unknown ? "# " : frameText(frame) + ": ") + "seconds x y z qx qy qz qw\n";
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

void writeKitti(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::string text;
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

void writeEuroc(const std::filesystem::path& file, const Trajectory& trajectory) {
  std::string text =
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z "
      "[]\n";
  char row[256];
  for (const auto& [time_ns, pose] : trajectory) {
    const Eigen::Quaterniond q(pose.linear());
    const Eigen::Vector3d t = pose.translation();
    std::snprintf(row, sizeof row, "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n",
                  static_cast<long long>(time_ns), t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
    text += row;
  }
  writeResultFile(file, text);
}

}  // namespace cartvo
