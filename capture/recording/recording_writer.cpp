// Segments of a recording, the streams in them, and its lock.
#include "capture/recording/recording_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "capture/camera_side.hpp"
#include "capture/codec/ffmpeg.hpp"
#include "capture/codec/ffmpeg_log.hpp"
#include "capture/codec/nal_units.hpp"
#include "capture/codec/picture_checksum.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/recording/recording_folder.hpp"
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

void prepareFolder(const std::filesystem::path& folder) {
  refuseLinkOfOthers(folder);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot create the folder " + folder.string() + ": " + error.message());
  if (isRecording(folder)) {
    throw std::runtime_error(folder.string() + " already contains a recording; choose another folder");
  }
  if (!std::filesystem::is_empty(folder, error) || error) {
    throw std::runtime_error(
        folder.string() +
        " is not empty; name a new folder, so that other files do not mix with the recording");
  }
}

int openDescriptionFile(const std::filesystem::path& folder) {
  return ::open((folder / "recording.json").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

}  // namespace

/// Writes one camera's stream as received into one segment: a Matroska file and its index. Internal to
/// capture: StreamRecorder handles its errors. All members throw std::runtime_error naming the file if it
/// cannot be written.
class StreamWriter {
 public:
  /// `first`: the key picture that the files begin with. File times are relative to `epoch_ns`, the segment's
  /// start by the host's clock.
  StreamWriter(const RecordingSegment& segment, CameraSide side, const StreamFormat& format,
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
    if (!index_)
      throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
    open(format, first);
    syncToDisk(segment.folder);
  }
  /// Finalises the files.
  ~StreamWriter() { av_write_trailer(output_.get()); }
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// Writes a picture. `connection`: the camera's connection, counted from 1; a new connection may have other
  /// parameter sets in `format`.
  void write(const EncodedUnit& unit, const StreamFormat& format, std::uint64_t connection) {
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

  /// Writes everything to the disk, so that it survives a power cut.
  void sync() {
    requireSuccess(av_write_frame(output_.get(), nullptr));
    avio_flush(output_->pb);
    requireSuccess(output_->pb->error);
    syncToDisk(video_file_);
    errno = 0;
    index_.flush();
    if (!index_)
      throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
    syncToDisk(index_file_);
  }

  VideoCodec codec() const { return codec_; }

 private:
  void open(const StreamFormat& format, const EncodedUnit& first) {
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
  void writeVideo(const std::vector<std::uint8_t>& data, std::int64_t time_ms, bool key) {
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
  std::int64_t nextFileTimeMs(const EncodedUnit& unit) {
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
  void requireSuccess(int result) const {
    if (result < 0) {
      throw std::runtime_error("cannot write " + video_file_.string() + ": " + ffmpeg::errorText(result));
    }
  }

  std::filesystem::path video_file_;
  std::filesystem::path index_file_;
  VideoCodec codec_;
  std::int64_t epoch_ns_;
  std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)> output_;
  ffmpeg::Packet packet_ = ffmpeg::makePacket();
  std::ofstream index_;
  std::uint64_t units_ = 0;
  std::uint64_t last_connection_ = 0;
  std::int64_t last_time_ms_ = 0;
  std::int64_t last_exposure_ns_ = 0;
  std::int64_t last_arrival_ns_ = 0;
};

RecordingWriter::RecordingWriter(std::filesystem::path folder, const RecordingInfo& info,
                                 std::chrono::nanoseconds segment_length)
    : folder_(std::move(folder)), segment_length_(segment_length) {
  prepareFolder(folder_);
  writeRecordingInfo(folder_, info);
  lock_ = openDescriptionFile(folder_);
  ::flock(lock_, LOCK_EX | LOCK_NB);  // if it fails, only another process's quota does not see the lock
}

RecordingWriter::~RecordingWriter() {
  if (lock_ >= 0) ::close(lock_);
}

void RecordingWriter::beginConnection(CameraSide which, const StreamFormat& format) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  side.format = format;
  ++side.connection;
}

bool RecordingWriter::write(CameraSide which, EncodedUnit unit) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  if (!side.format) return false;
  if (unit.key) openSegmentFor(which, unit);
  if (!side.writer || side.writer->codec() != side.format->codec) return false;
  unit.order = ++order_;
  side.writer->write(unit, *side.format, side.connection);
  return true;
}

/// Whether the key picture begins a new segment: the current one is long enough, the codec changed, or the
/// host's clock was set.
bool RecordingWriter::beginsNewSegment(const Side& side, const EncodedUnit& unit) const {
  if (!began_ns_) return true;
  if (side.segment != segment_) return false;
  const bool long_enough = std::abs(unit.arrival_ns - *began_ns_) >= segment_length_.count();
  return long_enough || (side.writer && side.writer->codec() != side.format->codec);
}

/// Opens the segment that this key picture of the camera belongs to, unless it is open.
void RecordingWriter::openSegmentFor(CameraSide which, const EncodedUnit& unit) {
  Side& side = sides_[static_cast<std::size_t>(which)];
  if (beginsNewSegment(side, unit)) {
    if (began_ns_) ++segment_;
    began_ns_ = unit.arrival_ns;
  }
  if (side.writer && side.segment == segment_) return;
  if (side.writer) {
    side.writer->sync();
    side.writer.reset();
  }
  const RecordingSegment segment = recordingSegment(folder_, segment_);
  refuseLink(segment.folder);
  std::error_code error;
  std::filesystem::create_directory(segment.folder, error);
  if (error) {
    throw std::runtime_error("cannot create the folder " + segment.folder.string() + ": " + error.message());
  }
  syncToDisk(folder_);
  side.segment = segment_;
  side.writer = std::make_unique<StreamWriter>(segment, which, *side.format, unit, *began_ns_);
}

void RecordingWriter::sync() {
  for (const Side& side : sides_) {
    if (side.writer) side.writer->sync();
  }
}

void RecordingWriter::endSegment() noexcept {
  for (Side& side : sides_)
    side.writer.reset();
  if (!began_ns_) return;
  ++segment_;
  began_ns_.reset();
}

std::uint64_t RecordingWriter::oldestOpenSegment() const {
  std::uint64_t oldest = began_ns_ || segment_ == 0 ? segment_ : segment_ - 1;
  for (const Side& side : sides_) {
    if (side.writer) oldest = std::min(oldest, side.segment);
  }
  return oldest;
}

bool isBeingWritten(const std::filesystem::path& recording) {
  const int descriptor = openDescriptionFile(recording);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0;
  ::close(descriptor);
  return locked;
}

}  // namespace cartvo::capture
