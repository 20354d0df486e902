// Keeps the images of views that were taken from streams.
#include "tools/calibrate/views/kept_views.hpp"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

fs::path unusedFolder(const fs::path& wanted) {
  fs::path folder = wanted;
  for (int number = 2; fs::exists(folder); ++number)
    folder = wanted.string() + "-" + std::to_string(number);
  return folder;
}

void writePng(const fs::path& file, const cv::Mat& image) {
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", image, png)) throw std::runtime_error(file.string() + ": cannot be encoded");
  writeResultFile(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace

KeptViews::KeptViews(const fs::path& folder) : folder_(unusedFolder(folder)) {
  createFolders(folder_.path() / "image_0");
  createFolders(folder_.path() / "image_1");
  folder_.keep();
}

void KeptViews::add(const DetectedView& view) {
  const std::string name = fmt::format("{:03d}.png", count_ + 1);
  try {
    writePng(folder() / "image_0" / name, view.left_image);
    writePng(folder() / "image_1" / name, view.right_image);
    ++count_;
  } catch (const std::exception& error) {
    if (!has_failed_) std::fprintf(stderr, "cartvo: views are not kept: %s\n", error.what());
    has_failed_ = true;
  }
}

}  // namespace cartvo
