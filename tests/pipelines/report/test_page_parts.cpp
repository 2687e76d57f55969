// Words, numbers, tables, charts and published figures of the page.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "chart.hpp"
#include "cohort.hpp"
#include "core/errors.hpp"
#include "html.hpp"
#include "published.hpp"
#include "run_data.hpp"

namespace valsalva::report {
namespace {

TEST(Quantity, SplitsWordsAndUnit) {
  EXPECT_EQ(quantity("mean_gradient_mmHg").words, "Mean gradient");
  EXPECT_EQ(quantity("mean_gradient_mmHg").unit, "mmHg");
  EXPECT_EQ(quantity("aortic_flow_mL_per_s").unit, "mL/s");
  EXPECT_EQ(quantity("cycle.eoa_cm2").words, "Effective orifice area");
  EXPECT_EQ(quantity("cycle.eoa_cm2").unit, "cm²");
  EXPECT_EQ(quantity("eccentricity").unit, "");
}

TEST(Number, RoundsToSignificantDigits) {
  EXPECT_EQ(number(84.2712), "84.27");
  EXPECT_EQ(number(0.00123456, 3), "0.00123");
  EXPECT_EQ(number(12345.6), "12346");
  EXPECT_EQ(number(5), "5");
  EXPECT_EQ(number(NAN), "–");
  EXPECT_EQ(number(0), "0");
}

TEST(Html, EscapesAndEncodes) {
  EXPECT_EQ(escape("a<b & \"c\">"), "a&lt;b &amp; &quot;c&quot;&gt;");
  EXPECT_EQ(base64("Man"), "TWFu");
  EXPECT_EQ(base64("Ma"), "TWE=");
  EXPECT_EQ(base64(""), "");
}

TEST(Csv, HonoursQuotesAndEmptyCells) {
  const auto cells = parse_csv("a,b\n\"x, \"\"y\"\"\",\n1,2\r\n");
  ASSERT_EQ(cells.size(), 3u);
  EXPECT_EQ(cells[1][0], "x, \"y\"");
  EXPECT_EQ(cells[1][1], "");
  EXPECT_EQ(cells[2][1], "2");
  const Series series = series_of(cells);
  EXPECT_TRUE(std::isnan(series.columns[0][0]));
  EXPECT_EQ(series.columns[1][1], 2);
}

TEST(Ticks, AreRoundAndCoverTheRange) {
  EXPECT_EQ(ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  const auto t = ticks(-0.31, 0.42, 5);
  EXPECT_GE(t.front(), -0.31);
  EXPECT_LE(t.back(), 0.42);
  EXPECT_NEAR(t[1] - t[0], 0.2, 1e-12);
}

TEST(Thinned, KeepsTheExtremes) {
  Line line;
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 77777 ? 50 : i == 12345 ? -50 : std::sin(0.001 * i));
  }
  const Line thin = thinned(line, 1000);
  EXPECT_LE(thin.x.size(), 1000u);
  EXPECT_EQ(*std::max_element(thin.y.begin(), thin.y.end()), 50);
  EXPECT_EQ(*std::min_element(thin.y.begin(), thin.y.end()), -50);
  EXPECT_TRUE(std::is_sorted(thin.x.begin(), thin.x.end()));
}

TEST(Chart, DrawsALineAndLeavesOutWhatIsNotFinite) {
  Chart chart{"Flow", "Time (s)", "mL/s", {{"Flow", {0, 1, 2, 3}, {0, NAN, 5, 1}}}};
  const std::string out = svg(chart);
  EXPECT_NE(out.find("<path"), std::string::npos);
  EXPECT_EQ(out.find("nan"), std::string::npos);
  chart.lines[0].y = {NAN, NAN, NAN, NAN};
  EXPECT_EQ(svg(chart), "");
}

TEST(Chart, ConstantLineIsDrawn) {
  EXPECT_NE(svg({"dt", "t", "s", {{"dt", {0, 1}, {3, 3}}}}).find("<path"), std::string::npos);
}

TEST(ChartsByUnit, PressuresTogetherGradientApartStepInMicroseconds) {
  Series s;
  s.names = {"time_s", "lv_pressure_mmHg", "aortic_pressure_mmHg", "gradient_mmHg", "dt_s"};
  s.columns = {{0, 1}, {10, 120}, {80, 119}, {-70, 1}, {1e-5, 2e-5}};
  const auto charts = charts_by_unit(s, "time_s");
  ASSERT_EQ(charts.size(), 3u);
  EXPECT_EQ(charts[0].lines.size(), 2u);
  EXPECT_EQ(charts[0].y_label, "mmHg");
  EXPECT_EQ(charts[1].y_label, "mmHg");
  EXPECT_EQ(charts[2].y_label, "µs");
  EXPECT_NEAR(charts[2].lines[0].y[1], 20, 1e-9);
}

TEST(Published, BuiltInFileParsesAndHasTheClinicalRange) {
  bool found = false;
  for (const PublishedFigure& f : published().figures)
    if (f.metric == "mean_gradient_mmHg" && f.low) {
      found = true;
      EXPECT_NEAR(0.5 * (*f.low + *f.high), 7.53, 1e-9);
      EXPECT_EQ(f.compare(7.0), "inside");
      EXPECT_EQ(f.compare(3.0), "below");
      EXPECT_EQ(f.compare(30.0), "above");
    }
  EXPECT_TRUE(found);
}

TEST(Published, SingleFigureIsComparedInPerCent) {
  PublishedFigure f;
  f.value = 10;
  EXPECT_EQ(f.compare(9), "−10 %");
  EXPECT_EQ(f.compare(12.5), "+25 %");
}

TEST(Published, CaseBeginningsDecideWhatIsShown) {
  PublishedFigure f;
  EXPECT_TRUE(f.concerns("demo"));
  f.cases = {"native"};
  EXPECT_TRUE(f.concerns("native-stenotic"));
  EXPECT_FALSE(f.concerns("tavr-evolut26"));
}

TEST(Published, EntryWithoutRangeOrValueIsRefused) {
  EXPECT_THROW(
      parse_published("[sources.a]\ntitle='t'\n[[figure]]\nmetric='m'\nstage='s'\nsource='a'\n", "x.toml"),
      InputError);
  EXPECT_THROW(parse_published("[[figure]]\nmetric='m'\nstage='s'\nsource='a'\nvalue=1.0\n", "x.toml"),
               InputError);
}

class CohortPage : public ::testing::Test {
 protected:
  void SetUp() override {
    folder =
        std::filesystem::temp_directory_path() /
        ("valsalva_cohort_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "cohort-a");
    std::filesystem::create_directories(folder / "one");
    std::ofstream(folder / "one" / "report.html") << "<!DOCTYPE html>";
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::filesystem::path write(const std::string& text) {
    const auto csv = folder / "cohort-a" / "cohort.csv";
    std::ofstream(csv) << text;
    return csv;
  }
  std::filesystem::path folder;
};

TEST_F(CohortPage, LinksReportsAndMarksFailures) {
  const auto csv = write(
      "name,status,cycle.mean_gradient_mmHg,cycle.max_cfl,message\none,ok,8.5,0.3,\ntwo,failed (3),,,\"no "
      "<mesh>\"\n");
  const std::string html = cohort_page(csv, csv.parent_path() / "cohort.html");
  EXPECT_NE(html.find("href=\"../one/report.html\""), std::string::npos);
  EXPECT_NE(html.find("<span class=\"fail\">failed (3)</span>"), std::string::npos);
  EXPECT_NE(html.find("no &lt;mesh&gt;"), std::string::npos);
  EXPECT_NE(html.find("2 cases, 1 of them not finished"), std::string::npos);
  EXPECT_NE(html.find("Mean gradient (mmHg)"), std::string::npos);
}

TEST_F(CohortPage, RefusesATableWithoutCases) {
  EXPECT_THROW(cohort_page(write("name,status\n"), "x.html"), InputError);
  EXPECT_THROW(cohort_page(folder / "none.csv", "x.html"), InputError);
  EXPECT_THROW(cohort_page(write("name,status\none\n"), "x.html"), InputError);
}

}  // namespace
}  // namespace valsalva::report
