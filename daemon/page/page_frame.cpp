// Encodes pictures and landmarks for the status page.
#include "daemon/page/page_frame.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "daemon/page/page_history.hpp"

namespace cartvo::daemon {
namespace {

constexpr int kMaxWidth = 960;  // px
constexpr int kQuality = 65;    // percent
constexpr int kDigits = 5;

std::string stagesJson(const pipeline::StageTimes& times) {
  constexpr double kMilliseconds = 1e3;
  std::string json = "{";
  for (int i = 0; i < vo::kStageCount; ++i) {
    const auto stage = static_cast<vo::Stage>(i);
    fmt::format_to(std::back_inserter(json), "\"{}\":{:.3f},", vo::stageName(stage),
                   kMilliseconds * times.stage(stage));
  }
  return json + fmt::format("\"all\":{:.3f}}}", kMilliseconds * times.total);
}

/// The elements of a JSON array.
std::string regionsJson(const vo::ImageRegions& regions) {
  std::string json;
  for (const vo::ImageRegion& region : regions) {
    fmt::format_to(std::back_inserter(json), "{}[{},{},{},{}]", json.empty() ? "" : ",", region.x, region.y,
                   region.width, region.height);
  }
  return json;
}

}  // namespace

EncodedPictures encodePictures(const cv::Mat& left, const cv::Mat& right) {
  EncodedPictures pictures;
  const cv::Size size = left.empty() ? right.size() : left.size();
  if (size.empty()) return pictures;
  while (size.width > kMaxWidth * pictures.scale)
    pictures.scale *= 2;
  pictures.width = size.width / pictures.scale;
  pictures.height = size.height / pictures.scale;
  cv::Mat both(2 * pictures.height, pictures.width, CV_8UC1, cv::Scalar(0));
  // Whole blocks of scale x scale pixels, so that the landmarks' positions are divided by the scale.
  const cv::Rect blocks(0, 0, pictures.scale * pictures.width, pictures.scale * pictures.height);
  int row = 0;
  for (const cv::Mat& picture : {left, right}) {
    cv::Mat part = both.rowRange(row, row + pictures.height);
    row += pictures.height;
    if (picture.empty()) continue;
    const cv::Mat shown = picture.size() == size ? picture(blocks) : picture;
    cv::resize(shown, part, part.size(), 0.0, 0.0, cv::INTER_AREA);
  }
  std::vector<unsigned char> jpeg;
  if (cv::imencode(".jpg", both, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality}))
    pictures.jpeg.assign(jpeg.begin(), jpeg.end());
  return pictures;
}

std::string unpairedJson(const EncodedPictures& pictures) {
  return fmt::format(R"({{"width":{},"height":{},"scale":{},"sequence":null}})", pictures.width,
                     pictures.height, pictures.scale);
}

std::string picturesJson(const EncodedPictures& pictures, const pipeline::PairView& view,
                         std::int64_t sequence) {
  std::string json = fmt::format(
      R"({{"width":{},"height":{},"scale":{},"sequence":{},"stages_ms":{},"still":[{}],"landmarks":[)",
      pictures.width, pictures.height, pictures.scale, sequence, stagesJson(view.times),
      regionsJson(view.still_regions));
  for (std::size_t i = 0; i < view.landmarks.size(); ++i) {
    const vo::LandmarkView& landmark = view.landmarks[i];
    json += i == 0 ? "[" : ",[";
    for (const float pixel : {landmark.left_x, landmark.left_y, landmark.right_x, landmark.right_y}) {
      appendNumber(pixel, kDigits, json);
      json += ',';
    }
    fmt::format_to(std::back_inserter(json), "{:.2f},{},", landmark.weight, landmark.age);
    appendNumber(landmark.inverse_depth, kDigits, json);
    json += ']';
  }
  return json + "]}";
}

std::string frameBytes(const std::string& json, const std::string& jpeg) {
  std::string bytes;
  bytes.reserve(4 + json.size() + jpeg.size());
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>((json.size() >> shift) & 0xFFU);
  return bytes + json + jpeg;
}

}  // namespace cartvo::daemon
