// Compares the messages of a replay with a truth file.
#include "tools/evaluate/compared_messages.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "common/input_file.hpp"

namespace cartvo {
namespace {

/// T_body_camera of a replay's summary.json.
Eigen::Isometry3d bodyFromCamera(const std::filesystem::path& summary) {
  constexpr std::uintmax_t kMaxBytes = 1U << 26U;
  constexpr std::size_t kNumbers = 12;
  const nlohmann::json json = nlohmann::json::parse(readInputText(summary, kMaxBytes), nullptr, false);
  const nlohmann::json matrix = json.is_object() && json.contains("rig") && json["rig"].is_object()
                                    ? json["rig"].value("T_body_camera", nlohmann::json())
                                    : nlohmann::json();
  const bool is_matrix =
      matrix.is_array() && matrix.size() == kNumbers &&
      std::all_of(matrix.begin(), matrix.end(), [](const auto& v) { return v.is_number(); });
  if (!is_matrix) {
    throw std::runtime_error(
        summary.string() +
        ": has no rig.T_body_camera of 12 numbers, with which a truth of the left camera is "
        "converted to the body; replay with this release of cartvo");
  }
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < kNumbers; ++i)
    T_body_camera.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) = matrix.at(i).get<double>();
  return T_body_camera;
}

void takeTimes(const std::vector<OdometryRow>& rows, Trajectory& truth) {
  if (rows.size() != truth.size()) {
    throw std::runtime_error("has " + std::to_string(truth.size()) + " poses for " +
                             std::to_string(rows.size()) +
                             " messages; KITTI rows have no times, so there must be one for each message");
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    truth[i].time_ns = rows[i].time_ns;
}

}  // namespace

Trajectory readBodyTruth(const std::filesystem::path& truth, const std::filesystem::path& odometry,
                         const std::vector<OdometryRow>& rows) {
  Trajectory poses = readTrajectory(truth);
  const bool is_kitti = isKittiTrajectory(truth);
  try {
    if (is_kitti) takeTimes(rows, poses);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(truth.string() + ": " + error.what());
  }
  if (frameOf(truth) != TrajectoryFrame::left_camera) return poses;
  const Eigen::Isometry3d T_body_camera = bodyFromCamera(odometry.parent_path() / "summary.json");
  for (StampedPose& stamped : poses)
    stamped.pose = T_body_camera * stamped.pose * T_body_camera.inverse();
  return poses;
}

std::vector<ComparedMessage> compareMessages(const std::filesystem::path& odometry,
                                             const std::filesystem::path& truth, std::int64_t offset_ns) {
  std::vector<OdometryRow> rows = readOdometryFile(odometry);
  for (OdometryRow& row : rows)
    row.time_ns += offset_ns;
  std::vector<ComparedMessage> compared = compareMotion(rows, readBodyTruth(truth, odometry, rows));
  const bool has_truth = std::any_of(compared.begin(), compared.end(), [](const ComparedMessage& message) {
    return message.true_twist.allFinite();
  });
  if (!has_truth) {
    throw std::runtime_error(odometry.string() + " and " + truth.string() +
                             ": no message has a truth at its time; check that both use the same clock");
  }
  return compared;
}

}  // namespace cartvo
