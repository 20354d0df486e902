// Reading of recorded streams, with recovery after damage.

#include "capture/recording/recording_reader.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/picture_checksum.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_index.hpp"
#include "common/exact_text.hpp"
#include "common/input_file.hpp"

namespace cartvo::capture {
namespace {

void requireSuccess(int result, const std::filesystem::path& file) {
  if (result < 0 && std::filesystem::is_empty(file)) throw std::runtime_error(file.string() + " is empty");
  if (result < 0) throw std::runtime_error(file.string() + " cannot be opened: " + ffmpeg::errorText(result));
}

/// The pictures of one segment's video file, in Annex B form.
class SegmentVideo {
 public:
  explicit SegmentVideo(const std::filesystem::path& file) {
    requireInputFile(file);
    AVFormatContext* context = nullptr;
    requireSuccess(avformat_open_input(&context, file.c_str(), av_find_input_format("matroska"), nullptr),
                   file);
    input_.reset(context);
    if (context->nb_streams != 1) throw std::runtime_error(file.string() + " must contain one video stream");
    const AVCodecParameters& parameters = *context->streams[0]->codecpar;
    const bool is_h264 = parameters.codec_id == AV_CODEC_ID_H264;
    if (!is_h264 && parameters.codec_id != AV_CODEC_ID_HEVC)
      throw std::runtime_error(file.string() + " contains neither H.264 nor H.265 video");
    // Matroska stores lengths instead of start codes, and the parameter sets separately.
    AVBSFContext* filter = nullptr;
    requireSuccess(
        av_bsf_alloc(av_bsf_get_by_name(is_h264 ? "h264_mp4toannexb" : "hevc_mp4toannexb"), &filter), file);
    to_annex_b_.reset(filter);
    requireSuccess(avcodec_parameters_copy(filter->par_in, &parameters), file);
    requireSuccess(av_bsf_init(filter), file);
    format_.codec = is_h264 ? VideoCodec::h264 : VideoCodec::h265;
    const AVCodecParameters& filtered = *filter->par_out;
    format_.parameter_sets.assign(filtered.extradata, filtered.extradata + filtered.extradata_size);
  }

  const StreamFormat& format() const { return format_; }
  cv::Size pictureSize() const {
    const AVCodecParameters& parameters = *input_->streams[0]->codecpar;
    return {parameters.width, parameters.height};
  }

  /// Reads the next packet. Returns its time stamp in the file, ms; nothing at the end.
  std::optional<std::int64_t> readNextPacket() {
    for (;;) {
      av_packet_unref(packet_.get());
      if (av_read_frame(input_.get(), packet_.get()) < 0) return std::nullopt;
      if (packet_->pts == AV_NOPTS_VALUE || packet_->stream_index != 0) continue;
      return av_rescale_q(packet_->pts, input_->streams[0]->time_base, AVRational{1, 1000});
    }
  }

  /// Converts the current packet to Annex B form; false if it is damaged.
  bool readPicture(std::vector<std::uint8_t>& data) {
    if (av_bsf_send_packet(to_annex_b_.get(), packet_.get()) < 0) {
      av_bsf_flush(to_annex_b_.get());
      return false;
    }
    if (av_bsf_receive_packet(to_annex_b_.get(), packet_.get()) < 0) return false;
    data.assign(packet_->data, packet_->data + packet_->size);
    return true;
  }

 private:
  ffmpeg::Input input_;
  ffmpeg::Filter to_annex_b_;
  ffmpeg::Packet packet_ = ffmpeg::makePacket();
  StreamFormat format_;
};

std::string seconds(std::int64_t milliseconds) {
  return fixedText(1e-3 * static_cast<double>(milliseconds), 2) + " s";
}

/// Pictures of one segment with one kind of damage.
struct DamageCount {
  std::uint64_t count = 0;
  std::int64_t first_ms = 0;

  void add(std::int64_t time_ms) {
    if (count++ == 0) first_ms = time_ms;
  }
};

EncodedUnit toEncodedUnit(const IndexRow& row) {
  EncodedUnit unit;
  static_cast<FrameTimestamps&>(unit) = row;
  unit.pts = row.pts;
  unit.first_arrival_ns = row.first_arrival_ns;
  unit.reference_us = row.reference_us;
  unit.status = row.status;
  unit.data_lost = row.data_lost;
  unit.key = row.key;
  return unit;
}

}  // namespace

struct RecordingReader::Implementation {
  std::vector<RecordingSegment> segments;
  CameraSide side = CameraSide::left;
  std::size_t next_segment = 0;
  RecordingDamage damage;

  // The current segment, if `video` has a value.
  std::optional<SegmentVideo> video;
  std::filesystem::path video_file;
  std::uint64_t segment = 0;
  RecordingIndex index;
  std::size_t next_row = 0;
  DamageCount lost, altered, unknown;
  bool damaged_since_key = false;  ///< data are missing since the last key picture

  /// Opens the next segment that contains a file of this camera. False if there is none.
  bool openNextSegment() {
    while (next_segment < segments.size()) {
      const RecordingSegment& candidate = segments[next_segment++];
      const bool has_video = std::filesystem::exists(candidate.video(side));
      const bool has_index = std::filesystem::exists(candidate.index(side));
      if (!has_video && !has_index) continue;  // the camera sent nothing during this segment
      try {
        openSegment(candidate);
        return true;
      } catch (const std::runtime_error& error) {
        damage.lost += index.rows.size();
        damaged_since_key = true;
        addDamage(error.what());
      }
    }
    return false;
  }
  void openSegment(const RecordingSegment& opened) {
    index = {};
    index = readRecordingIndex(opened.index(side));
    video_file = opened.video(side);
    video.emplace(video_file);
    segment = opened.number;
    next_row = 0;
    lost = altered = unknown = {};
  }
  bool readFromSegment(RecordedUnit& recorded) {
    while (const std::optional<std::int64_t> time_ms = video->readNextPacket()) {
      const IndexRow* row = findRow(*time_ms);
      if (row == nullptr) {
        unknown.add(*time_ms);
        damaged_since_key = true;
        continue;
      }
      if (row->key) damaged_since_key = false;
      recorded.unit = toEncodedUnit(*row);
      const bool intact = video->readPicture(recorded.unit.data) &&
                          pictureChecksum(video->format().codec, recorded.unit.data) == row->checksum;
      if (!intact) {
        altered.add(row->time_ms);
        damaged_since_key = true;
      }
      if (recorded.unit.data.empty()) continue;
      if (damaged_since_key) recorded.unit.status = FrameStatus::damaged;
      recorded.format = video->format();
      recorded.picture_size = video->pictureSize();
      recorded.segment = segment;
      recorded.connection = row->connection;
      return true;
    }
    return false;
  }
  /// The row of the picture with that file time. Counts the pictures of skipped rows as lost.
  const IndexRow* findRow(std::int64_t time_ms) {
    for (; next_row < index.rows.size() && index.rows[next_row].time_ms < time_ms; ++next_row) {
      lost.add(index.rows[next_row].time_ms);
      damaged_since_key = true;
    }
    if (next_row == index.rows.size() || index.rows[next_row].time_ms != time_ms) return nullptr;
    return &index.rows[next_row++];
  }
  void closeSegment() {
    for (; next_row < index.rows.size(); ++next_row) {
      lost.add(index.rows[next_row].time_ms);
      damaged_since_key = true;
    }
    const auto describe = [&](const DamageCount& tally, const char* what) {
      if (tally.count == 0) return;
      addDamage(video_file.string() + " is damaged or truncated: " + std::to_string(tally.count) + what +
                ", the first at " + seconds(tally.first_ms));
    };
    describe(lost, " pictures cannot be read");
    describe(altered, " pictures differ from their checksum");
    if (!index.damage.empty() || unknown.count > 0) {
      const std::string location = index.damage.empty()
                                       ? "the index of " + video_file.string() + " is shorter than the video"
                                       : index.damage;
      addDamage(location + ": " + std::to_string(unknown.count) + " pictures have no line");
    }
    damage.lost += lost.count;
    damage.altered += altered.count + unknown.count;
    video.reset();
  }
  void addDamage(const std::string& sentence) {
    if (damage.places.size() < kMaxDamagePlaces) damage.places.push_back(sentence);
  }
};

RecordingReader::RecordingReader(const std::filesystem::path& folder, CameraSide side)
    : implementation_(std::make_unique<Implementation>()) {
  keepFfmpegQuiet();
  Implementation& self = *implementation_;
  self.side = side;
  self.segments = recordingSegments(folder);
  if (self.openNextSegment()) return;
  const std::string reason = self.damage.places.empty() ? "" : ": " + self.damage.places.front();
  throw std::runtime_error("the recording " + folder.string() + " contains no picture of the " +
                           sideName(side) + " camera" + reason);
}

RecordingReader::~RecordingReader() = default;

bool RecordingReader::next(RecordedUnit& recorded) {
  Implementation& self = *implementation_;
  while (self.video || self.openNextSegment()) {
    if (self.readFromSegment(recorded)) return true;
    self.closeSegment();
  }
  return false;
}

const RecordingDamage& RecordingReader::damage() const {
  return implementation_->damage;
}

}  // namespace cartvo::capture
