#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/offset/offset_benchmark.hpp"

namespace cartvo::benchmark {

/// Readouts of both cameras, s, as in vo::Shutter.
struct StereoReadout {
  double left = 0.0;
  double right = 0.0;

  bool isGlobal() const { return left == 0.0 && right == 0.0; }
  bool operator==(const StereoReadout&) const = default;
};

/// The readouts that the odometry is given.
enum class ReadoutModel : std::uint8_t {
  known,      ///< the true readouts
  estimated,  ///< 32 ms with a standard deviation of 15 %, as of cameras without a statement
  ignored,    ///< global shutters
};

/// Returns "known", "estimated" or "ignored".
std::string readoutModelName(ReadoutModel model);
std::vector<std::string> readoutModelNames();
/// The model of that name. Throws std::invalid_argument if there is none.
ReadoutModel readoutModelNamed(const std::string& name);

/// How a world is seen.
struct ShutterCase {
  StereoReadout readout;
  RightClock clock;
  world::Shake shake;  ///< of the cameras' mount

  bool operator==(const ShutterCase& other) const {
    return readout == other.readout && clock == other.clock && isShakenAs(other);
  }
  bool isShakenAs(const ShutterCase& other) const {
    return shake.frequency == other.shake.frequency && shake.amplitude == other.shake.amplitude;
  }
};

/// Whether a model differs from others in a case: a global shutter has the model `known` alone, and only
/// readouts that are positive can be estimated from 32 ms.
bool isMeasured(const ShutterCase& seen, ReadoutModel model);

/// Worlds, cases and models of a shutter benchmark.
struct ShutterSettings {
  std::vector<world::WorldSettings> worlds;  ///< rendered in each of `cases`
  std::vector<ShutterCase> cases;
  std::vector<ReadoutModel> models;
  vo::OdometrySettings odometry;
  pipeline::AlertLimits limits;  ///< of VALID messages, and above which they are counted
  std::filesystem::path cache;   ///< for rendered worlds
};

/// Errors of the published angular velocities against the true ones at the exposures, over valid pairs.
class AngularRateErrors {
 public:
  AngularRateErrors() = default;
  AngularRateErrors(const Replay& replay, const SequenceTruth& truth);

  void add(const AngularRateErrors& other);

  std::size_t count() const { return count_; }
  /// RMS of the error over RMS of the true rate; infinite if the cart never turned.
  double relative() const;

 private:
  double errors_ = 0.0, rates_ = 0.0;  ///< sums of squares, rad^2/s^2
  std::size_t count_ = 0;
};

/// The accuracy of one model on one scenario in one case.
struct ShutterAccuracy {
  std::string sequence;  ///< a scenario with all its seeds
  ShutterCase seen;
  ReadoutModel model = ReadoutModel::known;
  SequenceAccuracy accuracy;  ///< see summarise
  AngularRateErrors rates;
};

/// Combines results of the same case and model into one with the given name. `results` must not be empty.
ShutterAccuracy summarise(const std::string& name, const std::vector<ShutterAccuracy>& results);

/// Measures each world in each case with each model that is measured there, through the daemon's pipeline;
/// the seeds of a scenario are summarised. Throws std::runtime_error naming a sequence that cannot be used,
/// std::invalid_argument for invalid settings.
std::vector<ShutterAccuracy> runShutterBenchmark(const ShutterSettings& settings,
                                                 const WorkObserver& observer);

}  // namespace cartvo::benchmark
