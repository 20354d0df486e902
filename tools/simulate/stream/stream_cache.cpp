// Caches encoded streams on disk, so that a drive is rendered and encoded only once.
#include "tools/simulate/stream/stream_cache.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
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

void StreamCache::makeRoomFor(std::uint64_t bytes) const {
  std::vector<fs::directory_entry> files;
  std::uint64_t total_bytes = bytes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    // Also counts temporary files of killed runs, whose names continue after the extension.
    if (!entry.is_regular_file() || entry.path().filename().string().find(kExtension) == std::string::npos)
      continue;
    total_bytes += entry.file_size();
    files.push_back(entry);
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.last_write_time() < b.last_write_time(); });
  for (const fs::directory_entry& entry : files) {
    if (total_bytes <= max_bytes_) break;
    total_bytes -= entry.file_size();
    fs::remove(entry.path());
  }
}

}  // namespace cartvo::simulate
