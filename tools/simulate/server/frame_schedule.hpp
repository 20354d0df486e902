#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// A picture and its exposure, ns since the Unix epoch.
struct ScheduledUnit {
  const AccessUnit* unit = nullptr;
  std::int64_t instant_ns = 0;
};

/// The first exposure at or after `not_before_ns` of a camera that exposes at `frame_rate` Hz from
/// `switched_on_ns` on. Content that starts at it continues the lead-in without a gap. All instants: ns since
/// the Unix epoch.
std::int64_t nextFrameInstant(std::int64_t switched_on_ns, double frame_rate, std::int64_t not_before_ns);

/// Schedule of a camera's pictures: the lead-in from being switched on, then the content once or repeatedly.
class FrameSchedule {
 public:
  /// `repeat_after_ns`: period of the content if it is repeated, 0 if it ends.
  FrameSchedule(std::shared_ptr<const EncodedStream> stream, std::int64_t switched_on_ns,
                std::int64_t repeat_after_ns);

  /// Sets the system time of content instant 0, ns since the Unix epoch. Only the first call has an effect.
  void startContent(std::int64_t epoch_ns);

  /// The next picture; none after the end.
  std::optional<ScheduledUnit> next() const;
  /// Marks the next picture as sent.
  void advance();

 private:
  bool inLeadIn() const;
  std::int64_t leadInInstant() const;

  std::shared_ptr<const EncodedStream> stream_;
  std::int64_t switched_on_ns_;
  std::int64_t repeat_after_ns_;
  std::optional<std::int64_t> epoch_ns_;
  std::int64_t lead_in_count_ = 0;  ///< lead-in pictures sent
  std::size_t content_count_ = 0;   ///< content pictures sent
};

}  // namespace cartvo::simulate
