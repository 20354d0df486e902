// The paths of the checkout and of the built program. Only this source depends on them, so that ccache shares
// all others between checkouts.
#include "support/places.hpp"

namespace cartvo::test {

std::filesystem::path sourceFolder() {
  return CARTVO_SOURCE_DIR;
}

std::filesystem::path cartvoProgram() {
  return CARTVO_PROGRAM;
}

}  // namespace cartvo::test
