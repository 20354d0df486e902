#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/service/configuration.hpp"

// Names of values in the configuration file, on command lines and in results.

namespace cartvo::daemon {

constexpr double kGigabyte = 1e9;
constexpr double kDay = 86400.0;

using LogLevel = spdlog::level::level_enum;
constexpr std::array<std::pair<const char*, LogLevel>, 4> kLogLevels{{{"debug", LogLevel::debug},
                                                                      {"info", LogLevel::info},
                                                                      {"warning", LogLevel::warn},
                                                                      {"error", LogLevel::err}}};
constexpr std::array<std::pair<const char*, capture::RtspTransport>, 2> kTransports{
    {{"tcp", capture::RtspTransport::tcp}, {"udp", capture::RtspTransport::udp}}};
constexpr std::array<std::pair<const char*, bool>, 2> kAuthentications{{{"digest", false}, {"basic", true}}};
constexpr std::array<std::pair<const char*, capture::PixelFormat>, 4> kFormats{
    {{"grey", capture::PixelFormat::grey},
     {"nv12", capture::PixelFormat::nv12},
     {"yuyv", capture::PixelFormat::yuyv},
     {"mjpeg", capture::PixelFormat::mjpeg}}};
constexpr std::array<std::pair<const char*, capture::ClockChoice>, 4> kClocks{
    {{"auto", capture::ClockChoice::automatic},
     {"ntp", capture::ClockChoice::ntp},
     {"arrival", capture::ClockChoice::arrival},
     {"visual", capture::ClockChoice::visual}}};
constexpr std::array<std::pair<const char*, PoseVelocity>, 2> kPoseVelocities{
    {{"local", PoseVelocity::local}, {"body", PoseVelocity::body}}};
constexpr std::array<std::pair<const char*, RecordingStart>, 2> kRecordingStarts{
    {{"automatic", RecordingStart::automatic}, {"by_hand", RecordingStart::by_hand}}};
constexpr std::array<std::pair<const char*, vo::RigRefinement>, 2> kRigRefinements{
    {{"off", vo::RigRefinement::off}, {"correct", vo::RigRefinement::correct}}};
constexpr std::array<std::pair<const char*, vo::Estimator>, 2> kEstimators{
    {{"reprojection", vo::Estimator::reprojection}, {"thesis", vo::Estimator::thesis}}};

template <typename Value, std::size_t count>
const char* nameOf(Value value, const std::array<std::pair<const char*, Value>, count>& choices) {
  for (const auto& [name, named] : choices) {
    if (named == value) return name;
  }
  return "";
}

/// `name` must be one of the choices.
template <typename Choices>
auto valueNamed(std::string_view name, const Choices& choices) {
  return std::find_if(choices.begin(), choices.end(),
                      [&](const auto& choice) { return choice.first == name; })
      ->second;
}

template <typename Choices>
std::vector<std::string> namesOf(const Choices& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices)
    names.emplace_back(name);
  return names;
}

}  // namespace cartvo::daemon
