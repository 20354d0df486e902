// Layout of boards on pages.
#include "tools/calibrate/board/board_sheet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"

namespace cartvo::calibrate {
namespace {

using ::testing::HasSubstr;

BoardSheet sheetOf(const char* board, const char* page) {
  return layOutBoard(calib::parseBoardSpec(board), page);
}

TEST(BoardSheet, UsesTheSmallestPageInTheFittingOrientation) {
  EXPECT_EQ(sheetOf("chessboard:9x6:0.025", "auto").page.name, "A4");
  EXPECT_EQ(sheetOf("chessboard:9x6:0.025", "auto").page.size, cv::Size2d(297, 210));
  EXPECT_EQ(sheetOf("chessboard:6x9:0.025", "auto").page.size, cv::Size2d(210, 297));
  EXPECT_EQ(sheetOf("charuco:11x8:0.03:0.022", "auto").page.name, "A3");
  EXPECT_EQ(sheetOf("aprilgrid:6x6:0.088:0.3", "auto").page.name, "A0");
}

TEST(BoardSheet, KeepsThePatternSizeAndSeparatesItFromTheRulers) {
  for (const char* page : {"auto", "A2", "700x900"}) {
    const BoardSheet sheet = sheetOf("chessboard:9x6:0.025", page);
    EXPECT_NEAR(sheet.pattern.width, 250.0, 1e-9);
    EXPECT_NEAR(sheet.pattern.height, 175.0, 1e-9);
    const cv::Rect2d paper({0.0, 0.0}, sheet.page.size);
    for (const cv::Rect2d& part : {sheet.pattern, sheet.horizontal_ruler, sheet.vertical_ruler})
      EXPECT_EQ(part & paper, part);
    EXPECT_GE(sheet.horizontal_ruler.y, sheet.pattern.br().y + 4.0);
    EXPECT_LE(sheet.vertical_ruler.br().x, sheet.pattern.x - 4.0);
    EXPECT_EQ(sheet.horizontal_ruler.width, 200.0);
    EXPECT_EQ(sheet.vertical_ruler.height, 170.0);
  }
}

TEST(BoardSheet, RefusesAPageThatIsTooSmallWithTheAvailableSize) {
  EXPECT_EQ(test::messageOf([] { sheetOf("charuco:11x8:0.03:0.022", "A4"); }),
            "the board is 330.0 x 240.0 mm and does not fit on A4, which has room for 273.0 x 178.0 mm");
  EXPECT_THAT(test::messageOf([] { sheetOf("aprilgrid:6x6:0.5:0.3", "auto"); }),
              HasSubstr("does not fit on A0"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "250x175"); }),
              HasSubstr("does not fit on 250x175 mm"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "A7"); }),
              HasSubstr("page 'A7': expected A4, A3, A2, A1, A0, auto, or WIDTHxHEIGHT in mm"));
  EXPECT_THAT(test::messageOf([] { sheetOf("chessboard:9x6:0.025", "10x10"); }),
              HasSubstr("each side must have 50 to 5000 mm"));
}

}  // namespace
}  // namespace cartvo::calibrate
