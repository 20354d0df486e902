// Fuzz target for image folders in all layouts: names, lists and instants. The images are empty files,
// because the image library decodes them.
//
// Input: several files: "kitti", the images' names, the right images' names, times.txt, calib.txt; or
// "euroc", the images' names, both cameras' data.csv; or "raw", the images' names, both cameras'
// timestamps.txt; or "lists", the images' names, left.txt, right.txt; or "pairs", the images' names,
// times.txt.

#include "capture/dataset/image_folder.hpp"

#include <utility>

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

namespace fs = std::filesystem;

/// Makes empty files with those names that are valid.
void makeImages(const fs::path& folder, const std::string& names) {
  constexpr std::size_t kMaxImages = 32, kMaxNameLength = 64;
  fs::create_directories(fuzz::scratchFolder() / folder);
  std::vector<std::string> lines = fuzz::splitLines(names);
  lines.resize(std::min(lines.size(), kMaxImages));
  for (const std::string& name : lines) {
    const bool is_name = !name.empty() && name.size() <= kMaxNameLength &&
                         fs::path(name).filename() == name && name != "." && name != ".." &&
                         name.find('\0') == std::string::npos;
    if (is_name) fuzz::writeScratch(folder / name, "");
  }
}

void makeKitti(std::vector<std::string> parts) {
  parts.resize(5);
  makeImages("sequence/image_0", parts[1]);
  makeImages("sequence/image_1", parts[2]);
  fuzz::writeScratch("sequence/times.txt", parts[3]);
  if (!parts[4].empty()) fuzz::writeScratch("sequence/calib.txt", parts[4]);
}

void makeEuroc(std::vector<std::string> parts) {
  parts.resize(4);
  makeImages("sequence/mav0/cam0/data", parts[1]);
  makeImages("sequence/mav0/cam1/data", parts[1]);
  fuzz::writeScratch("sequence/mav0/cam0/data.csv", parts[2]);
  fuzz::writeScratch("sequence/mav0/cam1/data.csv", parts[3]);
}

void makeRaw(std::vector<std::string> parts) {
  parts.resize(4);
  makeImages("sequence/image_00/data", parts[1]);
  makeImages("sequence/image_01/data", parts[1]);
  fuzz::writeScratch("sequence/image_00/timestamps.txt", parts[2]);
  fuzz::writeScratch("sequence/image_01/timestamps.txt", parts[3]);
}

void makeLists(std::vector<std::string> parts) {
  parts.resize(4);
  makeImages("sequence", parts[1]);
  fuzz::writeScratch("sequence/left.txt", parts[2]);
  fuzz::writeScratch("sequence/right.txt", parts[3]);
}

void makePairs(std::vector<std::string> parts) {
  parts.resize(3);
  makeImages("sequence", parts[1]);
  if (!parts[2].empty()) fuzz::writeScratch("sequence/times.txt", parts[2]);
}

void make(const std::vector<std::string>& parts) {
  const std::string& layout = parts.front();
  if (layout == "euroc\n") return makeEuroc(parts);
  if (layout == "raw\n") return makeRaw(parts);
  if (layout == "lists\n") return makeLists(parts);
  if (layout == "pairs\n") return makePairs(parts);
  makeKitti(parts);
}

void check(const capture::ImageSequence& sequence) {
  fuzz::require(!sequence.images.empty() && sequence.images.size() == sequence.instants_ns.size(),
                "each image has an instant");
  for (std::size_t i = 1; i < sequence.instants_ns.size(); ++i)
    fuzz::require(sequence.instants_ns[i] > sequence.instants_ns[i - 1], "instants increase");
  fuzz::require(sequence.images.size() == 1 || capture::nominalPeriodNs(sequence) > 0,
                "frames have a period");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> parts = fuzz::splitParts(fuzz::toText(data, size));
  const fs::path folder = fuzz::scratchFolder() / "sequence";
  fs::remove_all(folder);
  make(parts);
  const auto images = fuzz::parseOrReject([&] { return capture::readImageFolder(folder); }, folder.string());
  if (!images) return 0;
  check(images->left);
  check(images->right);
  return 0;
}
