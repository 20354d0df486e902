#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "tools/simulate/content.hpp"
#include "tools/simulate/stream/encode_content.hpp"
#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// A drive that was recorded by cartvod or written by recordFolder(): the simulated cameras send its pictures
/// as they are. The content starts with the left camera's first picture.
class RecordedDrive : public ContentDescription {
 public:
  /// Reads the recording, its rig, and the truth from truth.tum in the folder, if that is there. `seconds`:
  /// the length to be played, 0: all. `settings`: of the blank lead-in. Throws std::runtime_error naming the
  /// problem if there are no pictures of one camera, if they are not H.264, or if the rig is missing.
  RecordedDrive(const std::filesystem::path& folder, double seconds, const EncoderSettings& settings);

  calib::Rig rig() const override { return rig_; }
  double frameRate() const override { return streams_->left.frame_rate; }
  int pairCount() const override;
  std::int64_t leftInstant(int index) const override;
  std::int64_t rightInstant(int index) const override;
  Trajectory truth() const override;
  Trajectory denseTruth() const override { return truth_; }

  std::shared_ptr<const EncodedPair> streams() const { return streams_; }

 private:
  calib::Rig rig_;
  std::shared_ptr<const EncodedPair> streams_;
  Trajectory truth_;  ///< times since the content's start
};

/// The folder of the sample drive that is installed beside the running program, or in its build folder. Empty
/// if it is not there.
std::filesystem::path sampleDrive();

}  // namespace cartvo::simulate
