// IP camera over RTSP: connection state machine, assembly, timestamping and decoding.
#include "capture/rtsp/rtsp_camera.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "capture/clock/frame_period_estimator.hpp"
#include "capture/codec/video_decoder.hpp"
#include "capture/rtsp/access_unit_assembler.hpp"
#include "capture/rtsp/loss_detector.hpp"
#include "capture/rtsp/rtsp_session.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "capture/stream_remarks.hpp"
#include "common/exact_text.hpp"
#include "common/image_size.hpp"

namespace cartvo::capture {
namespace {

using Clock = RtspSession::Clock;
using std::chrono::milliseconds;

/// "30 s", "0.3 s": one decimal where needed, rounded up.
std::string inSeconds(milliseconds duration) {
  return roundedText(std::ceil(0.01 * static_cast<double>(duration.count())) / 10.0) + " s";
}

/// Converts the packets of one connection into numbered, timestamped units, and these into frames.
class PictureStream {
 public:
  PictureStream(const StreamFormat& format, const RtspCameraSettings& settings,
                StereoTimestamper& timestamper, CameraSide side, StreamRemarks& remarks)
      : assembler_(format.codec),
        losses_(format),
        timestamper_(timestamper),
        side_(side),
        remarks_(remarks),
        decoder_(format, settings.decoder_threads, settings.max_pixels) {
    timestamper_.connect(side_);
  }

  /// Kind of the data that have come since the last frame.
  enum class Progress : std::uint8_t { nothing, no_access_point, undecodable };
  Progress progress() const {
    if (!has_units_) return Progress::nothing;
    return has_begun_ ? Progress::undecodable : Progress::no_access_point;
  }
  void noteFrame() { has_units_ = false; }

  void add(const StreamFragment& fragment) { assembler_.add(fragment); }

  /// Removes and returns the next unit, numbered from `next_sequence` on, which is advanced. Nothing before
  /// the first picture where decoding can begin.
  std::optional<EncodedUnit> popUnit(std::uint64_t& next_sequence) {
    while (std::optional<AssembledUnit> assembled = assembler_.popUnit()) {
      const PictureInspection inspection = losses_.inspect(assembled->data, assembled->data_lost);
      has_units_ = true;
      if (!has_begun_ && !inspection.is_access_point) continue;
      has_begun_ = true;
      EncodedUnit unit;
      unit.key = inspection.is_access_point;
      unit.status = inspection.status;
      next_sequence += countMissedFrames(*assembled);
      unit.sequence = next_sequence++;
      unit.data = std::move(assembled->data);
      unit.pts = assembled->pts;
      unit.data_lost = assembled->data_lost;
      unit.reference_us = assembled->reference_us;
      unit.first_arrival_ns = assembled->first_arrival_ns;
      unit.arrival_ns = assembled->arrival_ns;
      const auto instant = timestamper_.stamp(side_, {unit.pts, unit.reference_us, unit.first_arrival_ns});
      if (!instant.is_usable) remarks_.add(StreamRemarks::Kind::time);
      setTimestamp(unit, instant);
      return unit;
    }
    return std::nullopt;
  }

  const AccessUnitAssembler& assembler() const { return assembler_; }

  VideoDecoder& decoder() { return decoder_; }
  const VideoDecoder& decoder() const { return decoder_; }

 private:
  /// Number of pictures missing between the previous one and this one, by the RTP time stamps, where packets
  /// were lost. Without a loss none is missing: a camera may send fewer pictures at night.
  std::uint64_t countMissedFrames(const AssembledUnit& unit) {
    const std::int64_t period = period_.periodNs();
    const std::int64_t step = last_pts_ ? unit.pts - *last_pts_ : 0;
    last_pts_ = unit.pts;
    period_.add(unit.pts);
    if (!unit.data_lost || period == 0 || step < period) return 0;
    const auto periods = std::llround(static_cast<double>(step) / static_cast<double>(period));
    return static_cast<std::uint64_t>(std::max(std::min(periods, kMaxMissed) - 1, 0LL));
  }

  static constexpr long long kMaxMissed = 10'000;

  AccessUnitAssembler assembler_;
  LossDetector losses_;
  StereoTimestamper& timestamper_;
  CameraSide side_;
  StreamRemarks& remarks_;
  FramePeriodEstimator period_;  ///< in RTP ticks instead of ns
  std::optional<std::int64_t> last_pts_;
  bool has_begun_ = false;  ///< a picture where decoding can begin has come
  bool has_units_ = false;  ///< a picture has come since the last frame
  VideoDecoder decoder_;
};

}  // namespace

/// Implementation of RtspCamera: connects, receives and reconnects in the thread that calls `read`.
class RtspCamera::Receiver {
 public:
  explicit Receiver(const RtspCameraSettings& settings) : settings_(settings) {
    checkSettings(settings_);
    frozen_text_.append(camera_).append(" is frozen: it has sent the same picture for more than ");
    frozen_text_.append(inSeconds(settings_.frozen_after)).append("; switch it off and on");
    health_.instant_source = InstantSource::arrival;
  }

  void setObserver(StreamObserver& observer) { observer_ = &observer; }
  void setTimestamper(StereoTimestamper& timestamper, CameraSide side) {
    timestamper_ = &timestamper;
    side_ = side;
  }

  ReadOutcome read(Frame& frame, milliseconds timeout) {
    const Clock::time_point deadline = Clock::now() + timeout;
    for (;;) {
      if (interrupted_) return finish();
      if (stream_ && popFrame(frame)) return ReadOutcome::frame;
      if (session_) {
        receive();
      } else if (waitUntil(std::min(next_attempt_, deadline)) && Clock::now() >= next_attempt_) {
        connect();
      }
      if (interrupted_) return finish();
      if (stream_ && popFrame(frame)) return ReadOutcome::frame;
      if (Clock::now() >= deadline) return ReadOutcome::timed_out;
    }
  }

  CameraHealth health() const {
    const std::lock_guard lock(mutex_);
    return health_;
  }

  void interrupt() noexcept {
    {
      const std::lock_guard lock(mutex_);
      interrupted_ = true;
    }
    wake_.notify_all();
  }

 private:
  /// Waits. False if interrupted.
  bool waitUntil(Clock::time_point instant) {
    std::unique_lock lock(mutex_);
    return !wake_.wait_until(lock, instant, [this] { return interrupted_.load(); });
  }

  void connect() {
    try {
      session_.emplace(settings_, interrupted_);
      stream_.emplace(session_->format(), settings_, *timestamper_, side_, session_->remarks());
    } catch (const RtspError& error) {
      disconnect();
      if (error.kind() == RtspError::Kind::interrupted) return;
      const bool refused = error.kind() == RtspError::Kind::refused;
      const RefusedLogin refusal =
          refused && settings_.ask_about_refusal ? settings_.ask_about_refusal(interrupted_) : RefusedLogin();
      if (interrupted_) return;
      const milliseconds pause = refused ? refusedPause(refusal) : failurePause();
      retryAfter(pause);
      const std::lock_guard lock(mutex_);
      health_.state = refused ? CameraState::refused : CameraState::connecting;
      health_.last_error = error.what();
      if (!refusal.text.empty()) health_.last_error += "; " + refusal.text;
      if (refused) health_.last_error += "; trying again in " + inSeconds(pause);
      return;
    }
    connected_at_ = Clock::now();
    frame_deadline_ =
        connected_at_ + settings_.connect_timeout;  // a camera may send nothing until its next key frame
    if (observer_ != nullptr) observer_->onStream(session_->format());
    remarks_.clear();
    timestamper_->setReportNote(side_, {});
    const std::lock_guard lock(mutex_);
    health_.advice.clear();
  }

  void receive() {
    switch (session_->receive(fragment_, frame_deadline_)) {
      case RtspSession::Outcome::fragment:
        stream_->add(fragment_);
        noteRemarks();
        while (std::optional<EncodedUnit> unit = stream_->popUnit(next_sequence_)) {
          if (observer_ != nullptr) observer_->onUnit(*unit);
          stream_->decoder().send(*unit);
          collectFrames();
        }
        break;
      case RtspSession::Outcome::timed_out:
        closeStream(CameraState::stalled, camera_ + " " + whyNoFrame() + "; reconnecting");
        break;
      case RtspSession::Outcome::lost:
        closeStream(CameraState::connecting,
                    "the connection to " + camera_ + " was lost (" + session_->reason() + "); reconnecting");
        break;
      case RtspSession::Outcome::interrupted:
        break;
    }
  }

  /// Takes over what the session and the assembler have left out.
  void noteRemarks() {
    StreamRemarks& all = session_->remarks();
    const AccessUnitAssembler& assembler = stream_->assembler();
    all.setTotal(StreamRemarks::Kind::structure, assembler.leftOut(), assembler.leftOutText());
    all.setTotal(StreamRemarks::Kind::undecodable, stream_->decoder().failures());
    if (all.text() == remarks_ && stream_->decoder().reorders() == reorders_) return;
    remarks_ = all.text();
    reorders_ = stream_->decoder().reorders();
    timestamper_->setReportNote(side_, all.text(StreamRemarks::Kind::report));
    const std::lock_guard lock(mutex_);
    health_.advice = remarks_.empty() ? "" : "left out of what " + camera_ + " sends: " + remarks_;
    if (!reorders_) return;
    if (!remarks_.empty()) health_.advice += "; ";
    health_.advice += camera_ +
                      " sends B-frames, which delay its pictures by some frame periods; switch them off in "
                      "the camera (H.264 profile Baseline, or no smart codec)";
  }

  /// Why no frame came in time, and what was left out.
  std::string whyNoFrame() {
    const std::string& left_out = session_->remarks().text();
    return whyNoPicture() + (left_out.empty() ? "" : "; left out: " + left_out);
  }

  /// No packets, or packets that give no picture.
  std::string whyNoPicture() {
    if (const cv::Size refused = stream_->decoder().refusedSize(); !refused.empty()) {
      return "sends pictures of " + sizeText(refused) + ", which are too large: at most " +
             std::to_string(settings_.max_pixels / 1000) + " thousand pixels are accepted";
    }
    std::string nothing = "sent no picture for " + std::to_string(frameTimeout().count()) + " ms";
    const auto progress = stream_->progress();
    const bool is_left_out = session_->remarks().count(StreamRemarks::Kind::structure) > 0;
    if (progress == PictureStream::Progress::nothing && settings_.transport == RtspTransport::udp)
      return nothing + " over UDP: let its packets through firewalls, or set cameras.transport: tcp";
    if (progress == PictureStream::Progress::nothing || is_left_out) return nothing;
    if (progress == PictureStream::Progress::no_access_point)
      return nothing +
             " that decoding can begin with (key picture, I-frame): set its I-frame interval to one second";
    if (!stream_->decoder().hasParameterSets())
      return nothing + ", as parameter sets (SPS, PPS) are missing; restart it";
    return nothing + " that can be decoded" + (streaming_ ? "" : ": switch encryption off in the camera");
  }

  milliseconds frameTimeout() const {
    return streaming_ ? settings_.stall_timeout : settings_.connect_timeout;
  }

  void collectFrames() {
    while (std::optional<Frame> frame = stream_->decoder().receive()) {
      streaming_ = true;
      stream_->noteFrame();
      frame_deadline_ =
          Clock::now() + settings_.stall_timeout;  // packets without a picture count as a stall, too
      failures_ = 0;
      refusals_ = 0;
      // One unit gives one frame; several are queued only if the decoder reorders.
      if (frames_.size() >= kMaxQueuedFrames) {
        frames_.pop_front();
        session_->remarks().add(StreamRemarks::Kind::overflow);
      }
      frames_.push_back(std::move(*frame));
    }
  }

  bool popFrame(Frame& frame) {
    if (frames_.empty()) return false;
    frame = std::move(frames_.front());
    frames_.pop_front();
    const bool frozen = frozen_detector_.update(frame.image, Clock::now()) >= settings_.frozen_after;
    const std::lock_guard lock(mutex_);
    health_.state = frozen ? CameraState::frozen : CameraState::streaming;
    if (frozen) health_.last_error = frozen_text_;
    health_.instant_source = frame.instant_source;
    ++health_.frames;
    if (frame.status == FrameStatus::damaged) ++health_.damaged;
    return true;
  }

  void closeStream(CameraState state, const std::string& reason) {
    // Reconnect at once if this connection delivered frames for a moment; otherwise pause, so that a camera
    // that only accepts connections, or ends each with its first picture, is not polled in a tight loop.
    if (streaming_) {
      next_attempt_ = connected_at_ + std::min(settings_.first_retry, kShortestConnection);
    } else {
      retryAfter(failurePause());
    }
    disconnect();
    const std::lock_guard lock(mutex_);
    health_.state = state;
    health_.last_error = reason;
    ++health_.reconnections;
  }

  void disconnect() {
    streaming_ = false;
    stream_.reset();
    session_.reset();
  }

  void retryAfter(milliseconds pause) { next_attempt_ = Clock::now() + pause; }

  milliseconds failurePause() { return backoff(settings_.first_retry, failures_++, settings_.longest_retry); }

  /// A camera is asked less and less often, and not while it states a lock: that may lock it anew. A stated
  /// lock only lengthens the pause, so that no answer of a camera leads to quick logins.
  milliseconds refusedPause(const RefusedLogin& refusal) {
    const milliseconds pause = backoff(settings_.refused_retry, refusals_++, settings_.longest_refused_retry);
    if (!refusal.locked_for) return pause;
    return std::max(pause, std::min(*refusal.locked_for, kMaxLock - kLockMargin) + kLockMargin);
  }

  static milliseconds backoff(milliseconds first, int times, milliseconds longest) {
    return std::min(longest, first * (1 << std::min(times, 16)));
  }

  ReadOutcome finish() {
    disconnect();
    frames_.clear();
    const std::lock_guard lock(mutex_);
    health_.state = CameraState::ended;
    return ReadOutcome::ended;
  }

  static constexpr std::size_t kMaxQueuedFrames = 16;
  static constexpr milliseconds kShortestConnection{250}, kLockMargin{1000}, kMaxLock{2 * 60 * 60 * 1000};

  const RtspCameraSettings settings_;
  const std::string camera_ = "the camera at " + rtspHost(settings_.url);  ///< for messages
  StreamObserver* observer_ = nullptr;
  StereoTimestamper own_timestamper_{ClockChoice::ntp};
  StereoTimestamper* timestamper_ = &own_timestamper_;
  CameraSide side_ = CameraSide::left;

  // Used by the reading thread only.
  std::optional<RtspSession> session_;
  std::optional<PictureStream> stream_;
  StreamFragment fragment_;
  std::deque<Frame> frames_;
  FrozenPictureDetector frozen_detector_;
  std::string frozen_text_;
  bool streaming_ = false;  ///< this connection has delivered a frame
  Clock::time_point connected_at_, frame_deadline_, next_attempt_;
  std::uint64_t next_sequence_ = 0;
  int failures_ = 0;
  int refusals_ = 0;
  std::string remarks_;    ///< text of what this connection has left out
  bool reorders_ = false;  ///< its pictures come in another order than they were taken in

  mutable std::mutex mutex_;  ///< guards health_
  std::condition_variable wake_;
  std::atomic<bool> interrupted_ = false;
  CameraHealth health_;
};

RtspCamera::RtspCamera(const RtspCameraSettings& settings)
    : receiver_(std::make_unique<Receiver>(settings)) {}
RtspCamera::~RtspCamera() = default;

void RtspCamera::setObserver(StreamObserver& observer) {
  receiver_->setObserver(observer);
}
void RtspCamera::setTimestamper(StereoTimestamper& timestamper, CameraSide side) {
  receiver_->setTimestamper(timestamper, side);
}
ReadOutcome RtspCamera::read(Frame& frame, milliseconds timeout) {
  return receiver_->read(frame, timeout);
}
CameraHealth RtspCamera::health() const {
  return receiver_->health();
}
void RtspCamera::interrupt() noexcept {
  receiver_->interrupt();
}

}  // namespace cartvo::capture
