#pragma once

#include <cstddef>
#include <filesystem>

#include "common/atomic_file.hpp"
#include "tools/calibrate/views/board_views.hpp"

namespace cartvo {

/// Keeps the images of views that were taken from streams, so that a calibration that fails later loses
/// none: a folder with image_0 (left) and image_1 (right), which `cartvo calibrate FOLDER` reads.
class KeptViews {
 public:
  /// Makes `folder`, or FOLDER-2, FOLDER-3, ... if there are views already. Throws std::runtime_error if that
  /// cannot be made.
  explicit KeptViews(const std::filesystem::path& folder);

  /// Writes both images. A failure is printed once, and does not end the collection of views.
  void add(const DetectedView& view);

  /// Removes the views, their folder and those above that were made for it and are empty.
  void remove() { folder_.remove(); }

  const std::filesystem::path& folder() const { return folder_.path(); }
  std::size_t count() const { return count_; }

 private:
  UnfinishedFolder folder_;
  std::size_t count_ = 0;
  bool has_failed_ = false;
};

}  // namespace cartvo
