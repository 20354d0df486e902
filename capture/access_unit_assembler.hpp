#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "capture/encoded_unit.hpp"

namespace cartvo {

/// What one RTP packet carried, as FFmpeg hands it out unparsed: whole NAL units behind start codes, or one
/// fragment of a NAL unit (RFC 6184 FU-A, RFC 7798 FU), of which only the first begins with a start code.
struct StreamFragment {
  std::span<const std::uint8_t> data;
  std::int64_t pts = 0;
  std::int64_t arrival_ns = 0;
  std::optional<std::int64_t>
      reference_us;        ///< the exposure's instant by the sender reports, if there is one
  bool data_lost = false;  ///< something is known to be missing before it
};

/// One picture, put together.
struct AssembledUnit {
  std::vector<std::uint8_t> data;
  std::int64_t pts = 0;
  std::int64_t first_arrival_ns = 0;  ///< of its first fragment
  std::int64_t arrival_ns = 0;        ///< of its last fragment
  std::optional<std::int64_t> reference_us;
  bool data_lost = false;
};

/// Puts pictures together from RTP payloads, each as soon as its last packet is there. Pure.
///
/// A parser only knows that a picture is complete when the next one begins, which costs a whole frame period.
/// FFmpeg does not show the RTP marker bit either. But senders cut a NAL unit into fragments of one size and
/// a shorter last one, and cameras cut each picture into the same number of slices. Both are learned from the
/// stream: a picture counts as complete when its usual number of slices has begun and a fragment of other
/// than the full size ends the last one. The rule first proves itself unused: only after it would have been
/// right for kPicturesToProve in a row, a key picture among them, it is acted upon. Where it does not hold, a
/// picture is complete when the next one begins, and few pictures show it: NAL units that are cut evenly have
/// fragments of another size in each picture, and where slices are limited in size a key picture has more of
/// them. Should it fail after all, the cut picture and those after it count as damaged until the next key
/// frame, and the rule is not used again.
class AccessUnitAssembler {
 public:
  explicit AccessUnitAssembler(VideoCodec codec) : codec_(codec) {}

  void add(const StreamFragment& fragment);

  /// The next complete picture.
  std::optional<AssembledUnit> take();

  /// The rule has proved itself: pictures are handed out with their last packet.
  bool completesEarly() const { return !refuted_ && proved_pictures_ >= kPicturesToProve && proved_on_key_; }

  /// Pictures that were handed out before their last packet.
  std::uint64_t wrongGuesses() const { return wrong_guesses_; }

 private:
  static constexpr int kPicturesToProve = 4;              // a key picture and three others
  static constexpr std::size_t kLargestUnit = 16U << 20;  ///< bytes; beyond any camera's picture

  bool isRepeated(const StreamFragment& fragment) const;
  bool lastFragmentEndsUnit() const;
  void beginPicture(const StreamFragment& fragment);
  void append(const StreamFragment& fragment);
  void learnFromContinuation();
  void judgePreviousPicture();
  void refute();

  VideoCodec codec_;
  std::deque<AssembledUnit> complete_;
  std::optional<AssembledUnit> current_;
  std::vector<std::uint8_t> last_fragment_;
  bool handed_out_ = false;  ///< the current picture was taken to be complete

  // The current picture as far as it is known.
  int slices_ = 0;
  bool key_ = false;
  bool seems_complete_ = false;      ///< the rule says that the last fragment was the picture's last
  std::size_t fragment_length_ = 0;  ///< of the last fragment, without start code and NAL header
  bool fragment_may_go_on_ = false;  ///< the last fragment held the beginning or middle of one NAL unit
  int went_on_after_ = 0;            ///< slices, when it last went on though a NAL unit had ended

  // What was learned.
  std::size_t full_fragment_ = 0;  ///< length of the fragments that were continued; 0: none seen yet
  int usual_slices_ = 0;
  int proved_pictures_ = 0;
  bool proved_on_key_ = false;
  bool refuted_ = false;
  std::uint64_t wrong_guesses_ = 0;
};

}  // namespace cartvo
