// HTML figures of a pair of pictures.
#include "tools/doctor/picture_figures.hpp"

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/base64.hpp"
#include "common/image_size.hpp"
#include "tools/report/html.hpp"

namespace cartvo::doctor {
namespace {

constexpr int kMaxWidth = 960, kMaxHeight = 960;  // px, of a picture in the report
constexpr int kJpegQuality = 80;
constexpr int kRowLines = 8;  // over the rectified pictures

cv::Mat scaledDown(const cv::Mat& image) {
  const double factor = std::min(
      {1.0, static_cast<double>(kMaxWidth) / image.cols, static_cast<double>(kMaxHeight) / image.rows});
  if (factor == 1.0) return image;
  cv::Mat scaled;
  cv::resize(image, scaled, {}, factor, factor, cv::INTER_AREA);
  return scaled;
}

/// `text`: what the picture shows, for those who cannot see it.
std::string figure(const cv::Mat& image, std::string_view caption, std::string_view text) {
  std::vector<unsigned char> jpeg;
  if (!cv::imencode(".jpg", scaledDown(image), jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality}))
    throw std::runtime_error("a picture of the report cannot be encoded");
  return "<figure><img alt=\"" + escaped(text) + "\" src=\"data:image/jpeg;base64," +
         encodeBase64({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}) + "\"><figcaption>" +
         escaped(caption) + "</figcaption></figure>\n";
}

cv::Mat overlayOf(const PicturePair& pair, const calib::Rig& rig) {
  const calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  cv::Mat left, right, overlay;
  rectifier.rectifyLeft(pair.left, left);
  rectifier.rectifyRight(pair.right, right);
  cv::addWeighted(left, 0.5, right, 0.5, 0.0, overlay);
  for (int i = 1; i < kRowLines; ++i)
    overlay.row(i * overlay.rows / kRowLines).setTo(255);
  return overlay;
}

std::string pictureText(const char* side, const cv::Mat& image) {
  return std::string("picture of the ") + side + " camera, " + sizeText(image.size()) + " px, not rectified";
}

}  // namespace

std::string pictureFigures(const PicturePair& pair, const calib::Rig* rig) {
  std::string html = "<div class=\"pictures\">\n" +
                     figure(pair.left, "left camera", pictureText("left", pair.left)) +
                     figure(pair.right, "right camera", pictureText("right", pair.right));
  if (rig != nullptr && pair.left.size() == rig->left.size && pair.right.size() == rig->left.size)
    html += figure(overlayOf(pair, *rig),
                   "both rectified: each thing must be in one row of both, left in the "
                   "right picture of where it is in the left one",
                   "both pictures, rectified with the rig file, laid over each other at half strength, with "
                   "white lines along rows");
  return html + "</div>\n";
}

}  // namespace cartvo::doctor
