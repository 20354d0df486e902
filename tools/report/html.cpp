// HTML elements of reports.
#include "tools/report/html.hpp"

#include <stdexcept>

#include <opencv2/imgcodecs.hpp>

#include "common/base64.hpp"

namespace cartvo {
std::string escaped(std::string_view text) {
  std::string result;
  for (const char character : text) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
    }
  }
  return result;
}

std::string imageElement(const cv::Mat& image, std::string_view description) {
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", image, png)) throw std::runtime_error("an image of the report cannot be encoded");
  return "<img alt=\"" + escaped(description) + "\" src=\"data:image/png;base64," +
         encodeBase64({reinterpret_cast<const char*>(png.data()), png.size()}) + "\">\n";
}

std::string tableElement(const std::vector<std::string>& header,
                         const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table><tr>";
  for (const std::string& cell : header)
    html += "<th>" + escaped(cell) + "</th>";
  html += "</tr>\n";
  for (const std::vector<std::string>& row : rows) {
    html += "<tr>";
    for (const std::string& cell : row)
      html += "<td>" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace cartvo
