// `cartvo replay`: processes recorded images with the pipeline of cartvod and writes text files.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "calib/model/rig_validation.hpp"
#include "capture/rtsp/password_file.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/http/listen_address.hpp"
#include "common/printable_text.hpp"
#include "common/units.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/configuration_names.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/replay/live_publisher.hpp"
#include "tools/replay/motion_csv.hpp"
#include "tools/replay/odometry_csv.hpp"
#include "tools/replay/output_files.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_page.hpp"
#include "tools/replay/summary.hpp"
#include "tools/replay/truth_evaluation.hpp"
#include "tools/replay/video/video_recorder.hpp"
#include "tools/report/counted.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {
namespace {

struct Options {
  ReplaySettings replay;
  std::string estimator = daemon::nameOf(vo::OdometrySettings{}.estimator, daemon::kEstimators);
  std::string rig_refinement = daemon::nameOf(vo::OdometrySettings{}.rig_refinement, daemon::kRigRefinements);
  std::string clock = daemon::nameOf(ReplayClock::configured, kReplayClocks);
  std::optional<double> offset_ms;
  std::string readout_ms;
  double offset_uncertainty_ms = 0.0;
  std::filesystem::path output;
  std::filesystem::path truth;
  std::filesystem::path video;
  int threads = 2;
  bool publish = false, loop = false, json = false;
  std::string url = daemon::defaultLcmUrl();
  double speed = 1.0;
  std::optional<ListenAddress> page;
  std::filesystem::path page_token;
};

/// Readouts of --readout-ms. Throws CommandLineError.
ReplayReadouts replayReadouts(const std::string& text) {
  const std::optional<ReplayReadouts> readouts = readReadouts(text, 1e3 * calib::kMaxReadout);
  if (!readouts)
    throw CommandLineError(
        "--readout-ms",
        "expected BOTH or LEFT,RIGHT, each -200 to 200 ms or 'unknown', found '" + text + "'");
  return *readouts;
}

/// `check`: called between pictures.
Replay replayBySource(const Options& options, const std::function<void()>& check,
                      const ReplayObserver& observer) {
  const bool are_videos =
      !options.replay.right_video.empty() || std::filesystem::is_regular_file(options.replay.source);
  if (!are_videos) return replaySource(options.replay, observer);
  ProgressBar progress("pictures searched for the offset");
  return replayVideos(
      options.replay,
      [&](std::size_t pictures, std::size_t expected) {
        check();
        progress.show(pictures, expected);
      },
      observer);
}

/// The page of the replay, if one is asked for. Throws std::runtime_error if it cannot be served.
std::unique_ptr<ReplayPage> startPage(const Options& options) {
  if (!options.page) return nullptr;
  ReplayPageSettings settings;
  settings.server.address = *options.page;
  if (!options.page_token.empty())
    settings.server.token = capture::readSecretFile(options.page_token, "the page's token");
  settings.server.controllers = daemon::PageControllers::readers;
  settings.title = options.replay.source.filename().string();
  settings.speed = options.publish ? 0.0 : options.speed;
  auto page = std::make_unique<ReplayPage>(settings);
  std::printf("page: %s\n", page->url().c_str());
  std::fflush(stdout);
  return page;
}

Replay replayWithProgress(Options& options, LivePublisher* publisher, ReplayPage* page) {
  // With a page nothing is half written, and a signal must end a pause.
  std::optional<Interruption> interruption;
  if (page == nullptr) interruption.emplace();
  const auto check = [&] {
    if (interruption) interruption->check();
  };
  ProgressBar progress("pairs");
  std::optional<VideoRecorder> video;
  if (!options.video.empty()) options.replay.viewer = &video.emplace(options.video);
  if (page != nullptr) options.replay.viewer = page;
  Replay replay =
      replayBySource(options, check, [&](const pipeline::PairResult& result, std::size_t expected) {
        check();
        if (publisher != nullptr) publisher->publish(result);
        if (page != nullptr) page->addPair(result, expected);
        if (video) video->add(result);
        progress.show(result.sequence + 1, expected);
      });
  options.replay.viewer = nullptr;
  if (video) video->finish();
  return replay;
}

/// Publishes the replay again and again, until a signal ends the program.
[[noreturn]] void repeatForEver(LivePublisher& publisher) {
  std::fputs("publishing again and again; Ctrl-C ends it\n", stderr);
  for (;;)
    publisher.repeat();
}

/// Serves the page until a signal ends the program.
[[noreturn]] void showForEver() {
  std::fputs("the page is served until Ctrl-C ends it\n", stdout);
  std::fflush(stdout);
  for (;;)
    std::this_thread::sleep_for(std::chrono::hours(1));
}

void printSummary(const Options& options, const Replay& replay, const nlohmann::ordered_json& summary) {
  std::printf("%s, %zu valid, %.1f m, median %.1f ms and p99 %.1f ms a pair; written to %s\n",
              counted(replay.pairs.size(), "pair").c_str(), summary["valid"].get<std::size_t>(),
              summary["path_length_m"].get<double>(), summary["time_ms"]["total"]["median"].get<double>(),
              summary["time_ms"]["total"]["p99"].get<double>(), options.output.c_str());
  std::printf("%s", invalidPairsText(replay).c_str());
  if (replay.timing) {
    std::printf("offset added to the right video's times: %+.2f ms (+- %.2f ms, by %s)%s\n",
                1e3 * replay.timing->offset, 1e3 * replay.timing->stddev, replay.timing->found_by.c_str(),
                replay.timing->agreement && !replay.timing->skew
                    ? "; the videos are too short to measure how the two clocks drift apart"
                    : "");
  }
}

void run(Options& options) {
  const OutputFolder output(options.output);
  if (!options.truth.empty()) checkTruth(options.truth);  // before the replay
  cv::setNumThreads(options.threads);
  std::optional<LivePublisher> publisher;
  if (options.publish) publisher.emplace(options.url, options.speed);
  const std::unique_ptr<ReplayPage> page = startPage(options);
  const Replay replay = replayWithProgress(options, publisher ? &*publisher : nullptr, page.get());
  if (page) page->finish();

  nlohmann::ordered_json summary = replaySummary(options.replay, replay);
  summary["threads"] = options.threads;
  writeKitti(output / "poses.txt", leftCameraTrajectory(replay));
  writeTum(output / "trajectory.tum", bodyTrajectory(replay), bodyTrajectoryFrame(replay));
  writeResultFile(output / "odometry.csv", odometryCsv(replay));
  writeResultFile(output / "timing.csv", timingCsv(replay));
  TruthEvaluation compared;
  if (!options.truth.empty()) {
    compared = evaluateWithTruth(replay, options.truth);
    summary["truth"] = options.truth.string();
    summary["evaluation"] = std::move(compared.evaluation);
    summary["consistency"] = std::move(compared.consistency);
  }
  writeResultFile(output / "Motionestimation.csv", motionCsv(replay, compared.errors));
  writeResultFile(output / "summary.json", jsonText(summary));

  constexpr std::size_t kMaxWarningBytes = 4000;
  for (const std::string& problem : replay.problems)
    std::fprintf(stderr, "cartvo: warning: %s\n", printableExcerpt(problem, kMaxWarningBytes).c_str());
  if (!replay.self_check.empty())
    std::fprintf(stderr, "cartvo: warning: self-check: %s\n", replay.self_check.c_str());
  if (options.json) {
    printJson(summary);
  } else {
    printSummary(options, replay, summary);
    std::fputs(compared.table.c_str(), stdout);
  }
  if (const std::string reason = nothingValidText(replay); !reason.empty())
    throw std::runtime_error(options.replay.source.string() + ": " + reason);
  if (options.loop) repeatForEver(*publisher);
  if (page) showForEver();
}

void addSourceOptions(Command command, Options& options) {
  command
      .addOption("SOURCE", options.replay.source,
                 "A recording (cartvod --record), a folder of images (KITTI, EuRoC, TUM-VI, New College, "
                 "Malaga, lists, ...), the left camera's video, or a video with both cameras' pictures side "
                 "by side")
      .required();
  const Option right =
      command.addOption("RIGHT", options.replay.right_video, "The right camera's video, if SOURCE is one");
  command
      .addOption(
          "--offset-ms", options.offset_ms,
          "Offset added to the right video's times; without it the offset is estimated from the images")
      .needs(right)
      .typeName("MS");
  command
      .addOption("--frame-rate", options.replay.frame_rate,
                 "Frame rate of the cameras: replaces the time stamps of videos and the times.txt of a "
                 "folder; needed for raw streams (.h264) and for images without instants")
      .range(0.5, 1000.0)
      .typeName("HZ");
  command
      .addFlag("--side-by-side", options.replay.side_by_side,
               "Each image of the folder SOURCE, or the video SOURCE, contains both cameras' pictures, the "
               "left camera's on the left; videos are recognised without it")
      .excludes(right);
  command.addOption("--output-dir", options.output, "Folder for the results; created if it is missing")
      .required()
      .typeName("DIR");
  command.addFlag("--json", options.json, "Print the summary as JSON, as in summary.json");
}

void addEstimationOptions(Command command, Options& options) {
  command
      .addOption("--rig", options.replay.rig,
                 "Rig file: cartvo's own, OpenCV's, Kalibr's, MATLAB's or KITTI's")
      .typeName("FILE");
  command.addOption("--estimator", options.estimator, "Motion estimator")
      .choices(daemon::namesOf(daemon::kEstimators))
      .typeName("NAME")
      .captureDefault();
  command
      .addOption("--features", options.replay.odometry.features,
                 "Target number of features in each left image")
      .range(50, 20000)
      .captureDefault();
  command
      .addOption("--online-rig-refinement", options.rig_refinement,
                 "Estimation and correction of the right camera's rotation relative to the rig file")
      .choices(daemon::namesOf(daemon::kRigRefinements))
      .typeName("NAME")
      .captureDefault();
  command
      .addOption("--offset-uncertainty-ms", options.offset_uncertainty_ms,
                 "Standard deviation of the time offset in an image folder, ms; not used for recordings")
      .range(0.0, 1000.0)
      .typeName("MS")
      .captureDefault();
  command
      .addOption("--clock", options.clock,
                 "Timestamps of a recording: recomputed with the clock of its configuration, with another "
                 "clock, or as recorded live")
      .choices(daemon::namesOf(kReplayClocks))
      .typeName("NAME")
      .captureDefault();
  command
      .addOption("--readout-ms", options.readout_ms,
                 "Readout of both cameras or of each, as in the rig file but in ms; 0: global shutter; "
                 "unknown: estimated from the usual 32 ms. Replaces the rig's")
      .typeName("BOTH|LEFT,RIGHT");
  command
      .addOption("--threads", options.threads,
                 "Threads for image operations; the results do not depend on it")
      .range(1, 64)
      .captureDefault();
  command
      .addOption(
          "--video", options.video,
          "Write a video (.mp4): tracked points by depth, path, speed, rates and validity over the left "
          "picture")
      .check([](const std::string& file) -> std::string {
        return std::filesystem::path(file).extension() == ".mp4" ? "" : "'" + file + "' is not named .mp4";
      })
      .typeName("FILE");
  command
      .addOption("--truth", options.truth,
                 "True poses: KITTI rows of the left camera, rows of TUM or EuRoC of the body, or a raw "
                 "recording of KITTI with its oxts; adds error columns")
      .typeName("FILE|DIR");
}

void addAlertLimitsOption(Command command, std::optional<pipeline::AlertLimits>& limits) {
  command
      .addListOption(
          "--alert-limits",
          [&limits](const std::vector<double>& values) {
            limits = {values[0], kRadiansPerDegree * values[1], values[2], kRadiansPerDegree * values[3]};
          },
          "Largest bounds of valid pairs: of velocity (m/s), angular rate (deg/s), translation (m) and "
          "rotation (deg) over the last second; without it those of the recording's configuration, else "
          "cartvod's")
      .delimiter(',')
      .expected(4)
      .range(1e-3, 1e6)
      .typeName("V,RATE,MOTION,ROTATION");
}

/// Returns the option and the address that is given with it; without one the page is at kPagePort.
std::pair<Option, std::shared_ptr<std::string>> addPageOptions(Command command, Options& options) {
  const auto address = std::make_shared<std::string>();
  const Option page = command
                          .addOption("--page", *address,
                                     "Serve a web page that shows the replay at the recorded pace, with "
                                     "pause and step, until Ctrl-C\n"
                                     "(default: 127.0.0.1:9465, for browsers on this computer only; 0: any "
                                     "free port)")
                          .typeName("[ADDRESS:]PORT")
                          .expected(0, 1)
                          .excludes("--video");
  command
      .addOption("--page-token", options.page_token,
                 "With --page at an address that other computers reach: file with the token that they need")
      .needs(page)
      .typeName("FILE");
  return {page, address};
}

/// Throws CommandLineError.
ListenAddress pageAddress(const std::string& text) {
  constexpr std::uint16_t kPagePort = 9465;
  if (text.empty()) return {.port = kPagePort};
  try {
    return ListenAddress::parse(text);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError("--page", error.what());
  }
}

void addPublishOptions(Command command, Options& options) {
  const Option publish = command.addFlag(
      "--publish", options.publish,
      "Publish each pair over LCM too, as cartvod does: at the recorded pace, with instants of now");
  command.addOption("--speed", options.speed, "With --publish or --page: factor on the recorded pace")
      .range(0.01, 100.0)
      .captureDefault();
  command
      .addFlag("--loop", options.loop,
               "With --publish: publish the replay again and again, until Ctrl-C; results are written before")
      .needs(publish);
  command.addOption("--url", options.url, "With --publish: LCM URL")
      .needs(publish)
      .typeName("URL")
      .captureDefault();
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "replay");
  const auto options = std::make_shared<Options>();
  addSourceOptions(command, *options);
  addEstimationOptions(command, *options);
  addAlertLimitsOption(command, options->replay.alert_limits);
  addPublishOptions(command, *options);
  const auto page = addPageOptions(command, *options);
  command.footer(
      "Without --rig the rig is that of the recording, or rig.yaml, EuRoC's sensor.yaml, KITTI's calib.txt "
      "or "
      "TUM-VI's\n"
      "camchain.yaml in the folder. Writes poses.txt (KITTI, left camera), trajectory.tum (body), "
      "Motionestimation.csv, "
      "odometry.csv, timing.csv and\n"
      "summary.json, described in cartvo-replay(1). The same source gives a byte for byte equal poses.txt.\n"
      "Examples:\n"
      "  cartvo replay kitti_06 --output-dir out --truth kitti_06/poses.txt\n"
      "  cartvo replay raw_images --rig rig.yaml --features 2000 --output-dir out\n"
      "  cartvo replay NewCollege --rig bumblebee.yaml --output-dir out\n"
      "  cartvo replay zed_pictures --side-by-side --frame-rate 30 --rig zed.yaml --output-dir out\n"
      "  cartvo replay raw_images --output-dir out --video out/replay.mp4\n"
      "  cartvo replay left.mp4 right.mkv --rig rig.yaml --output-dir out");
  command.callback([options, page, command] {
    if (command.option("--speed").value().count() > 0 && !options->publish && page.first.count() == 0)
      throw CommandLineError("--speed", "needs --publish or --page");
    if (page.first.count() > 0) options->page = pageAddress(*page.second);
    options->replay.odometry.estimator = daemon::valueNamed(options->estimator, daemon::kEstimators);
    options->replay.odometry.rig_refinement =
        daemon::valueNamed(options->rig_refinement, daemon::kRigRefinements);
    if (options->offset_ms) options->replay.video_offset = 1e-3 * *options->offset_ms;
    if (!options->readout_ms.empty()) options->replay.readouts = replayReadouts(options->readout_ms);
    options->replay.clock = daemon::valueNamed(options->clock, kReplayClocks);
    options->replay.folder_offset_stddev = 1e-3 * options->offset_uncertainty_ms;
    run(*options);
  });
}

}  // namespace cartvo
