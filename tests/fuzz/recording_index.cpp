// Fuzz target for a recording's index, alone and with its readers: with a stream, for a summary and for time
// stamps. The lines get valid checksums, because fuzzing does not find them.

#include "capture/recording/recording_index.hpp"

#include <sstream>

#include "capture/clock/stereo_timestamper.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/recording_summary.hpp"
#include "capture/recording/recording_writer.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

namespace fs = std::filesystem;

constexpr int kPictures = 4;

/// H.264's sequence and picture parameter sets of 64x64 px.
const std::vector<std::uint8_t> kParameterSets = {
    0,    0,    0,    1,    0x67, 0x42, 0xc0, 0x0a, 0xda, 0x10, 0x9b, 0x01, 0x10, 0x00, 0x00, 0x03, 0x00,
    0x10, 0x00, 0x00, 0x03, 0x03, 0x28, 0xf1, 0x22, 0x6a, 0,    0,    0,    1,    0x68, 0xce, 0x0f, 0xc8};

const std::vector<std::uint8_t> kKeySlice = {0,    0,    0,    1,    0x65, 0x88, 0x84, 0x3a,
                                             0x26, 0x28, 0x0c, 0x9c, 0x9c, 0x9d, 0x75, 0xd7,
                                             0x5d, 0x75, 0xd7, 0x5d, 0x75, 0xd7, 0x5e};
const std::vector<std::uint8_t> kSlice = {0, 0, 0, 1, 0x41, 0x9a, 0x20, 0x3a, 0x82, 0x30};

/// A key picture if `number` is 0, else a predicted one; all grey.
std::vector<std::uint8_t> picture(int number) {
  if (number > 0) return kSlice;
  std::vector<std::uint8_t> data = kParameterSets;
  data.insert(data.end(), kKeySlice.begin(), kKeySlice.end());
  return data;
}

/// Makes a recording of both cameras by RecordingWriter.
fs::path makeRecording() {
  fs::path folder = fuzz::scratchFolder() / "recording";
  capture::RecordingWriter writer(folder, {capture::kRecordingFormatVersion, "0", 0, "", ""},
                                  std::chrono::minutes(1));
  const capture::StreamFormat format{capture::VideoCodec::h264, kParameterSets};
  for (const capture::CameraSide side : {capture::CameraSide::left, capture::CameraSide::right}) {
    writer.beginConnection(side, format);
    for (int i = 0; i < kPictures; ++i) {
      capture::EncodedUnit unit;
      unit.data = picture(i);
      unit.key = i == 0;
      unit.sequence = static_cast<std::uint64_t>(i);
      unit.pts = 3600 * i;
      unit.exposure_ns = 1'700'000'000'000'000'000 + 40'000'000 * i;
      unit.first_arrival_ns = unit.arrival_ns = unit.min_delay_arrival_ns = unit.exposure_ns + 80'000'000;
      unit.reference_us = unit.exposure_ns / 1000;
      writer.write(side, unit);
    }
  }
  return folder;
}

/// The text with valid checksums, except in lines that end in "!".
std::string withChecksums(const std::string& text) {
  std::string result = capture::indexHeader() + "\n";
  for (const std::string& line : fuzz::splitLines(text)) {
    if (line.starts_with("number,")) continue;
    result +=
        line.ends_with("!") || line.find(',') == std::string::npos ? line : capture::withLineChecksum(line);
    result += "\n";
  }
  return result;
}

/// Checks the index. Returns whether it contains a row.
bool checkIndex(const std::string& text) {
  const auto index = fuzz::parseOrReject(
      [&] {
        std::istringstream stream(text);
        return capture::readRecordingIndex(stream, "left.csv");
      },
      "left.csv");
  if (!index) return false;
  fuzz::require((index->damaged_lines == 0) == index->damage.empty(), "damage is reported");
  for (std::size_t i = 0; i < index->rows.size(); ++i) {
    const std::string line = capture::formatIndexRow(index->rows[i]);
    const std::optional<capture::IndexRow> again = capture::parseIndexRow(line);
    fuzz::require(again && capture::formatIndexRow(*again) == line, "a row is read back: " + line);
    fuzz::require(i == 0 || (index->rows[i].number > index->rows[i - 1].number &&
                             index->rows[i].time_ms > index->rows[i - 1].time_ms),
                  "rows are in order");
  }
  return !index->rows.empty();
}

void readPictures(const fs::path& recording) {
  std::uint64_t pictures = 0;
  fuzz::parseOrReject(
      [&] {
        capture::RecordingReader reader(recording, capture::CameraSide::left);
        capture::RecordedUnit recorded;
        for (; reader.next(recorded); ++pictures)
          fuzz::require(!recorded.unit.data.empty(), "a picture has data");
        fuzz::require(reader.damage().places.size() <= capture::kMaxDamagePlaces,
                      "the damage report has a limited length");
        return pictures;
      },
      recording.string());
  fuzz::require(pictures <= kPictures, "no picture is read twice");
}

void recomputeTimestamps(const fs::path& recording) {
  for (const capture::ClockChoice choice : {capture::ClockChoice::automatic, capture::ClockChoice::ntp}) {
    capture::RecordingTimestamper clock(recording, choice);
    for (std::uint64_t order = 0; order < 2 * kPictures; ++order) {
      for (const capture::CameraSide side : {capture::CameraSide::left, capture::CameraSide::right}) {
        const std::optional<capture::ExposureTimestamp> instant = clock.stamp(side, order);
        fuzz::require(!instant || instant->exposure_stddev_ns >= 0, "a standard deviation is not negative");
      }
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path recording = makeRecording();
  const std::string text = fuzz::toText(data, size);
  checkIndex(text);
  const std::string index = withChecksums(text);
  if (!checkIndex(index)) return 0;  // nothing to read, and opening the stream is slow
  fuzz::writeScratch(capture::recordingSegment(recording, 0).index(capture::CameraSide::left), index);
  readPictures(recording);
  fuzz::require(capture::summariseRecording(recording).cameras[1].pictures == kPictures,
                "the other camera is unchanged");
  recomputeTimestamps(recording);
  return 0;
}
