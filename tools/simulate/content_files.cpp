// Writes images, instants, rig and ground truth of a content as files.
#include "tools/simulate/content_files.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "calib/format/rig_file.hpp"
#include "calib/format/ros_rig.hpp"
#include "capture/recording/recording_writer.hpp"
#include "common/atomic_file.hpp"
#include "tools/simulate/truth.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTruthFile = "truth.tum";

std::string decimalSeconds(std::int64_t time_ns) {
  const std::int64_t magnitude = time_ns < 0 ? -time_ns : time_ns;
  char text[40];
  std::snprintf(text, sizeof text, "%s%lld.%09lld", time_ns < 0 ? "-" : "",
                static_cast<long long>(magnitude / 1'000'000'000),
                static_cast<long long>(magnitude % 1'000'000'000));
  return text;
}

/// The text of a trajectory in TUM's format with `by_ns` added to its instants, which have nine decimals and
/// are not negative.
std::string shiftedTum(const std::string& text, std::int64_t by_ns) {
  std::istringstream lines(text);
  std::string shifted;
  for (std::string line; std::getline(lines, line); shifted += line + "\n") {
    if (line.starts_with('#')) continue;
    const std::size_t point = line.find('.'), end = line.find(' ');
    const std::int64_t time_ns = std::stoll(line.substr(0, point)) * 1'000'000'000 +
                                 std::stoll(line.substr(point + 1, end - point - 1));
    line.replace(0, end, decimalSeconds(time_ns + by_ns));
  }
  return shifted;
}

void writeImage(const fs::path& folder, int index, const cv::Mat& image) {
  char name[24];
  std::snprintf(name, sizeof name, "%06d.png", index);
  const fs::path file = folder / name;
  if (!cv::imwrite(file.string(), image)) throw std::runtime_error(file.string() + ": cannot be written");
}

/// Lets `fill` write into a new folder beside `folder` and renames that. Throws std::runtime_error if
/// `folder` exists and is not empty.
template <typename Fill>
void fillFolder(const fs::path& folder, Fill fill) {
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder))) {
    throw std::runtime_error(folder.string() + ": exists and is not empty; name a new folder");
  }
  fs::path partial = fs::absolute(folder).lexically_normal();
  if (!partial.has_filename()) partial = partial.parent_path();
  partial += ".partial";
  fs::remove_all(partial);  // from an interrupted run
  UnfinishedFolder unfinished(partial);
  fill(partial);
  fs::rename(partial, folder);
  unfinished.keep();
}

/// A picture of a simulated camera as a live one would have been received: its sender reports are exact.
capture::EncodedUnit recordedUnit(const EncodedStream& stream, std::size_t index) {
  constexpr std::int64_t kReportPrecision_ns = 1000;
  const AccessUnit& picture = stream.units[index];
  const std::span<const std::uint8_t> bytes = stream.data(picture);
  capture::EncodedUnit unit;
  unit.data.assign(bytes.begin(), bytes.end());
  unit.pts = std::llround(static_cast<double>(picture.instant_ns - stream.units.front().instant_ns) * 90e-6);
  unit.exposure_ns = kRecordedEpoch_ns + picture.instant_ns;
  unit.exposure_stddev_ns = kReportPrecision_ns;
  unit.min_delay_arrival_ns = unit.first_arrival_ns = unit.arrival_ns = unit.exposure_ns;
  unit.reference_us = unit.exposure_ns / kReportPrecision_ns;
  unit.sequence = index;
  unit.instant_source = capture::InstantSource::sender_report;
  unit.key = picture.key_frame;
  return unit;
}

}  // namespace

void writeDescription(const fs::path& folder, const ContentDescription& drive) {
  createFolders(folder);
  const std::map<std::string, std::string> written = drive.writtenFiles();
  for (const auto& [name, text] : written)
    if (name != kTruthFile) writeResultFile(folder / name, text);
  if (!written.empty()) return;
  const calib::Rig rig = drive.rig();
  calib::writeRig(folder / "rig.yaml", rig);
  std::string left_times;
  std::string right_times;
  for (int index = 0; index < drive.pairCount(); ++index) {
    left_times += decimalSeconds(drive.leftInstant(index)) + "\n";
    right_times += decimalSeconds(drive.rightInstant(index)) + "\n";
  }
  writeResultFile(folder / "times_0.txt", left_times);
  writeResultFile(folder / "times_1.txt", right_times);
  const Trajectory truth = drive.truth();
  if (!truth.empty()) writeKitti(folder / "poses.txt", cameraTrajectory(truth, rig));
}

void writeTruth(const fs::path& folder, const ContentDescription& drive, std::int64_t epoch_ns) {
  const std::map<std::string, std::string> written = drive.writtenFiles();
  if (!written.empty())
    return writeResultFile(folder / kTruthFile, shiftedTum(written.at(kTruthFile), epoch_ns));
  const Trajectory truth = drive.denseTruth();
  if (!truth.empty()) writeTum(folder / kTruthFile, shifted(truth, epoch_ns), TrajectoryFrame::body);
}

std::optional<fs::path> keepEarlierTruth(const fs::path& folder) {
  const fs::path file = folder / kTruthFile;
  if (!fs::exists(file)) return std::nullopt;
  const std::int64_t second = readTrajectory(file).front().time_ns / 1'000'000'000;
  const fs::path kept = folder / ("truth-" + std::to_string(second) + ".tum");
  if (fs::exists(kept)) {
    throw std::runtime_error(file.string() + ": would be replaced, and " + kept.string() +
                             " exists too; move one of them away, or name another --output-dir");
  }
  fs::rename(file, kept);
  return kept;
}

void renderFolder(const fs::path& folder, const Content& content, const Progress& progress) {
  fillFolder(folder, [&](const fs::path& partial) {
    createFolders(partial / "image_0");
    createFolders(partial / "image_1");
    cv::Mat left;
    cv::Mat right;
    for (int index = 0; index < content.pairCount(); ++index) {
      content.images(index, left, right);
      writeImage(partial / "image_0", index, left);
      writeImage(partial / "image_1", index, right);
      if (progress) progress(index + 1, content.pairCount());
    }
    writeDescription(partial, content);
    writeTruth(partial, content, 0);
    if (calib::isKittiRig(content.rig()))
      writeResultFile(partial / "calib.txt", calib::kittiText(content.rig()));
  });
}

void recordFolder(const fs::path& folder, const Content& content, const EncodedPair& streams) {
  fillFolder(folder, [&](const fs::path& partial) {
    constexpr std::chrono::hours kSegmentLength{24};  // one file for each camera
    capture::RecordingInfo info;
    info.software_version = CARTVO_VERSION;
    info.started_ns = kRecordedEpoch_ns;
    info.rig = calib::rigText(content.rig());
    capture::RecordingWriter writer(partial, info, kSegmentLength);
    for (const auto side : {capture::CameraSide::left, capture::CameraSide::right})
      writer.beginConnection(side, {});
    std::size_t left = 0, right = 0;
    while (left < streams.left.units.size() || right < streams.right.units.size()) {
      const bool is_left = right == streams.right.units.size() ||
                           (left < streams.left.units.size() &&
                            streams.left.units[left].instant_ns <= streams.right.units[right].instant_ns);
      if (is_left)
        writer.write(capture::CameraSide::left, recordedUnit(streams.left, left++));
      else
        writer.write(capture::CameraSide::right, recordedUnit(streams.right, right++));
    }
    writer.endSegment();
    writeDescription(partial, content);
    writeTruth(partial, content, kRecordedEpoch_ns);
  });
}

}  // namespace cartvo::simulate
