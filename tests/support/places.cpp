// The only source that knows where the checkout is, so that ccache serves all others to each checkout.
#include "support/places.hpp"

namespace cartvo::test {

std::filesystem::path sourceFolder() {
  return CARTVO_SOURCE_DIR;
}

std::filesystem::path cartvoProgram() {
  return CARTVO_PROGRAM;
}

}  // namespace cartvo::test
