// Counts VALID messages beyond their limits and bounds, and the time without any.
#include "tools/evaluate/validity/validity_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/units.hpp"
#include "tools/evaluate/association.hpp"

namespace cartvo {
namespace {

/// The largest component that is known; 0 if none is.
double largest(const Eigen::Vector3d& errors) {
  double most = 0.0;
  for (const double error : errors)
    most = std::max(most, error);  // keeps `most` where the error is NaN
  return most;
}

/// Whether an error that is known exceeds its bound, or has none.
bool exceeds(const Eigen::Vector3d& errors, const Eigen::Vector3d& bounds) {
  for (int i = 0; i < 3; ++i)
    if (!std::isnan(errors[i]) && !(errors[i] <= bounds[i])) return true;
  return false;
}

double longestGap(const std::vector<JudgedMessage>& messages) {
  if (messages.empty()) return 0.0;
  std::int64_t last_ns = messages.front().time_ns, longest_ns = 0;
  for (const JudgedMessage& message : messages) {
    longest_ns = std::max(longest_ns, message.time_ns - last_ns);
    if (message.valid) last_ns = message.time_ns;
  }
  return seconds(longest_ns);
}

}  // namespace

double ValidityFigures::availability() const {
  return messages == 0 ? 0.0 : static_cast<double>(valid) / static_cast<double>(messages);
}

bool isAboveLimit(const JudgedMessage& message, const pipeline::AlertLimits& limits) {
  const auto above = [](const Eigen::Vector3d& errors, double limit) {
    return exceeds(errors, Eigen::Vector3d::Constant(limit));
  };
  return above(message.error.velocity, limits.velocity) ||
         above(message.error.angular_rate, limits.angular_rate) ||
         above(message.error.motion, limits.motion) || above(message.error.rotation, limits.rotation);
}

bool isAboveBound(const JudgedMessage& message) {
  return exceeds(message.error.velocity, message.bound.velocity) ||
         exceeds(message.error.angular_rate, message.bound.angular_rate) ||
         exceeds(message.error.motion, message.bound.motion) ||
         exceeds(message.error.rotation, message.bound.rotation);
}

ValidityFigures validityFigures(const std::vector<JudgedMessage>& messages,
                                const pipeline::AlertLimits& limits) {
  ValidityFigures figures;
  figures.longest_gap = longestGap(messages);
  for (const JudgedMessage& message : messages) {
    ++figures.messages;
    if (!message.valid) continue;
    ++figures.valid;
    if (std::isnan(message.error.velocity.x()) && std::isnan(message.error.motion.x())) continue;
    ++figures.judged;
    figures.above_limit += isAboveLimit(message, limits) ? 1 : 0;
    figures.above_bound += isAboveBound(message) ? 1 : 0;
    figures.velocity_error = std::max(figures.velocity_error, largest(message.error.velocity));
    figures.rate_error = std::max(figures.rate_error, largest(message.error.angular_rate));
  }
  return figures;
}

std::string shareOfJudged(const ValidityFigures& figures, std::size_t count) {
  return fmt::format("{} of {}", count, figures.judged);
}

nlohmann::ordered_json validityJson(const ValidityFigures& figures) {
  return {{"messages", figures.messages},
          {"valid_messages", figures.valid},
          {"judged_messages", figures.judged},
          {"above_limit", figures.above_limit},
          {"above_bound", figures.above_bound},
          {"available_percent", 100.0 * figures.availability()},
          {"longest_gap_s", figures.longest_gap},
          {"largest_velocity_error_m_s", figures.velocity_error},
          {"largest_rate_error_deg_s", kDegreesPerRadian * figures.rate_error}};
}

std::string judgedMessagesCsv(const std::vector<JudgedMessage>& messages) {
  std::string csv = "utime_us,valid";
  for (const char* kind : {"error", "bound"}) {
    for (const char* quantity : {"velocity", "angular_rate", "motion", "rotation"})
      csv += fmt::format(",{0}_{1}_x,{0}_{1}_y,{0}_{1}_z", quantity, kind);
  }
  csv += "\n";
  for (const JudgedMessage& message : messages) {
    csv += fmt::format("{},{}", message.time_ns / 1000, message.valid ? 1 : 0);
    for (const pipeline::ProtectionLevel* level : {&message.error, &message.bound}) {
      for (const Eigen::Vector3d* values :
           {&level->velocity, &level->angular_rate, &level->motion, &level->rotation}) {
        for (const double value : *values)
          csv += std::isnan(value) ? std::string(",") : fmt::format(",{:.6g}", value);
      }
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace cartvo
