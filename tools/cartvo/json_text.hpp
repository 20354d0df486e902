#pragma once

#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

namespace cartvo {

/// JSON as all commands print and write it: indented, with an end of line. Bytes of names that are not UTF-8
/// become U+FFFD.
inline std::string jsonText(const nlohmann::ordered_json& json) {
  constexpr int kIndent = 2;
  return json.dump(kIndent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

inline void printJson(const nlohmann::ordered_json& json) {
  std::fputs(jsonText(json).c_str(), stdout);
}

}  // namespace cartvo
