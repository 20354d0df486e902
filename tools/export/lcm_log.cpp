// Writes the odometry of a replay as an event log of LCM.
#include "tools/export/lcm_log.hpp"

#include <cstdio>
#include <stdexcept>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "common/atomic_file.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/service/configuration.hpp"
#include "tools/export/export_source.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kNanosecondsPerMicrosecond = 1000;

/// The message as cartvod would have sent it at the instant `sent_us`.
odometry_t sentMessage(const odometry_t& message, std::size_t index, std::int64_t sent_us) {
  odometry_t sent = message;
  sent.sequence = static_cast<std::int64_t>(index);
  sent.publication_utime = sent_us;
  sent.time_to_live_us = std::chrono::microseconds(daemon::Configuration{}.time_to_live).count();
  return sent;
}

void writeEvents(lcm::LogFile& log, const std::filesystem::path& file, const Replay& replay) {
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const ReplayedPair& pair = replay.pairs[index];
    lcm::LogEvent event{};
    event.timestamp = receptionTime(pair) / kNanosecondsPerMicrosecond;
    event.channel = daemon::kOdometryChannel;
    const odometry_t message = sentMessage(pair.message, index, event.timestamp);
    std::vector<std::uint8_t> data(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(data.data(), 0, static_cast<int>(data.size()));
    event.data = data.data();
    event.datalen = static_cast<std::int32_t>(data.size());
    if (log.writeEvent(&event) != 0)
      throw std::runtime_error(file.string() + ": cannot be written: is the disk full?");
  }
  if (std::fflush(log.getFilePtr()) != 0)
    throw std::runtime_error(file.string() + ": cannot be written: is the disk full?");
}

}  // namespace

void writeLcmLog(const std::filesystem::path& file, const Replay& replay) {
  AtomicFileWriter writer(file);
  {
    lcm::LogFile log(writer.openPath().string(), "w");
    if (!log.good()) throw std::runtime_error(file.string() + ": LCM cannot open it for writing");
    writeEvents(log, file, replay);
  }
  writer.commit();
}

}  // namespace cartvo
