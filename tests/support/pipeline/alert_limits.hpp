#pragma once

#include "pipeline/protection_level.hpp"

namespace cartvo::test {

/// Limits that no bound exceeds: a few pairs of a small world are known less well than a cart asks.
constexpr pipeline::AlertLimits kNoAlertLimits{1e6, 1e6, 1e6, 1e6};

}  // namespace cartvo::test
