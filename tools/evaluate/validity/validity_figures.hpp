#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/evaluate/validity/judged_messages.hpp"

namespace cartvo {

/// Quality of VALID messages: how many of them have an error above a limit that does not depend on what
/// they state, how many one above the bound that they state, and how often there is one.
struct ValidityFigures {
  std::size_t messages = 0;     ///< of all pairs, the first among them
  std::size_t valid = 0;        ///< of these
  std::size_t judged = 0;       ///< VALID messages with a true velocity or motion
  std::size_t above_limit = 0;  ///< of these, any component's error exceeds its alert limit
  std::size_t above_bound = 0;  ///< of these, any component's error exceeds the message's bound, or has none
  double longest_gap = 0.0;     ///< s, between two VALID messages, or before the first or behind the last one
  double velocity_error = 0.0;  ///< m/s, largest error of a component of a VALID velocity
  double rate_error = 0.0;      ///< rad/s, of a VALID angular rate

  /// Share of VALID messages; 0 without any message.
  double availability() const;
};

bool isAboveLimit(const JudgedMessage& message, const pipeline::AlertLimits& limits);

/// An error without a bound is above it.
bool isAboveBound(const JudgedMessage& message);

/// Figures of one drive, whose messages are in the order of time.
ValidityFigures validityFigures(const std::vector<JudgedMessage>& messages,
                                const pipeline::AlertLimits& limits);

/// "3 of 251", of the VALID messages with a truth.
std::string shareOfJudged(const ValidityFigures& figures, std::size_t count);

/// Keys that each name their unit.
nlohmann::ordered_json validityJson(const ValidityFigures& figures);

/// A row of numbers for each message: instant, validity, errors and bounds.
std::string judgedMessagesCsv(const std::vector<JudgedMessage>& messages);

}  // namespace cartvo
