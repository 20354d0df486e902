// Checks of a recording or sequence on disk.
#include "tools/doctor/recording_checks.hpp"

#include <cstdint>
#include <exception>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_summary.hpp"
#include "capture/stereo_source.hpp"
#include "pipeline/source_rig.hpp"
#include "tools/calibrate/source_pairs.hpp"
#include "tools/doctor/configuration_checks.hpp"

namespace cartvo::doctor {
namespace {

void addSide(const char* side, const capture::RecordedCamera& camera, FindingList& findings) {
  constexpr double kMaxLost = 0.001;  // share
  const auto bad = static_cast<double>(camera.damaged + camera.missed);
  const bool has_pictures = camera.pictures > 0;
  const bool is_good = bad <= kMaxLost * static_cast<double>(camera.pictures) && camera.connections <= 1;
  findings.add(
      std::string(side) + " camera", has_pictures ? okIf(is_good, Verdict::look_at) : Verdict::broken,
      {fmt::format("{} pictures in {:.1f} s, {} damaged and {} missed on reception, connections: {}",
                   camera.pictures, camera.seconds(), camera.damaged, camera.missed, camera.connections),
       "at most one of 1000 lost, one connection",
       "cameras.transport: tcp; repair cable, switch or radio link"});
}

std::optional<daemon::Configuration> recordedConfiguration(const capture::RecordingInfo& info,
                                                           const std::filesystem::path& folder,
                                                           FindingList& findings) {
  try {
    if (info.configuration.empty()) return std::nullopt;
    return daemon::parseConfiguration(info.configuration, folder / "recording.json");
  } catch (const std::exception& error) {
    findings.add("configuration", Verdict::look_at,
                 {error.what(), "the configuration of the recording can be read",
                  "replay with the release of cartvo that made the recording"});
    return std::nullopt;
  }
}

/// Pairs of the first two minutes: a drive begins with a standstill, in which nothing is seen of static
/// parts.
KeptPairs firstPairs(capture::StereoSource& source, const WorkObserver::Progress& progress,
                     const std::atomic<bool>& interrupted) {
  constexpr std::int64_t kMost_ns = 120'000'000'000, kSecond_ns = 1'000'000'000;
  PairKeeper keeper;
  std::optional<std::int64_t> first_ns;
  calibrate::forEachPair(source, [&](const capture::FramePair& pair) {
    if (!first_ns) first_ns = pair.left.exposure_ns;
    const std::int64_t elapsed_ns = pair.left.exposure_ns - *first_ns;
    if (elapsed_ns > kMost_ns) return false;
    progress(static_cast<int>(elapsed_ns / kSecond_ns), static_cast<int>(kMost_ns / kSecond_ns));
    keeper.add(pair);
    return !interrupted.load();
  });
  return keeper.take();
}

}  // namespace

std::optional<daemon::Configuration> checkRecording(const std::filesystem::path& folder,
                                                    FindingList& findings) {
  try {
    const capture::RecordingSummary summary = capture::summariseRecording(folder);
    const bool is_whole = summary.unfinalised.empty() || summary.being_written;
    findings.add("recording", okIf(is_whole, Verdict::look_at),
                 {fmt::format("{} {}, {:.1f} MB, by cartvo {}{}", summary.segments,
                              summary.segments == 1 ? "segment" : "segments",
                              1e-6 * static_cast<double>(summary.bytes), summary.info.software_version,
                              summary.being_written ? ", being written"
                              : is_whole            ? ""
                                                    : ", its end was interrupted"),
                  "complete", "cartvo recording verify; all that is in the index can be replayed"});
    addSide("left", summary.cameras[0], findings);
    addSide("right", summary.cameras[1], findings);
    return recordedConfiguration(summary.info, folder, findings);
  } catch (const std::exception& error) {
    findings.add("recording", Verdict::broken,
                 {error.what(), "a recording of cartvod", "cartvo recording verify"});
    return std::nullopt;
  }
}

StreamMeasurement measureRecording(const std::filesystem::path& folder, capture::CameraSide side,
                                   double seconds, const std::atomic<bool>& interrupted) {
  StreamMeasurement measurement;
  try {
    capture::RecordingReader reader(folder, side);
    capture::RecordedUnit recorded;
    std::uint64_t connection = 0;
    std::int64_t first_ns = 0;
    while (!interrupted && reader.next(recorded)) {
      // A new connection begins RTP time anew: the first one is measured.
      if (connection != 0 && recorded.connection != connection) break;
      if (connection == 0) first_ns = recorded.unit.first_arrival_ns;
      connection = recorded.connection;
      if (1e-9 * static_cast<double>(recorded.unit.first_arrival_ns - first_ns) > seconds) break;
      measurement.codec = recorded.format.codec;
      measurement.size = recorded.picture_size;
      measurement.pictures.push_back(receivedPicture(recorded.unit));
    }
    const capture::RecordingDamage& damage = reader.damage();
    if (damage.lost + damage.altered > 0)
      measurement.problem =
          fmt::format("{} pictures lost and {} altered on disk", damage.lost, damage.altered);
  } catch (const std::exception& error) {
    measurement.problem = error.what();
  }
  return measurement;
}

SourceContent readSource(const std::filesystem::path& folder, const WorkObserver::Progress& progress,
                         const std::atomic<bool>& interrupted, FindingList& findings) {
  SourceContent content;
  try {
    capture::StereoSource source = capture::openSource(folder);
    content.absent_readout = pipeline::absentReadoutOf(source.kind);
    pipeline::FoundRig found = pipeline::findRig(source, folder, {});
    if (checkRig(found.rig, found.origin, findings)) content.rig = std::move(found.rig);
    content.pairs = firstPairs(source, progress, interrupted);
  } catch (const std::exception& error) {
    findings.add("source", Verdict::broken,
                 {error.what(), "a recording, or a sequence in KITTI's or EuRoC's layout, with its rig",
                  "see /usr/share/doc/cartvo/recordings.md"});
  }
  return content;
}

}  // namespace cartvo::doctor
