#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/benchmark/accuracy/accuracy.hpp"

// Files between the jobs of a benchmark that several computers share. They have all errors one by one, so
// that the table of all jobs is the one that a single run prints.

namespace cartvo::benchmark {

/// Measurements of one job.
struct JobSamples {
  std::size_t job = 0;   ///< the sequence's number, from 1
  std::size_t jobs = 0;  ///< number of sequences of the benchmark
  std::string options;   ///< of the benchmark; the same for all of its jobs
  int features = 0;
  std::vector<SequenceAccuracy> accuracies;
};

nlohmann::json toJson(const JobSamples& samples);

/// Throws std::runtime_error if `json` is not what toJson returns.
JobSamples samplesFromJson(const nlohmann::json& json);

/// Reads the files NUMBER.json of `folder` that its jobs have written, and combines them in the order of the
/// jobs: `job` is 0. Throws std::runtime_error that names the file if one is damaged or of another benchmark,
/// and names the missing jobs if there are any.
JobSamples mergedSamples(const std::filesystem::path& folder);

}  // namespace cartvo::benchmark
