// Rectification tables and the file that stores them.
#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "common/atomic_file.hpp"
#include "common/digest.hpp"
#include "support/calib/rigs.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;

/// A small rig, to keep the tests fast.
Rig smallRig() {
  Rig rig = test::cartRig();
  for (CameraModel* camera : {&rig.left, &rig.right}) {
    camera->size = {170, 105};
    for (double* value : {&camera->fx, &camera->fy, &camera->cx, &camera->cy})
      *value /= 4.0;
  }
  return rig;
}

class TablesFile : public ::testing::Test {
 protected:
  LoadedTables loadOrBuild(const Rig& rig) const { return loadOrBuildTables(rig, {}, file_); }

  const Rig rig_ = smallRig();
  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "tables.bin";
};

TEST(RectificationTables, AgreeWithUndistortPoints) {
  const Rig rig = test::cartRig();
  const Rectification rectification = computeRectification(rig, {});
  const RectificationTables tables = buildTables(rig, {});
  const auto check = [&](const CameraModel& camera, const Eigen::Matrix3d& R, const PixelSources& sources) {
    std::vector<cv::Point2d> raw;
    for (std::size_t i = 0; i < sources.column.size(); i += 37) {
      raw.emplace_back(sources.column[i] + sources.column_fraction[i] / 256.0,
                       sources.row[i] + sources.row_fraction[i] / 256.0);
    }
    const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    const cv::Matx33d P(rectification.focal_length, 0, rectification.cx, 0, rectification.focal_length,
                        rectification.cy, 0, 0, 1);
    cv::Matx33d R_cv;
    for (int i = 0; i < 9; ++i)
      R_cv.val[i] = R(i / 3, i % 3);
    std::vector<cv::Point2d> rectified;
    cv::undistortPoints(raw, rectified, K, camera.distortion, R_cv, P,
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 200, 1e-12));
    double largest = 0.0;
    for (std::size_t k = 0; k < rectified.size(); ++k) {
      const auto pixel = static_cast<int>(37 * k);
      const int row = pixel / tables.size.width;
      const int column = pixel % tables.size.width;
      largest = std::max({largest, std::abs(rectified[k].x - column), std::abs(rectified[k].y - row)});
    }
    // Half of 1/256 px in the raw image, which the distortion stretches towards the corners.
    EXPECT_LT(largest, 2.0 / 512.0);
  };
  check(rig.left, rectification.R_rectified_left, tables.left);
  check(rig.right, rectification.R_rectified_right, tables.right);
}

TEST(RectificationTables, AreDeterministic) {
  EXPECT_EQ(buildTables(smallRig(), {}), buildTables(smallRig(), {}));
}

TEST(RectificationTables, HaveTheSameBitsOnEachMachine) {
  const RectificationTables tables = buildTables(smallRig(), {});
  const auto hash = [](const auto& values) {
    return digestOf({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values.front())});
  };
  // Recorded on x86-64. A change of the method changes these hashes and requires a new kTablesVersion.
  EXPECT_EQ(hash(tables.left.column) ^ hash(tables.left.row_fraction), 6261850614025694950u);
  EXPECT_EQ(hash(tables.right.row) ^ hash(tables.right.column_fraction), 10538749160072467612u);
}

TEST(RectificationTables, FingerprintDependsOnCamerasRelativePoseAndSettings) {
  const std::uint64_t fingerprint = tablesFingerprint(test::cartRig(), {});
  const auto differs = [&](auto change) {
    Rig rig = test::cartRig();
    change(rig);
    return tablesFingerprint(rig, {}) != fingerprint;
  };
  EXPECT_TRUE(differs([](Rig& rig) { rig.left.fx += 1e-9; }));
  EXPECT_TRUE(differs([](Rig& rig) { rig.right.distortion[7] = 1e-9; }));
  EXPECT_TRUE(differs([](Rig& rig) { rig.T_right_left.translation().z() += 1e-9; }));
  EXPECT_TRUE(differs([](Rig& rig) { rig.right.size.width += 1; }));
  EXPECT_NE(tablesFingerprint(test::cartRig(), {.free_scaling = 0.5}), fingerprint);
  EXPECT_FALSE(differs([](Rig& rig) { rig.name = "another name"; }));
  EXPECT_FALSE(differs([](Rig& rig) { rig.T_body_camera.translation().z() += 1.0; }));
}

TEST_F(TablesFile, IsWrittenOnceAndThenLoaded) {
  const LoadedTables first = loadOrBuild(rig_);
  EXPECT_EQ(first.origin, TablesOrigin::first_built);
  const LoadedTables second = loadOrBuild(rig_);
  EXPECT_EQ(second.origin, TablesOrigin::loaded);
  EXPECT_EQ(second.tables, first.tables);
  EXPECT_EQ(first.tables, buildTables(rig_, {}));
}

TEST_F(TablesFile, IsRebuiltWhenTheRigChanges) {
  loadOrBuild(rig_);
  Rig changed = rig_;
  changed.right.cx += 0.5;
  const LoadedTables rebuilt = loadOrBuild(changed);
  EXPECT_EQ(rebuilt.origin, TablesOrigin::rig_changed);
  EXPECT_THAT(rebuilt.message, HasSubstr("the rig's calibration has changed"));
  EXPECT_EQ(rebuilt.tables, buildTables(changed, {}));
  EXPECT_EQ(loadOrBuild(changed).origin, TablesOrigin::loaded);
}

TEST_F(TablesFile, IsRebuiltWhenTheImageSizeChanges) {
  loadOrBuild(rig_);
  Rig changed = rig_;
  changed.left.size.height = changed.right.size.height = 104;
  const LoadedTables rebuilt = loadOrBuild(changed);
  EXPECT_EQ(rebuilt.origin, TablesOrigin::rig_changed);
  EXPECT_THAT(rebuilt.message, HasSubstr("is for images of 170x105, the rig's are 170x104"));
}

TEST_F(TablesFile, IsRebuiltWhenAnyByteIsDamaged) {
  loadOrBuild(rig_);
  const std::string whole = test::contentsOf(file_);
  for (const std::size_t at : {std::size_t{0}, std::size_t{9}, std::size_t{22}, std::size_t{28},
                               whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    writeFileAtomically(file_, damaged);
    const LoadedTables rebuilt = loadOrBuild(rig_);
    EXPECT_EQ(rebuilt.origin, TablesOrigin::damaged) << "byte " << at;
    EXPECT_THAT(rebuilt.message, HasSubstr(file_.string()));
    EXPECT_EQ(test::contentsOf(file_), whole);
  }
}

TEST_F(TablesFile, IsRebuiltWhenItIsCutShortOrTooLong) {
  loadOrBuild(rig_);
  const std::string whole = test::contentsOf(file_);
  for (const std::size_t length : {std::size_t{0}, std::size_t{10}, std::size_t{36}, whole.size() - 1}) {
    writeFileAtomically(file_, whole.substr(0, length));
    const LoadedTables rebuilt = loadOrBuild(rig_);
    EXPECT_EQ(rebuilt.origin, TablesOrigin::damaged) << length;
    EXPECT_THAT(rebuilt.message, HasSubstr("is cut short"));
  }
  writeFileAtomically(file_, whole + "more");
  EXPECT_EQ(loadOrBuild(rig_).origin, TablesOrigin::damaged);
}

TEST_F(TablesFile, IsRefusedIfItPointsOutsideTheImageDespiteAValidChecksum) {
  RectificationTables tables = buildTables(rig_, {});
  tables.left.column[3] = 169;  // the last column: its right neighbour does not exist
  writeTables(file_, tables);
  const LoadedTables rebuilt = loadOrBuild(rig_);
  EXPECT_EQ(rebuilt.origin, TablesOrigin::damaged);
  EXPECT_THAT(rebuilt.message, HasSubstr("points outside the raw image"));
}

TEST_F(TablesFile, ReportsAWriteErrorAndReturnsTheTables) {
  const LoadedTables built = loadOrBuildTables(rig_, {}, folder_ / "no-such-folder/tables.bin");
  EXPECT_EQ(built.origin, TablesOrigin::first_built);
  EXPECT_THAT(built.message, HasSubstr("the tables could not be saved"));
  EXPECT_EQ(built.tables, buildTables(rig_, {}));
}

TEST_F(TablesFile, IsNotNeededForARectifiedRig) {
  const LoadedTables loaded = loadOrBuildTables(test::rectifiedRig(), {}, file_);
  EXPECT_TRUE(loaded.tables.left.column.empty());
  EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace cartvo::calib
