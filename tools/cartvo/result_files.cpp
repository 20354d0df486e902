// Checks of the files that commands write.
#include "tools/cartvo/result_files.hpp"

#include "common/atomic_file.hpp"

namespace cartvo {

void checkResultFiles(std::initializer_list<std::filesystem::path> files) {
  for (const std::filesystem::path& file : files) {
    if (!file.empty()) checkFileCanBeWritten(file);
  }
}

}  // namespace cartvo
