#pragma once

#include <string>

namespace cartvo {

/// What a camera asks for before it serves its stream. Kept apart from the URL so that the URL may be logged.
struct Credentials {
  std::string user;  ///< empty: the camera asks for none
  std::string password;
};

}  // namespace cartvo
