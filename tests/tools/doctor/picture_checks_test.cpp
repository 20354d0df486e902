// Checks of made-up pictures: light, sharpness, rows and static parts. The figures of the report hold the
// pictures themselves, scaled down. Pairs that are kept for the checks, consecutive and spread ones.
#include "tools/doctor/picture_checks.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/base64.hpp"
#include "lab/render/rendered_world.hpp"
#include "support/calib/rigs.hpp"
#include "support/doctor/findings.hpp"
#include "support/tools/wall_drive.hpp"
#include "tools/doctor/cameras/kept_pairs.hpp"
#include "tools/doctor/picture_figures.hpp"
#include "tools/doctor/picture_measures.hpp"

namespace cartvo::doctor {
namespace {

using testing::HasSubstr;

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

/// The embedded pictures, decoded.
std::vector<cv::Mat> picturesIn(const std::string& html) {
  const std::string start = "src=\"data:image/jpeg;base64,";
  std::vector<cv::Mat> pictures;
  for (std::size_t at = html.find(start); at != std::string::npos; at = html.find(start, at)) {
    at += start.size();
    const auto jpeg = decodeBase64(html.substr(at, html.find('"', at) - at));
    if (!jpeg) {
      ADD_FAILURE() << "no base64";
      return pictures;
    }
    pictures.push_back(
        cv::imdecode(std::vector<unsigned char>(jpeg->begin(), jpeg->end()), cv::IMREAD_GRAYSCALE));
  }
  return pictures;
}

PicturePair plainPair(const cv::Size& size) {
  return {cv::Mat(size, CV_8UC1, cv::Scalar(60)), cv::Mat(size, CV_8UC1, cv::Scalar(200)), 0, 0};
}

TEST(PictureFigures, AreBothPicturesAndBothRectifiedAtHalfStrength) {
  const calib::Rig rig = test::cartRig();
  const std::string html = pictureFigures(plainPair(rig.left.size), &rig);
  const std::vector<cv::Mat> pictures = picturesIn(html);
  ASSERT_EQ(pictures.size(), 3U);
  for (const cv::Mat& picture : pictures)
    EXPECT_EQ(picture.size(), rig.left.size);
  const cv::Point between_lines(340, 26);
  EXPECT_NEAR(pictures[0].at<unsigned char>(between_lines), 60, 2);
  EXPECT_NEAR(pictures[1].at<unsigned char>(between_lines), 200, 2);
  EXPECT_NEAR(pictures[2].at<unsigned char>(between_lines), 130, 2);
  EXPECT_THAT(html, HasSubstr("alt=\"picture of the left camera, 680x420 px, not rectified\""));
  EXPECT_THAT(html, HasSubstr("alt=\"picture of the right camera, "));
  EXPECT_THAT(html, HasSubstr("alt=\"both pictures, rectified with the rig file, "));
}

TEST(PictureFigures, AreScaledDown) {
  const std::vector<cv::Mat> pictures = picturesIn(pictureFigures(plainPair({1920, 1080}), nullptr));
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[0].size(), cv::Size(960, 540));
}

TEST(PictureFigures, LeaveOutTheOverlayOfARigForOtherPictures) {
  const calib::Rig rig = test::cartRig();
  EXPECT_EQ(picturesIn(pictureFigures(plainPair({640, 480}), &rig)).size(), 2U);
}

/// Pairs 0.05 s apart.
KeptPairs keep(int count, cv::Size size) {
  PairKeeper keeper;
  for (int i = 0; i < count; ++i) {
    capture::FramePair pair;
    pair.left.image = cv::Mat::zeros(size, CV_8UC1);
    pair.right.image = cv::Mat::zeros(size, CV_8UC1);
    pair.left.exposure_ns = pair.right.exposure_ns = i * 50'000'000LL;
    keeper.add(std::move(pair));
  }
  return keeper.take();
}

double exposure(const capture::FramePair& pair) {
  return 1e-9 * static_cast<double>(pair.left.exposure_ns);
}

TEST(PairKeeper, KeepsAllOfAFew) {
  const KeptPairs kept = keep(20, {8, 8});
  EXPECT_EQ(kept.consecutive.size(), 20U);
  EXPECT_EQ(kept.spread.size(), 4U);
}

TEST(PairKeeper, SpreadsPairsOverTheWholeTime) {
  const KeptPairs kept = keep(2400, {8, 8});
  ASSERT_GE(kept.spread.size(), 40U);
  ASSERT_LE(kept.spread.size(), 80U);
  EXPECT_EQ(exposure(kept.spread.front()), 0.0);
  const double distance = exposure(kept.spread[1]);
  for (std::size_t i = 1; i < kept.spread.size(); ++i)
    EXPECT_NEAR(exposure(kept.spread[i]) - exposure(kept.spread[i - 1]), distance, 1e-6);
  EXPECT_GE(exposure(kept.spread.back()), 119.95 - distance - 1e-6);
}

TEST(PairKeeper, KeepsTheLastConsecutivePairs) {
  const KeptPairs kept = keep(2400, {8, 8});
  ASSERT_EQ(kept.consecutive.size(), 40U);
  EXPECT_DOUBLE_EQ(exposure(kept.consecutive.front()), 118.0);
  EXPECT_DOUBLE_EQ(exposure(kept.consecutive.back()), 119.95);
}

TEST(PairKeeper, KeepsFewerLargePairs) {
  const KeptPairs kept = keep(120, {4000, 1500});  // 12 MB each
  EXPECT_EQ(kept.consecutive.size(), 12U);
  EXPECT_LE(kept.spread.size(), 25U);
  EXPECT_GE(kept.spread.size(), 12U);
}

}  // namespace
}  // namespace cartvo::doctor
