// HTML elements of reports.
#include "tools/report/html.hpp"

#include <chrono>
#include <ctime>
#include <stdexcept>

#include <fmt/chrono.h>
#include <opencv2/imgcodecs.hpp>

#include "common/base64.hpp"

namespace cartvo {

std::string reportTime() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(now));
}

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

std::string htmlPage(std::string_view title, std::string_view style, std::string_view body) {
  constexpr std::string_view kCommonStyle =
      ":root{color-scheme:light dark;--line:#8886}"
      "body{font-family:sans-serif;max-width:1200px;margin:2em auto;padding:0 1em}"
      "table{border-collapse:collapse;width:100%}"
      "th,td{border:1px solid var(--line);padding:.3em .6em;text-align:left;vertical-align:top;"
      "overflow-wrap:anywhere}";
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>";
  html.append(escaped(title)).append("</title>\n<style>").append(kCommonStyle).append(style);
  return html.append("</style></head><body>\n").append(body).append("</body></html>\n");
}

}  // namespace cartvo
