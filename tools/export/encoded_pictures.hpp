#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "capture/camera_side.hpp"
#include "capture/recording/recording_reader.hpp"

namespace cartvo {

/// The encoded pictures of one camera of a recording, in the order of their arrival, as video players and
/// Foxglove need them: each is one access unit in Annex B form, and each key picture contains the parameter
/// sets. Begins at the first key picture. Nothing is encoded again.
class EncodedPictures {
 public:
  EncodedPictures(const std::filesystem::path& recording, capture::CameraSide side);

  bool isFinished() const { return finished_; }

  /// The current picture, unless it is finished.
  const std::vector<std::uint8_t>& data() const { return recorded_.unit.data; }
  std::int64_t exposureNs() const { return recorded_.unit.exposure_ns; }  ///< as recorded
  std::int64_t arrivalNs() const { return recorded_.unit.arrival_ns; }
  const char* codec() const;  ///< "h264" or "h265"

  void advance();

 private:
  void addParameterSets();

  capture::RecordingReader reader_;
  capture::RecordedUnit recorded_;
  std::vector<std::uint8_t> parameter_sets_;  ///< last ones of the stream
  bool finished_ = false;
};

}  // namespace cartvo
