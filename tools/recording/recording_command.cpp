// `cartvo recording`: shows, verifies and trims recordings.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "common/command_line/parser.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/time_option.hpp"
#include "tools/recording/information.hpp"
#include "tools/recording/trimming.hpp"
#include "tools/recording/verification.hpp"

namespace cartvo {
namespace {

struct Options {
  std::filesystem::path folder;
  std::filesystem::path output;
  TrimmedPart part;
  bool json = false;
};

void inform(const Options& options) {
  const capture::RecordingSummary summary = capture::summariseRecording(options.folder);
  const std::string text = options.json ? jsonText(informationJson(summary)) : informationText(summary);
  std::fputs(text.c_str(), stdout);
}

void verify(const Options& options) {
  Verification verification;
  {
    const capture::RecordingSummary summary = capture::summariseRecording(options.folder);
    ProgressBar progress("pictures");
    verification = verifyRecording(options.folder, [&](std::size_t pictures) {
      progress.show(pictures, summary.cameras[0].pictures + summary.cameras[1].pictures);
    });
  }
  const std::string text =
      options.json ? jsonText(verificationJson(verification)) : verificationText(verification);
  std::fputs(text.c_str(), stdout);
  if (!verification.isWhole()) throw ExitCode(EXIT_FAILURE);
}

TrimmedRecording trimWithProgress(const Options& options) {
  const Interruption interruption;
  ProgressBar progress("pictures");
  return trimRecording(options.folder, options.part, options.output,
                       [&](std::size_t pictures, std::size_t expected) {
                         interruption.check();
                         progress.show(pictures, expected);
                       });
}

void trim(const Options& options) {
  if (options.part.to <= options.part.from) throw CommandLineError("--to", "must be after --from");
  const TrimmedRecording trimmed = trimWithProgress(options);
  if (options.json) {
    const nlohmann::ordered_json json{{"output", options.output.string()},
                                      {"from_s", trimmed.from},
                                      {"to_s", trimmed.to},
                                      {"left", {{"pictures", trimmed.pictures[0]}}},
                                      {"right", {{"pictures", trimmed.pictures[1]}}}};
    printJson(json);
    return;
  }
  std::printf("%llu left and %llu right pictures, %.1f to %.1f s, written to %s\n",
              static_cast<unsigned long long>(trimmed.pictures[0]),
              static_cast<unsigned long long>(trimmed.pictures[1]), trimmed.from, trimmed.to,
              options.output.c_str());
}

Command addAction(Command command, const std::string& name, const std::string& description,
                  const std::shared_ptr<Options>& options, void (*work)(const Options&)) {
  const Command action = command.addSubcommand(name, description);
  action.addOption("DIR", options->folder, "The recording: a folder with recording.json").required();
  action.callback([options, work] { work(*options); });
  return action;
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "recording");
  command.limitSubcommands(1, 1);
  const auto options = std::make_shared<Options>();
  const Command info =
      addAction(command, "info", "Show the contents of a recording from its index (fast)", options, inform);
  info.addFlag("--json", options->json, "Print JSON");

  const Command check =
      addAction(command, "verify", "Read and decode all pictures and report damage", options, verify);
  check.addFlag("--json", options->json, "Print JSON");
  check.footer(
      "The exit code is 0 if all files are as they were recorded, else 1. Pictures with lost packets count "
      "as\n"
      "damaged, but do not change the exit code, because they were recorded so.");

  const Command part =
      addAction(command, "trim", "Copy a part of a recording to a new recording", options, trim);
  part.addOption("--from", options->part.from,
                 "Start of the part since the first picture: seconds, or M:SS, or H:MM:SS")
      .transform(timeInSeconds())
      .typeName("TIME");
  part.addOption("--to", options->part.to, "End of the part since the first picture, as --from")
      .transform(timeInSeconds())
      .typeName("TIME");
  part.addOption("--output-dir", options->output, "Folder for the new recording; created if missing")
      .required()
      .typeName("DIR");
  part.addFlag("--json", options->json, "Print what was copied as JSON");
  part.footer(
      "Each camera starts with its last key picture at or before --from, so the part may begin earlier; the "
      "result\n"
      "says when. Pictures are not encoded again.");

  command.footer(
      "Examples:\n"
      "  cartvo recording info drive\n"
      "  cartvo recording verify drive --json\n"
      "  cartvo recording trim drive --from 1:01.5 --to 1:20 --output-dir fault\n"
      "See cartvo-recording(1) for the files in a recording.");
}

}  // namespace cartvo
