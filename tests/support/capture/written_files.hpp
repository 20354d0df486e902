#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace cartvo::test {

/// Writes a text file and the folders that are missing.
inline void writeText(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// Writes an image in the format of the file's extension, and the folders that are missing.
inline void writePicture(const std::filesystem::path& file, const cv::Mat& image) {
  std::filesystem::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), image)) << file;
}

/// As writePicture: grey, all pixels equal.
inline void writePicture(const std::filesystem::path& file, cv::Size size, int grey) {
  writePicture(file, cv::Mat(size, CV_8UC1, cv::Scalar(grey)));
}

}  // namespace cartvo::test
