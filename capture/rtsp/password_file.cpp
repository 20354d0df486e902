// Reading of password files. Passwords are never part of a configuration or a command line.

#include "capture/rtsp/password_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "common/input_file.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

/// From now on this process writes no core dump, and only root can read its memory, also by a debugger.
void disableCoreDumps() {
  // The resource limit alone does not stop dumps into a pipe (core(5)). Neither call fails for these values.
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  prctl(PR_SET_DUMPABLE, 0L, 0L, 0L, 0L);
}

constexpr off_t kMaxFileSize = 1024;  // bytes

/// White space that editors and web pages leave at a line's ends: blank, tab, no-break space, zero-width
/// space, byte order mark, ideographic space, in UTF-8.
constexpr std::array<std::string_view, 6> kInvisible{" ", "\t", "\u00A0", "\u200B", "\uFEFF", "\u3000"};

/// Why a text is not clearly one password; empty if it is. A camera locks the account after some logins with
/// a wrong password, so that an ambiguous file is not tried.
std::string ambiguityOf(std::string_view line, std::string_view further_lines) {
  const bool is_bounded_by_blank =
      std::any_of(kInvisible.begin(), kInvisible.end(),
                  [&](std::string_view blank) { return line.starts_with(blank) || line.ends_with(blank); });
  if (is_bounded_by_blank) {
    return "the line begins or ends with a blank or another invisible character; remove it, or choose "
           "another password if it belongs to it";
  }
  if (!isPrintable(line))
    return "it is not UTF-8, or holds control characters; save it as plain text in UTF-8";
  if (further_lines.find_first_not_of(" \t\r\n") != std::string_view::npos)
    return "it holds several lines; leave the one with the password";
  return {};
}

}  // namespace

std::string readPasswordFile(const std::filesystem::path& file) {
  return readSecretFile(file, "the camera's password");
}

std::string readSecretFile(const std::filesystem::path& file, const std::string& secret) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) {
    throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno) + "; write " +
                             secret + " into it");
  }
  if (!S_ISREG(status.st_mode) || status.st_size > kMaxFileSize) {
    throw std::runtime_error(file.string() + ": expected a file of one line with " + secret);
  }
  if ((status.st_mode & S_IRWXO) != 0) {
    throw std::runtime_error(file.string() +
                             ": other users have access to this password; run: chmod o= " + file.string());
  }
  disableCoreDumps();
  std::string text;
  try {
    text = withoutByteOrderMark(readInputFile(file, kMaxFileSize));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; give it to the user that runs this program");
  }
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string password = text.substr(0, end);
  while (password.ends_with('\r'))
    password.pop_back();
  if (password.empty()) {
    throw std::runtime_error(file.string() + ": expected one line with " + secret + ", found none");
  }
  const std::string problem = ambiguityOf(password, std::string_view(text).substr(end));
  if (!problem.empty()) {
    throw std::runtime_error(file.string() + ": expected one line with " + secret +
                             " and nothing else: " + problem);
  }
  return password;
}

}  // namespace cartvo::capture
