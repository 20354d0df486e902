#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "tools/simulate/encoded_stream.hpp"

namespace cartvo::simulate {

/// A picture and the instant it is exposed at, ns since the Unix epoch.
struct ScheduledUnit {
  const AccessUnit* unit = nullptr;
  std::int64_t instant_ns = 0;
};

/// The first instant not before `not_before_ns` of a camera that has exposed at `frame_rate` since
/// `switched_on_ns`. Content that starts then continues the lead-in without a gap. All ns since the Unix
/// epoch.
std::int64_t frameInstantFrom(std::int64_t switched_on_ns, double frame_rate, std::int64_t not_before_ns);

/// What a camera sends when: its lead-in from being switched on, then its content once, or again and again.
class FrameSchedule {
 public:
  /// `repeat_after_ns`: length of one turn of the content if it is repeated, 0 if it ends.
  FrameSchedule(std::shared_ptr<const EncodedStream> stream, std::int64_t switched_on_ns,
                std::int64_t repeat_after_ns);

  /// The content's instant 0 becomes `epoch_ns` (ns since the Unix epoch). Only the first call counts.
  void startContent(std::int64_t epoch_ns);

  /// The next picture; none after the end.
  std::optional<ScheduledUnit> next() const;
  void advance();

 private:
  bool inLeadIn() const;
  std::int64_t leadInInstant() const;

  std::shared_ptr<const EncodedStream> stream_;
  std::int64_t switched_on_ns_;
  std::int64_t repeat_after_ns_;
  std::optional<std::int64_t> epoch_ns_;
  std::int64_t lead_in_count_ = 0;  ///< pictures of the lead-in that are past
  std::size_t content_count_ = 0;   ///< pictures of the content that are past
};

}  // namespace cartvo::simulate
