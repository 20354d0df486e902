// The last minute and the path, as the status page plots them.
#include "daemon/page/page_history.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::daemon {
namespace {

template <typename Iterator>
std::string arrayJson(Iterator begin, Iterator end) {
  std::string json = "[";
  for (Iterator sample = begin; sample != end; ++sample) {
    if (sample != begin) json += ',';
    appendJson(*sample, json);
  }
  return json + "]";
}

}  // namespace

void PageHistory::add(const PageSample& sample) {
  // A clock that was set back begins a new minute.
  if (!samples_.empty() && sample.utime() < samples_.back().utime() - kSpan_us) samples_.clear();
  samples_.push_back(sample);
  while (samples_.size() > kMaxSamples || samples_.front().utime() < sample.utime() - kSpan_us)
    samples_.pop_front();
  if (sample.isValid()) addToPath(sample);
}

void PageHistory::addToPath(const PageSample& sample) {
  if (!path_.empty() && path_.back().epoch() == sample.epoch() &&
      std::hypot(sample.x() - path_.back().x(), sample.y() - path_.back().y()) < spacing_)
    return;
  path_.push_back(sample);
  if (path_.size() <= kMaxPathPoints) return;
  spacing_ *= 2.0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < path_.size(); i += 2)
    path_[kept++] = path_[i];
  path_.resize(kept);
}

std::string PageHistory::newestJson(std::size_t count) const {
  const auto begin = samples_.end() - static_cast<std::ptrdiff_t>(std::min(count, samples_.size()));
  return arrayJson(begin, samples_.end());
}

std::string PageHistory::json() const {
  return "{\"samples\":" + arrayJson(samples_.begin(), samples_.end()) +
         ",\"path\":" + arrayJson(path_.begin(), path_.end()) + "}";
}

}  // namespace cartvo::daemon
