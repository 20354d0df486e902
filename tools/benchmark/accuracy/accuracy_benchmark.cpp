// Runs all variants of the odometry on all sequences, lossless and at all bit rates.
#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "tools/benchmark/encoded_source.hpp"
#include "tools/benchmark/simultaneous.hpp"
#include "tools/simulate/sequence_content.hpp"
#include "tools/simulate/stream/stream_cache.hpp"
#include "tools/simulate/truth.hpp"

namespace cartvo::benchmark {
namespace {

constexpr std::uint64_t kMaxStreamBytes = 4'000'000'000;  // of cached encoded streams

std::string withBitrate(const std::string& name, double bitrate_mbps) {
  if (bitrate_mbps == 0.0) return name;
  char text[48];
  std::snprintf(text, sizeof text, ", %g Mbit/s", bitrate_mbps);
  return name + text;
}

/// Runs all variants on one sequence at a time and collects the accuracies.
class AccuracyRun {
 public:
  AccuracyRun(const AccuracySettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer), streams_(settings.cache, kMaxStreamBytes) {}

  void measure(const Sequence& sequence) {
    for (const OdometryVariant& variant : settings_.variants) {
      capture::StereoSource source =
          variant.simultaneous ? openSimultaneous(sequence.folder) : capture::openSource(sequence.folder);
      const pipeline::FoundRig rig = pipeline::findRig(source, sequence.folder, {});
      measure(sequence, variant, 0.0, source, rig);
    }
    for (const double bitrate : settings_.bitrates_mbps)
      measureEncoded(sequence, bitrate);
  }

  std::vector<SequenceAccuracy> releaseResults() { return std::move(results_); }

 private:
  void measure(const Sequence& sequence, const OdometryVariant& variant, double bitrate_mbps,
               capture::StereoSource& source, const pipeline::FoundRig& rig) {
    const std::string name = withBitrate(sequence.name, bitrate_mbps);
    observer_.begin({name + ": " + variant.name});
    const Replay replay = replayPairs(
        source, rig, variant.odometry,
        [&](const pipeline::PairResult& result, std::size_t expected) {
          observer_.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
        },
        {}, nullptr, settings_.limits);
    if (replay.pairs.empty())
      throw std::runtime_error(
          name + ": no left and right image could be paired; check the timestamps of both cameras");
    SequenceAccuracy accuracy = measureAccuracy(replay, sequence.truth, settings_.limits);
    accuracy.sequence = sequence.name;
    accuracy.kind = sequence.kind;
    accuracy.set = sequence.set;
    accuracy.bitrate_mbps = bitrate_mbps;
    accuracy.estimator = variant.name;
    results_.push_back(std::move(accuracy));
  }

  /// Instants of the encoded content are relative to its first image, so the truth is shifted accordingly.
  void measureEncoded(const Sequence& sequence, double bitrate_mbps) {
    const simulate::SequenceContent content(sequence.folder, {});
    const auto streams = encoded(content, withBitrate(sequence.name, bitrate_mbps), bitrate_mbps);
    Sequence from_zero = sequence;
    from_zero.truth.left_camera =
        simulate::shifted(sequence.truth.left_camera, -sequence.truth.left_camera.front().time_ns);
    for (const OdometryVariant& variant : settings_.variants) {
      capture::StereoSource source = openEncoded(streams);
      measure(from_zero, variant, bitrate_mbps, source, {content.rig(), sequence.folder.string()});
    }
  }

  std::shared_ptr<const simulate::EncodedPair> encoded(const simulate::Content& content,
                                                       const std::string& name, double bitrate_mbps) {
    simulate::EncoderSettings encoder;
    encoder.bitrate_kbps = static_cast<int>(std::lround(1000.0 * bitrate_mbps));
    const std::string key = content.cacheKey() + "\n" + simulate::encoderKey(encoder);
    if (std::optional<simulate::EncodedPair> kept = streams_.load(key)) {
      return std::make_shared<const simulate::EncodedPair>(*std::move(kept));
    }
    observer_.begin({name + ": encoding"});
    auto streams = std::make_shared<const simulate::EncodedPair>(
        simulate::encodeContent(content, encoder, observer_.progress));
    streams_.store(key, *streams);
    return streams;
  }

  const AccuracySettings& settings_;
  const WorkObserver& observer_;
  simulate::StreamCache streams_;
  std::vector<SequenceAccuracy> results_;
};

}  // namespace

std::vector<std::string> sequenceNames(const AccuracySettings& settings) {
  std::vector<std::string> names;
  for (const Sequence& sequence : realSequences(settings.data))
    names.push_back(sequence.name);
  for (const world::WorldSettings& world : settings.worlds)
    names.push_back(worldName(world));
  return names;
}

std::vector<SequenceAccuracy> runAccuracyBenchmark(const AccuracySettings& settings,
                                                   const WorkObserver& observer) {
  AccuracyRun run(settings, observer);
  std::size_t index = 0;
  const auto is_chosen = [&] { return settings.only.value_or(index) == index; };
  for (const Sequence& sequence : realSequences(settings.data)) {
    if (is_chosen()) run.measure(sequence);
    ++index;
  }
  const WorldCache worlds(settings.cache / "worlds");
  for (const world::WorldSettings& world : settings.worlds) {
    if (is_chosen()) {
      observer.begin({worldName(world) + ": rendering, unless it is cached"});
      run.measure(renderedSequence(world, worlds, observer.progress));
    }
    ++index;
  }
  return run.releaseResults();
}

}  // namespace cartvo::benchmark
