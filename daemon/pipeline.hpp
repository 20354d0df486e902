#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <opencv2/core/types.hpp>

#include "capture/camera_source.hpp"
#include "daemon/pair_processor.hpp"

namespace cartvo {

/// Why there is no result where one was due.
enum class NoPairCause : std::uint8_t {
  no_frames,   ///< a camera delivers nothing
  no_partner,  ///< both deliver, but no two frames belong together
  damaged,     ///< frames came, but their pictures are damaged
  wrong_size,  ///< a stream's size is not the rig's
};

/// A pair that was due by the frame rate but did not come.
struct NoPair {
  std::int64_t due_ns = 0;  ///< host's clock, ns since the Unix epoch
  NoPairCause cause = NoPairCause::no_frames;
};

/// Receives what the pipeline makes, in order, on the thread that runs it. `no_pair` is for live only and may
/// be empty.
struct PipelineSink {
  std::function<void(const PairResult&)> pair;
  std::function<void(const NoPair&)> no_pair;
};

struct PipelineSettings {
  cv::Size image_size;         ///< the rig's: frames of another size are refused
  std::int64_t period_ns = 0;  ///< between a camera's frames; 0: learned from them (replay only). Frames pair
                               ///< within half of it.
};

/// What was made of the frames since the start.
struct PipelineCounts {
  std::uint64_t pairs = 0;                 ///< made by the synchroniser
  std::uint64_t processed = 0;             ///< of these, given to the odometry
  std::uint64_t skipped = 0;               ///< of these, left out to stay current (live only)
  std::uint64_t refused_size = 0;          ///< frames whose size is not the rig's (live only)
  std::uint64_t dropped_no_partner = 0;    ///< frames whose partner never came
  std::uint64_t dropped_damaged = 0;       ///< frames marked as damaged
  std::uint64_t dropped_out_of_order = 0;  ///< frames older than one before
  std::uint64_t dropped_overflow = 0;      ///< frames there was no room for
  std::uint64_t dropped_clock = 0;         ///< frames that waited when the host's clock was set back
};

/// How long ago each camera's reader went round, in seconds; it does so with or without frames, at least
/// after the camera's connection time-out.
struct PipelineProgress {
  double left_reader = 0.0;
  double right_reader = 0.0;
};

/// The path of a frame through the program:
/// CameraSource x 2 -> PairSynchroniser -> PairProcessor (rectification, odometry, body motion) -> sink.
class Pipeline {
 public:
  /// The sources and the processor are borrowed and must outlive the pipeline.
  Pipeline(CameraSource& left, CameraSource& right, PairProcessor& processor,
           const PipelineSettings& settings);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Replay: pulls both sources to their ends on this thread, the one first whose next frame was recorded
  /// first, or exposed first where that is not known, and processes every pair; the same sources give the
  /// same results. Throws what the sources and the sink throw, and std::runtime_error if a frame's size is
  /// not the rig's.
  void replay(const PipelineSink& sink);

  /// Live: a thread per camera reads and pairs; this thread processes the newest pair and skips older ones,
  /// so that nothing ever waits in a queue. Where pairs take too long, fewer features are looked for
  /// (FeatureBudget). A pair is missed when a whole period has passed after it was due;
  /// the sink then hears of it, and again each period until one comes. Returns after `stop`, or when both
  /// sources have ended. Throws what a source, the processor or the sink throws, after all threads have
  /// ended.
  void runLive(const PipelineSink& sink);

  /// Ends `runLive` and `replay`. From any thread; interrupts the sources.
  void stop() noexcept;

  /// From any thread.
  PipelineCounts counts() const;

  /// What a person has to mend about the streams, as a sentence (a picture's size that is not the rig's);
  /// empty if there is nothing. From any thread.
  std::string problem() const;

  /// From any thread, while `runLive` runs.
  PipelineProgress progress() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
