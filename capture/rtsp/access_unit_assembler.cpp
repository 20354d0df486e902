// Assembly of RTP payloads into pictures, which end with the marker bit where that can be relied on.

#include "capture/rtsp/access_unit_assembler.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

// Payload structures (RFC 6184, 5.2; RFC 7798, 4.4).
constexpr int kH264Aggregate = 24;  // STAP-A
constexpr int kH264Fragment = 28;   // FU-A
constexpr int kH265Aggregate = 48;  // AP
constexpr int kH265Fragment = 49;   // FU
constexpr std::uint8_t kFragmentBegins = 0x80;
constexpr std::uint8_t kFragmentEnds = 0x40;

constexpr std::array<std::uint8_t, 4> kLongStartCode = {0, 0, 0, 1};
constexpr std::size_t kShortStartCode = 3;  ///< bytes: 0 0 1

constexpr const char* kCutOff = "that are cut off";

/// Number of zeros at the end, at most `limit`.
std::size_t trailingZeros(std::span<const std::uint8_t> data, std::size_t limit) {
  std::size_t zeros = 0;
  while (zeros < std::min(limit, data.size()) && data[data.size() - 1 - zeros] == 0)
    ++zeros;
  return zeros;
}

/// The data after a start code at their beginning, which a payload should not have.
std::span<const std::uint8_t> withoutStartCode(std::span<const std::uint8_t> data) {
  for (const std::size_t zeros : {std::size_t{2}, std::size_t{3}}) {
    const bool has_code =
        data.size() > zeros && data[zeros] == 1 && trailingZeros(data.first(zeros), zeros) == zeros;
    if (has_code) return data.subspan(zeros + 1);
  }
  return data;
}

}  // namespace

void AccessUnitAssembler::add(const StreamFragment& fragment) {
  if (fragment.data_lost) {
    lost_since_ = true;
    nal_is_open_ = false;                                     // its remaining fragments are of no use
    if (current_ && !delivered_) current_->data_lost = true;  // the missing data may be its end
  }
  if (codec_ == VideoCodec::h264) {
    addH264(fragment);
  } else {
    addH265(fragment);
  }
  if (!fragment.ends_picture || !current_ || !has_slices_ || nal_is_open_ || delivered_) return;
  is_marked_ = true;
  if (completesEarly()) endPicture();
}

void AccessUnitAssembler::addH264(const StreamFragment& fragment) {
  const std::span<const std::uint8_t> data = withoutStartCode(fragment.data);
  if (data.empty()) return;
  const int type = data[0] & 0x1f;
  if (type == kH264Aggregate) return addAggregate(data.subspan(1), fragment);
  if (type < kH264Aggregate) return addWholeNal(data, fragment);
  if (type != kH264Fragment) return leaveOutType(type);
  if (data.size() < 2) return leaveOut(kCutOff);
  const std::array<std::uint8_t, 1> header = {static_cast<std::uint8_t>((data[0] & 0xe0) | (data[1] & 0x1f))};
  addFragmentedNal(header, data[1], data.subspan(2), fragment);
}

void AccessUnitAssembler::addH265(const StreamFragment& fragment) {
  const std::span<const std::uint8_t> data = withoutStartCode(fragment.data);
  if (data.empty()) return;
  const int type = (data[0] >> 1) & 0x3f;
  if (type < kH265Aggregate) return addWholeNal(data, fragment);
  if (data.size() < 3) return leaveOut(kCutOff);
  if (type == kH265Aggregate) return addAggregate(data.subspan(2), fragment);
  if (type != kH265Fragment) return leaveOutType(type);
  const std::array<std::uint8_t, 2> header = {
      static_cast<std::uint8_t>((data[0] & 0x81) | (data[2] & 0x3f) << 1), data[1]};
  addFragmentedNal(header, data[2], data.subspan(3), fragment);
}

void AccessUnitAssembler::leaveOut(std::string text) {
  ++left_out_;
  left_out_text_ = std::move(text);
}

void AccessUnitAssembler::leaveOutType(int type) {
  leaveOut("of type " + std::to_string(type) +
           ", which is not supported: of H.264, set its packetization-mode to 1");
}

/// NAL units, each behind its size in 16 bits.
void AccessUnitAssembler::addAggregate(std::span<const std::uint8_t> data, const StreamFragment& fragment) {
  while (data.size() > 2) {
    const std::size_t size = static_cast<std::size_t>(data[0]) << 8 | data[1];
    data = data.subspan(2);
    if (size > data.size()) return leaveOut(kCutOff);
    addWholeNal(data.first(size), fragment);
    data = data.subspan(size);
  }
}

void AccessUnitAssembler::addWholeNal(std::span<const std::uint8_t> nal, const StreamFragment& fragment) {
  if (nal.size() < nalHeaderSize(codec_)) return leaveOut(kCutOff);
  openNal();
  addNalBytes(nal, fragment, true);
  nal_is_open_ = false;
}

void AccessUnitAssembler::addFragmentedNal(std::span<const std::uint8_t> header, std::uint8_t fragment_header,
                                           std::span<const std::uint8_t> data,
                                           const StreamFragment& fragment) {
  if ((fragment_header & kFragmentBegins) != 0) {
    openNal();
    held_back_.assign(header.begin(), header.end());
  } else if (!nal_is_open_) {
    // Its beginning is missing: before the connection, by a loss, or the camera marks none.
    if (current_ && !lost_since_) leaveOut("that continue no NAL unit");
    return;
  }
  const bool ends = (fragment_header & kFragmentEnds) != 0;
  addNalBytes(data, fragment, ends);
  if (ends) nal_is_open_ = false;
}

/// Opens a NAL unit: its bytes follow.
void AccessUnitAssembler::openNal() {
  nal_is_open_ = true;
  nal_is_begun_ = nal_is_used_ = false;
  held_back_.clear();
}

/// Adds bytes of the open NAL unit. Where they contain start codes, as some cameras send them, they are
/// several NAL units: in one unit alone emulation prevention excludes the code (ITU-T H.264, 7.4.1). Bytes at
/// the end that may belong to a start code or to a header are held back until more follow, or this is the
/// unit's end.
void AccessUnitAssembler::addNalBytes(std::span<const std::uint8_t> data, const StreamFragment& fragment,
                                      bool ends) {
  std::vector<std::uint8_t> joined;
  if (!held_back_.empty()) {
    joined.swap(held_back_);
    joined.insert(joined.end(), data.begin(), data.end());
    data = joined;
  }
  const std::size_t beginning = nalHeaderSize(codec_) + 1;  // with the byte that tells where a picture begins
  for (;;) {
    const auto code = findStartCode(data);
    const std::size_t size = static_cast<std::size_t>(code - data.begin());  // of the current unit
    const bool is_last = code == data.end();
    std::span<const std::uint8_t> unit = data.first(size);
    if (is_last && !ends) {
      const bool is_short = !nal_is_begun_ && unit.size() < std::max(beginning, kLongStartCode.size());
      const std::size_t kept = is_short ? unit.size() : trailingZeros(unit, kLongStartCode.size() - 1);
      held_back_.assign(unit.end() - static_cast<std::ptrdiff_t>(kept), unit.end());
      unit = unit.first(unit.size() - kept);
    } else if (!is_last) {
      unit = unit.first(unit.size() - trailingZeros(unit, unit.size()));
    }
    if (!unit.empty()) addUnitBytes(unit, fragment);
    if (is_last) return;
    nal_is_begun_ = nal_is_used_ = false;
    data = data.subspan(size + kShortStartCode);
  }
}

/// Adds bytes of one NAL unit without start codes.
void AccessUnitAssembler::addUnitBytes(std::span<const std::uint8_t> unit, const StreamFragment& fragment) {
  if (!nal_is_begun_) {
    if (unit.size() < nalHeaderSize(codec_)) return;
    nal_is_begun_ = true;
    nal_is_used_ = beginNal(unit.first(std::min(unit.size(), nalHeaderSize(codec_) + 1)), fragment);
    if (nal_is_used_) append(kLongStartCode, fragment);
  }
  if (nal_is_used_) append(unit, fragment);
}

/// Begins a picture if the NAL unit does. False if the NAL unit belongs to a picture that was delivered.
bool AccessUnitAssembler::beginNal(std::span<const std::uint8_t> beginning, const StreamFragment& fragment) {
  const NalPlace place = nalPlace(codec_, beginning);
  const bool is_slice = place == NalPlace::first_slice || place == NalPlace::slice;
  const bool begins = place == NalPlace::before_slices || place == NalPlace::first_slice;
  const bool other_picture = is_slice && lost_since_ && current_ && current_->pts != fragment.pts;
  if (!current_ || (has_slices_ && (begins || other_picture))) {
    beginPicture(fragment);
  } else if (delivered_) {
    if (is_slice) {  // the marker bit was wrong: pictures that refer to the incomplete one are damaged, too
      rejectMarker();
      current_->data_lost = true;
    }
    return false;
  }
  if (is_marked_ && is_slice) marked_early_ = true;
  is_marked_ = false;
  if (!is_slice) return true;
  if (!has_slices_) {
    current_->pts = fragment.pts;
    current_->first_arrival_ns = fragment.arrival_ns;
    current_->reference_us = fragment.reference_us;
    is_key_ = isKeySlice(codec_, beginning);
    // A key picture needs nothing of what was lost before it; without its first slice it is incomplete.
    if (place != NalPlace::first_slice) current_->data_lost = true;
    if (is_key_ && place == NalPlace::first_slice) current_->data_lost = false;
  }
  has_slices_ = true;
  return true;
}

void AccessUnitAssembler::beginPicture(const StreamFragment& fragment) {
  checkMarkerOfFinishedPicture();
  const bool carried = delivered_ && current_ && current_->data_lost;
  if (current_ && !delivered_) complete_.push_back(std::move(*current_));
  current_ = AssembledUnit{{},
                           fragment.pts,
                           fragment.arrival_ns,
                           fragment.arrival_ns,
                           fragment.reference_us,
                           carried || lost_since_};
  delivered_ = has_slices_ = is_key_ = is_marked_ = marked_early_ = false;
}

void AccessUnitAssembler::append(std::span<const std::uint8_t> data, const StreamFragment& fragment) {
  lost_since_ = false;
  if (current_->data.size() + data.size() > kMaxUnitBytes) {
    current_->data_lost = true;
    return leaveOut("of pictures above 16 MB");
  }
  current_->data.insert(current_->data.end(), data.begin(), data.end());
  current_->arrival_ns = fragment.arrival_ns;
}

/// Delivers the current picture with its last packet.
void AccessUnitAssembler::endPicture() {
  const std::int64_t pts = current_->pts;
  complete_.push_back(std::move(*current_));
  current_ = AssembledUnit{{}, pts, 0, 0, std::nullopt, false};
  delivered_ = true;
}

std::optional<AssembledUnit> AccessUnitAssembler::popUnit() {
  if (complete_.empty()) return std::nullopt;
  AssembledUnit unit = std::move(complete_.front());
  complete_.pop_front();
  return unit;
}

/// Tests the marker bit on the current picture, whose last fragment is known because the next one begins.
void AccessUnitAssembler::checkMarkerOfFinishedPicture() {
  if (!current_ || !has_slices_ || current_->data_lost) return;
  if (!is_marked_ || marked_early_) {
    confirmations_ = 0;
    return;
  }
  if (confirmations_ == 0) confirmed_on_key_ = false;
  confirmed_on_key_ = confirmed_on_key_ || is_key_;
  if (confirmations_ < kConfirmationsNeeded) ++confirmations_;
}

void AccessUnitAssembler::rejectMarker() {
  marker_rejected_ = true;
  confirmations_ = 0;
}

}  // namespace cartvo::capture
