#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/simulate/content.hpp"
#include "tools/simulate/sequence_content.hpp"

namespace cartvo::simulate {

/// The program cartvo-render, which renders drives, as a child process. It checks its options itself. Signals
/// that Interruption receives are passed on to it.
class Renderer {
 public:
  /// Finds the program: beside the running one or in its build folder, else on $PATH. Throws
  /// std::runtime_error that says what provides it.
  Renderer();

  /// Runs it; progress and messages are printed as by itself. Throws ExitCode with its exit code unless that
  /// is 0.
  void run(const std::vector<std::string>& arguments) const;

  /// As run(), but returns what it writes to standard output.
  std::string outputOf(const std::vector<std::string>& arguments) const;

 private:
  std::filesystem::path program_;
};

/// A drive that cartvo-render has written into a folder, as content. Its description is given on as it was
/// written.
class RenderedDrive final : public Content {
 public:
  /// `key`: tells its pictures from those of other drives. Throws std::runtime_error that names the file if
  /// something is missing or unreadable.
  RenderedDrive(const std::filesystem::path& folder, double frame_rate, std::string key);

  calib::Rig rig() const override { return pictures_.rig(); }
  double frameRate() const override { return frame_rate_; }
  int pairCount() const override { return pictures_.pairCount(); }
  std::int64_t leftInstant(int index) const override { return pictures_.leftInstant(index); }
  std::int64_t rightInstant(int index) const override { return pictures_.rightInstant(index); }
  void images(int index, cv::Mat& left, cv::Mat& right) const override {
    pictures_.images(index, left, right);
  }
  bool startsAtStandstill() const override;
  Trajectory truth() const override { return pictures_.truth(); }
  Trajectory denseTruth() const override { return dense_truth_; }
  std::string cacheKey() const override { return key_; }
  std::map<std::string, std::string> writtenFiles() const override { return written_; }

 private:
  SequenceContent pictures_;
  double frame_rate_;
  std::string key_;
  Trajectory dense_truth_;
  std::map<std::string, std::string> written_;
};

}  // namespace cartvo::simulate
