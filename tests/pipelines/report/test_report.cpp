// valsalva-report on made-up run folders, and its page in headless Chromium.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "run_data.hpp"
#include "synthetic.hpp"

namespace valsalva::report {
namespace {

namespace fs = std::filesystem;

/// The exit code of a shell command.
int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    folder =
        fs::temp_directory_path() /
        ("valsalva_report_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(folder / "synthetic.toml")
        << "[case]\ntitle = \"made up\"\n[report]\npicture_width_px = 240\n";
  }
  void TearDown() override { fs::remove_all(folder); }

  int make(const std::string& options = {}) {
    return run("'" VALSALVA_REPORT "' '" + (folder / "synthetic.toml").string() + "' --out '" +
               (folder / "run" / "report").string() + "' " + options + " > '" +
               (folder / "out.txt").string() + "' 2>&1");
  }
  std::string html() const { return read_file(folder / "run" / "report.html"); }
  std::string output() const { return read_file(folder / "out.txt"); }

  /// The page's DOM after its scripts have run, from headless Chromium.
  std::string dom(const std::string& options = {}) {
    const std::string command =
        "timeout 240 '" VALSALVA_CHROMIUM
        "' --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking "
        "--disable-component-update --disable-sync --host-resolver-rules='MAP * ~NOTFOUND' "
        "--virtual-time-budget=10000 --user-data-dir='" +
        (folder / "profile").string() + "' " + options + " --dump-dom 'file://" +
        (folder / "run" / "report.html").string() + "' > '" + (folder / "dom.txt").string() +
        "' 2> /dev/null";
    EXPECT_EQ(run(command), 0);
    return read_file(folder / "dom.txt");
  }
  /// What the page's error handler wrote into the root element.
  static std::string script_errors(const std::string& dom) {
    const std::string mark = "data-script-errors=\"";
    const std::size_t at = dom.find(mark);
    return at == std::string::npos ? "" : dom.substr(at + mark.size(), 200);
  }
  static bool has_chromium() { return fs::exists(VALSALVA_CHROMIUM); }

  fs::path folder;
};

TEST_F(Report, TellsTheWholeStory) {
  synthetic::write_run(folder / "run", synthetic::all_stages);
  ASSERT_EQ(make(), 0) << output();
  const std::string page = html();
  for (const char* id : {"anatomy", "mesh", "device", "deployment", "beat", "three-d", "published", "checks",
                         "accuracy", "cost", "provenance"})
    EXPECT_EQ(count(page, "<section id=\"" + std::string(id) + "\">"), 1u) << id;
  EXPECT_EQ(page.find("has not been run"), std::string::npos);
  EXPECT_EQ(page.find("is not final"), std::string::npos);
  EXPECT_GE(count(page, "<img alt="), 16u);
  EXPECT_EQ(count(page, "<img alt=\"\""), 0u);
  EXPECT_GE(count(page, "<svg class=\"chart\""), 6u);
  EXPECT_NE(page.find("7.53 ± 2.65"), std::string::npos);
  EXPECT_NE(page.find("<span class=\"fail\">fail</span>"), std::string::npos);  // the made-up penetration
  EXPECT_NE(page.find("made-up numbers &amp; shapes for a test of the &lt;report&gt;"), std::string::npos);
  EXPECT_LT(page.size(), 8u << 20);
  EXPECT_TRUE(fs::exists(folder / "run" / "report" / "summary.json"));
}

TEST_F(Report, AsksNothingOfTheNetwork) {
  synthetic::write_run(folder / "run", synthetic::all_stages);
  ASSERT_EQ(make(), 0) << output();
  const std::string page = html();
  EXPECT_NE(page.find("Content-Security-Policy\" content=\"default-src 'none'; img-src data:;"),
            std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  EXPECT_EQ(page.find("@import"), std::string::npos);
  for (const char* request : {"src=\"http", "href=\"http", "url(http", "src=\"//", "href=\"//"})
    EXPECT_EQ(count(page, request), 0u) << request;
}

TEST_F(Report, RunsInABrowserWithoutScriptErrors) {
  if (!has_chromium()) GTEST_SKIP() << "Chromium is not installed";
  synthetic::write_run(folder / "run", synthetic::all_stages);
  ASSERT_EQ(make(), 0) << output();
  const std::string result = dom("--use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader");
  ASSERT_NE(result.find("</html>"), std::string::npos);
  EXPECT_EQ(script_errors(result), "");
  EXPECT_NE(result.find("data-state=\"drawn\""), std::string::npos);
  EXPECT_NE(result.find("<canvas"), std::string::npos);
  EXPECT_NE(result.find("type=\"range\""), std::string::npos);
  EXPECT_GE(count(result, "<svg class=\"chart\""), 6u);
  EXPECT_GE(count(result, "<path class=\"s s0\""), 6u);
}

TEST_F(Report, ScriptErrorsWouldBeSeen) {
  if (!has_chromium()) GTEST_SKIP() << "Chromium is not installed";
  synthetic::write_run(folder / "run", {"stent"});
  ASSERT_EQ(make(), 0) << output();
  std::ofstream(folder / "run" / "report.html", std::ios::app) << "<script>noSuchThing();</script>";
  EXPECT_NE(script_errors(dom("--disable-gpu")), "");
}

TEST_F(Report, WithoutWebGlThePageSaysSo) {
  if (!has_chromium()) GTEST_SKIP() << "Chromium is not installed";
  synthetic::write_run(folder / "run", {"stent"});
  ASSERT_EQ(make(), 0) << output();
  const std::string result = dom("--disable-gpu --disable-3d-apis");
  EXPECT_EQ(script_errors(result), "");
  EXPECT_NE(result.find("This browser has no WebGL; the pictures of this page show the same states."),
            std::string::npos);
}

TEST_F(Report, MissingStagesAreSaid) {
  synthetic::write_run(folder / "run", {"segment", "crimp"});
  ASSERT_EQ(make(), 0) << output();
  const std::string page = html();
  EXPECT_EQ(count(page, "has not been run for this case"), 4u);
  EXPECT_NE(page.find("Contours of the segmented lumen"), std::string::npos);
  EXPECT_NE(page.find("Radial force against diameter"), std::string::npos);
}

TEST_F(Report, DamagedFilesAreSaidAndTheRestIsShown) {
  synthetic::write_run(folder / "run", {"stent", "crimp"});
  fs::resize_file(folder / "run" / "crimp" / "state_000001.h5", 1000);
  std::ofstream(folder / "run" / "stent" / "summary.json") << "{\"stage\": ";
  ASSERT_EQ(make(), 0) << output();
  const std::string page = html();
  EXPECT_NE(page.find("state_000001.h5"), std::string::npos);
  EXPECT_NE(page.find("left no readable summary.json"), std::string::npos);
  EXPECT_NE(page.find("Expanded, free of loads"), std::string::npos);
}

TEST_F(Report, FailedStageIsMarked) {
  synthetic::write_run(folder / "run", {"stent"});
  std::ofstream(folder / "run" / "stent" / "summary.json")
      << R"({"stage": "stent", "status": "failed", "metrics": {"nodes": null}, "notes": {"message": "node 7"}})";
  ASSERT_EQ(make(), 0) << output();
  const std::string page = html();
  EXPECT_NE(page.find("Status of 'stent': failed"), std::string::npos);
  EXPECT_NE(page.find("node 7"), std::string::npos);
  EXPECT_NE(page.find("not available"), std::string::npos);
}

TEST_F(Report, NothingToReportIsAnInputError) {
  EXPECT_EQ(make(), 2);
  EXPECT_NE(output().find("no stage has left anything to report"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "run" / "report.html"));
}

TEST_F(Report, SameRunGivesTheSamePage) {
  synthetic::write_run(folder / "run", synthetic::all_stages);
  ASSERT_EQ(make(), 0) << output();
  const std::string first = html();
  ASSERT_EQ(make(), 0) << output();
  EXPECT_TRUE(first == html());
}

TEST_F(Report, CommonOptions) {
  EXPECT_EQ(make("--check"), 0);
  EXPECT_NE(output().find("report.picture_width_px"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "run"));
  EXPECT_EQ(make("--set report.picture_width_px=5"), 2);
  EXPECT_EQ(make("--set report.picture_width=500"), 2);
  EXPECT_EQ(make("--help"), 0);
}

TEST_F(Report, CohortOptionWritesThePage) {
  fs::create_directories(folder / "run");
  std::ofstream(folder / "run" / "cohort.csv") << "name,status,cycle.eoa_cm2\na,ok,1.5\nb,ok,1.7\n";
  const std::string command =
      "'" VALSALVA_REPORT "' --cohort '" + (folder / "run" / "cohort.csv").string() + "'";
  EXPECT_EQ(run(command + " --out '" + (folder / "run" / "x.html").string() + "' > /dev/null 2>&1"), 0);
  EXPECT_NE(
      read_file(folder / "run" / "x.html").find("<th scope=\"row\">Effective orifice area</th><td>1.5</td>"),
      std::string::npos);
  EXPECT_EQ(run(command + " --quite > /dev/null 2>&1"), 2);
}

}  // namespace
}  // namespace valsalva::report
