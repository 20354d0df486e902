// Assembly of pictures from synthetic RTP payloads.

#include "capture/rtsp/access_unit_assembler.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kMtu = 1400;  ///< maximum RTP payload, bytes
constexpr std::uint8_t kKeySlice = 0x65;
constexpr std::uint8_t kSlice = 0x41;
constexpr std::uint8_t kSei = 0x06;
constexpr std::uint8_t kParameters = 0x67;
constexpr std::uint8_t kFirst = 0x80;  ///< first byte of a slice whose first macroblock is the picture's
constexpr std::uint8_t kLater = 0x40;  ///< of another slice

/// One packet of a picture.
struct Packet {
  Bytes payload;
  bool marker = false;
  std::int64_t pts_step = 0;  ///< RTP time relative to the picture's
  bool data_lost = false;
};

/// A NAL unit as RTP packets: whole, or in FU-A fragments (RFC 6184, 5.8).
std::vector<Packet> nal(std::uint8_t header, std::uint8_t first_byte, std::size_t size) {
  Bytes body = {first_byte};
  while (body.size() < size)
    body.push_back(static_cast<std::uint8_t>(0x80U | (body.size() * 31U + size)));
  if (size + 1 <= kMtu) {
    body.insert(body.begin(), header);
    return {{body}};
  }
  std::vector<Packet> packets;
  for (std::size_t at = 0; at < body.size(); at += kMtu - 2) {
    const std::size_t end = std::min(at + kMtu - 2, body.size());
    Bytes payload = {static_cast<std::uint8_t>((header & 0xe0) | 28),
                     static_cast<std::uint8_t>(header & 0x1f)};
    if (at == 0) payload[1] |= 0x80;
    if (end == body.size()) payload[1] |= 0x40;
    payload.insert(payload.end(), body.begin() + static_cast<std::ptrdiff_t>(at),
                   body.begin() + static_cast<std::ptrdiff_t>(end));
    packets.push_back({payload});
  }
  return packets;
}

std::vector<Packet> joined(std::initializer_list<std::vector<Packet>> parts) {
  std::vector<Packet> all;
  for (const std::vector<Packet>& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// A picture of slices of these sizes, with the marker bit on its last packet.
std::vector<Packet> picture(bool key, const std::vector<std::size_t>& slices) {
  std::vector<Packet> packets;
  for (const std::size_t size : slices) {
    for (Packet& packet : nal(key ? kKeySlice : kSlice, packets.empty() ? kFirst : kLater, size))
      packets.push_back(std::move(packet));
  }
  packets.back().marker = true;
  return packets;
}

/// Feeds pictures packet by packet, and tells which are delivered after which packet.
class Feeder {
 public:
  struct Result {
    bool early = false;  ///< delivered with its own last packet
    AssembledUnit unit;
  };

  std::vector<Result> feed(const std::vector<Packet>& packets) {
    std::vector<Result> results;
    pts_ += 5000;
    for (std::size_t i = 0; i < packets.size(); ++i) {
      const Packet& packet = packets[i];
      assembler.add(
          {packet.payload, pts_ + packet.pts_step, ++now_ns_, std::nullopt, packet.marker, packet.data_lost});
      while (std::optional<AssembledUnit> unit = assembler.popUnit())
        results.push_back({unit->pts == pts_ && i + 1 == packets.size(), std::move(*unit)});
    }
    return results;
  }

  /// Feeds pictures, every tenth one a key picture.
  void warmUp(int pictures) {
    for (int i = 0; i < pictures; ++i)
      feed(picture(i % 10 == 0, {4000 + static_cast<std::size_t>(i)}));
  }

  AccessUnitAssembler assembler{VideoCodec::h264};

 private:
  std::int64_t pts_ = 0;
  std::int64_t now_ns_ = 0;
};

TEST(AccessUnitAssembler, CompletesPictureWhenNextOneBeginsUntilMarkerIsConfirmed) {
  Feeder feeder;
  EXPECT_TRUE(feeder.feed(picture(true, {5000})).empty());
  const auto results = feeder.feed(picture(false, {3000}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].unit.data.size(), 5005U);
  EXPECT_FALSE(results[0].early);
}

TEST(AccessUnitAssembler, CompletesPictureWithItsMarkerOnceThatIsConfirmed) {
  Feeder feeder;
  feeder.warmUp(12);
  ASSERT_TRUE(feeder.assembler.completesEarly());
  for (const std::size_t size : {100UL, 1399UL, 1400UL, 2796UL, 20000UL}) {
    const auto results = feeder.feed(picture(false, {size, 700}));
    ASSERT_EQ(results.size(), 1U) << size;
    EXPECT_TRUE(results[0].early) << size;
    EXPECT_EQ(results[0].unit.data.size(), size + 5 + 705) << size;
    EXPECT_FALSE(results[0].unit.data_lost);
  }
}

TEST(AccessUnitAssembler, DoesNotConfirmMarkerWithoutKeyPicture) {
  Feeder feeder;
  for (std::size_t i = 0; i < 50; ++i)
    feeder.feed(picture(false, {3000 + i}));
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, DoesNotRelyOnMarkerOfEachSlice) {
  Feeder feeder;
  std::size_t pictures = 0;
  for (int i = 0; i < 50; ++i) {
    std::vector<Packet> packets = picture(i % 10 == 0, {700, 700, 700});
    for (Packet& packet : packets)
      packet.marker = true;
    for (const auto& result : feeder.feed(packets)) {
      ++pictures;
      EXPECT_EQ(result.unit.data.size(), 3U * 705U);
      EXPECT_FALSE(result.unit.data_lost);
    }
  }
  EXPECT_EQ(pictures, 49U);
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, DeliversPicturesWithoutMarkers) {
  Feeder feeder;
  for (int i = 0; i < 20; ++i) {
    std::vector<Packet> packets = picture(i % 10 == 0, {4000});
    packets.back().marker = false;
    const auto results = feeder.feed(packets);
    EXPECT_EQ(results.size(), i == 0 ? 0U : 1U);
  }
}

TEST(AccessUnitAssembler, MarksPicturesAfterWrongMarkerAndDoesNotUseItAgain) {
  Feeder feeder;
  feeder.warmUp(12);
  std::vector<Packet> packets = picture(false, {700, 700});
  packets.front().marker = true;
  feeder.feed(packets);
  EXPECT_FALSE(feeder.assembler.completesEarly());
  feeder.feed(picture(false, {4000}));
  const auto results = feeder.feed(picture(false, {4000}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].unit.data_lost) << "it refers to the incomplete picture";
  feeder.warmUp(50);
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, KeepsMessagesWithTimesOfTheirOwnWithTheirPicture) {
  Feeder feeder;
  for (int i = 0; i < 30; ++i) {
    std::vector<Packet> message = nal(kSei, 5, 20);
    message.front().pts_step = -900;
    std::vector<Packet> parameters = nal(kParameters, 0x64, 12);
    parameters.front().pts_step = -1800;
    const auto results = feeder.feed(joined({parameters, message, picture(i % 10 == 0, {4000})}));
    for (const auto& result : results) {
      EXPECT_EQ(result.unit.data.size(), 4005U + 25U + 17U);
      EXPECT_EQ(result.unit.pts % 5000, 0) << "the slices' time";
      EXPECT_FALSE(result.unit.data_lost);
    }
  }
  EXPECT_TRUE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, NamesPayloadsThatItLeavesOut) {
  const auto left_out = [](Feeder& feeder, const std::vector<Packet>& packets) {
    feeder.warmUp(3);
    const std::uint64_t before = feeder.assembler.leftOut();
    feeder.feed(packets);
    return std::pair(feeder.assembler.leftOut() - before, feeder.assembler.leftOutText());
  };
  std::vector<Packet> headless = picture(false, {5000});
  headless.front().payload[1] &= 0x7f;
  const std::size_t count = headless.size();
  Feeder feeder;
  EXPECT_EQ(left_out(feeder, headless), std::pair(count, std::string("that continue no NAL unit")));
  headless.front().data_lost = true;
  EXPECT_EQ(left_out(feeder, headless).first, 0U) << "a loss explains it";
  EXPECT_EQ(left_out(feeder, {{{28}}, {{24, 0, 9, 0x41}}, {{24, 0, 0, 0x41}}}),
            std::pair(std::size_t{3}, std::string("that are cut off")));
  EXPECT_EQ(left_out(feeder, {{{29, 0, 1}}}).second.substr(0, 10), "of type 29");
  Feeder joining;
  joining.feed(headless);
  EXPECT_EQ(joining.assembler.leftOut(), 0U) << "the connection begins within a picture";
}

TEST(AccessUnitAssembler, TellsPicturesOfOneTimeStampApart) {
  Feeder feeder;
  std::vector<Packet> second = picture(false, {300});
  second.front().pts_step = -5000;  // the picture before has the same time
  feeder.feed(picture(true, {500}));
  const auto results = feeder.feed(second);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].unit.data.size(), 505U);
}

TEST(AccessUnitAssembler, MarksPicturesAroundALoss) {
  Feeder feeder;
  feeder.warmUp(12);
  // The beginning of a picture is lost.
  std::vector<Packet> packets = picture(false, {4000});
  packets.erase(packets.begin());
  packets.front().data_lost = true;
  feeder.feed(packets);
  auto results = feeder.feed(picture(false, {700}));
  ASSERT_EQ(results.size(), 1U);
  // The end of a picture is lost, and the next one is a key picture.
  packets = picture(false, {4000});
  packets.pop_back();
  feeder.feed(packets);
  std::vector<Packet> key = picture(true, {700});
  key.front().data_lost = true;
  results = feeder.feed(key);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_TRUE(results[0].unit.data_lost);
  EXPECT_FALSE(results[1].unit.data_lost) << "a whole key picture needs nothing that was lost before";
  // A slice in the middle of a picture is lost.
  packets = picture(false, {700, 700, 700});
  packets.erase(packets.begin() + 1);
  packets[1].data_lost = true;
  results = feeder.feed(packets);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].unit.data_lost);
}

TEST(AccessUnitAssembler, MarksPictureWithoutFirstSlice) {
  Feeder feeder;
  std::vector<Packet> packets = picture(true, {700, 700});
  packets.erase(packets.begin());
  feeder.feed(packets);
  const auto results = feeder.feed(picture(false, {700}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].unit.data_lost);
}

TEST(AccessUnitAssembler, SplitsAggregates) {
  // STAP-A (RFC 6184, 5.7.1) of a parameter set and a slice.
  AccessUnitAssembler assembler(VideoCodec::h264);
  const Bytes aggregate = {24, 0, 3, kParameters, 1, 2, 0, 4, kKeySlice, kFirst, 7, 8};
  assembler.add({aggregate, 0, 1, 77, true, false});
  const Bytes next = {kSlice, kFirst, 1};
  assembler.add({next, 5000, 2, std::nullopt, true, false});
  const std::optional<AssembledUnit> unit = assembler.popUnit();
  ASSERT_TRUE(unit);
  EXPECT_EQ(unit->data, (Bytes{0, 0, 0, 1, kParameters, 1, 2, 0, 0, 0, 1, kKeySlice, kFirst, 7, 8}));
  EXPECT_EQ(unit->reference_us, 77);
}

TEST(AccessUnitAssembler, ParsesH265) {
  AccessUnitAssembler assembler(VideoCodec::h265);
  constexpr std::uint8_t kIdr = 19, kTrail = 1, kSuffixSei = 40;
  std::int64_t pts = 0;
  std::size_t early = 0;
  for (int i = 0; i < 30; ++i) {
    pts += 5000;
    const std::uint8_t type = i % 10 == 0 ? kIdr : kTrail;
    const Bytes begin = {49 << 1, 1, static_cast<std::uint8_t>(0x80 | type), kFirst, 1, 2};
    const Bytes middle = {49 << 1, 1, type, 3, 4};
    const Bytes end = {49 << 1, 1, static_cast<std::uint8_t>(0x40 | type), 5, 6};
    const Bytes suffix = {kSuffixSei << 1, 1, 9, 9};
    assembler.add({begin, pts, pts, std::nullopt, false, false});
    assembler.add({middle, pts, pts, std::nullopt, false, false});
    assembler.add({end, pts, pts, std::nullopt, false, false});
    assembler.add({suffix, pts, pts, std::nullopt, true, false});
    while (const std::optional<AssembledUnit> unit = assembler.popUnit()) {
      if (unit->pts == pts) ++early;
      Bytes expected = {0, 0, 0, 1, unit->data[4], 1, kFirst, 1, 2, 3, 4, 5, 6, 0, 0, 0, 1};
      expected.insert(expected.end(), suffix.begin(), suffix.end());
      EXPECT_EQ(unit->data, expected);
    }
  }
  EXPECT_GT(early, 20U);
}

TEST(AccessUnitAssembler, SurvivesMalformedPayloads) {
  for (const VideoCodec codec : {VideoCodec::h264, VideoCodec::h265}) {
    AccessUnitAssembler assembler(codec);
    for (int type = 0; type < 256; ++type) {
      for (std::size_t size = 0; size < 6; ++size) {
        const Bytes data(size, static_cast<std::uint8_t>(type));
        assembler.add({data, type, type, std::nullopt, size % 2 == 0, size == 3});
        while (assembler.popUnit())
          continue;
      }
    }
  }
}

TEST(NalUnits, ReadsExpGolombCodesAndSkipsEmulationPrevention) {
  const Bytes data = {0b10100011, 0b01000010, 0x00, 0x00, 0x03, 0x01};
  BitReader bits(data);
  EXPECT_EQ(bits.readUnsignedExpGolomb(), 0U);  // 1
  EXPECT_EQ(bits.readUnsignedExpGolomb(), 1U);  // 010
  EXPECT_EQ(bits.readUnsignedExpGolomb(), 5U);  // 00110
  EXPECT_EQ(bits.readBits(7), 0b1000010U);
  EXPECT_EQ(bits.readBits(24), 1U);
  EXPECT_FALSE(bits.isExhausted());
  bits.readFlag();
  EXPECT_TRUE(bits.isExhausted());
}

/// Delivered pictures of payloads, the last of which has the marker bit, and those of the picture after it.
std::vector<AssembledUnit> assembled(const std::vector<Bytes>& payloads) {
  AccessUnitAssembler assembler(VideoCodec::h264);
  for (const Bytes& payload : payloads)
    assembler.add({payload, 5000, 1, std::nullopt, &payload == &payloads.back(), false});
  const Bytes next = {kSlice, kFirst, 9};
  assembler.add({next, 10000, 2, std::nullopt, true, false});
  std::vector<AssembledUnit> units;
  while (std::optional<AssembledUnit> unit = assembler.popUnit())
    units.push_back(std::move(*unit));
  return units;
}

TEST(AccessUnitAssembler, SplitsPayloadsAtStartCodes) {
  const Bytes expected = {0,    0, 0, 1, 0x67, 1, 2, 0,         0,      0, 1,
                          0x68, 3, 4, 0, 0,    0, 1, kKeySlice, kFirst, 5, 6};
  const Bytes all(expected.begin() + 4, expected.end());
  for (std::size_t cut = 2; cut + 1 < all.size(); ++cut) {
    Bytes begin = {0x7c, 0x87};  // FU-A of the parameter set's type
    begin.insert(begin.end(), all.begin() + 1, all.begin() + static_cast<std::ptrdiff_t>(cut));
    Bytes end = {0x7c, 0x47};
    end.insert(end.end(), all.begin() + static_cast<std::ptrdiff_t>(cut), all.end());
    const std::vector<AssembledUnit> units = assembled({begin, end});
    ASSERT_EQ(units.size(), 1U) << cut;
    EXPECT_EQ(units[0].data, expected) << cut;
  }
  for (const std::vector<Bytes>& payloads :
       {std::vector<Bytes>{all}, std::vector<Bytes>{expected},
        std::vector<Bytes>{{0, 0, 1, 0x67, 1, 2}, {0, 0, 0, 1, 0x68, 3, 4}, {kKeySlice, kFirst, 5, 6}}}) {
    const std::vector<AssembledUnit> units = assembled(payloads);
    ASSERT_EQ(units.size(), 1U);
    EXPECT_EQ(units[0].data, expected);
  }
}

}  // namespace
}  // namespace cartvo::capture
