#pragma once

#include <filesystem>

#include "pipeline/pair_processor.hpp"
#include "pipeline/pair_view.hpp"
#include "tools/replay/video/mp4_writer.hpp"
#include "tools/replay/video/replay_picture.hpp"

namespace cartvo {

/// Writes a replay's video: a viewer of all pairs, which are drawn once they are processed.
class VideoRecorder final : public pipeline::PairViewer {
 public:
  /// Creates missing folders. Throws std::runtime_error if the file cannot be written, and what Mp4Writer
  /// throws.
  explicit VideoRecorder(const std::filesystem::path& file);

  pipeline::PairView* nextView() override { return &view_; }

  /// Draws and writes the pair that has been processed.
  void add(const pipeline::PairResult& result);

  /// Completes the file and gives it its name. Without this call nothing is left of it.
  void finish() { writer_.finish(); }

 private:
  Mp4Writer writer_;
  ReplayPictures pictures_;
  pipeline::PairView view_;
};

}  // namespace cartvo
