// Texts, JSON and HTML of findings.
#include "tools/doctor/report.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/doctor/finding_list.hpp"

namespace cartvo::doctor {
namespace {

using testing::HasSubstr;
using testing::Not;

Findings example() {
  FindingList list("left camera");
  list.add("size", Verdict::ok, {"680x420", "680x420", "advice that is not needed"});
  list.add("wdr", Verdict::look_at, {"<open>", "off & \"closed\"", "cartvo camera apply wdr"});
  list.add("login", Verdict::broken, {"re\x1b[31mfused", "", "correct the password"});
  list.add("stream", Verdict::not_checked, {"no login"});
  return list.take();
}

const ReportHead kHead{"cart", "2026-05-04 10:00:00 UTC", "1.2.3", "/etc/cartvo/cartvod.yaml"};

TEST(DoctorReport, PrintsALineForEachFindingAndWhatToDoAboutIt) {
  EXPECT_EQ(areaText(example()),
            "left camera\n"
            "  ok           size: 680x420\n"
            "  look at      wdr: <open>\n"
            "               expected  off & \"closed\"\n"
            "               do        cartvo camera apply wdr\n"
            "  broken       login: re\\x1b[31mfused\n"
            "               do        correct the password\n"
            "  not checked  stream: no login\n");
  EXPECT_EQ(areaText({}), "");
  EXPECT_EQ(countsText(example()), "1 broken, 1 to look at, 1 ok, 1 not checked");
}

TEST(DoctorReport, TheWorstVerdictCounts) {
  EXPECT_EQ(worstVerdict({}), Verdict::ok);
  EXPECT_EQ(worstVerdict({example()[3]}), Verdict::ok);
  EXPECT_EQ(worstVerdict({example()[0], example()[1]}), Verdict::look_at);
  EXPECT_EQ(worstVerdict(example()), Verdict::broken);
}

TEST(DoctorReport, NamesTheWorstFirst) {
  EXPECT_EQ(namesText(example()), "broken: left camera, login\nlook at: left camera, wdr\n");
  EXPECT_EQ(namesText({example()[0], example()[3]}), "");
  const std::string html = htmlReport(kHead, example(), {}, nullptr);
  EXPECT_LT(html.find("left camera, login"), html.find("left camera, wdr"));
  EXPECT_LT(html.find("left camera, wdr"), html.find("<details>"));
}

TEST(DoctorReport, WritesJson) {
  const nlohmann::ordered_json json = findingsJson(kHead, example());
  EXPECT_EQ(json["verdict"], "broken");
  EXPECT_EQ(json["source"], "/etc/cartvo/cartvod.yaml");
  EXPECT_EQ(json["counts"]["not_checked"], 1);
  EXPECT_EQ(json["findings"][0]["advice"], "");
  EXPECT_EQ(json["findings"][1]["verdict"], "look_at");
  EXPECT_EQ(json["findings"][1]["area"], "left camera");
}

TEST(DoctorReport, WritesAPageThatNeedsNoOtherFile) {
  const std::string html = htmlReport(
      kHead, example(),
      {{cv::Mat(4, 6, CV_8UC1, cv::Scalar(7)), cv::Mat(4, 6, CV_8UC1, cv::Scalar(9)), 0, 0}}, nullptr);
  EXPECT_THAT(html, HasSubstr("<td>&lt;open&gt;</td><td>off &amp; &quot;closed&quot;</td>"));
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(html, HasSubstr("src=\"data:image/jpeg;base64,"));
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("\x1b")));
  EXPECT_THAT(htmlReport(kHead, {}, {}, nullptr), Not(HasSubstr("<img")));
}

}  // namespace
}  // namespace cartvo::doctor
