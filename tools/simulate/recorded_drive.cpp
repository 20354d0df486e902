// Plays recordings by the simulated cameras.
#include "tools/simulate/recorded_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "calib/format/rig_file.hpp"
#include "capture/codec/nal_units.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_reader.hpp"
#include "tools/simulate/truth.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

void append(EncodedStream& stream, const capture::RecordedUnit& recorded) {
  AccessUnit unit{
      .instant_ns = recorded.unit.exposure_ns, .begin = stream.bytes.size(), .key_frame = recorded.unit.key};
  // A camera may send the parameter sets in its description only.
  const std::vector<std::uint8_t>& sets = recorded.format.parameter_sets;
  if (recorded.unit.key && capture::parameterSets(capture::VideoCodec::h264, recorded.unit.data).empty())
    stream.bytes.insert(stream.bytes.end(), sets.begin(), sets.end());
  stream.bytes.insert(stream.bytes.end(), recorded.unit.data.begin(), recorded.unit.data.end());
  unit.size = stream.bytes.size() - unit.begin;
  stream.units.push_back(unit);
}

/// The intact pictures of one camera at increasing instants, up to `end_ns`; instants since the Unix epoch.
EncodedStream readStream(const fs::path& folder, capture::CameraSide side, std::int64_t end_ns) {
  capture::RecordingReader reader(folder, side);
  EncodedStream stream;
  capture::RecordedUnit recorded;
  while (reader.next(recorded) && recorded.unit.exposure_ns < end_ns) {
    if (recorded.format.codec != capture::VideoCodec::h264)
      throw std::runtime_error(folder.string() + ": is not H.264; simulated cameras send nothing else");
    const bool continues =
        stream.units.empty() ? recorded.unit.key : recorded.unit.exposure_ns > stream.units.back().instant_ns;
    if (!continues || recorded.unit.status != capture::FrameStatus::good) continue;
    stream.size = recorded.picture_size;
    append(stream, recorded);
  }
  if (stream.units.empty()) {
    throw std::runtime_error(folder.string() + ": contains no picture of the " + capture::sideName(side) +
                             " camera that begins a stream");
  }
  return stream;
}

/// Hz, from the median period.
double frameRateOf(const EncodedStream& stream) {
  constexpr double kOfASingle = 18.0;
  std::vector<std::int64_t> periods;
  for (std::size_t i = 1; i < stream.units.size(); ++i)
    periods.push_back(stream.units[i].instant_ns - stream.units[i - 1].instant_ns);
  if (periods.empty()) return kOfASingle;
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::nth_element(periods.begin(), middle, periods.end());
  return 1e9 / static_cast<double>(*middle);
}

}  // namespace

RecordedDrive::RecordedDrive(const fs::path& folder, double seconds, const EncoderSettings& settings) {
  const capture::RecordingInfo info = capture::readRecordingInfo(folder);
  if (info.rig.empty()) throw std::runtime_error(folder.string() + ": the recording contains no rig");
  rig_ = calib::parseRig(info.rig, folder / "recording.json");
  std::int64_t end_ns = std::numeric_limits<std::int64_t>::max();
  EncodedPair pair;
  for (EncodedStream* stream : {&pair.left, &pair.right}) {
    *stream = readStream(
        folder, stream == &pair.left ? capture::CameraSide::left : capture::CameraSide::right, end_ns);
    if (stream == &pair.left && seconds > 0.0) {
      end_ns = stream->units.front().instant_ns + std::llround(seconds * 1e9);
      std::erase_if(stream->units, [end_ns](const AccessUnit& unit) { return unit.instant_ns >= end_ns; });
    }
  }
  const std::int64_t start_ns = pair.left.units.front().instant_ns;
  for (EncodedStream* stream : {&pair.left, &pair.right}) {
    stream->frame_rate = frameRateOf(pair.left);
    for (AccessUnit& unit : stream->units)
      unit.instant_ns -= start_ns;
    addBlankLeadIn(*stream, settings);
  }
  streams_ = std::make_shared<const EncodedPair>(std::move(pair));
  if (fs::exists(folder / "truth.tum")) truth_ = shifted(readTrajectory(folder / "truth.tum"), -start_ns);
}

int RecordedDrive::pairCount() const {
  return static_cast<int>(std::min(streams_->left.units.size(), streams_->right.units.size()));
}

std::int64_t RecordedDrive::leftInstant(int index) const {
  return streams_->left.units.at(static_cast<std::size_t>(index)).instant_ns;
}

std::int64_t RecordedDrive::rightInstant(int index) const {
  return streams_->right.units.at(static_cast<std::size_t>(index)).instant_ns;
}

/// The poses at the left instants, which truth.tum contains to a microsecond if it belongs to the recording.
Trajectory RecordedDrive::truth() const {
  constexpr std::int64_t kTolerance_ns = 1000;
  Trajectory truth;
  auto next = truth_.begin();
  for (int index = 0; index < pairCount(); ++index) {
    const std::int64_t instant = leftInstant(index);
    next = std::find_if(next, truth_.end(), [instant](const StampedPose& pose) {
      return pose.time_ns >= instant - kTolerance_ns;
    });
    if (next == truth_.end() || next->time_ns > instant + kTolerance_ns) return {};
    truth.push_back({instant, next->pose});
  }
  return truth;
}

fs::path sampleDrive() {
  std::error_code no_error;
  const fs::path program = fs::read_symlink("/proc/self/exe", no_error);
  // From libexec/cartvo.
  const fs::path folder = program.parent_path().parent_path().parent_path() / "share/cartvo/sample_drive";
  return capture::isRecording(folder) ? folder : fs::path();
}

}  // namespace cartvo::simulate
