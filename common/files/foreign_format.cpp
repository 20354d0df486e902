// Recognition of logs, archives and other files by their first bytes.
#include "common/files/foreign_format.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <string_view>
#include <vector>

#include "common/ascii_text.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using std::string_view_literals::operator""sv;

constexpr const char* kBag =
    "Kalibr's 'kalibr_bagextractor' writes the pictures of two topics into folders cam0 and cam1, which "
    "'cartvo "
    "replay' plays";
constexpr const char* kRos2 =
    "convert it by 'rosbags-convert' to a ROS 1 bag; Kalibr's 'kalibr_bagextractor' writes the pictures of "
    "two "
    "topics into folders cam0 and cam1, which 'cartvo replay' plays";
constexpr const char* kZed =
    "the ZED SDK's sample 'SVO Export' writes a video with both pictures side by side, which 'cartvo replay' "
    "plays";
constexpr const char* kUnpack = "unpack it and give the folder or the file in it";
constexpr const char* kCapture =
    "it holds the packets of a network; record the cameras by 'cartvod --record' or by 'ffmpeg -i rtsp://... "
    "-c "
    "copy left.mkv'";
constexpr const char* kArray = "write its pictures as PNG files into folders image_left and image_right";
constexpr const char* kPage =
    "the download gave a page instead of the file, often one to log in; download it anew";

struct Format {
  const char* extension;   ///< in lower case; nullptr: any
  std::string_view bytes;  ///< empty: any
  std::size_t offset;      ///< of the bytes
  const char* name;
  const char* conversion;
};
// The first that fits holds: SVO 2 files are MCAP files.
constexpr std::array kFormats{
    Format{".svo", ""sv, 0, "a recording of a ZED camera (SVO)", kZed},
    Format{".svo2", ""sv, 0, "a recording of a ZED camera (SVO)", kZed},
    Format{nullptr, "SVO\0"sv, 0, "a recording of a ZED camera (SVO)", kZed},
    Format{nullptr, "#ROSBAG"sv, 0, "a ROS 1 bag", kBag},
    Format{nullptr, "\x89MCAP0\r\n"sv, 0, "an MCAP log, as of ROS 2 (rosbag2) and Foxglove", kRos2},
    Format{".db3", "SQLite format 3\0"sv, 0, "a ROS 2 bag (rosbag2, SQLite)", kRos2},
    Format{
        nullptr, "SQLite format 3\0"sv, 0, "a database (SQLite), as of RTAB-Map and ROS 2 bags",
        "export its pictures by the program that wrote it; 'rtabmap-export --images' does so for RTAB-Map"},
    Format{nullptr, "\xed\xa1\xda\x01"sv, 0, "an LCM log",
           "it holds messages; 'lcm-logplayer' sends them, and 'cartvo watch --output-dir' writes the "
           "trajectory of those of cartvo"},
    Format{".npz", ""sv, 0, "an archive of NumPy arrays", kArray},
    Format{nullptr, "PK\3\4"sv, 0, "a ZIP archive", kUnpack},
    Format{nullptr, "\x1f\x8b"sv, 0, "a gzip archive", kUnpack},
    Format{nullptr, "BZh"sv, 0, "a bzip2 archive", kUnpack},
    Format{nullptr,
           "\xfd"
           "7zXZ"sv,
           0, "an xz archive", kUnpack},
    Format{nullptr, "\x28\xb5\x2f\xfd"sv, 0, "a zstd archive", kUnpack},
    Format{nullptr, "7z\xbc\xaf\x27\x1c"sv, 0, "a 7z archive", kUnpack},
    Format{nullptr, "Rar!"sv, 0, "a RAR archive", kUnpack},
    Format{nullptr, "ustar"sv, 257, "a tar archive", kUnpack},
    Format{nullptr, "\x89HDF\r\n"sv, 0, "an HDF5 file", kArray},
    Format{nullptr, "\x93NUMPY"sv, 0, "a NumPy array", kArray},
    Format{".tfrecord", ""sv, 0, "a TFRecord file", kArray},
    Format{nullptr, "MATLAB 5.0"sv, 0, "a MAT-file",
           "write its values as text; 'cartvo calibrate convert --help' names the formats of rigs"},
    Format{nullptr, "\xd4\xc3\xb2\xa1"sv, 0, "a network capture (pcap)", kCapture},
    Format{nullptr, "\x0a\x0d\x0d\x0a"sv, 0, "a network capture (pcapng)", kCapture},
    Format{nullptr, "version https://git-lfs"sv, 0, "a Git LFS pointer, not the file itself",
           "fetch the file by 'git lfs pull'"},
    Format{nullptr, "<!DOCTYPE html"sv, 0, "a web page", kPage},
    Format{nullptr, "<!doctype html"sv, 0, "a web page", kPage},
    Format{nullptr, "<html"sv, 0, "a web page", kPage},
};

std::string textOf(const Format* format) {
  return format == nullptr ? "" : std::string("is ") + format->name + ": " + format->conversion;
}

/// The first bytes of a regular file.
std::string headOf(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  constexpr std::size_t kHead = 512;
  std::string head(kHead, '\0');
  std::ifstream input(file, std::ios::binary);
  input.read(head.data(), kHead);
  head.resize(static_cast<std::size_t>(input.gcount()));
  return head;
}

const Format* findFormat(const fs::path& file) {
  const std::string head = headOf(file);
  const std::string_view bytes = head;
  if (bytes.empty()) return nullptr;
  const std::string extension = lowerCase(file.extension().string());
  for (const Format& format : kFormats) {
    if (format.extension != nullptr && format.extension != extension) continue;
    if (format.offset > bytes.size() || !bytes.substr(format.offset).starts_with(format.bytes)) continue;
    return &format;
  }
  return nullptr;
}

}  // namespace

std::string foreignFormat(const fs::path& file) {
  return textOf(findFormat(file));
}

bool isTextFile(const fs::path& file) {
  const std::string head = headOf(file);
  const bool is_playlist = head.starts_with("#EXTM3U") || head.starts_with("ffconcat");
  return !head.empty() && !is_playlist && std::all_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= ' ' ? byte != 0x7F : c == '\n' || c == '\r' || c == '\t';
  });
}

std::string foreignContents(const fs::path& folder) {
  constexpr std::size_t kMaxFiles = 100;
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end && files.size() < kMaxFiles;
       entry.increment(error))
    files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const Format* const format = findFormat(file);
    const bool is_log = format != nullptr && format->conversion != kPage;
    if (is_log) return "contains " + file.filename().string() + ", which " + textOf(format);
  }
  return "";
}

}  // namespace cartvo
