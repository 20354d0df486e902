// Matroska file and index of one camera's segment.

#include "capture/recording/stream_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/nal_units.hpp"
#include "capture/codec/picture_checksum.hpp"
#include "capture/recording/recording_index.hpp"
#include "common/durable_file.hpp"

namespace cartvo::capture {
namespace {

constexpr std::int64_t kMaxExposureStep_ns =
    10'000'000'000;  ///< a larger step means that the camera's clock was set
constexpr std::int64_t kMaxStart_ns = 600'000'000'000;  ///< a later start means that the host's clock was set

void closeOutput(AVFormatContext* output) {
  if (output == nullptr) return;
  avio_closep(&output->pb);
  avformat_free_context(output);
}

}  // namespace

StreamWriter::StreamWriter(const RecordingSegment& segment, CameraSide side, const StreamFormat& format,
                           const EncodedUnit& first, std::int64_t epoch_ns)
    : video_file_(segment.video(side)),
      index_file_(segment.index(side)),
      codec_(format.codec),
      epoch_ns_(epoch_ns),
      output_(nullptr, closeOutput) {
  keepFfmpegQuiet();
  refuseLink(index_file_);
  refuseLink(video_file_);
  errno = 0;
  index_.open(index_file_);
  index_ << indexHeader() << '\n' << std::flush;
  if (!index_) throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
  open(format, first);
  syncToDisk(segment.folder);
}

StreamWriter::~StreamWriter() {
  av_write_trailer(output_.get());
}

void StreamWriter::open(const StreamFormat& format, const EncodedUnit& first) {
  AVFormatContext* output = nullptr;
  requireSuccess(avformat_alloc_output_context2(&output, nullptr, "matroska", video_file_.c_str()));
  output_.reset(output);
  output->flags |= AVFMT_FLAG_BITEXACT;  // no random identifier: the same pictures make the same file
  AVStream* stream = avformat_new_stream(output, nullptr);
  if (stream == nullptr) throw std::bad_alloc();
  std::vector<std::uint8_t> sets = parameterSets(format.codec, first.data);
  if (sets.empty()) sets = format.parameter_sets;
  stream->codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
  stream->codecpar->codec_id = ffmpeg::codecId(format.codec);
  ffmpeg::setExtradata(*stream->codecpar, sets);
  ffmpeg::readPictureSize(*stream->codecpar, first.data);
  stream->time_base = {1, 1000};
  requireSuccess(avio_open(&output->pb, video_file_.c_str(), AVIO_FLAG_WRITE));
  requireSuccess(avformat_write_header(output, nullptr));
}

void StreamWriter::write(const EncodedUnit& unit, const StreamFormat& format, std::uint64_t connection) {
  std::vector<std::uint8_t> with_parameter_sets;
  const std::vector<std::uint8_t>* data = &unit.data;
  if (units_ > 0 && connection != last_connection_ && parameterSets(codec_, unit.data).empty()) {
    // The file's header has the first connection's parameter sets; those of a later one go into the stream.
    with_parameter_sets = format.parameter_sets;
    with_parameter_sets.insert(with_parameter_sets.end(), unit.data.begin(), unit.data.end());
    data = &with_parameter_sets;
  }
  last_connection_ = connection;

  IndexRow row;
  static_cast<FrameTimestamps&>(row) = unit;
  row.number = units_;
  row.time_ms = nextFileTimeMs(unit);
  row.connection = connection;
  row.pts = unit.pts;
  row.reference_us = unit.reference_us;
  row.first_arrival_ns = unit.first_arrival_ns;
  row.size = unit.data.size();
  row.checksum = pictureChecksum(codec_, unit.data);
  row.key = unit.key;
  row.data_lost = unit.data_lost;
  row.status = unit.status;
  writeVideo(*data, row.time_ms, unit.key);
  index_ << formatIndexRow(row) << '\n';
  ++units_;
}

void StreamWriter::writeVideo(const std::vector<std::uint8_t>& data, std::int64_t time_ms, bool key) {
  packet_->data = const_cast<std::uint8_t*>(data.data());  // only read
  packet_->size = static_cast<int>(data.size());
  packet_->pts = packet_->dts = time_ms;
  packet_->flags = key ? AV_PKT_FLAG_KEY : 0;
  packet_->stream_index = 0;
  av_packet_rescale_ts(packet_.get(), AVRational{1, 1000}, output_->streams[0]->time_base);
  const int result = av_write_frame(output_.get(), packet_.get());
  packet_->data = nullptr;
  packet_->size = 0;
  requireSuccess(result);
}

/// File time of the next picture, ms from the segment's start, strictly increasing: from the exposures, or
/// from the arrivals where a camera's clock was set.
std::int64_t StreamWriter::nextFileTimeMs(const EncodedUnit& unit) {
  if (units_ == 0) {
    last_time_ms_ = std::clamp<std::int64_t>(unit.arrival_ns - epoch_ns_, 0, kMaxStart_ns) / 1'000'000;
  } else {
    std::int64_t step_ns = unit.exposure_ns - last_exposure_ns_;
    if (step_ns <= 0 || step_ns > kMaxExposureStep_ns) step_ns = unit.arrival_ns - last_arrival_ns_;
    last_time_ms_ += std::max<std::int64_t>((step_ns + 500'000) / 1'000'000, 1);
  }
  last_exposure_ns_ = unit.exposure_ns;
  last_arrival_ns_ = unit.arrival_ns;
  return last_time_ms_;
}

/// Syncs the pictures before their index lines, so that each line has a picture.
void StreamWriter::sync() {
  requireSuccess(av_write_frame(output_.get(), nullptr));
  avio_flush(output_->pb);
  requireSuccess(output_->pb->error);
  syncToDisk(video_file_);
  errno = 0;
  index_.flush();
  if (!index_) throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
  syncToDisk(index_file_);
}

void StreamWriter::requireSuccess(int result) const {
  if (result < 0) {
    throw std::runtime_error("cannot write " + video_file_.string() + ": " + ffmpeg::errorText(result));
  }
}

}  // namespace cartvo::capture
