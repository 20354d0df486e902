#include "capture/recording_source.hpp"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "capture/ffmpeg.hpp"
#include "capture/ffmpeg_log.hpp"
#include "capture/recording_index.hpp"
#include "capture/video_decoder.hpp"

namespace cartvo {

bool isRecording(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "recording.json");
}

RecordingInfo readRecordingInfo(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "recording.json";
  std::ifstream input(file);
  if (!input) throw std::runtime_error("cannot read " + file.string());
  RecordingInfo info;
  try {
    const nlohmann::json description = nlohmann::json::parse(input);
    info.format_version = description.at("format_version").get<int>();
    info.software_version = description.at("software_version").get<std::string>();
    info.configuration = description.at("configuration").get<std::string>();
    info.rig = description.at("rig").get<std::string>();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + " is damaged: " + error.what());
  }
  if (info.format_version < 1 || info.format_version > kRecordingFormatVersion) {
    throw std::runtime_error(file.string() + " has format " + std::to_string(info.format_version) +
                             ", but this program reads up to " + std::to_string(kRecordingFormatVersion) +
                             "; use the version that made it (" + info.software_version + ")");
  }
  return info;
}

struct RecordingSource::Implementation {
  std::filesystem::path video_file;
  Index index;
  std::size_t next_row = 0;
  ffmpeg::Input input;
  ffmpeg::Filter to_annex_b;
  ffmpeg::Packet packet = ffmpeg::makePacket();
  std::unique_ptr<VideoDecoder> decoder;
  bool at_end = false;
  std::atomic<bool> interrupted = false;

  mutable std::mutex mutex;  ///< guards health
  CameraHealth health;

  void open();
  bool nextUnit(EncodedUnit& unit);
  void end(const std::string& damage);
};

RecordingSource::RecordingSource(const std::filesystem::path& folder, const std::string& stream)
    : implementation_(std::make_unique<Implementation>()) {
  keepFfmpegQuiet();
  implementation_->video_file = folder / (stream + ".mkv");
  implementation_->index = readIndex(folder / (stream + ".csv"));
  implementation_->open();
}

RecordingSource::~RecordingSource() = default;

void RecordingSource::Implementation::open() {
  const auto check = [this](int result) {
    if (result < 0) {
      throw std::runtime_error("cannot open the recording " + video_file.string() + ": " +
                               ffmpeg::errorText(result));
    }
  };
  AVFormatContext* context = nullptr;
  check(avformat_open_input(&context, video_file.c_str(), av_find_input_format("matroska"), nullptr));
  input.reset(context);
  if (context->nb_streams != 1) throw std::runtime_error(video_file.string() + " must hold one video stream");
  const AVCodecParameters& parameters = *context->streams[0]->codecpar;
  const bool is_h264 = parameters.codec_id == AV_CODEC_ID_H264;
  if (!is_h264 && parameters.codec_id != AV_CODEC_ID_HEVC) {
    throw std::runtime_error(video_file.string() + " holds neither H.264 nor H.265 video");
  }
  // Matroska stores lengths where the stream had start codes, and the parameter sets apart.
  const AVBitStreamFilter* filter = av_bsf_get_by_name(is_h264 ? "h264_mp4toannexb" : "hevc_mp4toannexb");
  AVBSFContext* filter_context = nullptr;
  check(av_bsf_alloc(filter, &filter_context));
  to_annex_b.reset(filter_context);
  check(avcodec_parameters_copy(filter_context->par_in, &parameters));
  check(av_bsf_init(filter_context));
  StreamFormat format{is_h264 ? VideoCodec::h264 : VideoCodec::h265, {}};
  const AVCodecParameters& filtered = *filter_context->par_out;
  format.parameter_sets.assign(filtered.extradata, filtered.extradata + filtered.extradata_size);
  decoder = std::make_unique<VideoDecoder>(format, 1);
}

/// The next picture with what the index says of it. False at the end, which `end` has noted.
bool RecordingSource::Implementation::nextUnit(EncodedUnit& unit) {
  av_packet_unref(packet.get());
  const int error = av_read_frame(input.get(), packet.get());
  if (error < 0 || next_row >= index.rows.size()) {
    const bool video_goes_on = error >= 0;
    const bool index_goes_on = next_row < index.rows.size();
    if (!index.damage.empty()) {
      end(index.damage);
    } else if (video_goes_on) {
      end("the index of " + video_file.string() + " is shorter than the video");
    } else if (index_goes_on) {
      end(video_file.string() + " is cut short or damaged");
    } else {
      end("");
    }
    return false;
  }
  const std::int64_t time_ms = av_rescale_q(packet->pts, input->streams[0]->time_base, AVRational{1, 1000});
  const IndexRow& row = index.rows[next_row];
  if (time_ms != row.time_ms || (packet->flags & AV_PKT_FLAG_CORRUPT) != 0) {
    end(video_file.string() + " is damaged");
    return false;
  }
  if (av_bsf_send_packet(to_annex_b.get(), packet.get()) < 0 ||
      av_bsf_receive_packet(to_annex_b.get(), packet.get()) < 0) {
    end(video_file.string() + " is damaged");
    return false;
  }
  ++next_row;
  unit.data.assign(packet->data, packet->data + packet->size);
  unit.pts = row.pts;
  unit.exposure_ns = row.exposure_ns;
  unit.exposure_deviation_ns = usualDeviationNs(row.instant_source);
  unit.arrival_ns = row.arrival_ns;
  unit.sequence = row.sequence;
  unit.instant_source = row.instant_source;
  unit.status = row.status;
  unit.key = row.key;
  return true;
}

void RecordingSource::Implementation::end(const std::string& damage) {
  at_end = true;
  decoder->finish();
  if (damage.empty()) return;
  const std::lock_guard lock(mutex);
  health.last_error = damage + ": replayed the " + std::to_string(next_row) + " pictures before it";
}

ReadOutcome RecordingSource::read(Frame& frame, std::chrono::milliseconds /*timeout*/) {
  Implementation& self = *implementation_;
  EncodedUnit unit;
  while (!self.interrupted) {
    if (std::optional<Frame> decoded = self.decoder->receive()) {
      frame = std::move(*decoded);
      const std::lock_guard lock(self.mutex);
      self.health.state = CameraState::streaming;
      self.health.instant_source = frame.instant_source;
      ++self.health.frames;
      if (frame.status == FrameStatus::damaged) ++self.health.damaged;
      return ReadOutcome::frame;
    }
    if (self.at_end) break;
    if (self.nextUnit(unit)) self.decoder->send(unit);
  }
  const std::lock_guard lock(self.mutex);
  self.health.state = CameraState::ended;
  return ReadOutcome::ended;
}

CameraHealth RecordingSource::health() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->health;
}

void RecordingSource::interrupt() noexcept {
  implementation_->interrupted = true;
}

}  // namespace cartvo
