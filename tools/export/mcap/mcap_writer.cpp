// Writes MCAP files.
#include "tools/export/mcap/mcap_writer.hpp"

#include <algorithm>

#include "capture/codec/picture_checksum.hpp"
#include "tools/export/mcap/little_endian.hpp"

namespace cartvo {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

void append(std::string& bytes, std::string_view text) {
  appendLittleEndian(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

/// The record's opcode and length, without its content.
std::string recordStart(Opcode opcode, std::uint64_t size) {
  std::string bytes(1, static_cast<char>(opcode));
  appendLittleEndian(bytes, size);
  return bytes;
}

std::string record(Opcode opcode, const std::string& content) {
  return recordStart(opcode, content.size()) + content;
}

std::string header(std::string_view profile) {
  std::string content;
  append(content, profile);
  append(content, "cartvo " CARTVO_VERSION);
  return record(Opcode::header, content);
}

/// A map with numbers as keys: the size of its content in bytes, then keys and values.
std::string numberMap(const std::map<std::uint16_t, std::uint64_t>& values) {
  std::string pairs;
  for (const auto& [key, value] : values) {
    appendLittleEndian(pairs, key);
    appendLittleEndian(pairs, value);
  }
  std::string bytes;
  append(bytes, pairs);
  return bytes;
}

}  // namespace

void McapWriter::TimeRange::add(std::uint64_t time) {
  first = is_empty ? time : std::min(first, time);
  last = is_empty ? time : std::max(last, time);
  is_empty = false;
}

McapWriter::McapWriter(AtomicFileWriter& file, std::string_view profile) : file_(file) {
  emit(kMagic);
  emit(header(profile));
}

void McapWriter::emit(std::string_view bytes) {
  file_.write(bytes);
  position_ += bytes.size();
  checksum_ = capture::continuedChecksum(checksum_, bytes);
}

std::uint16_t McapWriter::addSchema(std::string_view name, std::string_view encoding, std::string_view data) {
  std::string content;
  appendLittleEndian(content, ++schema_count_);  // 0 means: no schema
  append(content, name);
  append(content, encoding);
  append(content, data);
  schemas_ += record(Opcode::schema, content);
  chunk_ += record(Opcode::schema, content);
  return schema_count_;
}

std::uint16_t McapWriter::addChannel(std::uint16_t schema, std::string_view topic,
                                     std::string_view encoding) {
  const auto channel = static_cast<std::uint16_t>(message_counts_.size());
  message_counts_[channel] = 0;
  std::string content;
  appendLittleEndian(content, channel);
  appendLittleEndian(content, schema);
  append(content, topic);
  append(content, encoding);
  append(content, "");  // no metadata
  channels_ += record(Opcode::channel, content);
  chunk_ += record(Opcode::channel, content);
  return channel;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                       std::string_view data) {
  std::string content;
  content.reserve(data.size() + 32);
  appendLittleEndian(content, channel);
  appendLittleEndian(content, static_cast<std::uint32_t>(message_counts_.at(channel)++));
  appendLittleEndian(content, log_time);
  appendLittleEndian(content, publish_time);
  content += data;
  chunk_index_[channel].emplace_back(log_time, chunk_.size());
  chunk_times_.add(log_time);
  times_.add(log_time);
  chunk_ += record(Opcode::message, content);
  if (chunk_.size() >= kChunkBytes) writeChunk();
}

void McapWriter::writeChunk() {
  const std::uint64_t chunk_start = position_;
  std::string content;
  appendLittleEndian(content, chunk_times_.first);
  appendLittleEndian(content, chunk_times_.last);
  appendLittleEndian(content, std::uint64_t{chunk_.size()});
  appendLittleEndian(content, capture::textChecksum(chunk_));
  append(content, "");  // not compressed
  appendLittleEndian(content, std::uint64_t{chunk_.size()});
  emit(recordStart(Opcode::chunk, content.size() + chunk_.size()));
  emit(content);
  emit(chunk_);

  const std::uint64_t indices_start = position_;
  std::map<std::uint16_t, std::uint64_t> offsets;
  for (const auto& [channel, messages] : chunk_index_) {
    offsets[channel] = position_;
    std::string entries;
    for (const auto& [time, offset] : messages) {
      appendLittleEndian(entries, time);
      appendLittleEndian(entries, offset);
    }
    std::string message_index;
    appendLittleEndian(message_index, channel);
    append(message_index, entries);
    emit(record(Opcode::message_index, message_index));
  }

  std::string index;
  appendLittleEndian(index, chunk_times_.first);
  appendLittleEndian(index, chunk_times_.last);
  appendLittleEndian(index, chunk_start);
  appendLittleEndian(index, indices_start - chunk_start);
  index += numberMap(offsets);
  appendLittleEndian(index, position_ - indices_start);
  append(index, "");
  appendLittleEndian(index, std::uint64_t{chunk_.size()});
  appendLittleEndian(index, std::uint64_t{chunk_.size()});
  chunk_indices_ += record(Opcode::chunk_index, index);
  ++chunk_count_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_times_ = {};
}

void McapWriter::writeSummary() {
  std::string statistics;
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : message_counts_)
    messages += count;
  appendLittleEndian(statistics, messages);
  appendLittleEndian(statistics, schema_count_);
  appendLittleEndian(statistics, static_cast<std::uint32_t>(message_counts_.size()));
  appendLittleEndian(statistics, std::uint32_t{0});  // attachments
  appendLittleEndian(statistics, std::uint32_t{0});  // metadata records
  appendLittleEndian(statistics, chunk_count_);
  appendLittleEndian(statistics, times_.first);
  appendLittleEndian(statistics, times_.last);
  statistics += numberMap(message_counts_);

  const std::uint64_t start = position_;
  checksum_ = 0;
  std::string offsets;
  const std::pair<Opcode, std::string> groups[] = {
      {Opcode::schema, schemas_},
      {Opcode::channel, channels_},
      {Opcode::statistics, record(Opcode::statistics, statistics)},
      {Opcode::chunk_index, chunk_indices_},
  };
  for (const auto& [opcode, records] : groups) {
    if (records.empty()) continue;
    std::string offset(1, static_cast<char>(opcode));
    appendLittleEndian(offset, position_);
    appendLittleEndian(offset, std::uint64_t{records.size()});
    offsets += record(Opcode::summary_offset, offset);
    emit(records);
  }
  const std::uint64_t offsets_start = position_;
  emit(offsets);

  std::string footer;
  appendLittleEndian(footer, start);
  appendLittleEndian(footer, offsets_start);
  emit(recordStart(Opcode::footer, footer.size() + sizeof checksum_));
  emit(footer);
  std::string checksum;  // of the summary and of the footer up to here
  appendLittleEndian(checksum, checksum_);
  emit(checksum);
}

void McapWriter::finish() {
  if (!chunk_.empty()) writeChunk();
  std::string data_end;
  appendLittleEndian(data_end, checksum_);
  emit(record(Opcode::data_end, data_end));
  writeSummary();
  emit(kMagic);
}

}  // namespace cartvo
