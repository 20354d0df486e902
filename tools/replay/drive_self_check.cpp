// Collects the messages of the self-check by their kinds.
#include "tools/replay/drive_self_check.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

namespace cartvo {
namespace {

constexpr double kLeast = 1.0;  // s that a fault lasts to be named

std::string kindOf(std::string message) {
  std::erase_if(message, [](unsigned char c) { return std::isdigit(c) != 0 || c == '.' || c == '-'; });
  return message;
}

}  // namespace

void DriveSelfCheck::add(const std::string& message, double seconds) {
  const double step = seconds - end_;
  end_ = seconds;
  if (message.empty()) return;
  const std::string kind = kindOf(message);
  auto fault = std::find_if(faults_.begin(), faults_.end(), [&](const Fault& f) { return f.kind == kind; });
  if (fault == faults_.end()) fault = faults_.insert(fault, Fault{kind, message, seconds, seconds});
  fault->message = message;
  fault->last = seconds;
  fault->lasted += step;
}

std::string DriveSelfCheck::sentence() const {
  std::vector<Fault> faults = faults_;
  std::erase_if(faults, [&](const Fault& fault) { return fault.lasted < std::min(kLeast, 0.5 * end_); });
  std::stable_sort(faults.begin(), faults.end(),
                   [](const Fault& a, const Fault& b) { return a.lasted > b.lasted; });
  std::string all;
  for (const Fault& fault : faults) {
    all += (all.empty() ? "" : "; ") + fault.message;
    if (fault.last < end_) all += fmt::format(" (from {:.1f} to {:.1f} s)", fault.first, fault.last);
  }
  return all;
}

}  // namespace cartvo
