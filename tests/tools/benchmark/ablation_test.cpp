// Tests of the ablation variants and of the table that compares them.
#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/benchmark/accuracy/ablation_report.hpp"
#include "tools/benchmark/accuracy/ablation_variants.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;

TEST(Ablation, ReferenceComesFirstEvenIfNotNamed) {
  vo::OdometrySettings full;
  full.features = 700;
  const std::vector<OdometryVariant> variants = ablatedVariants(full, {"two-pairs"});
  ASSERT_EQ(variants.size(), 2u);
  EXPECT_EQ(variants[0].name, "as-it-is");
  EXPECT_EQ(variants[0].odometry.bundle.frames, full.bundle.frames);
  EXPECT_EQ(variants[1].name, "two-pairs");
  EXPECT_EQ(variants[1].odometry.bundle.frames, 2);
  EXPECT_EQ(variants[1].odometry.features, 700);
}

TEST(Ablation, EachVariantHasValidSettings) {
  for (const OdometryVariant& variant : ablatedVariants({}, ablationNames()))
    EXPECT_NO_THROW(vo::validate(variant.odometry)) << variant.name;
}

SequenceAccuracy accuracyOf(const std::string& sequence, const std::string& variant, double percent) {
  SequenceAccuracy accuracy;
  accuracy.sequence = sequence;
  accuracy.estimator = variant;
  accuracy.kind = SequenceKind::rendered;
  accuracy.evaluation.poses = 10;
  accuracy.evaluation.path_length = 10.0;
  accuracy.evaluation.short_segments.all = {0.0, 10, 0.01 * percent, 0.002 * std::numbers::pi / 180.0};
  accuracy.times_ms = {10.0, 12.0, 30.0};
  return accuracy;
}

TEST(AblationTable, HasARowForEachVariantAndAColumnForEachSequence) {
  SequenceAccuracy standing = accuracyOf("standing 1", "as-it-is", 0.0);
  standing.evaluation.short_segments.all.count = 0;
  standing.standing_end = EndError{0.0012, 0.0};
  SequenceAccuracy lost = accuracyOf("campus 1", "two-pairs", 0.5);
  lost.invalid = 3;
  lost.validity.above_limit = 1;
  SequenceAccuracy drifting = standing;
  drifting.estimator = "two-pairs";
  const std::string table = ablationTable(
      {accuracyOf("campus 1", "as-it-is", 0.25), lost, standing, drifting}, ReportFormat::markdown);
  EXPECT_THAT(table, HasSubstr("| variant "));
  EXPECT_THAT(table, HasSubstr("campus 1 |"));
  EXPECT_THAT(table, HasSubstr("0.250 / 0.00200 "));
  EXPECT_THAT(table, HasSubstr("0.500 / 0.00200, 3 invalid, 1 above limit |"));
  EXPECT_THAT(table, HasSubstr("end 1.20 mm / 0°"));
  EXPECT_THAT(table, HasSubstr("12.0 |"));
  EXPECT_THAT(table, HasSubstr("two-pairs: a window of two pairs"));
  EXPECT_EQ(table.find("no-rig"), std::string::npos)
      << "the legend must not describe variants that were not measured";
}

}  // namespace
}  // namespace cartvo::benchmark
