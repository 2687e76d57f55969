// The table of published materials: every set can be made, is stress free, and carries its source; what is
// misspelt or missing is named.
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "materials/hgo.hpp"
#include "materials/library.hpp"
#include "materials/sheet_test.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

constexpr const char* good = R"(
["a/b"]
law = "neo-hookean"
mu_Pa = 1e5
used_for = "a test"
source = "this file"
)";

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expect_message(const std::string& toml, const std::vector<std::string>& parts) {
  const std::string message = message_of([&] { MaterialLibrary(toml, "laws.toml"); });
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
}

}  // namespace

TEST(Library, EverySetIsMadeAndStressFreeAndTellsItsSource) {
  EXPECT_GE(MaterialLibrary::built_in().sets().size(), 15u);
  for (const MaterialSet& set : MaterialLibrary::built_in().sets()) {
    EXPECT_FALSE(set.source.empty() || set.used_for.empty()) << set.name;
    EXPECT_LE(static_cast<int>(set.fibre_angles_deg.size()), find_law(set.law).fibre_families) << set.name;
    const SheetState rest = sheet_test(*set.plane_law(), set.plane_fibres(), {1, 1, 0});
    EXPECT_NEAR(rest.cauchy_Pa.norm(), 0, 1e-6) << set.name;
    EXPECT_GT(sheet_test(*set.plane_law(), set.plane_fibres(), {1.05, {}, 0}).cauchy_Pa(0, 0), 0) << set.name;
    const Mat3 rest_stress = set.solid_law().respond(Mat3::Identity(), {2}, 1, Derivatives::stress).stress;
    EXPECT_NEAR(rest_stress.norm(), 0, 1e-6) << set.name;
  }
}

TEST(Library, ThePaperOf2022HasTheConstantsOfTheStages) {
  // The stages build their leaflets from the constants in hgo.hpp: one table must not drift from the other.
  const auto same = [](const std::string& name, const HgoParameters& p, double angle) {
    const MaterialSet& set = MaterialLibrary::built_in().find(name);
    EXPECT_EQ(set.parameters.at("c10_Pa"), p.c10_Pa) << name;
    EXPECT_EQ(set.parameters.at("c01"), p.c01) << name;
    EXPECT_EQ(set.parameters.at("k1_Pa"), p.k1_Pa) << name;
    EXPECT_EQ(set.parameters.at("k2"), p.k2) << name;
    EXPECT_EQ(set.fibre_angles_deg.at(0), angle) << name;
  };
  same("tavr-ifed-2022/native-leaflet", native_leaflet_healthy, native_leaflet_fibre_angle_deg);
  same("tavr-ifed-2022/porcine-pericardium", porcine_pericardium, porcine_pericardium_fibre_angle_deg);
}

TEST(Library, UnknownNamesAreAnsweredWithTheNearest) {
  const auto find = [](const std::string& name) {
    return message_of([&] { MaterialLibrary::built_in().find(name); });
  };
  EXPECT_NE(
      find("tavr-ifed-2022/porcine-pericardum").find("did you mean 'tavr-ifed-2022/porcine-pericardium'"),
      std::string::npos);
  EXPECT_NE(message_of([] { make_law("hgoo", {}); }).find("did you mean 'hgo'"), std::string::npos);
  EXPECT_NE(message_of([] {
              make_law("neo-hookean", {{"mu_pa", 1}});
            }).find("did you mean 'mu_Pa'"),
            std::string::npos);
  EXPECT_NE(message_of([] {
              make_law("hgo", {{"c10_Pa", 1}, {"c01", 1}, {"k1_Pa", 1}});
            }).find("'k2'"),
            std::string::npos);
}

TEST(Library, BadTablesAreNamed) {
  EXPECT_EQ(MaterialLibrary(good, "laws.toml").find("a/b").law, "neo-hookean");
  expect_message("[\"a/b\"]\nlaw = \"neo-hookean\"\nused_for = \"x\"\n", {"laws.toml", "a/b", "source"});
  expect_message(std::string(good) + "mu2_Pa = 3\n", {"a/b", "mu2_Pa", "did you mean 'mu_Pa'"});
  expect_message(std::string(good) + "split = \"half\"\n", {"split", "half", "modified or full"});
  expect_message(std::string(good) + "volumetric = \"quadratc\"\n", {"quadratc", "did you mean 'quadratic'"});
  expect_message(std::string(good) + "volumetric = \"quadratic\"\n", {"bulk modulus", "positive"});
  expect_message(std::string(good) + "fibre_angles_deg = [1, 2, 3]\n", {"fibre_angles_deg", "two at most"});
  expect_message("[\"a/b\"\n", {"laws.toml:1"});
  expect_message("law = 3\n", {"'law'", "must be a table"});
}

TEST(Library, EveryLawRefusesConstantsOutOfRange) {
  const std::vector<std::pair<std::string, ParameterValues>> bad{
      {"neo-hookean", {{"mu_Pa", 0}}},
      {"mooney-rivlin", {{"c1_Pa", 1}, {"c2_Pa", -1}}},
      {"st-venant-kirchhoff", {{"lambda_Pa", -1}, {"mu_Pa", 1}}},
      {"ogden", {{"mu1_Pa", 1}, {"alpha1", -2}}},
      {"ogden", {{"mu1_Pa", 1}, {"alpha1", 0}}},
      {"hgo", {{"c10_Pa", 1}, {"c01", 1}, {"k1_Pa", 1}, {"k2", 1}, {"kappa", 0.4}}},
      {"holzapfel", {{"mu_Pa", 1}, {"a1_Pa", 1}, {"b1", 0}, {"a2_Pa", 1}, {"b2", 1}}},
      {"straightened-fibre", {{"c1_Pa", 1}, {"c3_Pa", 1}, {"c4", 1}, {"straightening_stretch", 0.9}}},
      {"fung", {{"ch_Pa", 1}, {"b1", -1}, {"b2", 1}, {"b3", 1}}},
      {"lee-sacks", {{"c0_Pa", 1}, {"c1_Pa", 1}, {"c2", 1}, {"w", 2}}}};
  for (const auto& [law, values] : bad) EXPECT_THROW(make_law(law, values), InputError) << law;
  EXPECT_THROW(make_law("neo-hookean", {{"mu_Pa", std::numeric_limits<double>::infinity()}}), InputError);
  EXPECT_THROW(make_law("fung", {{"ch_Pa", 1}, {"b1", 1}, {"b2", 1}, {"b3", 1}})
                   ->respond(Mat3::Identity(), {0}, 1, Derivatives::stress),
               InputError);
}

TEST(SheetTest, FreeDirectionsBearNoLoadAndBadLoadsAreRefused) {
  const MaterialSet& set = MaterialLibrary::built_in().find("tavr-ifed-2022/porcine-pericardium");
  const auto law = set.plane_law();
  for (const double l : {0.8, 1.03, 1.12, 1.6}) {
    const SheetState along = sheet_test(*law, set.plane_fibres(), {l, {}, 0});
    const SheetState across = sheet_test(*law, set.plane_fibres(), {{}, l, 0});
    EXPECT_LT(std::abs(along.nominal2_Pa), 1e-9 * std::abs(along.nominal1_Pa)) << l;
    EXPECT_LT(std::abs(across.nominal1_Pa), 1e-9 * std::abs(across.nominal2_Pa)) << l;
  }
  EXPECT_THROW(sheet_test(*law, {}, {}), InputError);
  EXPECT_THROW(sheet_test(*law, {}, {-1.0, {}, 0}), InputError);
}
