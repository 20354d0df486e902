#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/encoded_unit.hpp"

// Assembly of pictures from RTP packets, with minimum latency.

namespace cartvo::capture {

/// The payload of one RTP packet, in the order of sequence numbers: NAL units or a fragment of one (RFC 6184,
/// RFC 7798).
struct StreamFragment {
  std::span<const std::uint8_t> data;
  std::int64_t pts = 0;                      ///< RTP time stamp, unwrapped, 1/90000 s
  std::int64_t arrival_ns = 0;               ///< host's clock
  std::optional<std::int64_t> reference_us;  ///< exposure instant by the sender reports, if there is one
  bool ends_picture = false;                 ///< the packet's marker bit
  bool data_lost = false;                    ///< packets before this one are missing
};

/// One picture (access unit), assembled from its fragments.
struct AssembledUnit {
  std::vector<std::uint8_t> data;            ///< Annex B
  std::int64_t pts = 0;                      ///< of its first slice
  std::int64_t first_arrival_ns = 0;         ///< of its first slice's first fragment
  std::int64_t arrival_ns = 0;               ///< of its last fragment
  std::optional<std::int64_t> reference_us;  ///< of its first slice
  bool data_lost = false;
};

/// Assembles pictures from RTP payloads and delivers each one as soon as its last packet has arrived. Reads
/// no clock; deterministic.
///
/// A picture begins where the bit stream says so: with a slice whose first macroblock (first_mb_in_slice, or
/// first_slice_segment_in_pic_flag) is the picture's first, or with a NAL unit that may only precede the
/// slices of a picture (ITU-T H.264 7.4.1.2.3, H.265 7.4.2.4.4). RTP time stamps do not decide: cameras give
/// messages of their own (SEI) other ones. A new time stamp begins a picture only where packets are missing.
///
/// A picture ends with the packet that has the marker bit. Some senders set the bit on each slice, or never.
/// So it is used only after it was right for kConfirmationsNeeded pictures in a row, a key picture among
/// them; until then a picture is complete when the next one begins. If the bit is wrong later, the incomplete
/// picture and those after it are marked as damaged up to the next key picture, and it is not used again.
class AccessUnitAssembler {
 public:
  explicit AccessUnitAssembler(VideoCodec codec) : codec_(codec) {}

  void add(const StreamFragment& fragment);

  /// Removes and returns the next complete picture, or nothing.
  std::optional<AssembledUnit> popUnit();

  /// Number of payloads that were left out, and what is wrong with the last one: "that are cut off".
  std::uint64_t leftOut() const { return left_out_; }
  const std::string& leftOutText() const { return left_out_text_; }

  /// Whether the marker bit is confirmed: pictures are delivered with their last packet.
  bool completesEarly() const {
    return !marker_rejected_ && confirmations_ >= kConfirmationsNeeded && confirmed_on_key_;
  }

 private:
  static constexpr int kConfirmationsNeeded = 4;           // pictures: a key picture and three others
  static constexpr std::size_t kMaxUnitBytes = 16U << 20;  // larger than any camera's picture

  void addH264(const StreamFragment& fragment);
  void addH265(const StreamFragment& fragment);
  void addAggregate(std::span<const std::uint8_t> data, const StreamFragment& fragment);
  void addWholeNal(std::span<const std::uint8_t> nal, const StreamFragment& fragment);
  void addFragmentedNal(std::span<const std::uint8_t> header, std::uint8_t fragment_header,
                        std::span<const std::uint8_t> data, const StreamFragment& fragment);
  void leaveOut(std::string text);
  void leaveOutType(int type);
  void openNal();
  void addNalBytes(std::span<const std::uint8_t> data, const StreamFragment& fragment, bool ends);
  void addUnitBytes(std::span<const std::uint8_t> unit, const StreamFragment& fragment);
  bool beginNal(std::span<const std::uint8_t> beginning, const StreamFragment& fragment);
  void beginPicture(const StreamFragment& fragment);
  void append(std::span<const std::uint8_t> data, const StreamFragment& fragment);
  void endPicture();
  void checkMarkerOfFinishedPicture();
  void rejectMarker();

  VideoCodec codec_;
  std::deque<AssembledUnit> complete_;
  std::optional<AssembledUnit> current_;
  std::vector<std::uint8_t> held_back_;  ///< bytes at the end of the open NAL unit
  bool nal_is_begun_ = false;            ///< beginNal was called for the open NAL unit
  bool nal_is_used_ = false;             ///< it belongs to the current picture
  std::uint64_t left_out_ = 0;
  std::string left_out_text_;
  bool nal_is_open_ = false;   ///< further fragments of the last NAL unit follow
  bool lost_since_ = false;    ///< packets were lost since the current picture's last fragment
  bool delivered_ = false;     ///< the current picture was delivered with its marker bit
  bool has_slices_ = false;    ///< of the current picture
  bool is_key_ = false;        ///< the current picture has slices that need no other picture
  bool is_marked_ = false;     ///< the last fragment of the current picture has the marker bit
  bool marked_early_ = false;  ///< a fragment of the current picture has the bit, and others follow

  int confirmations_ = 0;
  bool confirmed_on_key_ = false;
  bool marker_rejected_ = false;
};

}  // namespace cartvo::capture
