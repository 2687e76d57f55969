#include <gtest/gtest.h>

#include <fstream>

#include "core/case.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

using test::expect_error;

Schema sample_schema() {
  Schema schema;
  schema.table("crimp", "Closing");
  schema.real("crimp.speed_mm_per_s", 500, {1, 5000}, "Speed");
  schema.real("crimp.element_mm", {1.0, 0.7, 0.5, 0.4}, {0.1, 3}, "Edge");
  schema.boolean("crimp.hold", true, "Hold");
  schema.integer("crimp.cells", 15, {3, 60}, "Cells");
  schema.choice("crimp.kind", "cylinder", {"cylinder", "iris"}, "Kind");
  schema.reals("crimp.axis", {0, 0, 1}, 3, unlimited(), "Axis");
  schema.texts("crimp.bodies", {"frame"}, "Bodies");
  schema.tables("body", "One body");
  schema.text("body.name", "", "Name");
  schema.real("body.thickness_mm", 0.4, positive(), "Thickness");
  return schema;
}

Case read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return Case::from_text(text, "sample.toml", sample_schema(), Fidelity::draft, overrides);
}

void expect_refused(const std::string& text, std::initializer_list<const char*> words) {
  expect_error(ExitCode::input, words, [&] { read(text); });
}

TEST(Case, DefaultsFollowTheFidelity) {
  EXPECT_EQ(read("").real("crimp.element_mm"), 1.0);
  const Case fine = Case::from_text("", "x", sample_schema(), Fidelity::fine);
  EXPECT_EQ(fine.real("crimp.element_mm"), 0.5);
  EXPECT_EQ(fine.real("crimp.speed_mm_per_s"), 500);
}

TEST(Case, WhatIsAbsentIsNotInTheScene) {
  EXPECT_FALSE(read("").has("crimp"));
  EXPECT_TRUE(read("[crimp]\n").has("crimp"));
  EXPECT_TRUE(read("", {"crimp.hold=false"}).has("crimp"));
}

TEST(Case, OverridesWinAndWordsNeedNoQuotes) {
  const Case scene = read("[crimp]\nspeed_mm_per_s = 10\n", {"crimp.speed_mm_per_s=20", "crimp.kind=iris"});
  EXPECT_EQ(scene.real("crimp.speed_mm_per_s"), 20);
  EXPECT_EQ(scene.text("crimp.kind"), "iris");
}

TEST(Case, RepeatedTablesKeepTheirOrderAndDefaults) {
  const Case scene = read("[[body]]\nname = \"a\"\n[[body]]\nname = \"b\"\nthickness_mm = 0.3\n");
  ASSERT_EQ(scene.entries("body").size(), 2u);
  EXPECT_EQ(scene.entries("body")[0].text("body.name"), "a");
  EXPECT_EQ(scene.entries("body")[0].real("body.thickness_mm"), 0.4);
  EXPECT_EQ(scene.entries("body")[1].real("body.thickness_mm"), 0.3);
}

TEST(Case, AnOverrideReachesTheEntryOfARepeatedTableThatItNames) {
  const std::string text = "[[body]]\nname = \"a\"\n[[body]]\nname = \"b.1\"\n";
  const Case scene = read(text, {"body.b.1.thickness_mm=0.7"});
  EXPECT_EQ(scene.entries("body")[0].real("body.thickness_mm"), 0.4);
  EXPECT_EQ(scene.entries("body")[1].real("body.thickness_mm"), 0.7);
  EXPECT_TRUE(scene.entries("body")[1].is_set("body.thickness_mm"));
  const auto refused = [&](const std::string& override_text, std::initializer_list<const char*> words) {
    expect_error(ExitCode::input, words, [&] { read(text, {override_text}); });
  };
  refused("body.thickness_mm=0.7", {"repeated", "body.NAME.thickness_mm", "a, b.1"});
  refused("body.c.thickness_mm=0.7", {"no [[body]] named 'c'", "a, b.1"});
  refused("body.a.thickness=0.7", {"unknown key 'body.thickness'", "thickness_mm"});
  refused("crimp.a.kind=iris", {"one dot too many"});
}

TEST(Case, ErrorsNameFileLineKeyFoundAndExpected) {
  expect_refused("[crimp]\nspeed_mm_per_s = -4\n",
                 {"sample.toml:2", "crimp.speed_mm_per_s", "found -4", "[1, 5000]"});
  expect_refused("[crimp]\nsped_mm_per_s = 4\n", {"sample.toml:2", "did you mean 'crimp.speed_mm_per_s'"});
  expect_refused("[crim]\n", {"unknown table", "did you mean 'crimp'"});
  expect_refused("[crimp]\nhold = 1\n", {"crimp.hold", "true or false"});
  expect_refused("[crimp]\ncells = 2.5\n", {"crimp.cells", "integer"});
  expect_refused("[crimp]\nkind = \"irs\"\n", {"did you mean 'iris'"});
  expect_refused("[crimp]\naxis = [1, 2]\n", {"crimp.axis", "3 numbers"});
  expect_refused("[crimp]\nspeed_mm_per_s = nan\n", {"finite"});
  expect_refused("[crimp]\nspeed_mm_per_s = inf\n", {"finite"});
  expect_refused("[crimp]\nspeed_mm_per_s = \"fast\"\n", {"number"});
  expect_refused("[crimp\n", {"sample.toml:1", "not valid TOML"});
  expect_refused("crimp = 3\n", {"must be a table"});
  expect_refused("[body]\nname = \"a\"\n", {"[[body]]"});
  expect_error(ExitCode::input, {"--set crimp.sped=1"}, [] { read("", {"crimp.sped=1"}); });
  expect_error(ExitCode::input, {"table.key=value"}, [] { read("", {"speed"}); });
}

TEST(Case, TheEffectiveParametersRoundTrip) {
  const Case scene = read("", {"crimp.speed_mm_per_s=0.1e2", "crimp.axis=[0.1, 0.2, 0.3]"});
  const std::string text = scene.effective({"crimp"});
  EXPECT_NE(text.find("crimp.axis = [0.1, 0.2, 0.3]\n"), std::string::npos) << text;
  EXPECT_NE(text.find("crimp.speed_mm_per_s = 10\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("body."), std::string::npos);
}

TEST(Case, AMissingFileSaysWhatToGive) {
  expect_error(ExitCode::input, {"nowhere.toml", "case file"},
               [] { Case::load("nowhere.toml", sample_schema(), Fidelity::draft, {}); });
}

TEST(Schema, TheReferencePageHoldsEveryKey) {
  const Schema schema = sample_schema();
  const std::string page = schema.reference_page();
  for (const Parameter& parameter : schema.parameters())
    EXPECT_NE(page.find("`" + parameter.key.substr(parameter.key.find('.') + 1) + "`"), std::string::npos);
}

}  // namespace
}  // namespace valsalva
