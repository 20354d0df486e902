// Shows the steps of long work on the error output.
#include "tools/cartvo/work_display.hpp"

#include <cstddef>

namespace cartvo {

WorkObserver WorkDisplay::observer() {
  return {[this](const WorkStep& step) {
            end();
            bar_.emplace(step);
          },
          [this](int done, int total) {
            if (bar_) bar_->show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
          }};
}

}  // namespace cartvo
