#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/codec/nal_units.hpp"
#include "capture/encoded_unit.hpp"

namespace cartvo::capture {

/// Whether decoding can begin with a picture, and whether it has recovered there.
struct PictureRefresh {
  bool is_access_point = false;  ///< decoding can begin with this picture
  bool is_complete = false;      ///< nothing wrong before the last access point affects this picture
};

/// Finds where a stream can be decoded from, and from where on nothing before matters: key pictures (IDR,
/// H.265's IRAP), recovery points (ITU-T H.264 D.2.8, H.265 D.3.8), which are complete some pictures later
/// (gradual refresh), and H.264 pictures of I slices alone. Reads no clock; deterministic.
class RefreshDetector {
 public:
  explicit RefreshDetector(const StreamFormat& format);

  /// Inspects the next picture, split into its NAL units.
  PictureRefresh inspect(const std::vector<NalUnit>& units);

  /// Picture data were lost or could not be decoded: a refresh in progress does not complete.
  void restart() { remaining_.reset(); }

 private:
  std::optional<int> picturesToRecovery(const std::vector<NalUnit>& units);

  VideoCodec codec_;
  int reference_pictures_ = 1;    ///< H.264: how many earlier pictures one is predicted from at most
  std::optional<int> remaining_;  ///< pictures until the refresh is complete
};

}  // namespace cartvo::capture
