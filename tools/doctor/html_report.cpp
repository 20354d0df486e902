// The HTML report of findings.
#include <fmt/format.h>

#include "tools/doctor/picture_figures.hpp"
#include "tools/doctor/report.hpp"
#include "tools/report/html.hpp"

namespace cartvo::doctor {
namespace {

constexpr const char* kStyle =
    ":root{--ok:#183;--look:#a60;--bad:#c22}"
    "@media(prefers-color-scheme:dark){:root{--ok:#5c7;--look:#eb4;--bad:#f77}}"
    "table{table-layout:fixed}th:nth-child(1){width:6em}th:nth-child(2){width:11em}"
    "th,td{overflow-wrap:break-word}td:first-child{white-space:nowrap}"
    // On a phone each row is a block, and its cells stand below each other.
    "@media(max-width:700px){table,tbody,tr,td{display:block}tr:first-child,td:empty{display:none}"
    "tr{border:1px solid var(--line);margin:.5em 0;padding:.3em .6em}td{border:0;padding:.1em 0}"
    "td:nth-child(2){font-weight:bold}td:nth-child(4)::before{content:'expected: '}"
    "td:nth-child(5)::before{content:'do: '}}"
    ".ok{color:var(--ok)}.look{color:var(--look);font-weight:bold}.broken{color:var(--bad);font-weight:bold}"
    ".pictures{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0;flex:1 1 min(500px,100%)}img{width:100%}";

/// `subject`: text of its cell.
std::string row(const Finding& finding, const std::string& subject) {
  return fmt::format("<tr><td class=\"{}\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                     namesOf(finding.verdict).css_class, namesOf(finding.verdict).text, escaped(subject),
                     escaped(finding.seen), escaped(finding.expected), escaped(finding.advice));
}

constexpr const char* kTableHead =
    "<table><tr><th>verdict</th><th>subject</th><th>seen</th><th>expected</th><th>do</th></tr>\n";

/// A table of the findings that are broken, then of those to look at; empty if there is neither.
std::string severeTable(const Findings& findings) {
  std::string html;
  for (const Finding& finding : bySeverity(findings))
    html += row(finding, finding.area + ", " + finding.subject);
  return html.empty() ? html : kTableHead + html + "</table>\n";
}

/// A table for each area, in their order.
std::string tables(const Findings& findings) {
  std::string html, area;
  for (const Finding& finding : findings) {
    if (html.empty() || finding.area != area) {
      html += (html.empty() ? "" : "</table>\n") + fmt::format("<h2>{}</h2>\n", escaped(finding.area)) +
              kTableHead;
      area = finding.area;
    }
    html += row(finding, finding.subject);
  }
  return html.empty() ? html : html + "</table>\n";
}

}  // namespace

std::string htmlReport(const ReportHead& head, const Findings& findings,
                       const std::vector<PicturePair>& pictures, const calib::Rig* rig) {
  return htmlPage(
      "cartvo doctor", kStyle,
      fmt::format("<h1>cartvo doctor</h1>\n<p>{} on {}, {}, cartvo {}</p>\n<p class=\"{}\">{}</p>\n",
                  escaped(head.source), escaped(head.host), escaped(head.time), escaped(head.version),
                  namesOf(worstVerdict(findings)).css_class, countsText(findings)) +
          severeTable(findings) + "<details><summary>all findings, by area</summary>\n" + tables(findings) +
          "</details>\n" +
          (pictures.empty()
               ? ""
               : "<h2>one pair of pictures</h2>\n" + pictureFigures(pictures[pictures.size() / 2], rig)));
}

}  // namespace cartvo::doctor
