// Reads and writes the file format of cached streams.
#include "tools/simulate/stream/stream_file.hpp"

#include <bit>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "common/digest.hpp"

namespace cartvo::simulate {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "cartvo encoded streams, format 2\n";

class Writer {
 public:
  template <class T>
  void number(T value) {
    static_assert(std::is_arithmetic_v<T>);
    contents_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  void text(std::string_view value) {
    number<std::uint64_t>(value.size());
    contents_.append(value);
  }

  void units(const std::vector<AccessUnit>& units) {
    number<std::uint64_t>(units.size());
    for (const AccessUnit& unit : units) {
      number(unit.instant_ns);
      number(unit.begin);
      number(unit.size);
      number<std::uint8_t>(unit.key_frame ? 1 : 0);
    }
  }

  void stream(const EncodedStream& stream) {
    number<std::int32_t>(stream.size.width);
    number<std::int32_t>(stream.size.height);
    number(stream.frame_rate);
    units(stream.lead_in);
    units(stream.units);
    text({reinterpret_cast<const char*>(stream.bytes.data()), stream.bytes.size()});
  }

  void raw(std::string_view bytes) { contents_.append(bytes); }
  const std::string& contents() const { return contents_; }
  std::string releaseContents() { return std::move(contents_); }

 private:
  std::string contents_;
};

class Reader {
 public:
  explicit Reader(std::string_view rest) : rest_(rest) {}

  std::string_view raw(std::uint64_t size) {
    if (size > rest_.size()) throw std::runtime_error("it is truncated");
    const std::string_view bytes = rest_.substr(0, static_cast<std::size_t>(size));
    rest_.remove_prefix(bytes.size());
    return bytes;
  }

  template <class T>
  T number() {
    T value{};
    std::memcpy(&value, raw(sizeof value).data(), sizeof value);
    return value;
  }

  std::string_view text() { return raw(number<std::uint64_t>()); }

  std::vector<AccessUnit> units() {
    const auto count = number<std::uint64_t>();
    std::vector<AccessUnit> units;
    for (std::uint64_t index = 0; index < count; ++index) {
      AccessUnit& unit = units.emplace_back();
      unit.instant_ns = number<std::int64_t>();
      unit.begin = number<std::uint64_t>();
      unit.size = number<std::uint64_t>();
      unit.key_frame = number<std::uint8_t>() != 0;
    }
    return units;
  }

  EncodedStream stream() {
    EncodedStream stream;
    stream.size.width = number<std::int32_t>();
    stream.size.height = number<std::int32_t>();
    stream.frame_rate = number<double>();
    stream.lead_in = units();
    stream.units = units();
    const std::string_view bytes = text();
    stream.bytes.assign(bytes.begin(), bytes.end());
    for (const auto* list : {&stream.lead_in, &stream.units}) {
      for (const AccessUnit& unit : *list) {
        if (unit.begin > stream.bytes.size() || unit.size > stream.bytes.size() - unit.begin) {
          throw std::runtime_error("a picture lies outside of the stream's bytes");
        }
      }
    }
    return stream;
  }

  bool atEnd() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

}  // namespace

std::string streamFileContents(const EncodedPair& pair, std::string_view key) {
  Writer writer;
  writer.raw(kMagic);
  writer.text(key);
  writer.stream(pair.left);
  writer.stream(pair.right);
  writer.number<std::uint64_t>(digestOf(writer.contents()));
  return writer.releaseContents();
}

EncodedPair parseStreamFile(std::string_view contents, std::string_view key) {
  constexpr std::size_t kChecksumSize = sizeof(std::uint64_t);
  if (!contents.starts_with(kMagic))
    throw std::runtime_error("it is not a file of encoded streams in this format");
  if (contents.size() < kMagic.size() + kChecksumSize) throw std::runtime_error("it is truncated");
  const std::string_view body = contents.substr(0, contents.size() - kChecksumSize);
  if (Reader(contents.substr(body.size())).number<std::uint64_t>() != digestOf(body)) {
    throw std::runtime_error("its checksum is wrong");
  }
  Reader reader(body.substr(kMagic.size()));
  if (reader.text() != key) throw std::runtime_error("it was made for other content");
  EncodedPair pair;
  pair.left = reader.stream();
  pair.right = reader.stream();
  if (!reader.atEnd()) throw std::runtime_error("more follows after the streams");
  return pair;
}

}  // namespace cartvo::simulate
