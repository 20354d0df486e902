#include "capture/stream_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "capture/ffmpeg_log.hpp"
#include "capture/nal_units.hpp"
#include "capture/recording_index.hpp"

namespace cartvo {
namespace {

constexpr std::chrono::milliseconds kFlushInterval{500};
constexpr std::int64_t kLargestStep_ns = 10'000'000'000;  ///< beyond it the camera's clock was set

void closeOutput(AVFormatContext* output) {
  if (output == nullptr) return;
  avio_closep(&output->pb);
  avformat_free_context(output);
}

}  // namespace

StreamWriter::StreamWriter(const std::filesystem::path& folder, const std::string& stream)
    : video_file_(folder / (stream + ".mkv")),
      index_file_(folder / (stream + ".csv")),
      output_(nullptr, closeOutput) {
  keepFfmpegQuiet();
  index_.open(index_file_);
  index_ << indexHeader() << '\n' << std::flush;
  if (!index_) throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
}

StreamWriter::~StreamWriter() {
  if (output_) av_write_trailer(output_.get());
}

void StreamWriter::begin(const StreamFormat& format) {
  if (format_ && format_->codec != format.codec) {
    throw std::runtime_error("the camera changed its video codec, and " + video_file_.string() +
                             " cannot hold two; start a new recording");
  }
  format_ = format;
  connection_began_ = true;
}

bool StreamWriter::write(const EncodedUnit& unit) {
  if (!format_) return false;
  if (!output_) {
    if (!unit.key) return false;
    open(unit);
  }
  std::vector<std::uint8_t> with_parameter_sets;
  const std::vector<std::uint8_t>* data = &unit.data;
  if (connection_began_ && units_ > 0 && parameterSets(format_->codec, unit.data).empty()) {
    // The file's header has the first connection's; those of a later one must stand in the stream.
    with_parameter_sets = format_->parameter_sets;
    with_parameter_sets.insert(with_parameter_sets.end(), unit.data.begin(), unit.data.end());
    data = &with_parameter_sets;
  }
  connection_began_ = false;

  const std::int64_t time_ms = fileTime(unit);
  packet_->data = const_cast<std::uint8_t*>(data->data());  // only read
  packet_->size = static_cast<int>(data->size());
  packet_->pts = packet_->dts = time_ms;
  packet_->flags = unit.key ? AV_PKT_FLAG_KEY : 0;
  packet_->stream_index = 0;
  av_packet_rescale_ts(packet_.get(), AVRational{1, 1000}, output_->streams[0]->time_base);
  const int result = av_write_frame(output_.get(), packet_.get());
  packet_->data = nullptr;
  packet_->size = 0;
  check(result);

  index_ << toText({units_, time_ms, unit.sequence, unit.pts, unit.exposure_ns, unit.arrival_ns,
                    unit.instant_source, unit.data.size(), unit.key, unit.status})
         << '\n';
  ++units_;
  if (std::chrono::steady_clock::now() - last_flush_ >= kFlushInterval) flush();
  return true;
}

void StreamWriter::open(const EncodedUnit& first) {
  AVFormatContext* output = nullptr;
  check(avformat_alloc_output_context2(&output, nullptr, "matroska", video_file_.c_str()));
  output_.reset(output);
  AVStream* stream = avformat_new_stream(output, nullptr);
  if (stream == nullptr) throw std::bad_alloc();
  std::vector<std::uint8_t> sets = parameterSets(format_->codec, first.data);
  if (sets.empty()) sets = format_->parameter_sets;
  stream->codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
  stream->codecpar->codec_id = ffmpeg::codecId(format_->codec);
  ffmpeg::setExtradata(*stream->codecpar, sets);
  ffmpeg::readPictureSize(*stream->codecpar, first.data);
  stream->time_base = {1, 1000};
  check(avio_open(&output->pb, video_file_.c_str(), AVIO_FLAG_WRITE));
  check(avformat_write_header(output, nullptr));
}

/// Milliseconds from the file's beginning, increasing: by the exposures, or by the arrivals where a camera's
/// clock was set.
std::int64_t StreamWriter::fileTime(const EncodedUnit& unit) {
  if (last_time_ms_ < 0) {
    last_time_ms_ = 0;
  } else {
    std::int64_t step_ns = unit.exposure_ns - last_exposure_ns_;
    if (step_ns <= 0 || step_ns > kLargestStep_ns) step_ns = unit.arrival_ns - last_arrival_ns_;
    last_time_ms_ += std::max<std::int64_t>((step_ns + 500'000) / 1'000'000, 1);
  }
  last_exposure_ns_ = unit.exposure_ns;
  last_arrival_ns_ = unit.arrival_ns;
  return last_time_ms_;
}

void StreamWriter::flush() {
  last_flush_ = std::chrono::steady_clock::now();
  check(av_write_frame(output_.get(), nullptr));
  avio_flush(output_->pb);
  check(output_->pb->error);
  errno = 0;
  index_.flush();
  if (!index_) throw std::runtime_error("cannot write " + index_file_.string() + ": " + std::strerror(errno));
}

void StreamWriter::check(int result) const {
  if (result < 0) {
    throw std::runtime_error("cannot write " + video_file_.string() + ": " + ffmpeg::errorText(result));
  }
}

}  // namespace cartvo
