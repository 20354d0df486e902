#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/codec/nal_units.hpp"
#include "capture/codec/refresh_detector.hpp"
#include "capture/encoded_unit.hpp"

namespace cartvo::capture {

/// Status of a received picture, and whether decoding can begin with it.
struct PictureInspection {
  FrameStatus status = FrameStatus::damaged;
  bool is_access_point = false;  ///< as PictureRefresh's
};

/// Detects that pictures are missing from a stream, and marks the pictures up to the next refresh (see
/// RefreshDetector) as damaged, because each picture is predicted from earlier ones. The pictures before the
/// first refresh are damaged, too. Reads no clock; deterministic.
///
/// The receiver finds lost packets by their sequence numbers. H.264 also numbers its reference pictures
/// (frame_num, ITU-T H.264 7.4.3), which shows pictures that a relay has left out. Gaps in time show nothing:
/// a camera may send fewer pictures at night.
class LossDetector {
 public:
  explicit LossDetector(const StreamFormat& format);

  /// Inspects the next picture. `data_lost`: the receiver knows that data are missing before or in it.
  PictureInspection inspect(std::span<const std::uint8_t> unit, bool data_lost);

 private:
  bool isReferenceMissing(const std::vector<NalUnit>& units);
  bool isReferenceMissing(const NalUnit& slice);

  VideoCodec codec_;
  std::optional<H264SequenceParameters> parameters_;
  std::optional<std::uint32_t> last_reference_;  ///< frame_num of the last reference picture
  RefreshDetector refreshes_;
  bool damaged_ = true;
};

}  // namespace cartvo::capture
