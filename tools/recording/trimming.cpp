// Copies a part of a recording to a new recording.
#include "tools/recording/trimming.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "capture/recording/recording_index.hpp"
#include "capture/recording/recording_reader.hpp"
#include "capture/recording/recording_writer.hpp"
#include "common/atomic_file.hpp"
#include "common/exact_text.hpp"

namespace cartvo {
namespace {

constexpr std::chrono::seconds kSegmentLength{60};
constexpr std::array<capture::CameraSide, 2> kSides = {capture::CameraSide::left, capture::CameraSide::right};

std::int64_t firstArrival(const std::filesystem::path& recording) {
  std::optional<std::int64_t> first;
  for (const capture::CameraSide side : kSides) {
    capture::RecordingIndexReader rows(recording, side);
    if (const capture::IndexRow* row = rows.next())
      first = std::min(first.value_or(row->arrival_ns), row->arrival_ns);
  }
  if (!first) throw std::runtime_error(recording.string() + ": contains no picture");
  return *first;
}

std::int64_t lastArrival(const std::filesystem::path& recording) {
  std::int64_t last = 0;
  for (const capture::CameraSide side : kSides) {
    capture::RecordingIndexReader rows(recording, side);
    while (const capture::IndexRow* row = rows.next())
      last = std::max(last, row->arrival_ns);
  }
  return last;
}

/// The pictures of one camera in the part, in recorded order.
class TrimmedCamera {
 public:
  TrimmedCamera(const std::filesystem::path& recording, capture::CameraSide side, std::int64_t from_ns,
                std::int64_t to_ns)
      : side_(side), reader_(recording, side), to_ns_(to_ns), first_order_(1) {
    capture::RecordingIndexReader rows(recording, side);
    finished_ = true;
    for (const capture::IndexRow* row = rows.next(); row != nullptr && row->arrival_ns <= to_ns;
         row = rows.next()) {
      if (finished_ && row->key && row->arrival_ns <= from_ns) {
        first_order_ = row->order;
        expected_ = 0;
      }
      ++expected_;
      finished_ = finished_ && row->arrival_ns < from_ns;
    }
    if (!finished_) advance();
  }

  capture::CameraSide side() const { return side_; }
  bool isFinished() const { return finished_; }
  const capture::RecordedUnit& unit() const { return unit_; }
  /// Number of pictures to copy.
  std::size_t expected() const { return expected_; }

  void advance() {
    do {
      finished_ = !reader_.next(unit_) || unit_.unit.arrival_ns > to_ns_;
    } while (!finished_ && unit_.unit.order < first_order_);
  }

 private:
  capture::CameraSide side_;
  capture::RecordingReader reader_;
  std::int64_t to_ns_;
  std::uint64_t first_order_;
  std::size_t expected_ = 0;
  capture::RecordedUnit unit_;
  bool finished_ = false;
};

/// The camera whose next picture arrived first.
TrimmedCamera& earlierOf(TrimmedCamera& left, TrimmedCamera& right) {
  if (left.isFinished()) return right;
  if (right.isFinished()) return left;
  return left.unit().unit.order < right.unit().unit.order ? left : right;
}

void copyPictures(TrimmedCamera& left, TrimmedCamera& right, capture::RecordingWriter& writer,
                  std::int64_t first_ns, const TrimProgress& progress, TrimmedRecording& trimmed) {
  std::array<std::uint64_t, 2> connections{};
  trimmed.from = std::numeric_limits<double>::infinity();
  while (!left.isFinished() || !right.isFinished()) {
    TrimmedCamera& next = earlierOf(left, right);
    const auto index = static_cast<std::size_t>(next.side());
    if (next.unit().connection != connections[index]) writer.beginConnection(next.side(), next.unit().format);
    connections[index] = next.unit().connection;
    if (writer.write(next.side(), next.unit().unit)) {
      ++trimmed.pictures[index];
      const double seconds = 1e-9 * static_cast<double>(next.unit().unit.arrival_ns - first_ns);
      trimmed.from = std::min(trimmed.from, seconds);
      trimmed.to = std::max(trimmed.to, seconds);
    }
    progress(trimmed.pictures[0] + trimmed.pictures[1], left.expected() + right.expected());
    next.advance();
  }
}

}  // namespace

TrimmedRecording trimRecording(const std::filesystem::path& recording, const TrimmedPart& part,
                               const std::filesystem::path& output, const TrimProgress& progress) {
  capture::RecordingInfo info = capture::readRecordingInfo(recording);
  const std::int64_t first_ns = firstArrival(recording);
  const auto after_first = [first_ns](double seconds) {
    return first_ns + static_cast<std::int64_t>(std::llround(1e9 * std::min(seconds, 1e9)));
  };
  TrimmedCamera left(recording, capture::CameraSide::left, after_first(part.from), after_first(part.to));
  TrimmedCamera right(recording, capture::CameraSide::right, after_first(part.from), after_first(part.to));
  if (left.isFinished() || right.isFinished()) {
    const double length = 1e-9 * static_cast<double>(lastArrival(recording) - first_ns);
    if (part.from > length)
      throw std::runtime_error(recording.string() + ": --from " + fixedText(part.from, 1) +
                               " is beyond its end: it is " + fixedText(length, 1) + " s long");
    throw std::runtime_error(
        recording.string() + ": contains no picture of the " +
        capture::sideName(left.isFinished() ? capture::CameraSide::left : capture::CameraSide::right) +
        " camera between --from and --to");
  }
  UnfinishedFolder unfinished(output);
  TrimmedRecording trimmed;
  if (info.started_ns > 0)
    info.started_ns += std::min(left.unit().unit.arrival_ns, right.unit().unit.arrival_ns) - first_ns;
  capture::RecordingWriter writer(output, info, kSegmentLength);
  copyPictures(left, right, writer, first_ns, progress, trimmed);
  writer.sync();
  unfinished.keep();
  return trimmed;
}

}  // namespace cartvo
