// Caches encoded streams on disk, so that a drive is rendered and encoded only once.
#include "tools/simulate/stream/stream_cache.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/atomic_file.hpp"
#include "common/digest.hpp"
#include "tools/simulate/stream/stream_file.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kExtension = ".streams";
constexpr const char* kDriveExtension = ".drive";

/// Something that was cached.
struct Entry {
  fs::path path;
  std::uint64_t bytes = 0;
  fs::file_time_type used;
};

std::uint64_t bytesIn(const fs::path& folder) {
  std::uint64_t bytes = 0;
  std::error_code ignored;  // another process may remove it meanwhile
  for (fs::recursive_directory_iterator entry(folder, ignored), end; entry != end; entry.increment(ignored)) {
    if (const std::uint64_t size = entry->is_regular_file(ignored) ? entry->file_size(ignored) : 0;
        size != static_cast<std::uintmax_t>(-1))
      bytes += size;
  }
  return bytes;
}

/// Streams and drives in a folder; also those that killed runs left, whose names continue after the
/// extension. A drive that may be being written is left out.
std::vector<Entry> entriesOf(const fs::path& folder) {
  constexpr std::chrono::hours kLongestRendering{24};
  std::vector<Entry> entries;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_drive = entry.is_directory() && name.find(kDriveExtension) != std::string::npos;
    if (!is_drive && !(entry.is_regular_file() && name.find(kExtension) != std::string::npos)) continue;
    const fs::file_time_type used = entry.last_write_time();
    if (is_drive && entry.path().extension() != kDriveExtension &&
        used > fs::file_time_type::clock::now() - kLongestRendering)
      continue;
    entries.push_back({entry.path(), is_drive ? bytesIn(entry.path()) : entry.file_size(), used});
  }
  return entries;
}

}  // namespace

StreamCache::StreamCache(fs::path folder, std::uint64_t max_bytes)
    : folder_(std::move(folder)), max_bytes_(max_bytes) {}

fs::path StreamCache::defaultFolder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return fs::path(cache) / "cartvo";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return fs::path(home) / ".cache" / "cartvo";
  }
  return fs::temp_directory_path() / ("cartvo-cache-" + std::to_string(getuid()));
}

fs::path StreamCache::fileFor(const std::string& key) const {
  char name[17];
  std::snprintf(name, sizeof name, "%016llx", static_cast<unsigned long long>(digestOf(key)));
  return folder_ / (std::string(name) + kExtension);
}

std::optional<EncodedPair> StreamCache::load(const std::string& key) const {
  const fs::path file = fileFor(key);
  std::ifstream input(file, std::ios::binary);
  if (!input) return std::nullopt;
  const std::string contents(std::istreambuf_iterator<char>(input), {});
  std::error_code ignored;
  try {
    EncodedPair pair = parseStreamFile(contents, key);
    fs::last_write_time(file, fs::file_time_type::clock::now(),
                        ignored);  // for the least-recently-used order
    return pair;
  } catch (const std::runtime_error& error) {
    spdlog::warn("{}: cached streams are removed and made again: {}", file.string(), error.what());
    fs::remove(file, ignored);
    return std::nullopt;
  }
}

void StreamCache::store(const std::string& key, const EncodedPair& pair) const {
  fs::create_directories(folder_);
  const std::string contents = streamFileContents(pair, key);
  if (contents.size() > max_bytes_) {
    spdlog::warn("streams of {} MB are not cached: the limit of the cache is {} MB",
                 contents.size() / 1'000'000, max_bytes_ / 1'000'000);
    return;
  }
  makeRoomFor(contents.size());
  // The folder may be in the temporary directory, where others can make links; a link of a name that the user
  // did not give is not followed.
  if (fs::is_symlink(fs::symlink_status(fileFor(key)))) fs::remove(fileFor(key));
  writeFileAtomically(fileFor(key), contents);
}

std::string StreamCache::problem() const {
  try {
    checkFileCanBeWritten(folder_ / "probe");
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

fs::path StreamCache::driveFolder(const std::string& key,
                                  const std::function<void(const fs::path&)>& render) const {
  fs::path folder = fileFor(key).replace_extension(kDriveExtension);
  std::error_code problem;
  if (!fs::is_directory(folder)) {
    // Several processes may render the same drive.
    const fs::path own = folder.string() + "." + std::to_string(getpid());
    render(own);
    fs::rename(own, folder, problem);
    if (problem) fs::remove_all(own);
    if (problem && !fs::is_directory(folder))
      throw std::runtime_error(folder.string() + ": cannot be written: " + problem.message());
  }
  fs::last_write_time(folder, fs::file_time_type::clock::now(),
                      problem);  // for the least-recently-used order
  return folder;
}

void StreamCache::makeRoomFor(std::uint64_t bytes) const {
  std::vector<Entry> entries = entriesOf(folder_);
  std::uint64_t total_bytes = bytes;
  for (const Entry& entry : entries)
    total_bytes += entry.bytes;
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
  for (const Entry& entry : entries) {
    if (total_bytes <= max_bytes_) break;
    total_bytes -= entry.bytes;
    fs::remove_all(entry.path);
  }
}

}  // namespace cartvo::simulate
