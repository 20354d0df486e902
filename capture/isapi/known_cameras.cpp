// File with the keys of cameras.
#include "capture/isapi/known_cameras.hpp"

#include <sstream>
#include <stdexcept>
#include <system_error>

#include "common/atomic_file.hpp"
#include "common/input_file.hpp"

namespace cartvo::capture {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 64 * 1024;

std::string nameOf(const HttpAddress& address) {
  return address.host + ":" + std::to_string(address.port);
}

}  // namespace

KnownCameras::KnownCameras(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error) && !error) return;
  text_ = readInputText(file_, kMaxFileBytes);
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
  std::istringstream lines(text_);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    std::string name, key, rest;
    if (line.empty() || line.front() == '#') continue;
    if (!(words >> name >> key) || words >> rest || !key.starts_with("sha256//")) {
      throw std::runtime_error(
          file_.string() + ":" + std::to_string(number) +
          ": expected HOST:PORT sha256//KEY; remove the line, the key is then kept anew");
    }
  }
}

std::optional<std::string> KnownCameras::keyOf(const HttpAddress& address) const {
  std::istringstream lines(text_);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, key;
    if (words >> name >> key && name == nameOf(address)) return key;
  }
  return std::nullopt;
}

void KnownCameras::add(const HttpAddress& address, const std::string& key) {
  if (text_.empty()) text_ = "# Keys of the cameras' HTTPS certificates, kept by cartvo camera --https\n";
  text_ += nameOf(address) + " " + key + "\n";
  writeFileAtomically(file_, text_);
}

}  // namespace cartvo::capture
