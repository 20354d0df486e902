// Tests of the states of integrity: the table of transitions by itself, its picture in the documentation, and
// the evidence of images.
#include "vo_core/integrity/integrity_monitor.hpp"

#include <array>
#include <cstddef>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/file_text.hpp"
#include "support/places.hpp"

namespace cartvo::vo {
namespace {

using enum IntegrityState;
using enum IntegrityAction;
using E = IntegrityEvidence;
using Condition = IntegrityTransition::Condition;

constexpr std::array kStates{tracking, standstill, left_frozen, right_frozen, both_frozen, lost};
constexpr std::array<const char*, 6> kStateNames{"tracking",     "standstill",  "left frozen",
                                                 "right frozen", "both frozen", "lost"};
const std::array<std::pair<Condition, const char*>, 16> kConditions{{
    {&E::left_repeats, "left repeats"},
    {&E::right_repeats, "right repeats"},
    {&E::left_alone, "left alone"},
    {&E::right_alone, "right alone"},
    {&E::cannot_stop, "cannot stop"},
    {&E::no_track, "no track"},
    {&E::late, "late"},
    {&E::by_candidate, "by candidate"},
    {&E::stands, "stands"},
    {&E::moves, "moves"},
    {&E::right_moves, "right moves"},
    {&E::right_stays, "right stays"},
    {&E::tracked, "tracked"},
    {&E::zero_velocity, "zero velocity"},
    {&E::lost, "lost"},
    {&E::ambiguous, "ambiguous"},
}};

E evidenceOf(unsigned bits) {
  E evidence;
  for (std::size_t i = 0; i < kConditions.size(); ++i)
    evidence.*kConditions[i].first = ((bits >> i) & 1U) != 0;
  return evidence;
}

/// Whether a pair can show this: no motion is seen to be two things at once.
bool isPossible(const E& e) {
  const bool seen = e.stands || e.moves;
  return !(e.stands && e.moves) && !(e.left_alone && e.right_alone) && !(e.tracked && e.lost) &&
         (!e.zero_velocity || (e.tracked && e.stands)) && (!e.tracked || seen) &&
         !(e.right_moves && e.right_stays) && (e.stands || !(e.right_moves || e.right_stays)) &&
         !(e.no_track && (e.late || e.by_candidate || seen)) && (!e.ambiguous || (e.lost && !seen));
}

const std::vector<E>& possibleEvidence() {
  static const std::vector<E> all = [] {
    std::vector<E> found;
    for (unsigned bits = 0; bits < 1U << kConditions.size(); ++bits)
      if (const E evidence = evidenceOf(bits); isPossible(evidence)) found.push_back(evidence);
    return found;
  }();
  return all;
}

bool isValidState(IntegrityState state) {
  return state == tracking || state == standstill;
}

TEST(IntegrityTable, UsesEachTransitionFromEachOfItsStates) {
  std::set<std::pair<const IntegrityTransition*, IntegrityState>> used;
  for (const IntegrityState state : kStates) {
    for (const E& evidence : possibleEvidence()) {
      for (const IntegrityTransition& row : integrityTransitions()) {
        if (!row.appliesTo(state, evidence)) continue;
        used.insert({&row, state});
        const IntegrityDecision decision = decide(state, evidence);
        EXPECT_EQ(decision.state, row.to);
        EXPECT_EQ(decision.action, row.action);
        break;
      }
    }
  }
  for (const IntegrityTransition& row : integrityTransitions())
    for (const IntegrityState state : kStates)
      EXPECT_EQ(used.contains({&row, state}), row.isFrom(state))
          << "row " << &row - integrityTransitions().data() << ", " << kStateNames[static_cast<int>(state)];
}

TEST(IntegrityTable, DecidesOnEachOutcome) {
  for (const IntegrityState state : kStates)
    for (const E& evidence : possibleEvidence())
      if (evidence.tracked || evidence.lost || evidence.no_track) {
        EXPECT_NE(decide(state, evidence).action, measure);
      }
}

TEST(IntegrityTable, PublishesMeasuredMotionsOnly) {
  for (const IntegrityState state : kStates) {
    for (const E& evidence : possibleEvidence()) {
      const IntegrityDecision decision = decide(state, evidence);
      if (decision.action == measure) continue;
      EXPECT_EQ(decision.action == publish, isValidState(decision.state));
      if (decision.action != publish) continue;
      EXPECT_TRUE(evidence.tracked);
      EXPECT_FALSE(evidence.cannot_stop &&
                   (evidence.stands || evidence.left_repeats || evidence.right_repeats));
    }
  }
}

TEST(IntegrityTable, LeadsFromEachStateToEachOther) {
  for (const IntegrityState from : kStates) {
    std::set<IntegrityState> reached{from};
    for (std::size_t before = 0; before != reached.size();) {
      before = reached.size();
      for (const IntegrityState state : std::set(reached))
        for (const E& evidence : possibleEvidence())
          reached.insert(decide(state, evidence).state);
    }
    EXPECT_EQ(reached.size(), kStates.size()) << kStateNames[static_cast<int>(from)];
  }
}

TEST(IntegrityTable, FreezesAndRecoversAsNamed) {
  struct Case {
    IntegrityState state;
    E evidence;
    IntegrityState to;
    IntegrityAction action;
  };
  const std::vector<Case> cases{
      {lost, {.no_track = true}, lost, start_epoch},
      {lost, {.moves = true, .tracked = true}, tracking, publish},
      {tracking, {.stands = true, .tracked = true, .zero_velocity = true}, standstill, publish},
      {standstill, {.moves = true, .tracked = true}, tracking, publish},
      // A standing cart's images may repeat; a fast cart's may not.
      {tracking, {.left_repeats = true, .right_repeats = true}, tracking, measure},
      {tracking, {.left_repeats = true, .right_repeats = true, .cannot_stop = true}, both_frozen, reject},
      {tracking, {.left_repeats = true, .cannot_stop = true}, left_frozen, reject},
      {tracking, {.right_repeats = true, .cannot_stop = true}, right_frozen, reject},
      {standstill, {.right_alone = true}, right_frozen, reject},
      {lost, {.left_alone = true}, left_frozen, reject},
      // Once frozen, a camera stays so until its images change and show motion.
      {both_frozen, {.right_repeats = true}, both_frozen, reject},
      {both_frozen, {.stands = true}, both_frozen, reject},
      {both_frozen, {.moves = true, .tracked = true}, tracking, publish},
      {right_frozen, {.right_repeats = true}, right_frozen, reject},
      {right_frozen, {.moves = true, .tracked = true}, tracking, publish},
      // Slow carts: by the other camera.
      {tracking, {.right_repeats = true, .moves = true}, right_frozen, reject},
      {standstill, {.stands = true, .right_moves = true}, left_frozen, reject},
      {left_frozen, {.stands = true}, left_frozen, reject},
      {left_frozen, {.stands = true, .right_stays = true}, left_frozen, measure},
      // An encoder that refines a frozen image: by the bound on braking, in two pairs.
      {tracking, {.cannot_stop = true, .stands = true}, lost, relocalise},
      {lost, {.cannot_stop = true, .stands = true}, both_frozen, reject},
      // The track of a frozen left camera is continued, however late; the distance is then unknown.
      {tracking, {.late = true}, lost, start_epoch},
      {left_frozen, {.late = true}, left_frozen, measure},
      {left_frozen, {.late = true, .stands = true}, left_frozen, reject},
      {left_frozen, {.late = true, .moves = true, .tracked = true}, lost, start_epoch},
      // A part of the cart in view hides a departure: the track waits, a candidate is replaced.
      {standstill, {.lost = true, .ambiguous = true}, lost, wait},
      {lost, {.lost = true, .ambiguous = true}, lost, wait},
      {lost, {.by_candidate = true, .lost = true, .ambiguous = true}, lost, relocalise},
      {both_frozen, {.by_candidate = true, .moves = true, .tracked = true}, lost, relocalise},
      {lost, {.by_candidate = true, .moves = true, .tracked = true}, tracking, publish},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const IntegrityDecision decision = decide(cases[i].state, cases[i].evidence);
    EXPECT_EQ(decision.state, cases[i].to) << i;
    EXPECT_EQ(decision.action, cases[i].action) << i;
  }
}

/// Whatever came before, and however long: frozen and lost are never valid, and cameras that see motion again
/// lead back to tracking, by the running track at once, by a candidate in two pairs.
TEST(IntegrityMonitor, IsSafeAndRecoversAfterAnyEvidence) {
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> any(0, possibleEvidence().size() - 1);
  IntegrityMonitor monitor{StereoMasks{}};
  for (int i = 0; i < 100'000; ++i) {
    const IntegrityState before = monitor.state();
    const IntegrityAction action = monitor.update(possibleEvidence()[any(random)]);
    if (action == measure) {
      EXPECT_EQ(monitor.state(), before);
      continue;
    }
    EXPECT_EQ(action == publish, isValidState(monitor.state())) << i;
    EXPECT_EQ(decide(monitor.state(), {.moves = true, .tracked = true}).state, tracking);
    const E candidate{.by_candidate = true, .moves = true, .tracked = true};
    EXPECT_EQ(decide(decide(monitor.state(), candidate).state, candidate).state, tracking);
  }
}

constexpr std::int64_t kPeriod = 50'000'000;  // ns

/// Images of stripes of one grey each, apart from a part that changes from pair to pair.
StereoImages imagesOf(int pair, int left, int right) {
  const auto image = [&](int grey) {
    cv::Mat all(64, 100, CV_8UC1, cv::Scalar(grey));
    for (int column = 0; column < all.cols; column += 2)
      all.col(column).setTo(grey + 100);
    all(cv::Rect(0, 0, 40, 10)).setTo(pair);
    return all;
  };
  return {image(left), image(right), pair * kPeriod, pair * kPeriod};
}

cv::Mat maskOfChanges() {
  cv::Mat mask(64, 100, CV_8UC1, cv::Scalar(1));
  mask(cv::Rect(0, 0, 40, 10)).setTo(0);
  return mask;
}

TEST(IntegrityMonitor, SeesEachImageThatRepeats) {
  IntegrityMonitor monitor({maskOfChanges(), maskOfChanges()});
  monitor.beginPair(imagesOf(0, 50, 60));
  EXPECT_FALSE(monitor.evidence().left_repeats || monitor.evidence().right_repeats);
  monitor.beginPair(imagesOf(1, 50, 61));
  EXPECT_TRUE(monitor.evidence().left_repeats);
  EXPECT_FALSE(monitor.evidence().right_repeats);
  monitor.beginPair(imagesOf(2, 51, 61));
  EXPECT_FALSE(monitor.evidence().left_repeats);
  EXPECT_TRUE(monitor.evidence().right_repeats);
}

TEST(IntegrityMonitor, ComparesWholeImagesWithoutAMask) {
  IntegrityMonitor monitor{StereoMasks{}};
  monitor.beginPair(imagesOf(0, 50, 60));
  monitor.beginPair(imagesOf(1, 50, 60));
  EXPECT_FALSE(monitor.evidence().left_repeats || monitor.evidence().right_repeats);
}

TEST(IntegrityMonitor, TakesUniformImagesForThoseOfACoveredLens) {
  IntegrityMonitor monitor{StereoMasks{}};
  const cv::Mat covered(64, 100, CV_8UC1, cv::Scalar(16));
  for (int pair = 0; pair < 3; ++pair) {
    StereoImages images = imagesOf(0, 50, 60);
    images.right = covered;
    monitor.beginPair(images);
    EXPECT_EQ(monitor.evidence().left_repeats, pair > 0);
    EXPECT_FALSE(monitor.evidence().right_repeats);
  }
}

TEST(IntegrityMonitor, BoundsBrakingFromTheLastValidMotion) {
  IntegrityMonitor monitor{StereoMasks{}};
  const auto at = [&](int pair) {
    monitor.beginPair(imagesOf(pair, pair, pair));
    return monitor.evidence().cannot_stop;
  };
  EXPECT_FALSE(at(0)) << "the speed is unknown";
  OdometryEstimate estimate;
  estimate.valid = true;
  estimate.time_step = 0.05;
  estimate.exposure_ns = 0;
  estimate.T_previous_current = Eigen::Translation3d(0.0, 0.0, 0.1);  // 2 m/s, braked to a stop in 0.2 s
  monitor.endPair(estimate);
  EXPECT_EQ(estimate.state, lost);
  OdometryEstimate invalid;
  for (int pair = 1; pair < 8; ++pair) {
    EXPECT_EQ(at(pair), pair < 4) << pair;
    monitor.endPair(invalid);
  }
}

/// The table as docs/integrity.md shows it.
std::string tableText() {
  const auto name = [](Condition condition) {
    for (const auto& [known, text] : kConditions)
      if (known == condition) return std::string(text);
    return std::string("?");
  };
  constexpr std::array<const char*, 6> kActions{"measure", "publish",    "reject",
                                                "wait",    "relocalise", "start an epoch"};
  std::string text = "| from | if | to | pair |\n| --- | --- | --- | --- |\n";
  for (const IntegrityTransition& row : integrityTransitions()) {
    std::string from, others, conditions;
    for (const IntegrityState state : kStates) {
      std::string& names = row.isFrom(state) ? from : others;
      names += (names.empty() ? "" : ", ") + std::string(kStateNames[static_cast<std::size_t>(state)]);
    }
    if (others.size() < from.size()) from = others.empty() ? "any" : "any but " + others;
    for (const Condition condition : row.with)
      if (condition != nullptr) conditions += (conditions.empty() ? "" : ", ") + name(condition);
    if (row.without != nullptr) conditions += ", not " + name(row.without);
    text += "| " + from + " | " + conditions + " | " + kStateNames[static_cast<std::size_t>(row.to)] + " | " +
            kActions[static_cast<std::size_t>(row.action)] + " |\n";
  }
  return text;
}

TEST(IntegrityTable, IsTheOneOfTheDocumentation) {
  const std::string page = test::contentsOf(test::sourceFolder() / "docs/integrity.md");
  EXPECT_NE(page.find(tableText()), std::string::npos) << "docs/integrity.md should contain:\n"
                                                       << tableText();
}

}  // namespace
}  // namespace cartvo::vo
