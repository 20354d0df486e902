// Verifies a recording by decoding all pictures and comparing checksums.
#include "tools/recording/verification.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_index.hpp"
#include "capture/recording/recording_source.hpp"

namespace cartvo {
namespace {

constexpr std::array<capture::CameraSide, 2> kSides = {capture::CameraSide::left, capture::CameraSide::right};

bool isUndamaged(const VerifiedCamera& camera) {
  return camera.unreadable.empty() && camera.files.places.empty();
}

VerifiedCamera verify(const std::filesystem::path& folder, capture::CameraSide side,
                      std::size_t& pictures_read, const VerificationProgress& progress) {
  VerifiedCamera camera;
  try {
    capture::RecordingSource source(folder, side);
    capture::Frame frame;
    while (source.read(frame, std::chrono::milliseconds(0)) == capture::ReadOutcome::frame)
      progress(++pictures_read);
    camera.pictures = source.health().frames;
    camera.damaged = source.health().damaged;
    camera.files = source.damage();
  } catch (const std::runtime_error& error) {
    camera.unreadable = error.what();
  }
  return camera;
}

}  // namespace

bool Verification::isWhole() const {
  return std::all_of(cameras.begin(), cameras.end(), isUndamaged);
}

namespace {

/// Whether the index has no picture of either camera, so that nothing can be damaged.
bool hasNoPicture(const std::filesystem::path& folder) {
  try {
    return std::all_of(kSides.begin(), kSides.end(), [&](capture::CameraSide side) {
      capture::RecordingIndexReader rows(folder, side);
      return rows.next() == nullptr;
    });
  } catch (const std::runtime_error&) {
    return false;  // the verification reports the damage
  }
}

}  // namespace

Verification verifyRecording(const std::filesystem::path& folder, const VerificationProgress& progress) {
  capture::readRecordingInfo(folder);
  Verification verification;
  verification.is_empty = hasNoPicture(folder);
  std::size_t pictures_read = 0;
  for (const capture::CameraSide side : kSides)
    verification.cameras[static_cast<std::size_t>(side)] = verify(folder, side, pictures_read, progress);
  return verification;
}

nlohmann::ordered_json verificationJson(const Verification& verification) {
  nlohmann::ordered_json json;
  json["whole"] = verification.isWhole();
  json["empty"] = verification.is_empty;
  for (const capture::CameraSide side : kSides) {
    const VerifiedCamera& camera = verification.cameras[static_cast<std::size_t>(side)];
    json[capture::sideName(side)] = {{"pictures", camera.pictures},
                                     {"damaged", camera.damaged},
                                     {"lost", camera.files.lost},
                                     {"altered", camera.files.altered},
                                     {"places", camera.files.places}};
    if (!camera.unreadable.empty()) json[capture::sideName(side)]["unreadable"] = camera.unreadable;
  }
  return json;
}

std::string verificationText(const Verification& verification) {
  if (verification.is_empty) {
    return "EMPTY: no picture was recorded; the log of cartvod says why the cameras sent none\n";
  }
  std::string text;
  for (const capture::CameraSide side : kSides) {
    const VerifiedCamera& camera = verification.cameras[static_cast<std::size_t>(side)];
    text += std::string(capture::sideName(side)) + ": ";
    if (!camera.unreadable.empty()) {
      text += camera.unreadable + "\n";
      continue;
    }
    text += std::to_string(camera.pictures) + " pictures decoded, " + std::to_string(camera.damaged) +
            " of them damaged; " + std::to_string(camera.files.lost) + " lost, " +
            std::to_string(camera.files.altered) + " altered on disk\n";
    for (const std::string& place : camera.files.places)
      text += "  " + place + "\n";
  }
  return text + (verification.isWhole() ? "whole: the files are as they were recorded\n"
                                        : "DAMAGED: a replay skips the damage and continues after it\n");
}

}  // namespace cartvo
