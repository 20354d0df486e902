// Tests of the files between the jobs of a benchmark.
#include "tools/benchmark/accuracy/accuracy_samples.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tools/benchmark/accuracy/accuracy_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;

/// Errors, counts and times that differ in each field, with values that have no short decimal.
SequenceAccuracy accuracyOf(const std::string& sequence, double error) {
  SequenceAccuracy a;
  a.sequence = sequence;
  a.kind = SequenceKind::rendered;
  a.estimator = "reprojection";
  a.pairs = 100;
  a.lost = 1;
  a.invalid = 2;
  a.resets = 3;
  a.standing = 5;
  a.standing_speed = error / 7.0;
  a.evaluation.method = AssociationMethod::time;
  a.evaluation.poses = 98;
  a.evaluation.path_length = 41.0 / 3.0;
  a.evaluation.final_drift = error;
  a.evaluation.final_drift_fraction = error / (41.0 / 3.0);
  a.evaluation.relative_translation = error / 9.0;
  a.evaluation.relative_rotation = error / 11.0;
  a.evaluation.short_segments = {{0.0, 7, error, error / 3.0}, {{5.0, 7, error, error / 3.0}}};
  a.evaluation.aligned_axes = AlignedAxes{{0.1, 0.2, error}, a.evaluation.short_segments};
  a.standing_end = EndError{error / 13.0, error / 17.0};
  a.consistency.motion = {{{6.0 * error, 3}, {1.0, 1}}, 2};
  a.consistency.pose = {{{error, 9}}, 0};
  a.validity = {100, 97, 96, 4, 6, error / 19.0, error / 23.0, error / 29.0};
  a.times_ms = {3.1, 10.0 / 3.0, 2.9};
  return a;
}

std::string wholeReport(const std::vector<SequenceAccuracy>& accuracies) {
  return accuracyJson(accuracies).dump() + accuracyTable(accuracies, ReportFormat::text);
}

void write(const std::filesystem::path& file, const JobSamples& samples) {
  std::ofstream(file) << toJson(samples).dump();
}

TEST(AccuracySamples, OfAllJobsGiveTheReportOfASingleRun) {
  const test::TemporaryFolder folder;
  const std::vector<SequenceAccuracy> all{accuracyOf("first", 0.1), accuracyOf("first, H.264", 0.2),
                                          accuracyOf("second", 1.0 / 3.0)};
  write(folder / "2.json", {2, 2, "--seeds 1", 700, {all[2]}});
  write(folder / "1.json", {1, 2, "--seeds 1", 700, {all[0], all[1]}});
  const JobSamples merged = mergedSamples(folder.path());
  EXPECT_EQ(merged.features, 700);
  EXPECT_EQ(wholeReport(merged.accuracies), wholeReport(all));
}

TEST(AccuracySamples, ThatAreMissingAreNamed) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }), HasSubstr("no results"));
  write(folder / "2.json", {2, 4, "", 700, {}});
  EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }),
              HasSubstr("results of 1 of 4 jobs; missing: 1, 3, 4"));
}

TEST(AccuracySamples, OfAnotherBenchmarkAreRefused) {
  const test::TemporaryFolder folder;
  write(folder / "1.json", {1, 2, "--seeds 1", 700, {}});
  write(folder / "2.json", {2, 2, "--seeds 2", 700, {}});
  EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }),
              AllOf(HasSubstr("2.json: of a benchmark with other options"), HasSubstr("--seeds 2")));
  write(folder / "2.json", {1, 2, "--seeds 1", 700, {}});
  EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }), HasSubstr("a second result of job 1"));
}

TEST(AccuracySamples, OfADamagedFileAreRefused) {
  const test::TemporaryFolder folder;
  const std::string whole = toJson({1, 1, "", 700, {accuracyOf("first", 0.1)}}).dump();
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("{}"), whole.substr(0, whole.size() / 2),
        std::string(R"({"cartvo_accuracy_samples": 3, "job": "one"})")}) {
    std::ofstream(folder / "1.json") << text;
    EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }),
                HasSubstr("1.json: no results of 'cartvo benchmark accuracy --samples'"))
        << text;
  }
  std::ofstream(folder / "1.json") << R"({"cartvo_accuracy_samples": 1})";
  EXPECT_THAT(test::messageOf([&] { mergedSamples(folder.path()); }), HasSubstr("another version"));
}

}  // namespace
}  // namespace cartvo::benchmark
