// Assembly of RTP payloads into pictures, with early detection of a picture's last packet.

#include "capture/rtsp/access_unit_assembler.hpp"

#include <algorithm>
#include <utility>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {

void AccessUnitAssembler::add(const StreamFragment& fragment) {
  if (fragment.data.empty() || isRepeated(fragment)) return;
  last_fragment_.assign(fragment.data.begin(), fragment.data.end());
  if (current_ && current_->pts == fragment.pts) {
    if (seems_complete_) rejectRule();
    if (delivered_) {  // incomplete; pictures that refer to it are damaged, too
      current_->data_lost = true;
      return;
    }
    if (!beginsWithStartCode(fragment.data)) learnFullFragmentLength();
    if (lastFragmentEndsNalUnit()) continued_after_slices_ = slices_;
  } else {
    checkRuleOnFinishedPicture();
    beginPicture(fragment);
  }
  append(fragment);

  seems_complete_ = slices_ > 0 && slices_ == usual_slices_ && lastFragmentEndsNalUnit();
  if (seems_complete_ && completesEarly()) {
    AssembledUnit unit = std::move(*current_);
    current_ = AssembledUnit{{}, unit.pts, 0, 0, std::nullopt, false};
    delivered_ = true;
    complete_.push_back(std::move(unit));
  }
}

std::optional<AssembledUnit> AccessUnitAssembler::popUnit() {
  if (complete_.empty()) return std::nullopt;
  AssembledUnit unit = std::move(complete_.front());
  complete_.pop_front();
  return unit;
}

/// Whether the fragment equals the previous one. A network may deliver a packet twice, and FFmpeg drops the
/// duplicate only if another packet came in between. A duplicate fragment would corrupt the picture, which
/// the decoder need not detect.
bool AccessUnitAssembler::isRepeated(const StreamFragment& fragment) const {
  return current_ && current_->pts == fragment.pts && !fragment.data_lost &&
         std::ranges::equal(fragment.data, last_fragment_);
}

void AccessUnitAssembler::beginPicture(const StreamFragment& fragment) {
  const bool lost = current_ && current_->data_lost;
  if (current_ && !delivered_) {
    if (fragment.data_lost) current_->data_lost = true;  // the missing data may be its end
    complete_.push_back(std::move(*current_));
  }
  // A premature picture marks the next one.
  const bool carried = delivered_ && lost;
  current_ = AssembledUnit{{}, fragment.pts, fragment.arrival_ns, fragment.arrival_ns, std::nullopt, carried};
  delivered_ = false;
  slices_ = 0;
  key_ = false;
  continued_after_slices_ = 0;
  // No start code: the picture's beginning is missing.
  if (!beginsWithStartCode(fragment.data)) current_->data_lost = true;
}

void AccessUnitAssembler::append(const StreamFragment& fragment) {
  if (current_->data.size() + fragment.data.size() > kMaxUnitBytes) {
    current_->data_lost = true;
    return;
  }
  current_->data.insert(current_->data.end(), fragment.data.begin(), fragment.data.end());
  current_->arrival_ns = fragment.arrival_ns;
  if (fragment.reference_us) current_->reference_us = fragment.reference_us;
  current_->data_lost = current_->data_lost || fragment.data_lost;

  if (!beginsWithStartCode(fragment.data)) {
    fragment_length_ = fragment.data.size();
    fragment_may_continue_ = true;
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
  fragment_may_continue_ = units.size() <= 1;  // an aggregate holds whole NAL units
}

/// Whether the last fragment ended its NAL unit. False until the length of full fragments is known.
bool AccessUnitAssembler::lastFragmentEndsNalUnit() const {
  return full_fragment_ > 0 && (!fragment_may_continue_ || fragment_length_ != full_fragment_);
}

/// Takes the length of the last fragment, which was continued by another one, as that of full fragments.
void AccessUnitAssembler::learnFullFragmentLength() {
  if (fragment_length_ == full_fragment_) return;
  full_fragment_ = fragment_length_;
  confirmations_ = 0;
}

/// Tests the rule on the current picture, whose last fragment is known because the next picture begins. The
/// first picture counts, too: its number of slices is known by now.
void AccessUnitAssembler::checkRuleOnFinishedPicture() {
  if (!current_) return;
  if (slices_ != usual_slices_) {
    usual_slices_ = slices_;
    confirmations_ = 0;
  }
  const bool is_right = slices_ > 0 && lastFragmentEndsNalUnit() && continued_after_slices_ != slices_;
  if (!is_right) return;
  if (confirmations_ == 0) confirmed_on_key_ = false;
  confirmed_on_key_ = confirmed_on_key_ || key_;
  if (confirmations_ < kConfirmationsNeeded) ++confirmations_;
}

/// Resets the rule after a picture continued that the rule took for complete.
void AccessUnitAssembler::rejectRule() {
  if (delivered_) rule_rejected_ = true;
  seems_complete_ = false;
  confirmations_ = 0;
}

}  // namespace cartvo::capture
