#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace cartvo::capture {

/// Counters of everything that a camera sends and that is left out, for health and messages.
class StreamRemarks {
 public:
  enum class Kind : std::uint8_t {
    stray_bytes,   ///< between the interleaved packets; detail: none
    malformed,     ///< packets that are no RTP or RTCP, or in part
    payload_type,  ///< packets of another payload type; detail: the types
    channel,       ///< packets on other interleaved channels; detail: the channel
    host,          ///< UDP packets of another computer; detail: its address
    structure,     ///< RTP payloads of which no picture can be made; detail: why
    report,        ///< sender reports that do not belong to the pictures; detail: why
    late,          ///< UDP packets that came too late or twice
    time,          ///< pictures whose RTP time does not follow from that of the others
    overflow,      ///< frames that were not read in time
    undecodable,   ///< pictures that the decoder refused or gave nothing for
    incomplete,    ///< pictures of a camera of this computer that lack data or have another size
    missed,        ///< pictures that its driver has counted, but not delivered
  };
  static constexpr std::size_t kKinds = static_cast<std::size_t>(Kind::missed) + 1;

  /// Counts up to a total. `detail`: of the latest one.
  void setTotal(Kind kind, std::uint64_t total, std::string_view detail = {});
  void add(Kind kind, std::string_view detail = {}) { setTotal(kind, count(kind) + 1, detail); }

  std::uint64_t count(Kind kind) const { return entries_[static_cast<std::size_t>(kind)].count; }

  /// Names what was left out, with the order of its number, so that the text seldom changes: "packets on
  /// channel 2 (100 or more)"; empty if nothing was. Single late packets and lost pictures are normal and not
  /// named.
  const std::string& text() const { return text_; }

  /// The part of the text about one kind.
  std::string text(Kind kind) const;

 private:
  struct Entry {
    std::uint64_t count = 0;
    std::uint64_t named = 0;  ///< the power of ten that the text names; 0: none
    std::string detail;
  };

  std::array<Entry, kKinds> entries_{};
  std::string text_;
};

/// Detects a frozen camera: one that keeps sending, but always the same picture. Sensor noise makes the
/// pictures of a standing cart differ, so only a frozen camera repeats every bit. A uniform picture, as that
/// of a covered lens, is no evidence: encoders give it without noise.
class FrozenPictureDetector {
 public:
  using Clock = std::chrono::steady_clock;

  /// Adds the next picture, CV_8UC1. Returns for how long the picture has been the same.
  Clock::duration update(const cv::Mat& image, Clock::time_point now);

 private:
  std::optional<std::uint64_t> hash_;
  Clock::time_point since_;
};

}  // namespace cartvo::capture
