// Table of the settings of a camera that matter to odometry.
#include "tools/camera/camera_settings.hpp"

#include <cmath>

namespace cartvo {
namespace {

constexpr double kLowestRate = 15.0, kHighestRate = 30.0, kDefaultRate = 18.0;  // Hz
constexpr double kRateUnit = 100.0;  // maxFrameRate counts hundredths of a picture per second

constexpr const char* kFalse = "false";

Setting off(const char* name, const char* title, const char* reason, Document document,
            std::vector<std::string> paths) {
  Setting setting{name, title, reason, document, std::move(paths), Rule::choice, {kFalse, "close", "off"}};
  return setting;
}

Setting choice(const char* name, const char* title, const char* reason, Document document,
               std::vector<std::string> paths, std::vector<std::string> accepted) {
  return {name, title, reason, document, std::move(paths), Rule::choice, std::move(accepted)};
}

Setting number(const char* name, const char* title, const char* reason, Document document,
               std::vector<std::string> paths, double least, double most, double best) {
  return {name, title, reason, document, std::move(paths), Rule::number, {}, least, most, best};
}

Setting anyValue(const char* name, const char* title, const char* reason, Document document,
                 std::vector<std::string> paths) {
  return {name, title, reason, document, std::move(paths), Rule::any};
}

Setting required(Setting setting) {
  setting.is_required = true;
  return setting;
}

Setting onlyIf(Setting setting, const char* path, const char* value) {
  setting.condition_path = path;
  setting.condition_value = value;
  return setting;
}

std::vector<Setting> imageSettings() {
  constexpr Document kImage = Document::image;
  constexpr double kLongestExposure = 1.0 / 250.0, kBestExposure = 1.0 / 500.0;  // s
  constexpr double kMaxSharpness = 40, kBestSharpness = 30, kMaxNoiseReduction = 30, kBestNoiseReduction = 20;
  Setting shutter{"shutter",
                  "longest exposure",
                  "at 30 deg/s of yaw a picture moves by 1 px in 1/250 s; longer exposures blur it",
                  kImage,
                  {"Shutter/ShutterLevel", "Shutter/maxShutterLevelLimit"},
                  Rule::shutter,
                  {},
                  0.0,
                  kLongestExposure,
                  kBestExposure};
  Setting flip = anyValue("flip", "flip or mirror",
                          "it must stay as at the calibration; a flipped picture also runs "
                          "from bottom to top",
                          kImage, {"ImageFlip/enabled"});
  flip.alike = false;
  return {
      off("stabilisation", "electronic stabilisation",
          "it moves the picture against the lens, so that no calibration is valid", kImage, {"EIS/enabled"}),
      off("lens-correction", "lens distortion correction",
          "it resamples the picture: no calibration made without it is valid, and rows lose their instant",
          kImage, {"LensDistortionCorrection/enabled", "lensDistortionCorrection/enabled"}),
      off("wdr", "wide dynamic range", "it merges exposures of different instants into one picture", kImage,
          {"WDR/mode", "WDR/enabled"}),
      off("dehaze", "dehaze", "it changes the local contrast from picture to picture", kImage,
          {"Dehaze/DehazeMode", "Dehaze/enabled"}),
      off("blc", "backlight compensation", "it changes the exposure by what passes the middle of the picture",
          kImage, {"BLC/enabled"}),
      off("hlc", "highlight compensation", "it changes the brightness around lamps from picture to picture",
          kImage, {"HLC/enabled"}),
      off("slow-shutter", "slow shutter (DSS)", "it lowers the frame rate in the dark", kImage,
          {"DSS/enabled"}),
      required(shutter),
      choice("day-night", "day and night mode", "the switch to night mode changes the picture and the focus",
             kImage, {"IrcutFilter/IrcutFilterType"}, {"day"}),
      number("sharpness", "sharpness", "sharpening draws contours that are not in the scene", kImage,
             {"Sharpness/SharpnessLevel", "sharpnessLevel"}, 0.0, kMaxSharpness, kBestSharpness),
      choice("noise-reduction", "noise reduction",
             "its expert modes mix pictures of different instants strongly", kImage, {"NoiseReduce/mode"},
             {"general", "close"}),
      onlyIf(number("noise-reduction-level", "strength of the noise reduction",
                    "it mixes pictures of different instants: moving detail lags", kImage,
                    {"NoiseReduce/GeneralMode/generalLevel"}, 0.0, kMaxNoiseReduction, kBestNoiseReduction),
             "NoiseReduce/mode", "general"),
      anyValue(
          "mains-frequency", "mains frequency",
          "it selects the mode of the sensor, and so the readout of the rows: both cameras need the same",
          kImage, {"powerLineFrequency/powerLineFrequencyMode"}),
      flip,
  };
}

std::vector<Setting> overlaySettings() {
  const char* reason = "text stands still in the picture while the cart moves";
  return {
      off("osd-name", "camera name in the picture", reason, Document::overlays,
          {"channelNameOverlay/enabled"}),
      off("osd-time", "time in the picture", reason, Document::overlays, {"DateTimeOverlay/enabled"}),
      off("osd-text", "text in the picture", reason, Document::overlays,
          {"TextOverlayList/TextOverlay/enabled", "TextOverlay/enabled"}),
  };
}

std::vector<Setting> streamSettings(const OdometryNeeds& needs, double frame_rate) {
  constexpr Document kStream = Document::stream;
  constexpr double kHighestBitRate = 1e6;  // kbit/s
  const double lowest_rate = needs.frame_rate.value_or(kLowestRate),
               highest_rate = needs.frame_rate.value_or(kHighestRate);
  const double period_ms = 1000.0;
  const double pictures = std::round(frame_rate);
  Setting width =
      anyValue("width", "picture width", "it must be the rig's: another size is another calibration", kStream,
               {"Video/videoResolutionWidth"});
  Setting height =
      anyValue("height", "picture height", width.reason.c_str(), kStream, {"Video/videoResolutionHeight"});
  Setting rate = required(number("frame-rate", "frame rate in Hz",
                                 "frames form pairs only at one rate that both cameras reach", kStream,
                                 {"Video/maxFrameRate"}, lowest_rate, highest_rate, frame_rate));
  rate.unit = kRateUnit;
  if (needs.width) width.accepted = {std::to_string(*needs.width)}, width.rule = Rule::choice;
  if (needs.height) height.accepted = {std::to_string(*needs.height)}, height.rule = Rule::choice;
  return {
      required(choice("codec", "codec", "other codecs cannot be decoded", kStream, {"Video/videoCodecType"},
                      {"H.264", "H.265"})),
      required(width),
      required(height),
      onlyIf(choice("profile", "H.264 profile", "the high profile allows B-frames, which delay each picture",
                    kStream, {"Video/H264Profile"}, {"Main", "Baseline"}),
             "Video/videoCodecType", "H.264"),
      off("smart-codec", "smart codec (H.264+, H.265+)",
          "it removes detail that it takes for background, and lengthens the key frame interval", kStream,
          {"Video/SmartCodec/enabled"}),
      off("svc", "scalable coding (SVC)", "its layers refer to each other as B-frames do", kStream,
          {"Video/SVC/enabled", "Video/SVC/mode"}),
      rate,
      required(number("key-frame-interval", "key frame interval",
                      "decoding begins, and begins again after a loss, only at a key frame: one each second",
                      kStream, {"Video/GovLength"}, 1.0, pictures, pictures)),
      number("key-frame-period", "key frame interval in ms",
             "as key-frame-interval; some firmwares use this one", kStream, {"Video/keyFrameInterval"}, 1.0,
             period_ms * std::max(1.0, pictures / frame_rate) + 1.0, period_ms),
      choice("bit-rate-mode", "bit rate mode", "a variable bit rate removes detail when the picture is quiet",
             kStream, {"Video/videoQualityControlType"}, {"CBR"}),
      number("bit-rate", "bit rate in kbit/s", "at low rates the encoder moves image detail", kStream,
             {"Video/constantBitRate", "Video/vbrUpperCap"}, needs.bit_rate, kHighestBitRate, needs.bit_rate),
      off("audio", "audio", "a second stream in the session is only load, and a fault the more", kStream,
          {"Audio/enabled"}),
  };
}

std::vector<Setting> timeSettings() {
  constexpr double kMaxInterval = 60.0;  // min
  Setting server{
      "time-server",
      "time server",
      "the time offset of the pictures is known only by one time base: both cameras need the same server",
      Document::time_servers,
      {},
      Rule::time_server};
  return {
      required(choice("time-mode", "time mode",
                      "sender reports carry the camera's clock; a clock that is set by hand drifts",
                      Document::time, {"timeMode"}, {"NTP"})),
      server,
      number("time-interval", "time synchronisation interval in minutes",
             "many cameras step their clock at each synchronisation: the more often, the smaller the step",
             Document::time_servers, {"NTPServer/synchronizeInterval", "synchronizeInterval"}, 1.0,
             kMaxInterval, 1.0),
  };
}

}  // namespace

std::vector<Setting> cameraSettings(const OdometryNeeds& needs, double frame_rate) {
  std::vector<Setting> all = imageSettings();
  for (const std::vector<Setting>& part :
       {overlaySettings(), streamSettings(needs, frame_rate), timeSettings()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

double frameRateOf(const OdometryNeeds& needs, const CameraDocuments& camera) {
  if (needs.frame_rate) return *needs.frame_rate;
  const auto& stream = camera.of(Document::stream);
  const double found =
      stream ? std::atof(stream->text("Video/maxFrameRate").value_or("").c_str()) / kRateUnit : 0.0;
  return found >= kLowestRate && found <= kHighestRate ? found : kDefaultRate;
}

}  // namespace cartvo
