#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "capture/encoded_unit.hpp"

// Assembly of pictures from RTP packets, with minimum latency.

namespace cartvo::capture {

/// The payload of one RTP packet, unparsed, as FFmpeg delivers it: whole NAL units behind start codes, or one
/// fragment of a NAL unit (RFC 6184 FU-A, RFC 7798 FU). Only the first fragment begins with a start code.
struct StreamFragment {
  std::span<const std::uint8_t> data;
  std::int64_t pts = 0;
  std::int64_t arrival_ns = 0;
  std::optional<std::int64_t> reference_us;  ///< exposure instant by the sender reports, if there is one
  bool data_lost = false;                    ///< data before this fragment are known to be missing
};

/// One picture (access unit), assembled from its fragments.
struct AssembledUnit {
  std::vector<std::uint8_t> data;
  std::int64_t pts = 0;
  std::int64_t first_arrival_ns = 0;  ///< of its first fragment
  std::int64_t arrival_ns = 0;        ///< of its last fragment
  std::optional<std::int64_t> reference_us;
  bool data_lost = false;
};

/// Assembles pictures from RTP payloads and delivers each one as soon as its last packet has arrived. Reads
/// no clock; deterministic.
///
/// A parser detects the end of a picture only when the next one begins, which adds one frame period of
/// latency, and FFmpeg does not expose the RTP marker bit. The assembler uses two properties of the stream
/// instead: senders cut a NAL unit into fragments of equal size and a shorter last one, and cameras cut each
/// picture into the same number of slices. It learns both. A picture is complete when its usual number of
/// slices has begun and a fragment of another size than the full one ends the last slice.
///
/// The rule is used only after it would have been right for kConfirmationsNeeded pictures in a row, a key
/// picture among them. Until then, and for streams that do not satisfy it (NAL units cut evenly; slices
/// limited in size, of which a key picture has more), a picture is complete when the next one begins. If the
/// rule fails in use, the incomplete picture and those after it are marked as damaged up to the next key
/// picture, and the rule is not used again.
class AccessUnitAssembler {
 public:
  explicit AccessUnitAssembler(VideoCodec codec) : codec_(codec) {}

  void add(const StreamFragment& fragment);

  /// Removes and returns the next complete picture, or nothing.
  std::optional<AssembledUnit> popUnit();

  /// Whether the rule is confirmed: pictures are delivered with their last packet.
  bool completesEarly() const {
    return !rule_rejected_ && confirmations_ >= kConfirmationsNeeded && confirmed_on_key_;
  }

 private:
  static constexpr int kConfirmationsNeeded = 4;           // pictures: a key picture and three others
  static constexpr std::size_t kMaxUnitBytes = 16U << 20;  // larger than any camera's picture

  bool isRepeated(const StreamFragment& fragment) const;
  bool lastFragmentEndsNalUnit() const;
  void beginPicture(const StreamFragment& fragment);
  void append(const StreamFragment& fragment);
  void learnFullFragmentLength();
  void checkRuleOnFinishedPicture();
  void rejectRule();

  VideoCodec codec_;
  std::deque<AssembledUnit> complete_;
  std::optional<AssembledUnit> current_;
  std::vector<std::uint8_t> last_fragment_;
  bool delivered_ = false;  ///< the current picture was delivered as complete

  // State of the current picture.
  int slices_ = 0;
  bool key_ = false;
  bool seems_complete_ = false;         ///< by the rule, the last fragment was the picture's last
  std::size_t fragment_length_ = 0;     ///< of the last fragment, without start code and NAL header, bytes
  bool fragment_may_continue_ = false;  ///< the last fragment held the beginning or middle of one NAL unit
  int continued_after_slices_ = 0;      ///< slices begun when it last continued after the end of a NAL unit

  // State of the rule.
  std::size_t full_fragment_ = 0;  ///< length of the fragments that were continued, bytes; 0: none seen yet
  int usual_slices_ = 0;
  int confirmations_ = 0;
  bool confirmed_on_key_ = false;
  bool rule_rejected_ = false;
};

}  // namespace cartvo::capture
