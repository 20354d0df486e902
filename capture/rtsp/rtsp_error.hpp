#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace cartvo::capture {

/// Error while opening a connection. The text names the camera, who answered what, and what to do; it never
/// contains the password.
class RtspError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t { unreachable, refused, interrupted };
  RtspError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace cartvo::capture
