#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>

#include <opencv2/imgcodecs.hpp>

namespace cartvo::test {

/// Writes a folder of image pairs as KITTI's: image_0, image_1 and times.txt. `image`: of a side (0: left)
/// and an index.
inline void writeImageFolder(const std::filesystem::path& folder, int pairs, double frame_rate,
                             const std::function<cv::Mat(int side, int index)>& image) {
  std::filesystem::create_directories(folder / "image_0");
  std::filesystem::create_directories(folder / "image_1");
  std::ofstream times(folder / "times.txt");
  for (int i = 0; i < pairs; ++i) {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.png", i);
    cv::imwrite((folder / "image_0" / name).string(), image(0, i));
    cv::imwrite((folder / "image_1" / name).string(), image(1, i));
    times << i / frame_rate << "\n";
  }
}

}  // namespace cartvo::test
