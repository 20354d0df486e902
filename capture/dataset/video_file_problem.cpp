// Diagnosis of files that FFmpeg cannot open as a video.
#include "capture/dataset/video_file_problem.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>

#include "common/files/foreign_format.hpp"

namespace cartvo::capture {
namespace {

/// Header of a box, the unit of an MP4 file (ISO/IEC 14496-12, 4.2).
struct Box {
  std::string type;
  std::uint64_t size = 0;  ///< bytes with the header; 0: up to the end of the file
};

std::optional<std::uint64_t> readBigEndian(std::istream& input, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    const int byte = input.get();
    if (byte < 0) return std::nullopt;
    value = value << 8U | static_cast<std::uint64_t>(byte);
  }
  return value;
}

std::optional<Box> readBox(std::istream& input) {
  const std::optional<std::uint64_t> size = readBigEndian(input, 4);
  std::array<char, 4> type{};
  if (!size || !input.read(type.data(), type.size())) return std::nullopt;
  Box box{{type.data(), type.size()}, *size};
  if (*size == 1) box.size = readBigEndian(input, 8).value_or(0);
  return box;
}

bool isFirstBoxType(const std::string& type) {
  constexpr std::array<const char*, 6> kTypes{"ftyp", "mdat", "moov", "wide", "free", "skip"};
  return std::find(kTypes.begin(), kTypes.end(), type) != kTypes.end();
}

enum class Mp4Index : std::uint8_t { no_mp4, missing, truncated, complete };

Mp4Index findMp4Index(const std::filesystem::path& file) {
  constexpr int kMaxBoxes = 10'000;
  constexpr std::uint64_t kMinBox = 8;
  std::error_code error;
  const std::uint64_t file_size = std::filesystem::file_size(file, error);
  std::ifstream input(file, std::ios::binary);
  std::uint64_t position = 0;
  for (int count = 0; count < kMaxBoxes; ++count) {
    input.seekg(static_cast<std::streamoff>(position));
    const std::optional<Box> box = readBox(input);
    if (count == 0 && (!box || !isFirstBoxType(box->type))) return Mp4Index::no_mp4;
    if (!box) return Mp4Index::missing;
    const bool is_cut = box->size > file_size - position;
    if (box->type == "moov") return is_cut ? Mp4Index::truncated : Mp4Index::complete;
    if (box->size < kMinBox || is_cut) return Mp4Index::missing;
    position += box->size;
  }
  return Mp4Index::missing;
}

}  // namespace

std::string videoFileProblem(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::file_size(file, error) == 0) return "it is empty: the recorder wrote nothing into it";
  if (const std::string format = foreignFormat(file); !format.empty()) return "it " + format;
  if (isTextFile(file))
    return "it is a text file; a rig, instants and a truth have options of their own, see '--help' of the "
           "command";
  switch (findMp4Index(file)) {
    case Mp4Index::missing:
    case Mp4Index::truncated:
      return "it is an MP4 whose index (moov) is missing: the recorder never finished the file, for example "
             "because it lost power. A tool that rebuilds the index from another recording of this camera "
             "can "
             "recover it; let the recorder write MKV, MPEG-TS or fragmented MP4, which need no index";
    case Mp4Index::complete:
      return "it is an MP4 that is damaged; copy it again";
    default:
      return "it is no video in a format that FFmpeg knows; 'ffprobe FILE' shows what it is";
  }
}

bool isUnfinishedMp4(const std::filesystem::path& file) {
  const Mp4Index index = findMp4Index(file);
  return index == Mp4Index::missing || index == Mp4Index::truncated;
}

}  // namespace cartvo::capture
