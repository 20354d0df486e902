// Runs the odometry with each tuned constant a little smaller and larger.
#include "tools/benchmark/sensitivity/sensitivity_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <utility>

namespace cartvo::benchmark {
namespace {

/// Runs that differ from the default by chance only.
std::vector<OdometryVariant> chanceVariants(const vo::OdometrySettings& settings) {
  std::vector<OdometryVariant> variants(4, {"chance", settings});
  variants[0].odometry.seed += 1;
  variants[1].odometry.seed += 2;
  variants[2].odometry.features = static_cast<int>(std::lround(0.98 * settings.features));
  variants[3].odometry.features = static_cast<int>(std::lround(1.02 * settings.features));
  return variants;
}

/// Mean logarithm of the ratios of defined errors.
class MeanRatio {
 public:
  void add(double changed, double reference) {
    if (!(changed > 0.0 && reference > 0.0) || !std::isfinite(changed + reference)) return;
    sum_ += std::log(changed / reference);
    ++count_;
  }
  double mean() const { return count_ > 0 ? sum_ / count_ : 0.0; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

double neesOf(const SequenceAccuracy& accuracy) {
  const NormalisedErrors& motion = accuracy.consistency.motion;
  return motion.groups() > 0 ? motion.mean() : 0.0;
}

void widen(double& most, double change) {
  most = std::max(most, std::abs(change));
}

/// Change in multiples of what chance changes. `least`: smallest chance that counts, of few runs.
double multiple(double change, double chance, double least) {
  return std::abs(change) / std::max(chance, least);
}

double effectOf(const RelativeResult& result, const RelativeResult& chance) {
  constexpr double kLeastRatio = 0.002;
  return std::max({multiple(result.segments, chance.segments, kLeastRatio),
                   multiple(result.relative, chance.relative, kLeastRatio),
                   multiple(result.nees, chance.nees, kLeastRatio),
                   multiple(result.invalid, chance.invalid, 1.0),
                   multiple(result.above_limit, chance.above_limit, 1.0)});
}

/// Runs variants on several threads and reports the progress of all together.
class ParallelRuns {
 public:
  ParallelRuns(const SensitivitySettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer) {}

  /// Results of each variant on each sequence.
  std::vector<std::vector<SequenceAccuracy>> run(const std::vector<OdometryVariant>& variants) {
    total_ = static_cast<int>(variants.size() * sequenceCount());
    observer_.begin({std::to_string(variants.size()) + " runs on each of " + std::to_string(sequenceCount()) +
                         " sequences",
                     "runs"});
    std::vector<std::future<std::vector<SequenceAccuracy>>> parts;
    const auto threads = std::min(static_cast<std::size_t>(settings_.threads), variants.size());
    for (std::size_t part = 0; part < threads; ++part)
      parts.push_back(std::async(std::launch::async, [&, part] { return runPart(variants, part, threads); }));
    std::vector<std::vector<SequenceAccuracy>> results(variants.size());
    for (std::size_t part = 0; part < threads; ++part) {
      const std::vector<SequenceAccuracy> accuracies = parts[part].get();
      const std::size_t count = (variants.size() - part + threads - 1) / threads;
      for (std::size_t i = 0; i < accuracies.size(); ++i)
        results[part + i % count * threads].push_back(accuracies[i]);
    }
    return results;
  }

 private:
  std::size_t sequenceCount() const {
    return sequenceNames(settings_.sequences).size() * (1 + settings_.sequences.bitrates_mbps.size());
  }

  std::vector<SequenceAccuracy> runPart(const std::vector<OdometryVariant>& variants, std::size_t part,
                                        std::size_t parts) {
    AccuracySettings own = settings_.sequences;
    own.variants.clear();
    for (std::size_t i = part; i < variants.size(); i += parts)
      own.variants.push_back(variants[i]);
    return runAccuracyBenchmark(own, {[](const WorkStep&) {},
                                      [&](int done, int) {
                                        if (done == 1) countRun();
                                      }});
  }

  /// Called when a run on a sequence begins.
  void countRun() {
    const std::scoped_lock lock(mutex_);
    observer_.progress(std::min(++done_, total_), total_);
  }

  const SensitivitySettings& settings_;
  const WorkObserver& observer_;
  std::mutex mutex_;
  int done_ = 0, total_ = 0;
};

std::vector<const vo::TunedConstant*> constantsNamed(const std::vector<std::string>& names) {
  std::vector<const vo::TunedConstant*> constants;
  for (const std::string& name : names) {
    const auto all = vo::tunedConstants();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const vo::TunedConstant& one) { return name == one.name; });
    if (found == all.end()) throw std::invalid_argument(name + ": no tuned constant; --list prints all");
    constants.push_back(&*found);
  }
  return constants;
}

}  // namespace

std::optional<vo::OdometrySettings> withConstant(const vo::TunedConstant& constant, double value,
                                                 const vo::OdometrySettings& settings) {
  const double before = constant.value(settings);
  if (constant.isInteger() && std::lround(value) == std::lround(before))
    value = before + (value > before ? 1 : -1);
  value = std::clamp(value, constant.low, constant.high);
  if (value == before) return std::nullopt;
  vo::OdometrySettings changed = settings;
  constant.set(value, changed);
  try {
    validate(changed);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  return changed;
}

RelativeResult relativeTo(const std::vector<SequenceAccuracy>& reference,
                          const std::vector<SequenceAccuracy>& changed) {
  MeanRatio segments, relative, nees;
  RelativeResult result;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Evaluation &before = reference[i].evaluation, &after = changed[i].evaluation;
    segments.add(after.short_segments.all.translation, before.short_segments.all.translation);
    segments.add(after.short_segments.all.rotation, before.short_segments.all.rotation);
    relative.add(after.relative_translation, before.relative_translation);
    relative.add(after.relative_rotation, before.relative_rotation);
    nees.add(neesOf(changed[i]), neesOf(reference[i]));
    result.invalid += static_cast<int>(changed[i].invalid) - static_cast<int>(reference[i].invalid);
    result.above_limit += static_cast<int>(changed[i].validity.above_limit) -
                          static_cast<int>(reference[i].validity.above_limit);
  }
  result.segments = segments.mean();
  result.relative = relative.mean();
  result.nees = nees.mean();
  return result;
}

Sensitivity runSensitivityBenchmark(const SensitivitySettings& settings, const WorkObserver& observer) {
  Sensitivity sensitivity;
  std::vector<OdometryVariant> variants = chanceVariants(settings.odometry);
  const std::size_t chances = variants.size();
  for (const vo::TunedConstant* constant : constantsNamed(settings.constants)) {
    ConstantSensitivity& one = sensitivity.constants.emplace_back();
    one.constant = constant;
    one.default_value = constant->value(settings.odometry);
    const auto add = [&](double wanted, double& value, std::optional<RelativeResult>& result) {
      const auto changed = withConstant(*constant, wanted, settings.odometry);
      if (!changed) return;
      value = constant->value(*changed);
      result.emplace();
      variants.push_back({constant->name, *changed});
    };
    add(one.default_value / settings.factor, one.low_value, one.low);
    add(one.default_value * settings.factor, one.high_value, one.high);
  }

  // The default first and alone: it renders and encodes the sequences for all others.
  AccuracySettings first = settings.sequences;
  first.variants = {{"default", settings.odometry}};
  const std::vector<SequenceAccuracy> reference = runAccuracyBenchmark(first, observer);
  for (const SequenceAccuracy& accuracy : reference)
    sensitivity.pairs += accuracy.pairs;
  const auto results = ParallelRuns(settings, observer).run(variants);

  for (std::size_t i = 0; i < chances; ++i) {
    const RelativeResult result = relativeTo(reference, results[i]);
    widen(sensitivity.chance.segments, result.segments);
    widen(sensitivity.chance.relative, result.relative);
    widen(sensitivity.chance.nees, result.nees);
    sensitivity.chance.invalid = std::max(sensitivity.chance.invalid, std::abs(result.invalid));
    sensitivity.chance.above_limit = std::max(sensitivity.chance.above_limit, std::abs(result.above_limit));
  }
  std::size_t next = chances;
  for (ConstantSensitivity& one : sensitivity.constants) {
    for (std::optional<RelativeResult>* side : {&one.low, &one.high}) {
      if (!*side) continue;
      *side = relativeTo(reference, results[next++]);
      one.effect = std::max(one.effect, effectOf(**side, sensitivity.chance));
    }
  }
  std::stable_sort(sensitivity.constants.begin(), sensitivity.constants.end(),
                   [](const auto& a, const auto& b) { return a.effect > b.effect; });
  return sensitivity;
}

}  // namespace cartvo::benchmark
