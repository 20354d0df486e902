// Writes a large file piece by piece; it appears when it is complete.
#include "common/atomic_file_writer.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

fs::path targetOf(const fs::path& file) {
  checkFileCanBeWritten(file);
  std::error_code error;
  if (!fs::exists(file, error)) return file;
  fs::path target = fs::canonical(file);
  if (!fs::is_regular_file(target))
    throw std::runtime_error(file.string() + ": is not a regular file; name a new file");
  return target;
}

}  // namespace

AtomicFileWriter::AtomicFileWriter(fs::path file) : file_(std::move(file)), target_(targetOf(file_)) {
  constexpr mode_t kOfUmask = 0666;
  created_ = createFolders(folderOf(target_));
  contents_.emplace(target_, kOfUmask);
  if (!contents_->isOpen()) fail("no file can be made in the folder " + folderOf(target_).string(), errno);
}

AtomicFileWriter::~AtomicFileWriter() {
  contents_.reset();
  if (committed_) return;
  std::error_code not_empty;
  for (; !created_.empty(); created_.pop_back())
    fs::remove(created_.back(), not_empty);
}

void AtomicFileWriter::fail(const std::string& what, int error) const {
  throw std::runtime_error(file_.string() + ": " + what + ": " + std::generic_category().message(error));
}

void AtomicFileWriter::write(std::string_view contents) {
  if (const int error = writeAll(contents_->descriptor(), contents); error != 0)
    fail("cannot be written", error);
}

void AtomicFileWriter::commit() {
  struct stat old {};
  if (::stat(target_.c_str(), &old) == 0 && !contents_->takeOwner(old))
    fail("cannot be replaced by a file of the same owner and mode", errno);
  if (::fsync(contents_->descriptor()) != 0) fail("cannot be synced to the disk", errno);
  if (const int error = contents_->moveToTarget(); error != 0) fail("cannot be renamed into place", error);
  committed_ = true;
}

}  // namespace cartvo
