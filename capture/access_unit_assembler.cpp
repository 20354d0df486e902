#include "capture/access_unit_assembler.hpp"

#include <algorithm>
#include <utility>

#include "capture/nal_units.hpp"

namespace cartvo {

void AccessUnitAssembler::add(const StreamFragment& fragment) {
  if (fragment.data.empty() || isRepeated(fragment)) return;
  last_fragment_.assign(fragment.data.begin(), fragment.data.end());
  if (current_ && current_->pts == fragment.pts) {
    if (seems_complete_) refute();
    if (handed_out_) {  // too late for it; what follows cannot be trusted
      current_->data_lost = true;
      return;
    }
    if (!beginsWithStartCode(fragment.data)) learnFromContinuation();
    if (lastFragmentEndsUnit()) went_on_after_ = slices_;
  } else {
    judgePreviousPicture();
    beginPicture(fragment);
  }
  append(fragment);

  seems_complete_ = slices_ > 0 && slices_ == usual_slices_ && lastFragmentEndsUnit();
  if (seems_complete_ && completesEarly()) {
    AssembledUnit unit = std::move(*current_);
    current_ = AssembledUnit{{}, unit.pts, 0, 0, std::nullopt, false};
    handed_out_ = true;
    complete_.push_back(std::move(unit));
  }
}

std::optional<AssembledUnit> AccessUnitAssembler::take() {
  if (complete_.empty()) return std::nullopt;
  AssembledUnit unit = std::move(complete_.front());
  complete_.pop_front();
  return unit;
}

/// A network may deliver a packet twice, and FFmpeg drops a repeated one only if another came between the
/// two. A fragment that stood twice in a picture would garble it, and the decoder need not notice.
bool AccessUnitAssembler::isRepeated(const StreamFragment& fragment) const {
  return current_ && current_->pts == fragment.pts && !fragment.data_lost &&
         std::ranges::equal(fragment.data, last_fragment_);
}

void AccessUnitAssembler::beginPicture(const StreamFragment& fragment) {
  const bool lost = current_ && current_->data_lost;
  if (current_ && !handed_out_) {
    if (fragment.data_lost) current_->data_lost = true;  // what is missing may have been its end
    complete_.push_back(std::move(*current_));
  }
  // A picture that was handed out too early shows in the next one's status.
  const bool carried = handed_out_ && lost;
  current_ = AssembledUnit{{}, fragment.pts, fragment.arrival_ns, fragment.arrival_ns, std::nullopt, carried};
  handed_out_ = false;
  slices_ = 0;
  key_ = false;
  went_on_after_ = 0;
  // Without a start code its beginning is missing.
  if (!beginsWithStartCode(fragment.data)) current_->data_lost = true;
}

void AccessUnitAssembler::append(const StreamFragment& fragment) {
  if (current_->data.size() + fragment.data.size() > kLargestUnit) {
    current_->data_lost = true;
    return;
  }
  current_->data.insert(current_->data.end(), fragment.data.begin(), fragment.data.end());
  current_->arrival_ns = fragment.arrival_ns;
  if (fragment.reference_us) current_->reference_us = fragment.reference_us;
  current_->data_lost = current_->data_lost || fragment.data_lost;

  if (!beginsWithStartCode(fragment.data)) {
    fragment_length_ = fragment.data.size();
    fragment_may_go_on_ = true;
    return;
  }
  const std::vector<NalUnit> units = splitNalUnits(codec_, fragment.data);
  for (const NalUnit& unit : units) {
    if (unit.kind == NalKind::slice || unit.kind == NalKind::key_slice) ++slices_;
    key_ = key_ || unit.kind == NalKind::key_slice;
  }
  const std::size_t start_code = fragment.data[2] == 1 ? 3 : 4;
  fragment_length_ =
      fragment.data.size() - std::min(fragment.data.size(), start_code + nalHeaderSize(codec_));
  fragment_may_go_on_ = units.size() <= 1;  // an aggregate holds whole NAL units
}

/// As far as fragments tell; never before it is known how long they are.
bool AccessUnitAssembler::lastFragmentEndsUnit() const {
  return full_fragment_ > 0 && (!fragment_may_go_on_ || fragment_length_ != full_fragment_);
}

/// The last fragment went on in the next one, so its length is that of full fragments.
void AccessUnitAssembler::learnFromContinuation() {
  if (fragment_length_ == full_fragment_) return;
  full_fragment_ = fragment_length_;
  proved_pictures_ = 0;
}

/// The next picture begins, so the last fragment of this one is known. The first one proves the rule, too:
/// its number of slices is known now.
void AccessUnitAssembler::judgePreviousPicture() {
  if (!current_) return;
  if (slices_ != usual_slices_) {
    usual_slices_ = slices_;
    proved_pictures_ = 0;
  }
  const bool right = slices_ > 0 && lastFragmentEndsUnit() && went_on_after_ != slices_;
  if (!right) return;
  if (proved_pictures_ == 0) proved_on_key_ = false;
  proved_on_key_ = proved_on_key_ || key_;
  if (proved_pictures_ < kPicturesToProve) ++proved_pictures_;
}

/// More of a picture came although the rule took it to be complete.
void AccessUnitAssembler::refute() {
  if (handed_out_ && !refuted_) {
    ++wrong_guesses_;
    refuted_ = true;
  }
  seems_complete_ = false;
  proved_pictures_ = 0;
}

}  // namespace cartvo
