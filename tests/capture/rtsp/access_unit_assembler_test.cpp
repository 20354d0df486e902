// Assembly of pictures from synthetic RTP payloads.

#include "capture/rtsp/access_unit_assembler.hpp"

#include <algorithm>
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

Bytes startCode() {
  return {0, 0, 0, 1};
}

/// One NAL unit as FFmpeg delivers its RTP packets: whole, or in FU-A fragments (RFC 6184, 5.8).
std::vector<Bytes> packets(std::uint8_t header, std::size_t payload, std::size_t fragment = kMtu - 2) {
  Bytes whole = startCode();
  whole.push_back(header);
  for (std::size_t i = 0; i < payload; ++i)  // all fragments differ, and none contains a start code
    whole.push_back(static_cast<std::uint8_t>(0x80U | (i * 31U + i / 128U + payload)));
  if (payload + 1 <= kMtu) return {whole};
  std::vector<Bytes> result;
  std::size_t begin = 0;
  std::size_t end = 5 + fragment;
  while (begin < whole.size()) {
    end = std::min(end, whole.size());
    result.emplace_back(whole.begin() + static_cast<std::ptrdiff_t>(begin),
                        whole.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
    end += fragment;
  }
  return result;
}

std::vector<Bytes> picture(bool key, const std::vector<std::size_t>& slices) {
  std::vector<Bytes> result;
  for (const std::size_t size : slices) {
    for (Bytes& packet : packets(key ? kKeySlice : kSlice, size))
      result.push_back(std::move(packet));
  }
  return result;
}

/// Feeds pictures packet by packet and records after which packet each is delivered.
class Feeder {
 public:
  struct Result {
    bool early = false;  ///< delivered with its own last packet
    bool data_lost = false;
    Bytes data;
  };

  std::vector<Result> feed(const std::vector<Bytes>& fragments) {
    std::vector<Result> results;
    pts_ += 5000;
    Bytes whole;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      whole.insert(whole.end(), fragments[i].begin(), fragments[i].end());
      assembler.add({fragments[i], pts_, pts_ + static_cast<std::int64_t>(i), std::nullopt, false});
      while (std::optional<AssembledUnit> unit = assembler.popUnit()) {
        if (unit->pts == pts_) {
          EXPECT_EQ(unit->arrival_ns, pts_ + static_cast<std::int64_t>(i));
        }
        results.push_back(
            {unit->pts == pts_ && i + 1 == fragments.size(), unit->data_lost, std::move(unit->data)});
      }
    }
    return results;
  }

  /// Feeds pictures of these sizes, every tenth one a key picture.
  void warmUp(int pictures, const std::vector<std::size_t>& slices) {
    for (int i = 0; i < pictures; ++i) {
      std::vector<std::size_t> sizes = slices;
      sizes.back() += static_cast<std::size_t>(i) * 37;
      feed(picture(i % 10 == 0, sizes));
    }
  }

  AccessUnitAssembler assembler{VideoCodec::h264};

 private:
  std::int64_t pts_ = 0;
};

TEST(AccessUnitAssembler, CompletesPictureWhenNextOneBeginsUntilRuleIsConfirmed) {
  Feeder feeder;
  EXPECT_TRUE(feeder.feed(picture(true, {5000})).empty());
  const auto results = feeder.feed(picture(false, {3000}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].data.size(), 5005U);
  EXPECT_FALSE(results[0].early);
}

TEST(AccessUnitAssembler, CompletesPictureWithLastPacketOnceRuleIsConfirmed) {
  Feeder feeder;
  feeder.warmUp(40, {4000});
  ASSERT_TRUE(feeder.assembler.completesEarly());
  for (const std::size_t size : {100UL, 1399UL, 1400UL, 5000UL, 20000UL}) {
    const auto results = feeder.feed(picture(false, {size}));
    ASSERT_EQ(results.size(), 1U) << size;
    EXPECT_TRUE(results[0].early) << size;
    EXPECT_EQ(results[0].data.size(), size + 5) << size;
  }
}

TEST(AccessUnitAssembler, ConfirmsRuleAfterFourPicturesIncludingKeyPicture) {
  Feeder feeder;
  feeder.feed(picture(true, {9000}));
  for (const std::size_t size : {3000UL, 3100UL, 2900UL}) {
    for (const auto& result : feeder.feed(picture(false, {size})))
      EXPECT_FALSE(result.early) << size;
  }
  const auto results = feeder.feed(picture(false, {3200}));
  ASSERT_EQ(results.size(), 2U) << "the previous picture and this one";
  EXPECT_FALSE(results[0].early);
  EXPECT_TRUE(results[1].early);
}

TEST(AccessUnitAssembler, DoesNotConfirmRuleWithoutKeyPicture) {
  Feeder feeder;
  for (std::size_t i = 0; i < 100; ++i)
    feeder.feed(picture(false, {3000 + 37 * i}));
  EXPECT_FALSE(feeder.assembler.completesEarly());
  feeder.feed(picture(true, {9000}));
  feeder.feed(picture(false, {3000}));
  EXPECT_TRUE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, DoesNotCompleteEarlyWithSlicesOfLimitedSize) {
  Feeder feeder;
  for (int i = 0; i < 100; ++i)  // a key picture has more slices
    feeder.feed(picture(i % 10 == 0, std::vector<std::size_t>(i % 10 == 0 ? 5 : 2, 2000)));
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, DoesNotConfirmRuleWithKeyPictureFollowedByOtherNalUnits) {
  Feeder feeder;
  std::vector<Bytes> first = picture(true, {4000});
  first.push_back(packets(kSei, 20).front());
  feeder.feed(first);
  for (std::size_t i = 0; i < 50; ++i)
    feeder.feed(picture(false, {3000 + 37 * i}));
  EXPECT_FALSE(feeder.assembler.completesEarly()) << "no key picture has satisfied the rule";
}

TEST(AccessUnitAssembler, WaitsForNextPictureAfterLastFragmentOfFullSize) {
  Feeder feeder;
  feeder.warmUp(40, {4000});
  EXPECT_TRUE(feeder.feed(picture(false, {3 * (kMtu - 2)})).empty());
  const auto results = feeder.feed(picture(false, {2000}));
  ASSERT_EQ(results.size(), 2U);
  EXPECT_FALSE(results[0].early);
  EXPECT_TRUE(results[1].early);
  EXPECT_FALSE(results[0].data_lost || results[1].data_lost);
}

TEST(AccessUnitAssembler, CountsSlicesOfEachPicture) {
  Feeder feeder;
  feeder.warmUp(40, {1700, 900, 2500, 3000});
  ASSERT_TRUE(feeder.assembler.completesEarly());
  const auto results = feeder.feed(picture(false, {800, 900, 700, 100}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].early);
}

TEST(AccessUnitAssembler, DropsDuplicatePacket) {
  Feeder feeder;
  feeder.warmUp(40, {4000});
  for (std::size_t repeated = 0; repeated < 3; ++repeated) {
    std::vector<Bytes> fragments = picture(false, {4000});
    const Bytes twice = fragments[repeated];
    fragments.insert(fragments.begin() + static_cast<std::ptrdiff_t>(repeated), twice);
    const auto results = feeder.feed(fragments);
    ASSERT_EQ(results.size(), 1U) << repeated;
    EXPECT_EQ(results[0].data.size(), 4005U) << repeated;
    EXPECT_FALSE(results[0].data_lost) << repeated;
  }
  EXPECT_FALSE(feeder.feed(picture(false, {4000})).at(0).data_lost);
}

TEST(AccessUnitAssembler, DoesNotCompleteEarlyWithVaryingNumberOfSlices) {
  Feeder feeder;
  for (int i = 0; i < 100; ++i) {
    feeder.feed(picture(i % 10 == 0, std::vector<std::size_t>(static_cast<std::size_t>(1 + i % 3), 2000)));
  }
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, DoesNotCompleteEarlyWithEvenlyCutFragments) {
  Feeder feeder;
  for (int i = 0; i < 100; ++i) {
    const std::size_t size = 3000 + static_cast<std::size_t>(i * 131 % 4000);
    const std::size_t count = size / kMtu + 1;
    feeder.feed(packets(i % 10 == 0 ? kKeySlice : kSlice, size, size / count + 1));
  }
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, WaitsForNalUnitsAfterSlices) {
  Feeder feeder;
  for (int i = 0; i < 100; ++i) {
    std::vector<Bytes> fragments = picture(i % 10 == 0, {4000});
    for (Bytes& packet : packets(kSei, 20))
      fragments.push_back(std::move(packet));
    for (const auto& result : feeder.feed(fragments))
      EXPECT_EQ(result.data.size(), 4005U + 25U);
  }
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, MarksNextPictureAfterPrematureOneAndRejectsRule) {
  Feeder feeder;
  feeder.warmUp(40, {4000});
  ASSERT_TRUE(feeder.assembler.completesEarly());
  feeder.feed(picture(false, {4000, 4000}));  // two slices instead of one
  EXPECT_FALSE(feeder.assembler.completesEarly());
  feeder.feed(picture(false, {4000}));
  const auto results = feeder.feed(picture(false, {4000}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].data_lost) << "the picture after the incomplete one must count as damaged";
  feeder.warmUp(100, {4000});
  EXPECT_FALSE(feeder.assembler.completesEarly());
}

TEST(AccessUnitAssembler, MarksPictureWithoutBeginning) {
  Feeder feeder;
  std::vector<Bytes> fragments = picture(false, {4000});
  fragments.erase(fragments.begin());
  feeder.feed(fragments);
  const auto results = feeder.feed(picture(false, {3000}));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_TRUE(results[0].data_lost);
}

TEST(AccessUnitAssembler, KeepsLatestReferenceOfPicture) {
  AccessUnitAssembler assembler(VideoCodec::h264);
  const Bytes data = packets(kKeySlice, 100).front();
  assembler.add({data, 0, 1, 77, false});
  assembler.add({data, 5000, 2, std::nullopt, false});
  const std::optional<AssembledUnit> unit = assembler.popUnit();
  ASSERT_TRUE(unit);
  EXPECT_EQ(unit->reference_us, 77);
}

TEST(AccessUnitAssembler, ParsesH265Headers) {
  AccessUnitAssembler assembler(VideoCodec::h265);
  constexpr std::uint8_t kIdr = 19 << 1;
  constexpr std::uint8_t kTrail = 1 << 1;
  std::int64_t pts = 0;
  std::size_t early = 0;
  for (int i = 0; i < 60; ++i) {
    pts += 5000;
    Bytes first = startCode();
    first.push_back(i % 10 == 0 ? kIdr : kTrail);
    first.push_back(1);
    first.insert(first.end(), kMtu - 3, 0xaa);
    assembler.add({first, pts, pts, std::nullopt, false});
    assembler.add({Bytes(kMtu - 3, 0xaa), pts, pts, std::nullopt, false});
    assembler.add({Bytes(200 + static_cast<std::size_t>(i), 0xaa), pts, pts, std::nullopt, false});
    while (const std::optional<AssembledUnit> unit = assembler.popUnit()) {
      if (unit->pts == pts) ++early;
    }
  }
  EXPECT_GT(early, 20U);
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

}  // namespace
}  // namespace cartvo::capture
