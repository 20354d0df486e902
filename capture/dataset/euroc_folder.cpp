// EuRoC's layout: mav0/cam0 and mav0/cam1, each with data.csv, data/*.png and sensor.yaml; TUM-VI has
// dso/camchain.yaml in place of the latter.

#include <cctype>
#include <stdexcept>

#include "capture/dataset/frame_interval.hpp"
#include "capture/dataset/image_folder_layouts.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;

ImageSequence readCamera(const fs::path& folder) {
  const fs::path file = folder / "data.csv";
  ImageSequence sequence;
  for (const TextLine& line : readLines(file)) {
    const bool is_header =
        line.number == 1 && std::isalpha(static_cast<unsigned char>(line.text.front())) != 0;
    if (is_header) continue;
    const std::size_t comma = line.text.find(',');
    const auto instant_ns = parseNumber<std::int64_t>(line.text.substr(0, comma));
    std::string name = comma == std::string::npos ? "" : line.text.substr(comma + 1);
    name.erase(0, name.find_first_not_of(" \t"));
    const bool is_instant = instant_ns && *instant_ns >= -kMaxTimestampNs && *instant_ns <= kMaxTimestampNs;
    if (!is_instant || name.empty()) {
      throw std::runtime_error(fileAndLine(file, line) + "expected 'instant in ns,file name' instead of '" +
                               printableExcerpt(line.text) + "'");
    }
    if (fs::path(name).filename() != name) {
      throw std::runtime_error(fileAndLine(file, line) + "'" + printableExcerpt(name) +
                               "' must be the name of a file in data/");
    }
    requireIncreasing(sequence.instants_ns, *instant_ns, file, line);
    const fs::path image = folder / "data" / name;
    if (!fs::exists(image))
      throw std::runtime_error(fileAndLine(file, line) + image.string() + " is missing");
    sequence.instants_ns.push_back(*instant_ns);
    sequence.images.push_back(image);
  }
  if (sequence.images.empty()) throw std::runtime_error(file.string() + " lists no image");
  requirePlausibleInterval(sequence.instants_ns, file, TimeUnit::nanoseconds);
  return sequence;
}

}  // namespace

std::optional<fs::path> findEurocFolder(const fs::path& folder) {
  for (const fs::path& candidate : {folder, folder / "mav0"}) {
    if (fs::is_directory(candidate / "cam0") && fs::is_directory(candidate / "cam1")) return candidate;
  }
  return std::nullopt;
}

ImageFolder readEurocFolder(const fs::path& folder) {
  ImageFolder result;
  result.layout = FolderLayout::euroc;
  result.folder = folder;
  result.left = readCamera(folder / "cam0");
  result.right = readCamera(folder / "cam1");
  result.sensor_files = {pathIfExists(folder / "cam0/sensor.yaml"),
                         pathIfExists(folder / "cam1/sensor.yaml")};
  for (const fs::path& place : {folder, folder.parent_path()}) {
    for (const char* name : {"camchain.yaml", "dso/camchain.yaml"})
      if (result.calib_file.empty()) result.calib_file = pathIfExists(place / name);
  }
  result.rig_file = pathIfExists(folder / "rig.yaml");
  if (result.rig_file.empty()) result.rig_file = pathIfExists(folder.parent_path() / "rig.yaml");
  return result;
}

}  // namespace cartvo::capture
