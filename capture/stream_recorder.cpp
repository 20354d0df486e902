#include "capture/stream_recorder.hpp"

#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "capture/recording_index.hpp"
#include "capture/recording_source.hpp"
#include "capture/stream_writer.hpp"

namespace cartvo {
namespace {

void writeDescription(const RecordingSettings& settings) {
  nlohmann::ordered_json description;
  description["format_version"] = kRecordingFormatVersion;
  description["software_version"] = CARTVO_VERSION;
  description["configuration"] = settings.configuration;
  description["rig"] = settings.rig;
  const std::filesystem::path file = settings.folder / "recording.json";
  std::ofstream output(file);
  output << description.dump(2) << '\n' << std::flush;
  if (!output) throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
}

void prepareFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot make the folder " + folder.string() + ": " + error.message());
  if (isRecording(folder)) {
    throw std::runtime_error(folder.string() + " holds a recording already; give another folder");
  }
}

}  // namespace

struct StreamRecorder::Implementation {
  /// What is shared by the two sides. The first error stops both.
  struct Shared {
    mutable std::mutex mutex;
    RecorderHealth health;
  };

  /// One camera's way into its file.
  class Side : public StreamObserver {
   public:
    Side(const std::filesystem::path& folder, const std::string& stream, Shared& shared)
        : writer_(folder, stream), shared_(shared) {}

    void onStream(const StreamFormat& format) noexcept override {
      shielded([&] { writer_.begin(format); });
    }

    void onUnit(const EncodedUnit& unit) noexcept override {
      shielded([&] {
        if (!writer_.write(unit)) return;
        const std::lock_guard lock(shared_.mutex);
        ++shared_.health.units;
        shared_.health.bytes += unit.data.size();
      });
    }

   private:
    /// Does the work unless recording has stopped; an error stops it, and goes no further.
    template <typename Work>
    void shielded(const Work& work) noexcept {
      try {
        {
          const std::lock_guard lock(shared_.mutex);
          if (!shared_.health.error.empty()) return;
        }
        work();
      } catch (const std::exception& error) {
        const std::lock_guard lock(shared_.mutex);
        if (shared_.health.error.empty())
          shared_.health.error = std::string("recording stopped: ") + error.what();
      }
    }

    StreamWriter writer_;
    Shared& shared_;
  };

  explicit Implementation(const std::filesystem::path& folder)
      : left(folder, "left", shared), right(folder, "right", shared) {}

  Shared shared;
  Side left;
  Side right;
};

StreamRecorder::StreamRecorder(const RecordingSettings& settings) {
  prepareFolder(settings.folder);
  writeDescription(settings);
  implementation_ = std::make_unique<Implementation>(settings.folder);
}

StreamRecorder::~StreamRecorder() = default;

StreamObserver& StreamRecorder::left() {
  return implementation_->left;
}
StreamObserver& StreamRecorder::right() {
  return implementation_->right;
}

RecorderHealth StreamRecorder::health() const {
  const std::lock_guard lock(implementation_->shared.mutex);
  return implementation_->shared.health;
}

}  // namespace cartvo
