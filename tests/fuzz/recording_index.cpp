// A recording's index, alone and as its readers use it: beside a stream, for a summary and for the clocks.
// The checksums of its lines are made to match, for fuzzing does not find them.

#include "capture/recording_index.hpp"

#include <sstream>

#include "capture/pair_clock.hpp"
#include "capture/recording_clock.hpp"
#include "capture/recording_reader.hpp"
#include "capture/recording_summary.hpp"
#include "capture/recording_writer.hpp"
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

/// A key picture and those after it, all grey.
std::vector<std::uint8_t> picture(int number) {
  if (number > 0) return kSlice;
  std::vector<std::uint8_t> data = kParameterSets;
  data.insert(data.end(), kKeySlice.begin(), kKeySlice.end());
  return data;
}

/// A recording of both cameras, by our own writer.
fs::path makeRecording() {
  fs::path folder = fuzz::scratchFolder() / "recording";
  RecordingWriter writer(folder, {kRecordingFormatVersion, "0", 0, "", ""}, std::chrono::minutes(1));
  const StreamFormat format{VideoCodec::h264, kParameterSets};
  for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
    writer.begin(side, format);
    for (int i = 0; i < kPictures; ++i) {
      EncodedUnit unit;
      unit.data = picture(i);
      unit.key = i == 0;
      unit.sequence = static_cast<std::uint64_t>(i);
      unit.pts = 3600 * i;
      unit.exposure_ns = 1'700'000'000'000'000'000 + 40'000'000 * i;
      unit.first_arrival_ns = unit.arrival_ns = unit.undelayed_arrival_ns = unit.exposure_ns + 80'000'000;
      unit.reference_us = unit.exposure_ns / 1000;
      writer.write(side, unit);
    }
  }
  return folder;
}

/// The text with its lines' checksums, but for lines that end in "!".
std::string sealed(const std::string& text) {
  std::string result = indexHeader() + "\n";
  for (const std::string& line : fuzz::linesOf(text)) {
    if (line.starts_with("number,")) continue;
    result += line.ends_with("!") || line.find(',') == std::string::npos ? line : withLineChecksum(line);
    result += "\n";
  }
  return result;
}

/// Whether it holds a row.
bool checkIndex(const std::string& text) {
  const auto index = fuzz::accepted(
      [&] {
        std::istringstream stream(text);
        return readIndex(stream, "left.csv");
      },
      "left.csv");
  if (!index) return false;
  fuzz::require((index->damaged_lines == 0) == index->damage.empty(), "damage is told");
  for (std::size_t i = 0; i < index->rows.size(); ++i) {
    const std::string line = toText(index->rows[i]);
    const std::optional<IndexRow> again = parseIndexRow(line);
    fuzz::require(again && toText(*again) == line, "a row is read back: " + line);
    fuzz::require(i == 0 || (index->rows[i].number > index->rows[i - 1].number &&
                             index->rows[i].time_ms > index->rows[i - 1].time_ms),
                  "rows are in order");
  }
  return !index->rows.empty();
}

void readPictures(const fs::path& recording) {
  std::uint64_t pictures = 0;
  fuzz::accepted(
      [&] {
        RecordingReader reader(recording, CameraSide::left);
        RecordedUnit recorded;
        for (; reader.next(recorded); ++pictures)
          fuzz::require(!recorded.unit.data.empty(), "a picture that is read has data");
        fuzz::require(reader.damage().places.size() <= kMostDamagePlaces, "damage is told briefly");
        return pictures;
      },
      recording.string());
  fuzz::require(pictures <= kPictures, "no picture is read twice");
}

void replayClocks(const fs::path& recording) {
  for (const ClockChoice choice : {ClockChoice::automatic, ClockChoice::ntp}) {
    RecordingClock clock(recording, choice);
    for (std::uint64_t order = 0; order < 2 * kPictures; ++order) {
      for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
        const std::optional<StampedInstant> instant = clock.stamp(side, order);
        fuzz::require(!instant || instant->deviation_ns >= 0, "a deviation is a number");
      }
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path recording = makeRecording();
  const std::string text = fuzz::textOf(data, size);
  checkIndex(text);
  const std::string index = sealed(text);
  if (!checkIndex(index)) return 0;  // its readers have nothing to do, and opening the stream takes long
  fuzz::writeScratch(recordingSegment(recording, 0).index(CameraSide::left), index);
  readPictures(recording);
  fuzz::require(summariseRecording(recording).cameras[1].pictures == kPictures,
                "the other camera is not touched");
  replayClocks(recording);
  return 0;
}
