#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/atomic_file.hpp"

namespace cartvo {

/// Writes an MCAP file (mcap.dev/spec, version 0): messages in uncompressed chunks with their indices, a
/// summary with statistics, and checksums of chunks, data and summary. No attachments and no metadata
/// records.
class McapWriter {
 public:
  /// Writes the header. `file` is borrowed and must outlive the writer. `profile`: "" or "ros2".
  McapWriter(AtomicFileWriter& file, std::string_view profile);

  /// Returns the new schema's number.
  std::uint16_t addSchema(std::string_view name, std::string_view encoding, std::string_view data);

  /// Returns the new channel's number.
  std::uint16_t addChannel(std::uint16_t schema, std::string_view topic, std::string_view encoding);

  /// Appends a message. Instants: ns since the Unix epoch, not negative. `log_time`: viewers order by it.
  void write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
             std::string_view data);

  /// Writes the last chunk, the summary and the end. Must be the last call.
  void finish();

  /// Messages of a channel so far.
  std::uint64_t messageCount(std::uint16_t channel) const { return message_counts_.at(channel); }

  /// The smallest and the largest log time so far; 0 without messages.
  std::uint64_t firstTime() const { return times_.first; }
  std::uint64_t lastTime() const { return times_.last; }

 private:
  struct TimeRange {
    std::uint64_t first = 0, last = 0;
    bool is_empty = true;

    void add(std::uint64_t time);
  };
  using MessageIndex =
      std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< log time, offset in the chunk

  void emit(std::string_view bytes);
  void writeChunk();
  void writeSummary();

  AtomicFileWriter& file_;
  std::uint64_t position_ = 0;  ///< bytes written
  std::uint32_t checksum_ = 0;  ///< of them

  std::string schemas_, channels_;  ///< records, for the summary
  std::uint16_t schema_count_ = 0;
  std::map<std::uint16_t, std::uint64_t> message_counts_;  ///< by channel
  TimeRange times_;

  std::string chunk_;  ///< records of the chunk that is being filled
  TimeRange chunk_times_;
  std::map<std::uint16_t, MessageIndex> chunk_index_;
  std::string chunk_indices_;  ///< chunk index records, for the summary
  std::uint32_t chunk_count_ = 0;
};

}  // namespace cartvo
