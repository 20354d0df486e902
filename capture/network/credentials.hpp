#pragma once

#include <string>

namespace cartvo::capture {

/// User and password of a camera. Separate from the URL, so that the URL may be logged.
struct Credentials {
  std::string user;  ///< empty: the camera requires none
  std::string password;
};

}  // namespace cartvo::capture
