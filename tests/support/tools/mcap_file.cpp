// Reads MCAP files strictly, independently of the writer.
#include "support/tools/mcap_file.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <string_view>

namespace cartvo::test {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";

void require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error("MCAP: " + what);
}

/// CRC-32 bit by bit.
std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  std::string_view take(std::uint64_t count) {
    require(count <= bytes_.size(), "a length exceeds its record");
    const std::string_view part = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return part;
  }
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const std::string_view part = take(size);
    for (std::size_t i = size; i-- > 0;)
      value = value << 8U | static_cast<unsigned char>(part[i]);
    return value;
  }
  std::string text() { return std::string(take(number(4))); }
  std::map<std::uint64_t, std::uint64_t> numberMap() {
    Bytes pairs(take(number(4)));
    std::map<std::uint64_t, std::uint64_t> values;
    while (!pairs.isEmpty()) {
      const std::uint64_t key = pairs.number(2);
      require(values.emplace(key, pairs.number(8)).second, "a key twice in a map");
    }
    return values;
  }
  bool isEmpty() const { return bytes_.empty(); }
  std::size_t size() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

struct Record {
  std::uint64_t opcode, offset, end;
  std::string_view content;
};

/// The records of a part of the file that begins at `offset`.
std::vector<Record> records(std::string_view bytes, std::uint64_t offset) {
  std::vector<Record> found;
  Bytes rest(bytes);
  while (!rest.isEmpty()) {
    Record record{};
    record.offset = offset + bytes.size() - rest.size();
    record.opcode = rest.number(1);
    record.content = rest.take(rest.number(8));
    record.end = offset + bytes.size() - rest.size();
    found.push_back(record);
  }
  return found;
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  McapFile read() {
    require(bytes_.size() > 2 * kMagic.size() && bytes_.starts_with(kMagic) && bytes_.ends_with(kMagic),
            "the magic bytes are missing");
    const auto all = records(bytes_.substr(kMagic.size(), bytes_.size() - 2 * kMagic.size()), kMagic.size());
    require(all.size() > 3 && all.front().opcode == 0x01 && all.back().opcode == 0x02, "header or footer");
    file_.profile = Bytes(all.front().content).text();
    std::size_t index = 1;
    for (; all.at(index).opcode != 0x0f; ++index)
      readData(all[index]);
    Bytes data_end(all[index].content);
    require(data_end.number(4) == checksum(bytes_.substr(0, all[index].offset)), "checksum of the data");
    readSummary(all, index + 1);
    return file_;
  }

 private:
  struct Chunk {
    Record record{};
    std::string_view data;
    std::uint64_t first = 0, last = 0, indices_end = 0;
    std::map<std::uint64_t, std::uint64_t> indices;   ///< offsets by channel
    std::set<std::array<std::uint64_t, 3>> messages;  ///< channel, time, offset
  };

  void readData(const Record& record) {
    if (record.opcode == 0x06) return readChunk(record);
    require(record.opcode == 0x07 && !chunks_.empty(), "a record that is not expected in the data");
    Chunk& chunk = chunks_.back();
    Bytes content(record.content);
    const std::uint64_t channel = content.number(2);
    require(chunk.indices.emplace(channel, record.offset).second, "an index twice");
    chunk.indices_end = record.end;
    Bytes entries(content.take(content.number(4)));
    require(content.isEmpty(), "bytes after an index");
    while (!entries.isEmpty()) {
      const std::uint64_t time = entries.number(8);
      require(chunk.messages.erase({channel, time, entries.number(8)}) == 1, "an index entry");
    }
  }

  void readChunk(const Record& record) {
    Chunk chunk;
    chunk.record = record;
    Bytes content(record.content);
    chunk.first = content.number(8);
    chunk.last = content.number(8);
    const std::uint64_t size = content.number(8), crc = content.number(4);
    require(content.text().empty(), "compression");
    chunk.data = content.take(content.number(8));
    require(content.isEmpty() && chunk.data.size() == size && checksum(chunk.data) == crc, "chunk checksum");
    for (const Record& inner : records(chunk.data, 0)) {
      if (inner.opcode == 0x05) {
        readMessage(inner, chunk);
      } else {
        addDefinition(inner);
      }
    }
    chunk.indices_end = record.end;
    chunks_.push_back(chunk);
  }

  void addDefinition(const Record& record) {
    require(record.opcode == 0x03 || record.opcode == 0x04, "a record that is not expected in a chunk");
    definitions_.insert(std::string(1, static_cast<char>(record.opcode)) + std::string(record.content));
    Bytes content(record.content);
    const std::uint64_t id = content.number(2);
    if (record.opcode == 0x03) {
      const std::string name = content.text(), encoding = content.text();
      require(id != 0 && schema_names_.emplace(id, name).second, "a schema's number");
      file_.schemas[name] = encoding + ":" + content.text();
    } else {
      McapMessage channel;
      channel.schema = schema_names_.at(content.number(2));
      channel.topic = content.text();
      channel.encoding = content.text();
      require(content.numberMap().empty() && channels_.emplace(id, channel).second, "a channel");
    }
    require(content.isEmpty(), "bytes after a definition");
  }

  void readMessage(const Record& record, Chunk& chunk) {
    Bytes content(record.content);
    const std::uint64_t channel = content.number(2);
    McapMessage message = channels_.at(channel);
    require(content.number(4) == counts_[channel]++, "a message's sequence number");
    message.log_time = content.number(8);
    message.publish_time = content.number(8);
    require(message.log_time >= chunk.first && message.log_time <= chunk.last, "the times of a chunk");
    message.data = content.take(content.size());
    require(chunk.messages.insert({channel, message.log_time, record.offset}).second, "a message twice");
    file_.messages.push_back(message);
  }

  void readSummary(const std::vector<Record>& all, std::size_t index) {
    Bytes footer(all.back().content);
    const std::uint64_t start = footer.number(8), offsets_start = footer.number(8), crc = footer.number(4);
    const std::size_t checked = bytes_.size() - kMagic.size() - 4;
    require(crc == checksum(bytes_.substr(start, checked - start)), "checksum of the summary");
    require(footer.isEmpty() && start == all.at(index).offset, "start of the summary");
    std::size_t chunk = 0;
    std::map<std::uint64_t, std::pair<std::uint64_t, std::uint64_t>> groups, offsets;
    for (; index + 1 < all.size(); ++index) {
      const Record& record = all[index];
      if (record.opcode == 0x0e) {
        require(record.offset >= offsets_start, "a summary offset before their start");
        Bytes content(record.content);
        const std::uint64_t opcode = content.number(1), group = content.number(8);
        offsets[opcode] = {group, group + content.number(8)};
        continue;
      }
      groups.emplace(record.opcode, std::pair(record.offset, record.end)).first->second.second = record.end;
      if (record.opcode == 0x03 || record.opcode == 0x04) {
        require(definitions_.erase(std::string(1, static_cast<char>(record.opcode)) +
                                   std::string(record.content)) == 1,
                "a definition in the summary");
      } else if (record.opcode == 0x0b) {
        checkStatistics(record);
      } else {
        require(record.opcode == 0x08 && chunk < chunks_.size(), "a record in the summary");
        checkChunkIndex(record, chunks_[chunk++]);
      }
    }
    require(definitions_.empty() && chunk == chunks_.size() && offsets == groups,
            "the summary is incomplete");
    file_.chunks = chunk;
  }

  void checkStatistics(const Record& record) {
    Bytes content(record.content);
    require(content.number(8) == file_.messages.size(), "count of messages");
    require(content.number(2) == schema_names_.size(), "count of schemas");
    require(content.number(4) == channels_.size(), "count of channels");
    require(content.number(4) == 0 && content.number(4) == 0, "attachments or metadata");
    require(content.number(4) == chunks_.size(), "count of chunks");
    std::uint64_t first = ~std::uint64_t{0}, last = 0;
    for (const McapMessage& message : file_.messages) {
      first = std::min(first, message.log_time);
      last = std::max(last, message.log_time);
    }
    require(content.number(8) == first && content.number(8) == last, "first and last time");
    for (const auto& [channel, definition] : channels_)
      counts_.try_emplace(channel, 0);
    require(content.numberMap() == counts_ && content.isEmpty(), "counts of the channels");
  }

  static void checkChunkIndex(const Record& record, const Chunk& chunk) {
    require(chunk.messages.empty(), "a message without an index entry");
    Bytes content(record.content);
    require(content.number(8) == chunk.first && content.number(8) == chunk.last, "a chunk index's times");
    require(content.number(8) == chunk.record.offset, "a chunk's offset");
    require(content.number(8) == chunk.record.end - chunk.record.offset, "a chunk's length");
    require(content.numberMap() == chunk.indices, "offsets of the indices");
    require(content.number(8) == chunk.indices_end - chunk.record.end, "length of the indices");
    require(content.text().empty(), "compression in a chunk index");
    require(content.number(8) == chunk.data.size() && content.number(8) == chunk.data.size(), "chunk sizes");
    require(content.isEmpty(), "bytes after a chunk index");
  }

  std::string_view bytes_;
  McapFile file_;
  std::vector<Chunk> chunks_;
  std::map<std::uint64_t, std::string> schema_names_;
  std::map<std::uint64_t, McapMessage> channels_;
  std::map<std::uint64_t, std::uint64_t> counts_;
  std::set<std::string> definitions_;
};

}  // namespace

McapFile readMcapFile(const std::string& bytes) {
  return Reader(bytes).read();
}

}  // namespace cartvo::test
