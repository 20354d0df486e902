// Text of numbers in a program whose locale has a decimal comma and groups of digits, as each Qt program in
// German.
#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "capture/recording/recording_index.hpp"
#include "common/exact_text.hpp"
#include "support/calib/rigs.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo {
namespace {

class GermanNumbers : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// Folder of C's locale de_DE.UTF-8, which is made once; empty if it cannot be made here.
const std::filesystem::path& localeFolder() {
  static const test::TemporaryFolder folder;
  static const std::filesystem::path made = [] {
    const std::string make =
        "localedef -i de_DE -f UTF-8 '" + (folder.path() / "de_DE.UTF-8").string() + "' >/dev/null 2>&1";
    return std::system(make.c_str()) == 0 ? folder.path() : std::filesystem::path();
  }();
  return made;
}

/// Sets both locales, C++'s and C's, the latter if one with a decimal comma can be made.
class GermanLocale {
 public:
  GermanLocale() : before_(std::locale::global(std::locale(std::locale(), new GermanNumbers))) {
    if (localeFolder().empty()) return;
    ::setenv("LOCPATH", localeFolder().c_str(), 1);
    std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
    ::unsetenv("LOCPATH");
  }
  ~GermanLocale() {
    std::setlocale(LC_NUMERIC, "C");
    std::locale::global(before_);
  }
  GermanLocale(const GermanLocale&) = delete;
  GermanLocale& operator=(const GermanLocale&) = delete;

 private:
  std::locale before_;
};

/// A rig that each format can represent: KITTI's only rectified ones, some only four coefficients.
calib::Rig rigFor(calib::RigFormat format) {
  if (format == calib::RigFormat::kitti) return test::rectifiedRig();
  calib::Rig rig = test::cartRig();
  rig.left.distortion[4] = rig.right.distortion[4] = 0.0;
  return rig;
}

std::vector<std::string> writtenTexts() {
  std::vector<std::string> texts{exactText(240.264), fixedText(1234.5678, 2), roundedText(12345.6)};
  for (const std::string& name : calib::rigFormatNames()) {
    const calib::RigFormat format = calib::parseRigFormat(name);
    for (const calib::RigFile& file : calib::rigFilesOf(rigFor(format), format))
      texts.push_back(file.text);
  }
  capture::IndexRow row;
  row.number = 123'456;
  row.exposure_ns = 1'700'000'000'123'456'789;
  texts.push_back(capture::formatIndexRow(row));
  try {
    calib::parseRig("cartvo_rig: 12345.5\n", "rig.yaml");
  } catch (const std::exception& error) {
    texts.emplace_back(error.what());
  }
  return texts;
}

TEST(Locale, WrittenTextIsTheSame) {
  const std::vector<std::string> expected = writtenTexts();
  EXPECT_EQ(expected[0], "240.264");
  EXPECT_EQ(expected[1], "1234.57");
  EXPECT_EQ(expected[2], "12345.6");
  const GermanLocale german;
  EXPECT_EQ(writtenTexts(), expected);
}

TEST(Locale, RigsOfAllFormatsAreRead) {
  const test::TemporaryFolder folder;
  const GermanLocale german;
  for (const std::string& name : calib::rigFormatNames()) {
    const calib::RigFormat format = calib::parseRigFormat(name);
    const calib::Rig rig = rigFor(format);
    std::vector<std::filesystem::path> files;
    for (const calib::RigFile& file : calib::rigFilesOf(rig, format)) {
      files.push_back(folder.path() / (name + std::to_string(files.size()) + ".txt"));
      std::ofstream(files.back()) << file.text;
    }
    calib::RigReading reading;
    reading.image_size = rig.left.size;
    const calib::Rig read = calib::readRigFiles(files, reading);
    EXPECT_NEAR(read.left.fx, rig.left.fx, 1e-6) << name;
    EXPECT_NEAR(read.baseline(), rig.baseline(), 1e-6) << name;
  }
}

TEST(Locale, NumbersReadBack) {
  const GermanLocale german;
  for (const double value : {0.1, 1e-300, -1234567.875, 1.7976931348623157e308})
    EXPECT_EQ(exactText(value).find(','), std::string::npos);
  EXPECT_EQ(exactText(std::vector<double>{1.0, 2.5}), "[1, 2.5]");
}

}  // namespace
}  // namespace cartvo
