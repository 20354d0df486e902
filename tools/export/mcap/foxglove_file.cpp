// Writes the results and the video of a drive as an MCAP file for Foxglove and other viewers.
#include "tools/export/mcap/foxglove_file.hpp"

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "tools/export/exported_motion.hpp"
#include "tools/export/mcap/foxglove_messages.hpp"
#include "tools/export/mcap/foxglove_schemas.hpp"
#include "tools/export/mcap/mcap_writer.hpp"
#include "tools/export/mcap/picture_channels.hpp"

namespace cartvo {
namespace {

/// Adds channels, and the schema of each message once.
class Channels {
 public:
  explicit Channels(McapWriter& writer) : writer_(writer) {}

  std::uint16_t add(const char* topic, const std::string& message) {
    if (!schemas_.contains(message))
      schemas_[message] = writer_.addSchema(message, "protobuf", foxgloveSchema(message));
    return writer_.addChannel(schemas_[message], topic, "protobuf");
  }

 private:
  McapWriter& writer_;
  std::map<std::string, std::uint16_t> schemas_;
};

/// Writes the messages of the odometry.
class MotionChannels {
 public:
  MotionChannels(McapWriter& writer, Channels& channels, const Replay* replay)
      : writer_(writer),
        pose_(channels.add("/pose", "foxglove.PoseInFrame")),
        transform_(channels.add("/tf", "foxglove.FrameTransform")) {
    if (replay == nullptr) return;
    const auto frames = cameraFrames(replay->rig.rig);
    camera_frames_.assign(frames.begin(), frames.end());
    has_velocity_ = true;
    odometry_ = channels.add("/odometry", "foxglove.Odometry");
    log_ = channels.add("/log", "foxglove.Log");
  }

  void write(const ExportedMotion& motion) {
    send(motion, pose_, foxglovePose(motion));
    send(motion, transform_,
         foxgloveTransform(motion.exposure_ns, {kOdometryFrame, kBodyFrame, motion.T_odom_body}));
    for (const FramePose& frame : camera_frames_)
      send(motion, transform_, foxgloveTransform(motion.exposure_ns, frame));
    if (!has_velocity_) return;
    if (motion.valid) send(motion, odometry_, foxgloveOdometry(motion));
    logChange(motion);
  }

 private:
  void send(const ExportedMotion& motion, std::uint16_t channel, const std::string& message) {
    const auto time = static_cast<std::uint64_t>(motion.reception_ns);
    writer_.write(channel, time, time, message);
  }

  void logChange(const ExportedMotion& motion) {
    const std::string state = motion.valid ? "valid" : "invalid: " + motion.reasons;
    if (state == last_state_) return;
    last_state_ = state;
    send(motion, log_, foxgloveLog(motion.exposure_ns, !motion.valid, "odometry " + state));
  }

  McapWriter& writer_;
  std::uint16_t pose_, transform_, odometry_ = 0, log_ = 0;
  std::vector<FramePose> camera_frames_;
  bool has_velocity_ = false;
  std::string last_state_;
};

}  // namespace

void writeFoxgloveFile(const std::filesystem::path& file, const ExportSource& source,
                       const std::function<void(std::size_t pictures)>& progress) {
  const std::vector<ExportedMotion> motions = exportedMotions(source);
  AtomicFileWriter output(file);
  McapWriter writer(output, "");
  Channels channels(writer);
  MotionChannels odometry(writer, channels, source.replay ? &*source.replay : nullptr);
  PictureChannels pictures(
      writer, source, [&](const char* topic) { return channels.add(topic, "foxglove.CompressedVideo"); },
      foxgloveVideo);
  for (const ExportedMotion& motion : motions) {
    pictures.writeUntil(motion.reception_ns);
    odometry.write(motion);
    if (source.has_video) progress(pictures.writtenCount());
  }
  pictures.writeUntil(std::numeric_limits<std::int64_t>::max());
  writer.finish();
  output.commit();
}

}  // namespace cartvo
