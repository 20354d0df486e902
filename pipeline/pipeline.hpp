#pragma once

// The processing chain from two cameras to the sink, live or replayed.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "capture/camera_source.hpp"
#include "capture/clock/stereo_timestamper.hpp"
#include "pipeline/frame_periods.hpp"
#include "pipeline/pair_processor.hpp"

namespace cartvo::pipeline {

/// Reason why a pair that was due did not arrive.
enum class NoPairCause : std::uint8_t {
  no_frames,   ///< a camera delivers no frames
  no_partner,  ///< both deliver frames, but no two can be paired
  damaged,     ///< frames arrive, but their pictures are damaged
  wrong_size,  ///< a stream's image size is not the rig's
};

/// A pair that was due by the frame rate but did not arrive.
struct NoPair {
  std::int64_t due_ns = 0;  ///< ns since the Unix epoch, host's clock
  NoPairCause cause = NoPairCause::no_frames;
};

/// Receives the pipeline's results, in order, on the thread that runs it. `no_pair` is called only by runLive
/// and may be empty.
struct PipelineSink {
  std::function<void(const PairResult&)> pair;
  std::function<void(const NoPair&)> no_pair;
};

struct PipelineSettings {
  cv::Size image_size;         ///< of the rig; frames of another size are rejected
  std::int64_t period_ns = 0;  ///< frame period; 0: measured from the frames. Frames are paired within half
                               ///< of it.
  /// Receives the odometry's estimate of the time offset after each pair, before the sink: the clock model
  /// that stamps the next frames. May be empty.
  std::function<void(const std::optional<capture::OffsetEstimate>&)> set_visual_offset{};
  /// Receives each camera's frames before they are paired, on the thread that reads this camera (live only).
  /// Must not wait. May be empty.
  std::function<void(capture::CameraSide, const capture::Frame&)> frame{};
};

/// Numbers of pairs and frames since the start.
struct PipelineCounts {
  std::uint64_t pairs = 0;                 ///< pairs formed by the synchroniser
  std::uint64_t processed = 0;             ///< pairs processed by the odometry
  std::uint64_t skipped = 0;               ///< pairs dropped because a newer one was available (live only)
  std::uint64_t refused_size = 0;          ///< frames whose size is not the rig's (live only)
  std::uint64_t dropped_no_partner = 0;    ///< frames without a partner
  std::uint64_t dropped_damaged = 0;       ///< frames marked as damaged
  std::uint64_t dropped_out_of_order = 0;  ///< frames older than a previous one
  std::uint64_t dropped_overflow = 0;      ///< frames that exceeded the synchroniser's buffer
  std::uint64_t dropped_clock = 0;         ///< frames buffered when the host's clock was set back
  FramePeriods periods;                    ///< measured (live only)
};

/// Time since each camera's reader last started a read, s; 0 after the reader has ended. A reader loops with
/// or without frames, at the latest after the camera's connection time-out.
struct PipelineProgress {
  double left_reader = 0.0;
  double right_reader = 0.0;

  /// Name of the camera reader whose last read started more than `reader_timeout` s ago
  /// (LiveCamera::readerTimeout); empty if none is. The reader of an absent, silent or refusing camera still
  /// loops.
  std::string stalledReader(double reader_timeout) const;
};

/// Runs the processing chain
/// CameraSource x 2 -> PairSynchroniser -> PairProcessor (rectification, odometry, body motion) -> sink.
class Pipeline {
 public:
  /// The sources and the processor must outlive the pipeline.
  Pipeline(capture::CameraSource& left, capture::CameraSource& right, PairProcessor& processor,
           const PipelineSettings& settings);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Replay: reads both sources to their ends on this thread, merged in the order of recording or, where that
  /// is unknown, of exposure, and processes every pair. The same sources give the same results. Throws what
  /// the sources and the sink throw, and std::runtime_error if the size of a pair's image is not the rig's.
  void replay(const PipelineSink& sink);

  /// Live: one thread per camera reads frames and forms pairs; the calling thread processes the newest pair
  /// and skips older ones, so that no queue adds latency. If processing takes too long, the number of
  /// features is reduced (FeatureBudget). A pair is missed one period after it was due; the sink's `no_pair`
  /// is then called, and again each period until a pair arrives. Returns after `stop`, or when both sources
  /// have ended. Throws what a source, the processor or the sink throws, after all threads have ended.
  void runLive(const PipelineSink& sink);

  /// Ends `runLive` and `replay`; interrupts the sources. May be called from any thread.
  void stop() noexcept;

  /// May be called from any thread.
  PipelineCounts counts() const;

  /// Problem of a stream that the operator has to fix (an image size that is not the rig's); empty if there
  /// is none. May be called from any thread.
  std::string problem() const;

  /// Why both cameras deliver frames, but none have been paired for seconds; empty if some have. May be
  /// called from any thread.
  std::string pairingProblem() const;

  /// May be called from any thread while `runLive` runs.
  PipelineProgress progress() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::pipeline
