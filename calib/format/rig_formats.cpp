// Rig formats of other tools: detection, reading and writing, and those that are not read.
#include "calib/format/rig_formats.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "calib/format/kalibr_rig.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/format/rig_parts.hpp"
#include "calib/format/ros_rig.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/files/foreign_format.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

namespace fs = std::filesystem;

Rig readOneFile(const fs::path& file, const RigReading& reading) {
  const StrictYaml yaml = readYamlOrXml(file);
  if (yaml.has("cartvo_rig")) return parseCartvoRig(yaml, file.parent_path());
  if (isKittiRig(yaml) && !isOpenCvRig(yaml))
    return parseKittiRig(yaml, file, reading.image_size, reading.cameras);
  if (const std::optional<Rig> rig = parseForeignRig(yaml, file, reading.image_size)) return *rig;
  if (yaml.has("T_BS") || isRosCamera(yaml)) {
    throw std::runtime_error(file.string() +
                             ": holds one camera only: give the left and the right camera's file");
  }
  throw std::runtime_error(file.string() + ": is in none of the known formats: " + kKnownRigFormats);
}

Rig readTwoFiles(const fs::path& first, const fs::path& second, const RigReading& reading) {
  const StrictYaml yaml = readYamlOrXml(first), other = readYamlOrXml(second);
  if (yaml.has("T_BS")) return readEurocRig(first, second);
  if (isOpenCvRig(yaml) && isOpenCvRig(other))
    return parseOpenCvRig({yaml, other}, first, reading.image_size);
  if (isRosCamera(yaml)) return readRosRig(first, second);
  throw std::runtime_error(first.string() + " and " + second.string() +
                           ": two files are OpenCV's intrinsics (K1 or M1) and extrinsics (R, T), or the "
                           "left and the right camera's: "
                           "EuRoC's sensor.yaml (T_BS) or ROS' camera_info (camera_matrix or K)");
}

Rig readAnyFiles(const std::vector<fs::path>& files, const RigReading& reading) {
  if (files.size() == 1) return readOneFile(files[0], reading);
  if (files.size() == 2) return readTwoFiles(files[0], files[1], reading);
  throw std::runtime_error("a rig is one file, or the left and the right camera's");
}

}  // namespace

const std::vector<std::string>& rigFormatNames() {
  static const std::vector<std::string> kNames{"cartvo", "opencv", "kalibr", "matlab",
                                               "kitti",  "ros",    "euroc"};
  return kNames;
}

RigFormat parseRigFormat(const std::string& name) {
  const auto& names = rigFormatNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("there is no rig format '" + name + "'");
  return static_cast<RigFormat>(found - names.begin());
}

Rig readRigFiles(const std::vector<fs::path>& files, const RigReading& reading) {
  Rig rig = readAnyFiles(files, reading);
  const std::string finding = unusualGeometry(rig);
  if (finding.empty() || rig.unusual_geometry) return rig;
  if (!reading.unusual_geometry) {
    throw std::runtime_error(files.back().string() + ": " + finding +
                             " If the rig is really so, convert it with --unusual-geometry");
  }
  rig.unusual_geometry = true;
  return rig;
}

std::vector<RigFile> rigFilesOf(const Rig& rig, RigFormat format) {
  validateRig(rig);
  switch (format) {
    case RigFormat::opencv:
      return {{"", openCvText(rig)}};
    case RigFormat::kalibr:
      return {{"", kalibrText(rig)}};
    case RigFormat::matlab:
      return {{"", matlabText(rig)}};
    case RigFormat::kitti:
      return {{"", kittiText(rig)}};
    case RigFormat::ros: {
      const RosText text = rosText(rig);
      return {{"left.yaml", text.left}, {"right.yaml", text.right}};
    }
    case RigFormat::euroc: {
      const EurocText text = eurocText(rig);
      return {{"cam0/sensor.yaml", text.left}, {"cam1/sensor.yaml", text.right}};
    }
    default:
      return {{"", rigText(rig)}};
  }
}

const char* const kKnownRigFormats =
    "cartvo's rig.yaml (key cartvo_rig), an OpenCV FileStorage (K1 or M1, D1, K2, D2, R, T; also in two "
    "files), a Kalibr or OpenVINS camchain (cam0), MATLAB's stereoParameters as JSON (CameraParameters1), "
    "KITTI's calib.txt (P0) or calib_cam_to_cam.txt (P_rect_00), two ROS camera_info files or messages "
    "(camera_matrix or K), two EuRoC sensor.yaml (T_BS)";

namespace {

/// A tool's files, and how to make one that is read.
struct OtherTool {
  const char* tool;
  std::array<std::string_view, 2> marks;  ///< both occur in the text; empty: only the name tells
  std::string_view name;                  ///< the end of the file's name; empty: only the text tells
  const char* target;                     ///< the file to write, or nothing
  const char* conversion;
};

constexpr const char* kFileStorage = "write an OpenCV FileStorage with K1 D1 K2 D2 R T image_size: ";
constexpr const char* kByPython =
    "write the arrays in Python by cv2.FileStorage('stereo.yml', cv2.FILE_STORAGE_WRITE)";

constexpr std::array kOtherTools{
    OtherTool{
        "ORB-SLAM2",
        {"Camera.bf", "LEFT.K"},
        "",
        kFileStorage,
        "K1 D1 K2 D2 are LEFT.K LEFT.D RIGHT.K RIGHT.D; R is the transpose of RIGHT.R times LEFT.R; T is the "
        "transpose of RIGHT.R times [-Camera.bf / Camera.fx, 0, 0]"},
    OtherTool{
        "ORB-SLAM3",
        {"Camera1.fx", "Camera.type"},
        "",
        kFileStorage,
        "K1 and D1 (k1 k2 p1 p2) are those of Camera1, K2 and D2 those of Camera2; R and T are those of the "
        "inverse of Stereo.T_c1_c2; with KannalaBrandt8 add fisheye_model: 1"},
    OtherTool{
        "ORB-SLAM2 or 3",
        {"Camera.fx", "Camera.bf"},
        "",
        kFileStorage,
        "the pictures are rectified: K1 and K2 are those of Camera, D1 and D2 zeros, R is the unit matrix, T "
        "is [-Camera.bf / Camera.fx, 0, 0]"},
    OtherTool{
        "stella_vslam",
        {"focal_x_baseline", "fx"},
        "",
        kFileStorage,
        "the pictures are rectified: K1 and K2 are those of Camera, D1 and D2 zeros, R is the unit matrix, T "
        "is [-focal_x_baseline / fx, 0, 0]"},
    OtherTool{
        "VINS-Fusion (camodocal)",
        {"model_type", "projection_parameters"},
        "",
        kFileStorage,
        "K1 D1 K2 D2 are the parameters of the two files (PINHOLE: k1 k2 p1 p2; KANNALA_BRANDT: k2 k3 k4 k5 "
        "and fisheye_model: 1); R and T are those of inverse(body_T_cam1) body_T_cam0 of the main file"},
    OtherTool{"VINS-Fusion",
              {"body_T_cam0", "cam0_calib"},
              "",
              kFileStorage,
              "K1 D1 K2 D2 are the parameters in the files cam0_calib and cam1_calib; R and T are those of "
              "inverse(body_T_cam1) body_T_cam0"},
    OtherTool{
        "mrcal",
        {"lensmodel", "LENSMODEL_"},
        ".cameramodel",
        "",
        "'mrcal-to-kalibr left.cameramodel right.cameramodel > camchain.yaml' makes a camchain that is read "
        "(of LENSMODEL_OPENCV4: mrcal-convert-lensmodel first fits that to files of another model)"},
    OtherTool{
        "a ZED",
        {"[LEFT_CAM_", "[RIGHT_CAM_"},
        "",
        "",
        "give the messages of the ZED's ROS driver instead: camera_info of its left and right pictures"},
    OtherTool{
        "Middlebury's data sets",
        {"cam0=[", "baseline="},
        "",
        "",
        "write KITTI's calib.txt, for the size width x height, from [f 0 cx0; 0 f cy; 0 0 1] and baseline in "
        "mm: 'P0: f 0 cx0 0 0 f cy 0 0 0 1 0', 'P1: f 0 cx1 -f*baseline/1000 0 f cy 0 0 0 1 0'"},
    OtherTool{"Basalt",
              {"\"value0\"", "\"T_imu_cam\""},
              "",
              "",
              "write a camchain: cam0 and cam1 with T_imu_cam as a 4x4 matrix, and for kb4 the camera_model "
              "pinhole with the distortion_model equidistant; other models (ds, eucm): calibrate again"},
    OtherTool{
        "COLMAP",
        {"CAMERA_ID", "MODEL"},
        "cameras.txt",
        kFileStorage,
        "K and D of each camera are its PARAMS (OPENCV: fx fy cx cy k1 k2 p1 p2; OPENCV_FISHEYE: with "
        "fisheye_model: 1); COLMAP does not know the scale, so that T needs a measured baseline: rather "
        "calibrate"},
    OtherTool{
        "COLMAP",
        {},
        "cameras.bin",
        "",
        "'colmap model_converter --output_type TXT' makes cameras.txt, whose PARAMS are K and D; COLMAP does "
        "not know the scale, so that T needs a measured baseline: rather calibrate"},
    OtherTool{
        "DepthAI (Luxonis OAK)",
        {"\"cameraData\"", "\"intrinsicMatrix\""},
        "",
        kFileStorage,
        "K is intrinsicMatrix, D distortionCoeff; R and T are rotationMatrix and translation / 100 (cm) of "
        "the left camera's extrinsics to the right camera"},
    OtherTool{
        "SVO or maplab",
        {"T_B_C", "distortion"},
        "",
        kFileStorage,
        "K D are intrinsics and distortion of each camera; R and T are those of inverse(T_B_C of the right) "
        "times T_B_C of the left; with equidistant add fisheye_model: 1"},
    OtherTool{"RealSense's rs-enumerate-devices",
              {"Intrinsic of \"", "Fx:"},
              "",
              "",
              "give the messages of its ROS driver instead: camera_info of infra1 and infra2"},
    OtherTool{"calib.io's Calibrator",
              {"libCalib::", "polymorphic_name"},
              "",
              kFileStorage,
              "K and D are the parameters of each camera; R and T are those that take a point from the left "
              "camera's axes to the right's"},
    OtherTool{"ROS' camera_calibration",
              {"# oST version", "[image]"},
              "",
              "",
              "give the two files left.yaml and right.yaml beside it, or those of 'rosrun "
              "camera_calibration_parsers convert ost.txt left.yaml' for each camera"},
    OtherTool{"NumPy", {}, ".npz", "", kByPython},
    OtherTool{"Python (pickle)", {}, ".pkl", "", kByPython},
    OtherTool{"Kalibr's report",
              {"Camera-system parameters", "projection:"},
              "",
              "",
              "give the camchain.yaml that Kalibr wrote beside it"},
    OtherTool{"MATLAB (binary)",
              {"MATLAB 5.0 MAT-file", "MATLAB"},
              ".mat",
              "",
              "write the parameters as JSON in MATLAB, with the lines in cartvo-calibrate-convert(1): s = "
              "struct(stereoParams) ... jsonencode(s)"},
};

bool isOf(const OtherTool& tool, std::string_view text, const std::string& name) {
  if (!tool.name.empty() && name.ends_with(tool.name)) return true;
  return !tool.marks[0].empty() &&
         std::all_of(tool.marks.begin(), tool.marks.end(),
                     [&](std::string_view mark) { return text.find(mark) != std::string_view::npos; });
}

}  // namespace

void refuseOtherRigs(const std::string& text, const std::filesystem::path& file) {
  if (text.find("cartvo_rig") != std::string::npos) return;
  const auto fail = [&file](const std::string& problem) {
    throw std::runtime_error(file.string() + ": " + problem);
  };
  for (const OtherTool& tool : kOtherTools) {
    if (!isOf(tool, text, file.filename().string())) continue;
    fail("is of " + std::string(tool.tool) + ", a format that is not read: " + tool.target + tool.conversion);
  }
  if (const std::string format = foreignFormat(file); !format.empty()) fail(format);
  if (text.find('\0') != std::string::npos)
    fail(std::string("is a binary file; expected ") + kKnownRigFormats);
}

}  // namespace cartvo::calib
