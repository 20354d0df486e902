#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/encoded_unit.hpp"

// Parsing of H.264 and H.265 byte streams into NAL units.

namespace cartvo::capture {

/// Kind of a NAL unit (ITU-T H.264 table 7-1, ITU-T H.265 table 7-1).
enum class NalKind : std::uint8_t { slice, key_slice, parameter_set, other };

/// Place of a NAL unit in its picture (ITU-T H.264 7.4.1.2.3, H.265 7.4.2.4.4).
enum class NalPlace : std::uint8_t {
  before_slices,  ///< after a slice, it begins the next picture
  first_slice,    ///< begins a picture
  slice,          ///< a further slice of the same picture
  other,
};

/// One NAL unit within a buffer in Annex B form: header and payload, without the start code.
struct NalUnit {
  std::span<const std::uint8_t> bytes;
  NalKind kind = NalKind::other;
  bool is_reference = false;  ///< H.264: later pictures may be predicted from it
};

/// The first start code (bytes 0, 0, 1), or the end.
std::span<const std::uint8_t>::iterator findStartCode(std::span<const std::uint8_t> data);

/// Size of a NAL unit's header, bytes: 1 in H.264, 2 in H.265.
std::size_t nalHeaderSize(VideoCodec codec);

/// Place of a NAL unit, by its header and the first byte after it.
NalPlace nalPlace(VideoCodec codec, std::span<const std::uint8_t> nal);

/// Whether the NAL unit is a slice of a key picture (IDR, or H.265's IRAP), by its header.
bool isKeySlice(VideoCodec codec, std::span<const std::uint8_t> nal);

/// Splits the buffer at its start codes. Bytes before the first one are ignored.
std::vector<NalUnit> splitNalUnits(VideoCodec codec, std::span<const std::uint8_t> data);

/// The parameter sets among the NAL units, each after a start code; empty if there are none.
std::vector<std::uint8_t> parameterSets(VideoCodec codec, std::span<const std::uint8_t> data);

/// Reads the bits of an H.264 NAL unit without its emulation prevention bytes (7.4.1.1). Reads zeros beyond
/// the end, and isExhausted() is true then.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> nal) : bytes_(nal) {}

  std::uint32_t readBits(int count);
  std::uint32_t readUnsignedExpGolomb();  ///< ue(v), 9.1
  std::int32_t readSignedExpGolomb();     ///< se(v), 9.1.1
  bool readFlag() { return readBits(1) != 0; }
  bool isExhausted() const { return exhausted_; }

 private:
  std::uint32_t readBit();

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  int bits_left_ = 0;
  int zeros_ = 0;
  std::uint8_t current_ = 0;
  bool exhausted_ = false;
};

/// The used values of an H.264 sequence parameter set (ITU-T H.264 7.3.2.1.1).
struct H264SequenceParameters {
  int frame_num_bits = 0;  ///< log2_max_frame_num
  bool separate_colour_planes = false;
  bool frame_num_gaps_allowed = false;
  int reference_pictures = 0;  ///< max_num_ref_frames
};

/// Parses an H.264 NAL unit of type 7; nothing if it is invalid.
std::optional<H264SequenceParameters> parseH264SequenceParameters(std::span<const std::uint8_t> nal);

}  // namespace cartvo::capture
