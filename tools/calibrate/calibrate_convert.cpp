// `cartvo calibrate convert`: converts rigs from and to other tools' file formats.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/format/rig_formats.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/image_size.hpp"
#include "tools/calibrate/next_step.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<fs::path> files;
  std::string format = "cartvo";
  std::string image_size;
  bool unusual_geometry = false, json = false;
  fs::path output;
};

/// Returns the paths of the written files.
std::vector<std::string> write(const fs::path& output, const std::vector<calib::RigFile>& files) {
  std::vector<std::string> paths;
  for (const calib::RigFile& file : files) {
    const fs::path path = file.name.empty() ? output : output / file.name;
    writeResultFile(path, file.text);
    paths.push_back(path);
  }
  return paths;
}

/// The files on standard output and the rig on standard error, or both as JSON.
void report(const Options& options, const std::vector<std::string>& files, const calib::Rig& rig,
            const calib::Rectification& rectified) {
  if (options.json) {
    const nlohmann::ordered_json json{{"format", options.format},
                                      {"files", files},
                                      {"size", {rig.left.size.width, rig.left.size.height}},
                                      {"baseline_m", rectified.baseline},
                                      {"rectified_focal_length_px", rectified.focal_length}};
    printJson(json);
    return;
  }
  for (const std::string& file : files)
    if (fs::is_regular_file(file)) std::printf("%s\n", file.c_str());  // not behind the data on /dev/stdout
  std::fprintf(stderr, "cartvo: %dx%d px, baseline %.4f m, focal length %.1f px as rectified, %s\n",
               rig.left.size.width, rig.left.size.height, rectified.baseline, rectified.focal_length,
               rig.left.lens == calib::LensModel::wide ? "wide lenses (cv::fisheye)" : "Brown's distortion");
}

void warnOfLostScaleUncertainty(const calib::Rig& rig, calib::RigFormat format) {
  if (format == calib::RigFormat::cartvo || !(rig.scale_stddev > 0.0)) return;
  std::fprintf(
      stderr,
      "cartvo: the format %s cannot store the scale's uncertainty (scale_deviation: %g); when read back, the "
      "scale counts as exact\n",
      calib::rigFormatNames()[static_cast<std::size_t>(format)].c_str(), rig.scale_stddev);
}

void warnOfLostMasks(const calib::Rig& rig, calib::RigFormat format) {
  if (format == calib::RigFormat::cartvo || (rig.left.mask.empty() && rig.right.mask.empty())) return;
  std::fprintf(stderr,
               "cartvo: the format %s cannot store masks; when read back, all of the pictures is used\n",
               calib::rigFormatNames()[static_cast<std::size_t>(format)].c_str());
}

cv::Size parsedSize(const std::string& text) {
  const std::optional<cv::Size> size = parseImageSize(text);
  if (!size) throw std::invalid_argument("'" + text + "' is not WIDTHxHEIGHT, such as 680x420");
  return *size;
}

void run(const Options& options) {
  calib::RigReading reading;
  if (!options.image_size.empty()) reading.image_size = parsedSize(options.image_size);
  reading.unusual_geometry = options.unusual_geometry;
  const calib::Rig rig = calib::readRigFiles(options.files, reading);
  // Rejects a rig that cannot be rectified now, not at the daemon's start.
  const calib::Rectification rectified = calib::computeRectification(rig, rig.rectification);
  const calib::RigFormat format = calib::parseRigFormat(options.format);
  report(options, write(options.output, calib::rigFilesOf(rig, format)), rig, rectified);
  warnOfLostScaleUncertainty(rig, format);
  warnOfLostMasks(rig, format);
  if (format == calib::RigFormat::cartvo) printNextStep(rig, options.output);
}

}  // namespace

void addCalibrateConvert(Command calibrate) {
  const Command command = calibrate.addSubcommand("convert", "Convert rigs from and to other tools' formats");
  const auto options = std::make_shared<Options>();
  command
      .addOption("FILE", options->files,
                 "A rig file in any format; for EuRoC's sensor.yaml and ROS' camera_info the left and the "
                 "right file, for OpenCV's sample intrinsics.yml and extrinsics.yml")
      .required()
      .expected(1, 2);
  command.addOption("--format", options->format, "Format to write")
      .choices(calib::rigFormatNames())
      .typeName("NAME")
      .captureDefault();
  command.addOption("--output", options->output, "File to write; a folder for ros and euroc")
      .required()
      .typeName("PATH");
  command
      .addOption(
          "--size", options->image_size,
          "Size of the images, px; needed for files that do not contain it (KITTI's calib.txt, OpenCV's "
          "intrinsics.yml) or contain several (KITTI's calib_cam_to_cam.txt)")
      .typeName("WIDTHxHEIGHT");
  command.addFlag("--unusual-geometry", options->unusual_geometry,
                  "Accept numbers that are unusual for a stereo pair on a vehicle, such as a principal point "
                  "near the rim, and confirm them in the rig file");
  command.addFlag("--json", options->json, "Print what was written as JSON");
  command.footer(
      "The format of FILE is detected from its contents. Other formats contain neither the cameras' mounting "
      "on\n"
      "the cart (see 'cartvo calibrate mount') nor the scale's uncertainty.\n"
      "Examples:\n"
      "  cartvo calibrate convert camchain.yaml --output rig.yaml\n"
      "  cartvo calibrate convert left.yaml right.yaml --output rig.yaml\n"
      "  cartvo calibrate convert rig.yaml --format ros --output camera_info");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
