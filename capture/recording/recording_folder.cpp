// Layout of a recording's folder, its description recording.json, and the quota of all recordings.
#include "capture/recording/recording_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "capture/recording/recording_writer.hpp"
#include "common/durable_file.hpp"
#include "common/exact_text.hpp"
#include "common/files/foreign_format.hpp"
#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

constexpr const char* kDescriptionFile = "recording.json";
constexpr std::uintmax_t kMaxDescriptionBytes = 4U << 20;
constexpr std::size_t kMinNumberDigits = 6;

std::optional<std::uint64_t> parseSegmentNumber(const std::string& name) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (name.size() < kMinNumberDigits || error != std::errc() || end != name.data() + name.size())
    return std::nullopt;
  return number;
}

/// The value as a 64-bit integer. JSON numbers may be out of range, for which a conversion is undefined.
/// Throws std::runtime_error naming file and key.
std::int64_t requireInteger(const nlohmann::json& value, const std::string& key,
                            const std::filesystem::path& file) {
  const bool is_too_large =
      value.is_number_unsigned() && value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max();
  if (!value.is_number_integer() || is_too_large)
    throw std::runtime_error(file.string() + " is damaged: " + key + " is not an integer of 64 bits");
  return value.get<std::int64_t>();
}

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;

/// A segment and its disk usage.
struct SegmentUsage {
  fs::path recording;
  RecordingSegment segment;
  std::uint64_t bytes = 0;
  fs::file_time_type last_written = fs::file_time_type::min();
};

std::vector<fs::path> segmentFiles(const RecordingSegment& segment) {
  return {segment.video(CameraSide::left), segment.index(CameraSide::left), segment.video(CameraSide::right),
          segment.index(CameraSide::right)};
}

SegmentUsage measureSegment(const fs::path& recording, const RecordingSegment& segment) {
  SegmentUsage usage{recording, segment};
  for (const fs::path& file : segmentFiles(segment)) {
    std::error_code missing;
    const std::uintmax_t size = fs::file_size(file, missing);
    if (missing) continue;
    usage.bytes += size;
    usage.last_written = std::max(usage.last_written, fs::last_write_time(file, missing));
  }
  return usage;
}

std::vector<fs::path> recordingsIn(const fs::path& folder) {
  std::vector<fs::path> recordings;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_directory() && !entry.is_symlink() && isRecording(entry.path()))
      recordings.push_back(entry.path());
  }
  std::sort(recordings.begin(), recordings.end());
  return recordings;
}

bool isSame(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error);
}

/// Recorded segments, oldest first.
struct Inventory {
  std::vector<SegmentUsage> deletable;
  std::uint64_t bytes = 0;  ///< of all segments
};

Inventory buildInventory(const fs::path& recordings, const fs::path& own, std::uint64_t oldest_open) {
  Inventory inventory;
  for (const fs::path& recording : recordingsIn(recordings)) {
    const bool is_own = isSame(recording, own);
    const bool is_written_elsewhere = !is_own && isBeingWritten(recording);
    for (const RecordingSegment& segment : recordingSegments(recording)) {
      SegmentUsage usage = measureSegment(recording, segment);
      inventory.bytes += usage.bytes;
      if (is_written_elsewhere || (is_own && segment.number >= oldest_open)) continue;
      inventory.deletable.push_back(std::move(usage));
    }
  }
  return inventory;
}

/// Deletes a segment's files, and its recording if it was the last segment. False if it could not be deleted.
bool removeSegment(const SegmentUsage& usage, const fs::path& own) {
  std::error_code error;
  for (const fs::path& file : segmentFiles(usage.segment))
    fs::remove(file, error);
  if (!fs::remove(usage.segment.folder, error) || error) return false;
  if (!isSame(usage.recording, own) && recordingSegments(usage.recording).empty()) {
    fs::remove(usage.recording / "recording.json", error);
    fs::remove(usage.recording, error);  // fails if it contains other files
  }
  return true;
}

std::uint64_t freeBytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? UINT64_MAX : space.available;
}

std::string gigabytes(std::uint64_t bytes) {
  return fixedText(static_cast<double>(bytes) / kGigabyte, 2) + " GB";
}

}  // namespace

bool isRecording(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / kDescriptionFile);
}

RecordingInfo readRecordingInfo(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kDescriptionFile;
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) {
    const bool is_folder = std::filesystem::is_directory(folder);
    std::string reason = is_folder ? foreignContents(folder) : foreignFormat(folder);
    if (reason.empty()) {
      reason = is_folder
                   ? "contains no recording.json"
                   : std::string(std::filesystem::exists(folder) ? "is not a folder" : "does not exist");
      reason += "; expected the folder of a recording ('cartvod --record', or recording.directory)";
    }
    throw std::runtime_error(folder.string() + " " + reason);
  }
  return parseRecordingInfo(readInputText(file, kMaxDescriptionBytes), file);
}

RecordingInfo parseRecordingInfo(const std::string& text, const std::filesystem::path& file) {
  RecordingInfo info;
  try {
    const nlohmann::json description = nlohmann::json::parse(text);
    const std::int64_t version = requireInteger(description.at("format_version"), "format_version", file);
    info.format_version = static_cast<int>(std::clamp<std::int64_t>(version, -1, 1'000'000));
    info.software_version = description.at("software_version").get<std::string>();
    if (description.contains("started_ns"))
      info.started_ns = requireInteger(description["started_ns"], "started_ns", file);
    info.configuration = description.at("configuration").get<std::string>();
    info.rig = description.at("rig").get<std::string>();
  } catch (const nlohmann::json::parse_error& error) {
    throw std::runtime_error(file.string() + " is damaged: it is not JSON from byte " +
                             std::to_string(error.byte) + " on");
  } catch (const nlohmann::json::exception&) {
    throw std::runtime_error(file.string() +
                             " is damaged: expected an object with the integer format_version and the texts "
                             "software_version, configuration and rig");
  }
  if (info.format_version != kRecordingFormatVersion) {
    throw std::runtime_error(file.string() + " has format " + std::to_string(info.format_version) +
                             ", but this program reads format " + std::to_string(kRecordingFormatVersion) +
                             "; use the version that made it (" + printableExcerpt(info.software_version) +
                             ")");
  }
  return info;
}

void writeRecordingInfo(const std::filesystem::path& folder, const RecordingInfo& info) {
  nlohmann::ordered_json description;
  description["format_version"] = info.format_version;
  description["software_version"] = info.software_version;
  description["started_ns"] = info.started_ns;
  description["configuration"] = info.configuration;
  description["rig"] = info.rig;
  const std::filesystem::path file = folder / kDescriptionFile;
  refuseLink(file);
  errno = 0;
  std::ofstream output(file);
  output << description.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n' << std::flush;
  if (!output) throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
  syncToDisk(file);
  syncToDisk(folder);
}

RecordingSegment recordingSegment(const std::filesystem::path& recording, std::uint64_t number) {
  std::array<char, 24> name{};
  std::snprintf(name.data(), name.size(), "%06llu", static_cast<unsigned long long>(number));
  return {number, recording / name.data()};
}

std::vector<RecordingSegment> recordingSegments(const std::filesystem::path& recording) {
  std::vector<RecordingSegment> segments;
  for (const auto& entry : std::filesystem::directory_iterator(recording)) {
    const std::optional<std::uint64_t> number = parseSegmentNumber(entry.path().filename().string());
    if (number && entry.is_directory() && !entry.is_symlink()) segments.push_back({*number, entry.path()});
  }
  std::sort(segments.begin(), segments.end(),
            [](const RecordingSegment& a, const RecordingSegment& b) { return a.number < b.number; });
  return segments;
}

QuotaOutcome enforceQuota(const RecordingQuota& quota, const fs::path& recording, std::uint64_t oldest_open) {
  QuotaOutcome outcome;
  if (!quota.recordings.empty()) {
    Inventory inventory = buildInventory(quota.recordings, recording, oldest_open);
    const auto now = fs::file_time_type::clock::now();
    for (const SegmentUsage& usage : inventory.deletable) {
      const bool too_much = quota.maximum_bytes > 0 && inventory.bytes > quota.maximum_bytes;
      const bool too_old = quota.maximum_age.count() > 0 && now - usage.last_written > quota.maximum_age;
      const bool too_full = quota.keep_free_bytes > 0 && freeBytes(recording) < quota.keep_free_bytes;
      if (!too_much && !too_old && !too_full) break;
      if (!removeSegment(usage, recording)) continue;
      inventory.bytes -= usage.bytes;
      ++outcome.deleted_segments;
      outcome.deleted_bytes += usage.bytes;
    }
  }
  if (const std::uint64_t free = freeBytes(recording); free < quota.keep_free_bytes) {
    outcome.shortage = "only " + gigabytes(free) + " are free for " + recording.string() + "; " +
                       gigabytes(quota.keep_free_bytes) + " must be kept free";
  }
  return outcome;
}

}  // namespace cartvo::capture
