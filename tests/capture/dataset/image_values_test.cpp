// Values, completeness and orientation of image files.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/dataset/image_files.hpp"
#include "capture/dataset/image_folder.hpp"
#include "support/capture/written_files.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Writes three image pairs whose values rise from low to high along the columns.
void writeRamps(const fs::path& folder, const cv::Vec2i& left, const cv::Vec2i& right, int right_type) {
  std::string times;
  for (int i = 0; i < 3; ++i) {
    for (const char* camera : {"image_0", "image_1"}) {
      const bool is_left = camera == std::string("image_0");
      const cv::Vec2i range = is_left ? left : right;
      cv::Mat image(24, 33, CV_16UC1);
      for (int row = 0; row < image.rows; ++row)
        for (int column = 0; column < image.cols; ++column)
          image.at<std::uint16_t>(row, column) =
              static_cast<std::uint16_t>(range[0] + (range[1] - range[0]) * column / (image.cols - 1));
      if (!is_left) image.convertTo(image, right_type);
      fs::create_directories(folder / camera);
      ASSERT_TRUE(cv::imwrite((folder / camera / (std::to_string(i) + ".png")).string(), image));
    }
    times += std::to_string(i) + "e-1\n";
  }
  test::writeText(folder / "times.txt", times);
}

/// Smallest and largest value of a camera's last frame.
cv::Vec2i rangeRead(const ImageSequence& sequence) {
  ImageSequenceSource source(sequence);
  Frame frame;
  cv::Vec2d range;
  while (source.read(frame, std::chrono::milliseconds(0)) == ReadOutcome::frame)
    cv::minMaxLoc(frame.image, &range[0], &range[1]);
  return range;
}

TEST(ImageValues, SubtractWhatThermalImagesDoNotUse) {
  const test::TemporaryFolder folder;
  writeRamps(folder.path(), {30000, 30400}, {30020, 30380}, CV_16U);
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_THAT(read.warnings,
              ElementsAre(HasSubstr("use a small part of their values; 29950 is subtracted, and "
                                    "the rest is divided by 2")));
  EXPECT_EQ(rangeRead(read.left), cv::Vec2i(25, 225));
  EXPECT_EQ(rangeRead(read.right), cv::Vec2i(35, 215));
}

TEST(ImageValues, HaveTheirOwnScaleInEachCamera) {
  const test::TemporaryFolder folder;
  writeRamps(folder.path(), {0, 4000}, {0, 64000}, CV_16U);
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("image_0: the 16-bit images use 12 bits")));
  EXPECT_EQ(rangeRead(read.left), rangeRead(read.right));
}

TEST(ImageValues, AreScaledBesideACameraOfEightBits) {
  const test::TemporaryFolder folder;
  writeRamps(folder.path(), {0, 4000}, {0, 250}, CV_8U);
  const ImageFolder read = readImageFolder(folder.path());
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("image_0: the 16-bit images use 12 bits")));
  EXPECT_EQ(rangeRead(read.left), cv::Vec2i(0, 250));
  EXPECT_EQ(rangeRead(read.right), cv::Vec2i(0, 250));
}

TEST(ImageValues, IgnoreSingleBrightPixels) {
  const test::TemporaryFolder folder;
  cv::Mat image(100, 100, CV_16UC1);
  cv::randu(image, 0, 4096);
  image.at<std::uint16_t>(50, 50) = 65535;
  const std::string file = (folder / "a.png").string();
  ASSERT_TRUE(cv::imwrite(file, image));
  EXPECT_EQ(measureGreyLevels({file}, {file}).left, (GreyRange{12, 0}));
}

/// A JPEG with an orientation (EXIF tag 0x112) in front of its content.
std::string jpegWithOrientation(const cv::Mat& image, char orientation) {
  std::vector<unsigned char> plain;
  cv::imencode(".jpg", image, plain);
  std::string segment("Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 24);
  segment += std::string{orientation, 0, 0, 0, 0, 0, 0, 0};
  const std::string bytes(plain.begin(), plain.end());
  return bytes.substr(0, 2) + std::string("\xff\xe1\0", 3) + static_cast<char>(segment.size() + 2) + segment +
         bytes.substr(2);
}

TEST(ImageFile, IsReadAsStoredWhateverItsOrientation) {
  const test::TemporaryFolder folder;
  const cv::Mat image(24, 32, CV_8UC1, cv::Scalar(90));
  for (const char orientation : {'\1', '\3', '\6', '\10'}) {
    test::writeText(folder / "a.jpg", jpegWithOrientation(image, orientation));
    EXPECT_EQ(readGreyImage(folder / "a.jpg").size(), image.size());
  }
}

TEST(ImageFile, IsAnErrorIfItIsCutOff) {
  const test::TemporaryFolder folder;
  cv::Mat image(240, 320, CV_8UC1);
  cv::randu(image, 0, 255);
  for (const char* extension : {".png", ".jpg", ".pgm", ".bmp", ".tiff", ".webp"}) {
    const fs::path file = folder / (std::string("a") + extension);
    ASSERT_TRUE(cv::imwrite(file.string(), image));
    EXPECT_EQ(readGreyImage(file).size(), image.size()) << extension;
    fs::resize_file(file, fs::file_size(file) * 6 / 10);
    const std::string error = test::messageOf([&] { readGreyImage(file); });
    EXPECT_THAT(error, HasSubstr(file.string())) << extension;
    EXPECT_THAT(error, HasSubstr("expected a complete file")) << extension;
  }
}

}  // namespace
}  // namespace cartvo::capture
