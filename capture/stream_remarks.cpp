// Counters and texts of what a camera sends and what is left out; cameras that repeat a picture.
#include "capture/stream_remarks.hpp"

#include "common/picture_digest.hpp"

namespace cartvo::capture {
namespace {

using Remark = StreamRemarks::Kind;

constexpr std::uint64_t kNamedFrom = 100;  ///< kinds of which single ones are normal

constexpr bool areSingleOnesNormal(Remark kind) {
  return kind >= Remark::late && kind <= Remark::missed && kind != Remark::overflow;
}

/// The largest power of ten up to a number; 0 of 0.
std::uint64_t powerOfTen(std::uint64_t number) {
  std::uint64_t power = number > 0 ? 1 : 0;
  while (power > 0 && number / power >= 10)
    power *= 10;
  return power;
}

std::string nameOf(Remark kind, const std::string& detail) {
  switch (kind) {
    case Remark::stray_bytes:
      return "bytes between packets that belong to none: lower its bit rate if its connection is congested";
    case Remark::malformed:
      return "packets that are malformed, or neither RTP nor RTCP";
    case Remark::payload_type:
      return "packets of payload type " + detail;
    case Remark::channel:
      return "packets on channel " + detail + ", which was not set up";
    case Remark::host:
      return "UDP packets from " + detail + ", which is another computer";
    case Remark::structure:
      return "RTP payloads " + detail;
    case Remark::report:
      return "sender reports " + detail;
    case Remark::late:
      return "UDP packets that came too late or twice";
    case Remark::time:
      return "pictures whose RTP time does not follow from that of the others";
    case Remark::overflow:
      return "frames that were not read in time";
    case Remark::undecodable:
      return "pictures that cannot be decoded";
    case Remark::incomplete:
      return "pictures that are incomplete or of another size";
    case Remark::missed:
      return "pictures that its driver lost";
  }
  return {};
}

}  // namespace

void StreamRemarks::setTotal(Kind kind, std::uint64_t total, std::string_view detail) {
  Entry& entry = entries_[static_cast<std::size_t>(kind)];
  if (total == entry.count) return;
  entry.count = total;
  const std::uint64_t named = areSingleOnesNormal(kind) && total < kNamedFrom ? 0 : powerOfTen(total);
  if (named == entry.named) return;
  entry.named = named;
  entry.detail = detail;
  text_.clear();
  for (std::size_t i = 0; i < kKinds; ++i) {
    const std::string part = text(static_cast<Kind>(i));
    if (!part.empty()) text_.append(text_.empty() ? "" : "; ").append(part);
  }
}

std::string StreamRemarks::text(Kind kind) const {
  const Entry& entry = entries_[static_cast<std::size_t>(kind)];
  if (entry.named == 0) return {};
  const std::string number =
      entry.named == 1 ? " (fewer than 10)" : " (" + std::to_string(entry.named) + " or more)";
  return nameOf(kind, entry.detail) + number;
}

FrozenPictureDetector::Clock::duration FrozenPictureDetector::update(const cv::Mat& image,
                                                                     Clock::time_point now) {
  const std::uint64_t current = pictureDigest(image);
  if (hash_ != current || isUniform(image)) {
    hash_ = current;
    since_ = now;
  }
  return now - since_;
}

}  // namespace cartvo::capture
