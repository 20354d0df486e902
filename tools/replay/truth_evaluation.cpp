// Evaluates a replay by the program of `cartvo evaluate`.
#include "tools/replay/truth_evaluation.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <system_error>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace cartvo {
namespace {

using Json = nlohmann::json;

/// An open file without a name.
using File = std::unique_ptr<std::FILE, decltype([](std::FILE* file) { std::fclose(file); })>;

File temporaryFile() {
  File file(std::tmpfile());
  if (!file) throw std::runtime_error("no temporary file: " + std::generic_category().message(errno));
  return file;
}

/// A matrix by rows; a value that is not finite becomes null.
template <typename Matrix>
Json numbers(const Matrix& matrix) {
  Json values = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
      values.push_back(matrix(i, j));
  }
  return values;
}

/// Runs cartvo-evaluate, which is beside this program, with `option` and the truth, and its standard input
/// from `input`; returns its standard output. Throws std::runtime_error with `failure` if it fails.
std::string outputOf(std::string option, const std::filesystem::path& truth, const std::string& input,
                     const char* failure) {
  const File in = temporaryFile(), out = temporaryFile();
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0)
    throw std::runtime_error("the temporary file cannot be written");
  std::rewind(in.get());
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  std::string name = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "cartvo-evaluate",
              file = truth.string();
  const std::array<char*, 4> words{name.data(), option.data(), file.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawn(&child, name.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::runtime_error(name + ": cannot be started: " + std::generic_category().message(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) throw std::runtime_error(failure);
  std::string output;
  std::array<char, 4096> part{};
  std::rewind(out.get());
  for (std::size_t count = 0; (count = std::fread(part.data(), 1, part.size(), out.get())) > 0;)
    output.append(part.data(), count);
  return output;
}

/// The input of `cartvo-evaluate --of-replay`, which tools/evaluate/evaluation/of_replay.py describes.
Json inputOf(const Replay& replay) {
  Json input{{"T_body_camera", numbers(replay.rig.rig.T_body_camera.matrix())}};
  for (const ReplayedPair& pair : replay.pairs) {
    vo::Vector6d twist;
    twist << pair.velocity, pair.angular_velocity;
    input["exposure_ns"].push_back(pair.exposure_ns);
    input["valid"].push_back(pair.valid);
    input["reset_counter"].push_back(pair.reset_counter);
    input["time_step"].push_back(pair.time_step);
    input["T_first_left"].push_back(numbers(pair.T_first_left.matrix()));
    input["T_epoch_left"].push_back(numbers(pair.T_epoch_left.matrix()));
    input["T_previous_current"].push_back(numbers(pair.T_previous_current.matrix()));
    input["twist"].push_back(numbers(twist));
    input["motion_covariance"].push_back(numbers(pair.motion_covariance));
    input["pose_covariance"].push_back(numbers(pair.pose_covariance));
    input["twist_covariance"].push_back(numbers(pair.twist_covariance));
  }
  return input;
}

}  // namespace

void checkTruth(const std::filesystem::path& truth) {
  outputOf("--check-truth", truth, "", "--truth cannot be used; nothing was replayed");
}

TruthEvaluation evaluateWithTruth(const Replay& replay, const std::filesystem::path& truth) {
  const std::string text =
      outputOf("--of-replay", truth, inputOf(replay).dump(),
               "the replay could not be compared with its truth; replay without --truth");
  auto output = nlohmann::ordered_json::parse(text);
  return {std::move(output["evaluation"]), std::move(output["consistency"]),
          output["errors"].get<std::vector<std::string>>(), output["table"].get<std::string>()};
}

}  // namespace cartvo
