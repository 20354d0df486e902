// Formats the summary of a recording as text and JSON.
#include "tools/recording/information.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>

#include "capture/recording/stream_recorder.hpp"
#include "common/image_size.hpp"
#include "common/printable_text.hpp"
#include "tools/report/table.hpp"

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 5> kInstantSources = {"file", "sender_report", "arrival", "pictures",
                                                        "kernel"};

constexpr double kMaxLoss_s = 1e-3 * static_cast<double>(capture::kMaxPowerCutLoss.count());

const char* codecName(const capture::RecordedCamera& camera) {
  const std::optional<capture::VideoCodec>& codec = camera.codec;
  if (!codec) return camera.pictures == 0 ? kNoValue : "unreadable";
  return *codec == capture::VideoCodec::h264 ? "H.264" : "H.265";
}

double frameRate(const capture::RecordedCamera& camera) {
  const double seconds = camera.seconds();
  return seconds > 0.0 ? static_cast<double>(camera.pictures + camera.missed - 1) / seconds : 0.0;
}

double megabits(const capture::RecordedCamera& camera) {
  const double seconds = camera.seconds();
  return seconds > 0.0 ? 8e-6 * static_cast<double>(camera.bytes) / seconds : 0.0;
}

/// Time from the first to the last picture of both cameras, s.
double duration(const capture::RecordingSummary& summary) {
  std::int64_t first = 0;
  std::int64_t last = 0;
  for (const capture::RecordedCamera& camera : summary.cameras) {
    if (camera.pictures == 0) continue;
    first = first == 0 ? camera.first_arrival_ns : std::min(first, camera.first_arrival_ns);
    last = std::max(last, camera.last_arrival_ns);
  }
  return 1e-9 * static_cast<double>(last - first);
}

std::string utc(std::int64_t instant_ns) {
  const std::time_t seconds = instant_ns / 1'000'000'000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return text.data();
}

Json cameraJson(const capture::RecordedCamera& camera) {
  Json sources = Json::object();
  for (std::size_t i = 0; i < kInstantSources.size(); ++i) {
    if (camera.by_instant_source[i] > 0) sources[kInstantSources[i]] = camera.by_instant_source[i];
  }
  return {{"codec", camera.pictures == 0 ? Json(nullptr) : Json(codecName(camera))},
          {"picture_size", {camera.picture_size.width, camera.picture_size.height}},
          {"pictures", camera.pictures},
          {"key_pictures", camera.key_pictures},
          {"damaged", camera.damaged},
          {"missed", camera.missed},
          {"connections", camera.connections},
          {"bytes", camera.bytes},
          {"frame_rate", frameRate(camera)},
          {"megabits_per_s", megabits(camera)},
          {"first_arrival_ns", camera.first_arrival_ns},
          {"last_arrival_ns", camera.last_arrival_ns},
          {"instant_sources", sources}};
}

std::string instantSources(const capture::RecordedCamera& camera) {
  std::string text;
  for (std::size_t i = 0; i < kInstantSources.size(); ++i) {
    if (camera.by_instant_source[i] == 0) continue;
    const double share =
        static_cast<double>(camera.by_instant_source[i]) / static_cast<double>(camera.pictures);
    text +=
        (text.empty() ? "" : ", ") + std::string(kInstantSources[i]) + " " + fixed(100.0 * share, 0) + " %";
  }
  return text.empty() ? kNoValue : text;
}

Json unfinalisedJson(const capture::RecordingSummary& summary) {
  Json parts = Json::array();
  for (const capture::UnfinalisedPart& part : summary.unfinalised) {
    parts.push_back({{"camera", capture::sideName(part.side)},
                     {"segment", part.segment},
                     {"last_arrival_ns", part.last_arrival_ns ? Json(*part.last_arrival_ns) : Json()},
                     {"most_lost_s", kMaxLoss_s}});
  }
  return parts;
}

/// One sentence for each video file without a trailer.
std::string unfinalisedText(const capture::RecordingSummary& summary) {
  std::string text;
  for (const capture::UnfinalisedPart& part : summary.unfinalised) {
    std::array<char, 32> segment{};
    std::snprintf(segment.data(), segment.size(), "%06llu/", static_cast<unsigned long long>(part.segment));
    text.append("NOT ENDED: ").append(segment.data()).append(capture::sideName(part.side));
    text += ".mkv has no trailer, as after a power cut, kill -9 or on a full disk; ";
    text +=
        part.last_arrival_ns ? "its last picture is from " + utc(*part.last_arrival_ns) : "it has no picture";
    text += "; at most " + fixed(kMaxLoss_s, 1) + " s before the interruption are lost\n";
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace

Json informationJson(const capture::RecordingSummary& summary) {
  return {{"format_version", summary.info.format_version},
          {"software_version", summary.info.software_version},
          {"started_ns", summary.info.started_ns},
          {"duration_s", duration(summary)},
          {"segments", summary.segments},
          {"bytes", summary.bytes},
          {"being_written", summary.being_written},
          {"unended", unfinalisedJson(summary)},
          {"has_rig", !summary.info.rig.empty()},
          {"has_configuration", !summary.info.configuration.empty()},
          {"left", cameraJson(summary.cameras[0])},
          {"right", cameraJson(summary.cameras[1])}};
}

std::string informationText(const capture::RecordingSummary& summary) {
  std::string text = "format " + std::to_string(summary.info.format_version) + ", by cartvo " +
                     printableExcerpt(summary.info.software_version) + ", started " +
                     utc(summary.info.started_ns) + "\n" + fixed(duration(summary), 1) + " s in " +
                     std::to_string(summary.segments) +
                     (summary.segments == 1 ? " segment, " : " segments, ") +
                     fixed(1e-6 * static_cast<double>(summary.bytes), 1) + " MB";
  if (summary.being_written) text += ", being written";
  text += std::string("; with") + (summary.info.rig.empty() ? "out" : "") + " rig, with" +
          (summary.info.configuration.empty() ? "out" : "") + " configuration\n\n";

  text += unfinalisedText(summary);
  if (summary.cameras[0].pictures + summary.cameras[1].pictures == 0)
    text += "NO PICTURE was recorded; the log of cartvod says why the cameras sent none\n\n";
  Table table({"", "left", "right"});
  const auto row = [&](const char* name, const auto& value) {
    table.add({name, value(summary.cameras[0]), value(summary.cameras[1])});
  };
  const auto count = [&](const char* name, std::uint64_t capture::RecordedCamera::*member) {
    row(name, [member](const capture::RecordedCamera& camera) { return std::to_string(camera.*member); });
  };
  row("codec", [](const capture::RecordedCamera& camera) { return std::string(codecName(camera)); });
  row("picture size", [](const capture::RecordedCamera& camera) {
    return camera.picture_size.empty() ? std::string(kNoValue) : sizeText(camera.picture_size);
  });
  row("frames/s", [](const capture::RecordedCamera& camera) { return fixed(frameRate(camera), 2); });
  row("Mbit/s", [](const capture::RecordedCamera& camera) { return fixed(megabits(camera), 2); });
  count("pictures", &capture::RecordedCamera::pictures);
  count("key pictures", &capture::RecordedCamera::key_pictures);
  count("damaged by loss", &capture::RecordedCamera::damaged);
  count("missed", &capture::RecordedCamera::missed);
  count("connections", &capture::RecordedCamera::connections);
  row("instants by", instantSources);
  return text + table.text();
}

}  // namespace cartvo
