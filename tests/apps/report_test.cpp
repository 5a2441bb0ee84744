#include "orbifit/apps/report.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "orbifit/model/errors.h"

#include "count.h"

namespace orbifit {
namespace {

ReportPicture picture(const std::string& caption) {
  return {encode_png({2, 3, std::vector<std::uint8_t>(18, 7)}), caption};
}

Report sample() {
  Report report;
  report.title = "A <b>bold</b> & \"quoted\" title";
  report.intro = "First.\n\nSecond, with <script>alert('x')</script>.";
  ReportSection detect;
  detect.title = "Detect";
  detect.pictures = {picture("before"), picture("a < b")};
  detect.tables = {{{"region", "group", "residual"}, {{"seat", "C4v", "1e-17"}, {"leg & foot", "Cs", "< 2e-3"}}}};
  detect.notes = {"small > print"};
  report.sections = {detect, {"Check", "Fine.", {picture("")}, {}, {}}};
  return report;
}

// Every tag that opens closes, in order.
void expect_nested(const std::string& page) {
  const std::vector<std::string> empty{"!DOCTYPE", "meta", "img"};
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at)) {
    const std::size_t end = page.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const bool closes = page[at + 1] == '/';
    const std::size_t first = at + (closes ? 2 : 1);
    const std::string name = page.substr(first, page.find_first_of(" >", first) - first);
    at = end + 1;
    if (closes) {
      ASSERT_FALSE(open.empty()) << name;
      ASSERT_EQ(open.back(), name);
      open.pop_back();
    } else if (std::find(empty.begin(), empty.end(), name) == empty.end()) {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(ToHtml, EscapesEveryText) {
  const std::string page = to_html(sample());
  EXPECT_EQ(count(page, "<script"), 0U);
  EXPECT_EQ(count(page, "<b>"), 0U);
  EXPECT_EQ(count(page, "A &lt;b&gt;bold&lt;/b&gt; &amp; &quot;quoted&quot; title"), 2U);  // title and heading
  EXPECT_EQ(count(page, "alert(&#39;x&#39;)"), 1U);
  EXPECT_EQ(count(page, "leg &amp; foot"), 1U);
  EXPECT_EQ(count(page, "small &gt; print"), 1U);
  EXPECT_EQ(count(page, "alt=\"a &lt; b\""), 1U);
}

TEST(ToHtml, IsNestedAndNeedsNothingElse) {
  const std::string page = to_html(sample());
  expect_nested(page);
  EXPECT_EQ(count(page, "<img "), 3U);
  EXPECT_EQ(count(page, "<img src=\"data:image/png;base64,"), 3U);
  EXPECT_EQ(count(page, "width=\"2\" height=\"3\""), 3U);
  EXPECT_EQ(count(page, base64(picture("").png)), 3U);
  EXPECT_EQ(count(page, "://"), 0U);
  EXPECT_EQ(count(page, "url("), 0U);
  EXPECT_EQ(count(page, "<link"), 0U);
}

TEST(ToHtml, HasASectionEachAndALinkToIt) {
  const std::string page = to_html(sample());
  EXPECT_EQ(count(page, "<section "), 2U);
  EXPECT_EQ(count(page, "href=\"#step-2\""), 1U);
  EXPECT_EQ(count(page, "id=\"step-2\""), 1U);
  EXPECT_LT(page.find("Detect</h2>"), page.find("Check</h2>"));
}

TEST(ToHtml, PartsParagraphsAtBlankLines) {
  const std::string page = to_html(sample());
  EXPECT_EQ(count(page, "<p>First.</p>"), 1U);
  EXPECT_EQ(count(page, "<p>Second,"), 1U);
}

TEST(ToHtml, AlignsColumnsOfNumbersOnly) {
  const std::string page = to_html(sample());
  EXPECT_EQ(count(page, "<th class=\"number\">residual</th>"), 1U);
  EXPECT_EQ(count(page, "<td class=\"number\">1e-17</td>"), 1U);
  EXPECT_EQ(count(page, "<th>group</th>"), 1U);
}

TEST(ToHtml, ShowsTheCommandWhatItPrintedAndItsFiles) {
  Report report;
  report.sections.resize(1);
  ReportSection& section = report.sections[0];
  section.title = "Check";
  section.command = "orbifit check a.obj a.json < b";
  section.output =
      "  region  group  rest max %  name\n"
      "       0  C4v            12  seat and legs\n"
      "      11  Cs          1e-13\n"
      "Distances are in percent.\n"
      "   x <y>\n"
      "Sizes:\n"
      "  vertices    246\n"
      "  triangles  1384\n";
  section.files = {{"out/a b#1.json", "a b#1.json"}};
  const std::string page = to_html(report);
  expect_nested(page);
  EXPECT_EQ(count(page, "<pre class=\"command\">orbifit check a.obj a.json &lt; b</pre>"), 1U);
  EXPECT_EQ(count(page, "<th class=\"number\">rest max %</th>"), 1U);
  EXPECT_EQ(count(page, "<td>seat and legs</td>"), 1U);
  EXPECT_EQ(count(page, "<td class=\"number\">1e-13</td>"), 1U);
  EXPECT_EQ(count(page, "<tr>"), 3U);
  EXPECT_EQ(count(page, "<pre class=\"output prose\">Distances are in percent.\n</pre>"), 1U);
  EXPECT_EQ(count(page, "   x &lt;y&gt;"), 1U);       // one line is no table; its blanks stay
  EXPECT_EQ(count(page, "  vertices    246\n"), 1U);  // nor are lines without headers
  EXPECT_EQ(count(page, "<a href=\"out/a%20b%231.json\">a b#1.json</a>"), 1U);
}

TEST(ToHtml, SetsTheFirstLineOfACaptionApart) {
  Report report;
  report.sections.push_back({"Regions", "", {picture("region 0  C4v: seat\n12 % of the area")}, {}, {}});
  EXPECT_EQ(count(to_html(report), "<figcaption><b>region 0  C4v: seat</b>12 % of the area</figcaption>"), 1U);
}

TEST(ToHtml, RefusesWhatDoesNotMatch) {
  Report report = sample();
  report.sections[0].tables[0].rows[0].pop_back();
  EXPECT_THROW(to_html(report), UsageError);
  report = sample();
  report.sections[0].pictures[0].png = "GIF89a, or so it says, but it is long enough to be one";
  EXPECT_THROW(to_html(report), UsageError);
}

TEST(ToHtml, OfNothingIsStillAPage) {
  expect_nested(to_html({}));
}

// RFC 4648, section 10.
TEST(Base64, GivesTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

}  // namespace
}  // namespace orbifit
