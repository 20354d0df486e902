// Checks of made-up pictures: light, sharpness, rows and static parts.
#include "tools/doctor/picture_checks.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "lab/render/rendered_world.hpp"
#include "support/doctor/findings.hpp"
#include "support/tools/wall_drive.hpp"
#include "tools/doctor/picture_measures.hpp"

namespace cartvo::doctor {
namespace {

using ::testing::HasSubstr;

Findings checked(const std::vector<PicturePair>& pairs, const calib::Rig* rig) {
  FindingList findings("pictures");
  checkPictures(pairs, rig, findings);
  return findings.take();
}

void expectFinding(const Findings& findings, const std::string& subject, Verdict verdict,
                   const std::string& advice) {
  const Finding finding = test::findingOf(findings, subject);
  EXPECT_EQ(finding.verdict, verdict) << subject << ": " << finding.seen;
  EXPECT_THAT(finding.advice, HasSubstr(advice)) << subject;
}

/// A raw pair of a rendered street, exposed at one instant, and its rig.
class StreetPair : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    world::WorldSettings settings;
    settings.seconds = 0.1;
    settings.lead_in_seconds = 0.0;
    settings.edge_samples = 0;
    const world::RenderedWorld world(settings);
    world.images(0, street_.left, street_.right);
    rig_ = world.rig();
  }
  static void TearDownTestSuite() { street_ = {}; }

  PicturePair pair_{street_.left.clone(), street_.right.clone(), 0, 0};

  static PicturePair street_;
  static calib::Rig rig_;
};
PicturePair StreetPair::street_;
calib::Rig StreetPair::rig_;

TEST_F(StreetPair, IsInOrder) {
  const Findings findings = checked({pair_}, &rig_);
  for (const char* subject :
       {"left camera, light", "right camera, light", "light, left against right", "left camera, sharpness",
        "right camera, sharpness", "sharpness, left against right", "rows, left against right"})
    expectFinding(findings, subject, Verdict::ok, "");
  EXPECT_THAT(test::findingOf(findings, "rows, left against right").seen, HasSubstr(" px (RMS), mean "));
  expectFinding(findings, "left camera, static parts", Verdict::not_checked, "cartvo calibrate mask");
}

TEST_F(StreetPair, IsDark) {
  pair_.left = 0.1 * pair_.left;
  const Findings findings = checked({pair_}, &rig_);
  expectFinding(findings, "left camera, light", Verdict::look_at, "is the lens covered");
  expectFinding(findings, "right camera, light", Verdict::ok, "");
  expectFinding(findings, "light, left against right", Verdict::look_at, "of both cameras alike");
}

TEST_F(StreetPair, IsOverexposed) {
  pair_.right = 3.0 * pair_.right;
  expectFinding(checked({pair_}, &rig_), "right camera, light", Verdict::look_at, "reduce the exposure");
}

TEST_F(StreetPair, IsBlurredInOneCamera) {
  cv::GaussianBlur(pair_.right, pair_.right, {}, 2.0);
  const Findings findings = checked({pair_}, &rig_);
  expectFinding(findings, "left camera, sharpness", Verdict::ok, "");
  expectFinding(findings, "right camera, sharpness", Verdict::look_at, "clean and focus the lens");
  expectFinding(findings, "sharpness, left against right", Verdict::look_at, "the lens of the right camera");
}

TEST_F(StreetPair, IsSlightlyBlurredInOneCamera) {
  cv::GaussianBlur(pair_.left, pair_.left, {}, 1.0);
  const Findings findings = checked({pair_}, &rig_);
  expectFinding(findings, "left camera, sharpness", Verdict::ok, "");
  expectFinding(findings, "sharpness, left against right", Verdict::look_at, "the lens of the left camera");
}

TEST_F(StreetPair, DoesNotFitTheRig) {
  calib::Rig turned = rig_;
  turned.T_right_left.prerotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()));
  expectFinding(checked({pair_}, &turned), "rows, left against right", Verdict::broken,
                "is it the rig file of these cameras?");
}

TEST_F(StreetPair, IsOkWithASmallTurnThatIsCorrectedWhileDriving) {
  calib::Rig turned = rig_;
  turned.T_right_left.prerotate(Eigen::AngleAxisd(0.0015, Eigen::Vector3d::UnitX()));  // 0.086 degrees
  const Finding rows = test::findingOf(checked({pair_}, &turned), "rows, left against right");
  EXPECT_EQ(rows.verdict, Verdict::ok) << rows.seen;
  EXPECT_THAT(rows.seen, HasSubstr(" px after a small turn, which cartvod corrects while driving"));
  EXPECT_THAT(rows.expected, HasSubstr("after a small turn of the right camera"));
}

TEST_F(StreetPair, SaysNothingAboutTheRigIfTheCartMayMove) {
  constexpr std::int64_t kOffset_ns = 20'000'000, kSecond_ns = 1'000'000'000;
  calib::Rig turned = rig_;
  turned.T_right_left.prerotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()));
  pair_.right_exposure_ns = kOffset_ns;
  const char* const rows = "rows, left against right";
  expectFinding(checked({pair_}, &turned), rows, Verdict::not_checked, "let the cart stand");
  // A second later the view is the same: the cart stands.
  PicturePair later{pair_.left.clone(), pair_.right.clone(), kSecond_ns, kSecond_ns + kOffset_ns};
  expectFinding(checked({pair_, later}, &turned), rows, Verdict::broken, "is it the rig file");
  cv::flip(later.left, later.left, 1);
  cv::flip(later.right, later.right, 1);
  expectFinding(checked({pair_, later}, &turned), rows, Verdict::not_checked, "let the cart stand");
}

TEST_F(StreetPair, IsExchanged) {
  std::swap(pair_.left, pair_.right);
  const Finding rows = test::findingOf(checked({pair_}, &rig_), "rows, left against right");
  EXPECT_EQ(rows.verdict, Verdict::broken);
}

TEST_F(StreetPair, OfAnotherSizeSaysNothingAboutTheRig) {
  calib::Rig small = rig_;
  small.left.size = small.right.size = {320, 240};
  expectFinding(checked({pair_}, &small), "rows, left against right", Verdict::not_checked,
                "set both cameras to the size of the rig file");
}

TEST_F(StreetPair, HasNoRig) {
  expectFinding(checked({pair_}, nullptr), "rows, left against right", Verdict::not_checked,
                "calibrate the cameras");
}

TEST(PictureChecks, OfNoPicturesSaySo) {
  const Findings findings = checked({}, nullptr);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings.front().verdict, Verdict::not_checked);
}

TEST(PictureChecks, OfPlainPicturesSayThatThereIsNothingToSee) {
  const cv::Mat plain(240, 320, CV_8UC1, cv::Scalar(128));
  const Findings findings = checked({{plain, plain, 0, 0}}, nullptr);
  expectFinding(findings, "left camera, sharpness", Verdict::not_checked, "a scene with texture");
  EXPECT_EQ(findings.front().verdict, Verdict::look_at);
}

/// Pairs of a drive, four a second, with the bonnet in the left picture.
std::vector<PicturePair> driveWithBonnet() {
  test::WallDrive left, right;
  left.showBonnet();
  std::vector<PicturePair> pairs;
  for (std::int64_t i = 0; i < 40; ++i)
    pairs.push_back({left.next(), right.next(), i * 260'000'000, i * 260'000'000});
  return pairs;
}

TEST(PictureChecks, FindTheBonnetInADrive) {
  const Findings findings = checked(driveWithBonnet(), nullptr);
  expectFinding(findings, "left camera, static parts", Verdict::look_at, "'cartvo calibrate mask'");
  expectFinding(findings, "right camera, static parts", Verdict::ok, "");
}

TEST(PictureChecks, AreContentWithAMask) {
  calib::Rig rig;
  rig.left.size = rig.right.size = test::kWallView;
  rig.left.fx = rig.left.fy = rig.right.fx = rig.right.fy = 300.0;
  rig.left.cx = rig.right.cx = 160.0;
  rig.left.cy = rig.right.cy = 100.0;
  rig.T_right_left.translation().x() = -0.12;
  rig.left.mask = calib::maskOfPolygons({{{40, 150}, {280, 150}, {280, 199}, {40, 199}}}, test::kWallView);
  const Finding finding = test::findingOf(checked(driveWithBonnet(), &rig), "left camera, static parts");
  EXPECT_EQ(finding.verdict, Verdict::ok);
  EXPECT_EQ(finding.seen, "19 % of the picture is masked");
}

TEST(PictureMeasures, LeaveMaskedPixelsOut) {
  cv::Mat picture(100, 100, CV_8UC1, cv::Scalar(100)), used(100, 100, CV_8UC1, cv::Scalar(255));
  picture.rowRange(0, 50).setTo(0);
  used.rowRange(0, 50).setTo(0);
  EXPECT_EQ(measurePicture(picture, used).mean, 100.0);
  EXPECT_EQ(measurePicture(picture, used).black, 0.0);
  EXPECT_EQ(measurePicture(picture, {}).mean, 50.0);
  EXPECT_EQ(measurePicture(picture, {}).black, 0.5);
}

}  // namespace
}  // namespace cartvo::doctor
