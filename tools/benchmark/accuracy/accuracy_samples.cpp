// All errors of accuracies as JSON, and their combination.
#include "tools/benchmark/accuracy/accuracy_samples.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/input_file.hpp"

namespace cartvo::benchmark {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr int kFormat = 3;                       // of the files
constexpr std::size_t kMaxFileBytes = 1U << 30;  // an hour at 18 Hz needs 10 MB

Json optionalJson(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json segmentJson(const SegmentErrors& errors) {
  return {errors.length, errors.count, errors.translation, errors.rotation};
}

SegmentErrors segmentOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<int>(), json.at(2).get<double>(),
          json.at(3).get<double>()};
}

Json groupJson(const SegmentGroup& group) {
  Json each = Json::array();
  for (const SegmentErrors& errors : group.each)
    each.push_back(segmentJson(errors));
  return {{"all", segmentJson(group.all)}, {"each", std::move(each)}};
}

SegmentGroup groupOf(const Json& json) {
  SegmentGroup group;
  group.all = segmentOf(json.at("all"));
  for (const Json& errors : json.at("each"))
    group.each.push_back(segmentOf(errors));
  return group;
}

Json alignedJson(const std::optional<AlignedAxes>& aligned) {
  if (!aligned) return nullptr;
  const Eigen::Vector3d& rotation = aligned->rotation;
  return {{"rotation", {rotation.x(), rotation.y(), rotation.z()}},
          {"short_segments", groupJson(aligned->short_segments)}};
}

AlignedAxes alignedOf(const Json& json) {
  const Json& rotation = json.at("rotation");
  return {{rotation.at(0).get<double>(), rotation.at(1).get<double>(), rotation.at(2).get<double>()},
          groupOf(json.at("short_segments"))};
}

Json evaluationSamples(const Evaluation& e) {
  return {{"by_time", e.method == AssociationMethod::time},
          {"poses", e.poses},
          {"unmatched", e.unmatched},
          {"path_length", e.path_length},
          {"estimated_path_length", e.estimated_path_length},
          {"final_drift", e.final_drift},
          {"final_drift_fraction", optionalJson(e.final_drift_fraction)},
          {"final_rotation", e.final_rotation},
          {"absolute_aligned", e.absolute_aligned},
          {"absolute_origin", e.absolute_origin},
          {"relative_translation", e.relative_translation},
          {"relative_rotation", e.relative_rotation},
          {"short_segments", groupJson(e.short_segments)},
          {"long_segments", groupJson(e.long_segments)},
          {"aligned_axes", alignedJson(e.aligned_axes)}};
}

Evaluation evaluationOf(const Json& json) {
  Evaluation e;
  e.method = json.at("by_time").get<bool>() ? AssociationMethod::time : AssociationMethod::rows;
  json.at("poses").get_to(e.poses);
  json.at("unmatched").get_to(e.unmatched);
  json.at("path_length").get_to(e.path_length);
  json.at("estimated_path_length").get_to(e.estimated_path_length);
  json.at("final_drift").get_to(e.final_drift);
  if (const Json& fraction = json.at("final_drift_fraction"); !fraction.is_null())
    e.final_drift_fraction = fraction.get<double>();
  json.at("final_rotation").get_to(e.final_rotation);
  json.at("absolute_aligned").get_to(e.absolute_aligned);
  json.at("absolute_origin").get_to(e.absolute_origin);
  json.at("relative_translation").get_to(e.relative_translation);
  json.at("relative_rotation").get_to(e.relative_rotation);
  e.short_segments = groupOf(json.at("short_segments"));
  e.long_segments = groupOf(json.at("long_segments"));
  if (const Json& aligned = json.at("aligned_axes"); !aligned.is_null()) e.aligned_axes = alignedOf(aligned);
  return e;
}

Json errorsJson(const NormalisedErrors& errors) {
  Json groups = Json::array();
  for (const NormalisedErrors::Group& group : errors.eachGroup())
    groups.push_back({group.sum, group.count});
  return {{"groups", std::move(groups)}, {"unusable", errors.unusable()}};
}

NormalisedErrors errorsOf(const Json& json) {
  std::vector<NormalisedErrors::Group> groups;
  for (const Json& group : json.at("groups")) {
    groups.push_back({group.at(0).get<double>(), group.at(1).get<std::size_t>()});
    if (groups.back().count == 0) throw std::runtime_error("a group of errors is empty");
  }
  return {std::move(groups), json.at("unusable").get<std::size_t>()};
}

Json validitySamples(const ValidityFigures& figures) {
  return {figures.messages,    figures.valid,       figures.judged,         figures.above_limit,
          figures.above_bound, figures.longest_gap, figures.velocity_error, figures.rate_error};
}

ValidityFigures validityOf(const Json& json) {
  const auto count = [&](std::size_t i) { return json.at(i).get<std::size_t>(); };
  const auto number = [&](std::size_t i) { return json.at(i).get<double>(); };
  return {count(0), count(1), count(2), count(3), count(4), number(5), number(6), number(7)};
}

Json accuracySamples(const SequenceAccuracy& a) {
  Json json{{"sequence", a.sequence},
            {"rendered", a.kind == SequenceKind::rendered},
            {"set", a.set ? Json(worldSetName(*a.set)) : Json(nullptr)},
            {"bitrate_mbps", a.bitrate_mbps},
            {"estimator", a.estimator},
            {"pairs", a.pairs},
            {"lost", a.lost},
            {"invalid", a.invalid},
            {"resets", a.resets},
            {"standing", a.standing},
            {"standing_speed", a.standing_speed},
            {"standing_end", nullptr},
            {"evaluation", evaluationSamples(a.evaluation)},
            {"motion", errorsJson(a.consistency.motion)},
            {"pose", errorsJson(a.consistency.pose)},
            {"velocity", errorsJson(a.consistency.velocity)},
            {"validity", validitySamples(a.validity)},
            {"times_ms", a.times_ms}};
  if (a.standing_end) json["standing_end"] = {a.standing_end->translation, a.standing_end->rotation};
  return json;
}

SequenceAccuracy accuracyOf(const Json& json) {
  SequenceAccuracy a;
  json.at("sequence").get_to(a.sequence);
  a.kind = json.at("rendered").get<bool>() ? SequenceKind::rendered : SequenceKind::real;
  if (const Json& set = json.at("set"); !set.is_null()) a.set = worldSetNamed(set.get<std::string>());
  json.at("bitrate_mbps").get_to(a.bitrate_mbps);
  json.at("estimator").get_to(a.estimator);
  json.at("pairs").get_to(a.pairs);
  json.at("lost").get_to(a.lost);
  json.at("invalid").get_to(a.invalid);
  json.at("resets").get_to(a.resets);
  json.at("standing").get_to(a.standing);
  json.at("standing_speed").get_to(a.standing_speed);
  if (const Json& end = json.at("standing_end"); !end.is_null())
    a.standing_end = EndError{end.at(0).get<double>(), end.at(1).get<double>()};
  a.evaluation = evaluationOf(json.at("evaluation"));
  a.consistency = {errorsOf(json.at("motion")), errorsOf(json.at("pose")), errorsOf(json.at("velocity"))};
  a.validity = validityOf(json.at("validity"));
  json.at("times_ms").get_to(a.times_ms);
  return a;
}

JobSamples readSamples(const fs::path& file) {
  const Json json = Json::parse(readInputFile(file, kMaxFileBytes), nullptr, false);
  try {
    return samplesFromJson(json);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

/// The numbers of 1 to `jobs` that are not in `found`, such as "2, 5".
std::string missingJobs(const std::map<std::size_t, JobSamples>& found, std::size_t jobs) {
  std::string missing;
  for (std::size_t job = 1; job <= jobs; ++job)
    if (!found.contains(job)) missing += (missing.empty() ? "" : ", ") + std::to_string(job);
  return missing;
}

}  // namespace

Json toJson(const JobSamples& samples) {
  Json accuracies = Json::array();
  for (const SequenceAccuracy& accuracy : samples.accuracies)
    accuracies.push_back(accuracySamples(accuracy));
  return {{"cartvo_accuracy_samples", kFormat},
          {"job", samples.job},
          {"jobs", samples.jobs},
          {"options", samples.options},
          {"features", samples.features},
          {"accuracies", std::move(accuracies)}};
}

JobSamples samplesFromJson(const Json& json) {
  JobSamples samples;
  try {
    if (json.at("cartvo_accuracy_samples") != kFormat)
      throw std::runtime_error("written by another version of cartvo");
    json.at("job").get_to(samples.job);
    json.at("jobs").get_to(samples.jobs);
    json.at("options").get_to(samples.options);
    json.at("features").get_to(samples.features);
    for (const Json& accuracy : json.at("accuracies"))
      samples.accuracies.push_back(accuracyOf(accuracy));
  } catch (const Json::exception&) {
    throw std::runtime_error("no results of 'cartvo benchmark accuracy --samples'");
  }
  return samples;
}

JobSamples mergedSamples(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  if (files.empty())
    throw std::runtime_error(folder.string() +
                             ": no results (*.json) of the jobs of 'cartvo benchmark accuracy --list'");
  std::sort(files.begin(), files.end());
  std::map<std::size_t, JobSamples> by_job;
  for (const fs::path& file : files) {
    JobSamples samples = readSamples(file);
    const JobSamples& first = by_job.empty() ? samples : by_job.begin()->second;
    if (samples.options != first.options || samples.jobs != first.jobs)
      throw std::runtime_error(file.string() + ": of a benchmark with other options ('" + samples.options +
                               "' instead of '" + first.options + "')");
    const std::size_t job = samples.job;
    if (!by_job.emplace(job, std::move(samples)).second)
      throw std::runtime_error(file.string() + ": a second result of job " + std::to_string(job));
  }
  JobSamples all = by_job.begin()->second;
  if (const std::string missing = missingJobs(by_job, all.jobs); !missing.empty())
    throw std::runtime_error(folder.string() + ": results of " + std::to_string(by_job.size()) + " of " +
                             std::to_string(all.jobs) + " jobs; missing: " + missing);
  all.job = 0;
  all.accuracies.clear();
  for (auto& [job, samples] : by_job)
    std::move(samples.accuracies.begin(), samples.accuracies.end(), std::back_inserter(all.accuracies));
  return all;
}

}  // namespace cartvo::benchmark
