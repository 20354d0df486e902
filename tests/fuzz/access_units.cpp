// Fuzz target for camera streams: NAL units, parameter sets, slice headers, and pictures cut into packets.
//
// Input: codec, number of repetitions, then packets, each with flags, a length and its bytes.

#include "capture/codec/nal_units.hpp"
#include "capture/rtsp/access_unit_assembler.hpp"
#include "capture/rtsp/loss_detector.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

constexpr int kMaxRounds = 40;  // more than AccessUnitAssembler needs to confirm the marker bit

struct Packet {
  std::vector<std::uint8_t> data;
  bool begins_picture = false;
  bool ends_picture = false;
  bool data_lost = false;
};

std::vector<Packet> parsePackets(fuzz::Bytes& bytes) {
  std::vector<Packet> packets;
  while (!bytes.empty()) {
    const std::uint8_t flags = bytes.readByte();
    Packet packet;
    packet.begins_picture = (flags & 1) != 0;
    packet.data_lost = (flags & 2) != 0;
    packet.ends_picture = (flags & 4) != 0;
    const auto piece = bytes.readSpan(bytes.readByte());
    packet.data.insert(packet.data.end(), piece.begin(), piece.end());
    packets.push_back(std::move(packet));
  }
  return packets;
}

void checkNalUnits(capture::VideoCodec codec, std::span<const std::uint8_t> data) {
  std::size_t bytes = 0;
  std::size_t sets = 0;
  for (const capture::NalUnit& unit : capture::splitNalUnits(codec, data)) {
    fuzz::require(unit.bytes.size() >= capture::nalHeaderSize(codec), "a NAL unit has a header");
    bytes += unit.bytes.size();
    if (unit.kind == capture::NalKind::parameter_set) ++sets;
  }
  fuzz::require(bytes <= data.size(), "NAL units do not overlap");
  const std::vector<std::uint8_t> extracted = capture::parameterSets(codec, data);
  fuzz::require(capture::splitNalUnits(codec, extracted).size() == sets, "parameter sets are found again");
  fuzz::require(capture::parameterSets(codec, extracted) == extracted, "parameter sets are nothing else");
}

/// Sends the packets round by round and checks the pictures.
void receive(capture::VideoCodec codec, const std::vector<Packet>& packets, int rounds) {
  capture::AccessUnitAssembler assembler(codec);
  const capture::StreamFormat format{codec,
                                     packets.empty() ? std::vector<std::uint8_t>() : packets.front().data};
  capture::LossDetector detector(format);
  std::size_t sent = 0, received = 0;
  std::int64_t pts = 0, now_ns = 0;
  for (int i = 0; i < rounds; ++i) {
    for (const Packet& packet : packets) {
      if (packet.begins_picture) pts += 3600;
      assembler.add({packet.data, pts, ++now_ns, std::nullopt, packet.ends_picture, packet.data_lost});
      sent += 4 * packet.data.size() + 4;  // with start codes
      while (const std::optional<capture::AssembledUnit> unit = assembler.popUnit()) {
        received += unit->data.size();
        fuzz::require(unit->first_arrival_ns <= unit->arrival_ns, "a picture begins before it ends");
        detector.inspect(unit->data, unit->data_lost);
        if (i == 0) checkNalUnits(codec, unit->data);
      }
    }
  }
  fuzz::require(received <= sent, "no picture holds more than was sent");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  const capture::VideoCodec codec =
      bytes.readByte() % 2 == 0 ? capture::VideoCodec::h264 : capture::VideoCodec::h265;
  const int rounds = 1 + bytes.readByte() % kMaxRounds;
  checkNalUnits(codec, {data, size});
  receive(codec, parsePackets(bytes), rounds);
  return 0;
}
