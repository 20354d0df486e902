// Runs the renderer of drives as a child process.
#include "tools/simulate/renderer.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/command_line/command_line_error.hpp"
#include "common/input_file.hpp"
#include "tools/cartvo/interruption.hpp"

namespace cartvo::simulate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kName = "cartvo-render";

bool isProgram(const fs::path& file) {
  std::error_code no_error;
  return fs::is_regular_file(file, no_error) && access(file.c_str(), X_OK) == 0;
}

fs::path findProgram() {
  std::error_code no_error;
  const fs::path libexec = fs::read_symlink("/proc/self/exe", no_error).parent_path().parent_path();
  const fs::path prefix = libexec.parent_path();
  for (const fs::path& file : {prefix / "bin" / kName, prefix.parent_path() / "lab/render" / kName})
    if (isProgram(file)) return file;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string name; std::getline(folders, name, ':');)
    if (name.starts_with('/') && isProgram(fs::path(name) / kName)) return fs::path(name) / kName;
  throw std::runtime_error(
      "rendering a drive needs the program cartvo-render, which is not there: install the package "
      "cartvo-lab, "
      "or build the target cartvo-render (tools/build --target cartvo-render); the sample drive needs none: "
      "'cartvo simulate' without options");
}

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::system_category().message(errno));
}

/// Two ends of a pipe; -1: closed.
struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("no pipe to cartvo-render");
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  std::array<int, 2> ends{-1, -1};
};

/// Starts a program in a process group of its own, which gets signals from this process only, and once. It
/// ends with this process.
pid_t start(const fs::path& program, const std::vector<std::string>& arguments, std::optional<int> output) {
  std::vector<char*> words{const_cast<char*>(kName)};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) fail("cartvo-render cannot be started");
  if (child > 0) return child;
  constexpr int kNotStarted = 127;  // as of a shell
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent || (output && dup2(*output, STDOUT_FILENO) < 0)) _exit(kNotStarted);
  execv(program.c_str(), words.data());
  _exit(kNotStarted);
}

/// Waits for the end of `child`, appends to `text` what comes from `input` meanwhile (-1: nothing), and
/// passes on signals. Returns the exit code, or 128 + signal.
int await(pid_t child, int input, std::string& text, const Interruption& interruption) {
  constexpr int kPoll_ms = 20, kSignalBase = 128;
  std::array<char, 4096> part{};
  bool is_told = false, is_open = input >= 0;
  for (int status = 0;;) {
    pollfd waiting{.fd = is_open ? input : -1, .events = POLLIN, .revents = 0};
    poll(&waiting, 1, kPoll_ms);
    if (const int signal = interruption.received(); signal != 0 && !is_told)
      is_told = kill(child, signal) == 0;
    if (waiting.revents != 0) {
      const ssize_t count = read(input, part.data(), part.size());
      if (count > 0) text.append(part.data(), static_cast<std::size_t>(count));
      is_open = count > 0;
    } else if (waitpid(child, &status, WNOHANG) != 0) {
      return WIFEXITED(status) ? WEXITSTATUS(status) : kSignalBase + WTERMSIG(status);
    }
  }
}

}  // namespace

Renderer::Renderer() : program_(findProgram()) {}

void Renderer::run(const std::vector<std::string>& arguments) const {
  const Interruption interruption;
  std::string nothing;
  const int code = await(start(program_, arguments, std::nullopt), -1, nothing, interruption);
  if (code != 0) throw ExitCode(code);
}

std::string Renderer::outputOf(const std::vector<std::string>& arguments) const {
  const Interruption interruption;
  Pipe pipe;
  const pid_t child = start(program_, arguments, pipe.ends[1]);
  close(pipe.ends[1]);
  pipe.ends[1] = -1;
  std::string text;
  const int code = await(child, pipe.ends[0], text, interruption);
  if (code != 0) throw ExitCode(code);
  return text;
}

RenderedDrive::RenderedDrive(const std::filesystem::path& folder, double frame_rate, std::string key)
    : pictures_(folder, {}),
      frame_rate_(frame_rate),
      key_(std::move(key)),
      dense_truth_(readTrajectory(folder / "truth.tum")) {
  constexpr std::uintmax_t kMaxFileBytes = 1U << 30U;
  for (const char* name : {"rig.yaml", "times_0.txt", "times_1.txt", "poses.txt", "truth.tum"})
    written_[name] = readInputText(folder / name, kMaxFileBytes);
}

/// The truth's first two poses are a fraction of a frame period apart.
bool RenderedDrive::startsAtStandstill() const {
  return dense_truth_.size() < 2 || dense_truth_[0].pose.isApprox(dense_truth_[1].pose, 0.0);
}

}  // namespace cartvo::simulate
