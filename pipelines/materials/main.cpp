// valsalva-material: the response of a law to the tests of a thin sheet, by name or by parameters. The fit
// tool (pipelines/materials/fit.py) and the figures evaluate the laws through it, so that no law is written
// twice.
//
//   valsalva-material --laws                                   the laws and their parameters
//   valsalva-material --describe hgo                           its parameters as CSV
//   valsalva-material --sets                                   the published materials
//   valsalva-material --set tavr-ifed-2022/porcine-pericardium --test uniaxial1 --to 1.1 --points 11
//   valsalva-material --law neo-hookean --parameter mu_Pa=1e5 --test equibiaxial --to 1.3
//   valsalva-material --law hgo --fibre-angles 10,-10 --loads loads.csv --stream c10_Pa,c01,k1_Pa,k2
//
// --test writes CSV. --loads reads lines "stretch1,stretch2,shear" below such a header (an empty stretch is
// free) and, with --stream, answers every line of parameter values on standard input by one line of nominal
// stresses (P11, P22 of each load, Pa), or by "error: ..." where the law refuses. The stream's key
// fibre_angle_deg turns the families to plus and minus that angle.
// Exit codes: 0 done, 2 wrong usage or input, 3 no solution, 4 a file cannot be read.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>

#include "core/errors.hpp"
#include "core/schema.hpp"
#include "materials/library.hpp"
#include "materials/sheet_test.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

struct Options {
  std::string set, law, describe, test, loads_file, stream;
  ParameterValues parameters;
  std::vector<double> fibre_angles_deg;
  bool list_laws = false, list_sets = false;
  double to = 1.2;
  int points = 21;
};

constexpr const char* usage =
    "usage: valsalva-material (--set NAME | --law LAW [--parameter key=value]... [--fibre-angles a,b])\n"
    "         (--test uniaxial1|uniaxial2|equibiaxial|shear [--to VALUE] [--points N] |\n"
    "          --loads FILE.csv [--stream key,key...])\n"
    "       valsalva-material --laws | --sets | --describe LAW\n";

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::string part;
  std::istringstream in(text);
  while (std::getline(in, part, at)) parts.push_back(part);
  if (!text.empty() && text.back() == at) parts.emplace_back();
  return parts;
}

double number(const std::string& text, const std::string& what) {
  std::size_t read = 0;
  double value = 0;
  try {
    value = std::stod(text, &read);
  } catch (const std::exception&) {
    read = std::string::npos;
  }
  if (read != text.size() || !std::isfinite(value))
    throw InputError("{}: found '{}'; expected a number", what, text);
  return value;
}

Options parse(int argc, char** argv) {
  static const std::vector<std::string> known{"--laws", "--sets",      "--set",          "--describe",
                                              "--law",  "--parameter", "--fibre-angles", "--test",
                                              "--to",   "--points",    "--loads",        "--stream"};
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 >= argc) throw InputError("{} needs a value\n{}", word, usage);
      return argv[++i];
    };
    if (word == "--laws") {
      o.list_laws = true;
    } else if (word == "--sets") {
      o.list_sets = true;
    } else if (word == "--set") {
      o.set = value();
    } else if (word == "--describe") {
      o.describe = value();
    } else if (word == "--law") {
      o.law = value();
    } else if (word == "--parameter") {
      const std::string pair = value();
      const auto at = pair.find('=');
      if (at == std::string::npos) throw InputError("--parameter {}: expected key=value", pair);
      o.parameters[pair.substr(0, at)] = number(pair.substr(at + 1), "--parameter " + pair.substr(0, at));
    } else if (word == "--fibre-angles") {
      for (const std::string& angle : split(value(), ','))
        o.fibre_angles_deg.push_back(number(angle, "--fibre-angles"));
      if (o.fibre_angles_deg.size() > 2) throw InputError("--fibre-angles: expected one or two angles");
    } else if (word == "--test") {
      o.test = value();
    } else if (word == "--to") {
      o.to = number(value(), "--to");
    } else if (word == "--points") {
      o.points = static_cast<int>(number(value(), "--points"));
      if (o.points < 2) throw InputError("--points = {}; expected 2 or more", o.points);
    } else if (word == "--loads") {
      o.loads_file = value();
    } else if (word == "--stream") {
      o.stream = value();
    } else {
      const std::string near = nearest(word, known);
      throw InputError("unknown option '{}'{}\n{}", word,
                       near.empty() ? "" : "; did you mean '" + near + "'?", usage);
    }
  }
  return o;
}

void list_laws() {
  for (const LawEntry& law : law_catalogue()) {
    fmt::print("{}\n  {}\n", law.name, law.equation);
    for (const LawParameter& p : law.parameters) {
      const std::string standard = p.required   ? "required"
                                   : p.standard ? fmt::format("default {}", *p.standard)
                                                : "optional";
      fmt::print("  {:22} {} ({}; a fit searches {} to {})\n", p.key, p.doc, standard, p.low, p.high);
    }
  }
}

void describe(const std::string& name) {
  const LawEntry& law = find_law(name);
  fmt::print("# fibre families: {}\nkey,low,high,required,default\n", law.fibre_families);
  for (const LawParameter& p : law.parameters)
    fmt::print("{},{},{},{},{}\n", p.key, p.low, p.high, p.required ? 1 : 0,
               p.standard ? fmt::format("{}", *p.standard) : "");
}

void list_sets() {
  for (const MaterialSet& set : MaterialLibrary::built_in().sets()) {
    fmt::print("{}\n  {}", set.name, set.law);
    for (const auto& [key, value] : set.parameters) fmt::print(", {} = {}", key, value);
    if (set.volumetric.form != Volumetric::Form::none)
      fmt::print(", {} {} Pa", name_of(set.volumetric.form), set.volumetric.modulus_Pa);
    fmt::print("\n  {}\n  source: {}\n", set.used_for, set.source);
    if (!set.assumed.empty()) fmt::print("  assumed: {}\n", set.assumed);
  }
}

std::vector<SheetLoad> loads_of_test(const Options& o) {
  std::vector<SheetLoad> loads;
  for (int i = 0; i < o.points; ++i) {
    const double share = static_cast<double>(i) / (o.points - 1);
    const double stretch = 1 + share * (o.to - 1);
    if (o.test == "uniaxial1") {
      loads.push_back({stretch, {}, 0});
    } else if (o.test == "uniaxial2") {
      loads.push_back({{}, stretch, 0});
    } else if (o.test == "equibiaxial") {
      loads.push_back({stretch, stretch, 0});
    } else if (o.test == "shear") {
      loads.push_back({1, 1, share * o.to});
    } else {
      throw InputError("--test {}: expected uniaxial1, uniaxial2, equibiaxial or shear", o.test);
    }
  }
  return loads;
}

std::vector<SheetLoad> read_loads(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw EnvironmentError("{}: cannot be opened", path);
  std::string line;
  if (!std::getline(in, line) || line != "stretch1,stretch2,shear")
    throw InputError("{}:1: found '{}'; expected the header stretch1,stretch2,shear", path, line);
  std::vector<SheetLoad> loads;
  for (int row = 2; std::getline(in, line); ++row) {
    const std::string where = fmt::format("{}:{}", path, row);
    const std::vector<std::string> cells = split(line, ',');
    if (cells.size() != 3) throw InputError("{}: found {} columns; expected 3", where, cells.size());
    SheetLoad load;
    if (!cells[0].empty()) load.stretch1 = number(cells[0], where);
    if (!cells[1].empty()) load.stretch2 = number(cells[1], where);
    load.shear = cells[2].empty() ? 0 : number(cells[2], where);
    loads.push_back(load);
  }
  return loads;
}

MaterialSet material_of(const Options& o) {
  if (!o.set.empty()) {
    if (!o.law.empty() || !o.parameters.empty())
      throw InputError("--set {} goes without --law and --parameter", o.set);
    return MaterialLibrary::built_in().find(o.set);
  }
  if (o.law.empty()) throw InputError("neither --set nor --law is given\n{}", usage);
  MaterialSet set;
  set.name = set.law = find_law(o.law).name;
  set.parameters = o.parameters;
  set.fibre_angles_deg = o.fibre_angles_deg;
  if (set.law == "st-venant-kirchhoff") {
    set.split = Split::full;
    set.incompressible_sheet = false;
  }
  return set;
}

void print_curve(const MaterialSet& set, const std::vector<SheetLoad>& loads) {
  const auto law = set.plane_law();
  fmt::print(
      "stretch1,stretch2,stretch3,shear,nominal1_Pa,nominal2_Pa,cauchy1_Pa,cauchy2_Pa,cauchy12_Pa,energy_Pa,"
      "exponent\n");
  for (const SheetLoad& load : loads) {
    const SheetState s = sheet_test(*law, set.plane_fibres(), load);
    fmt::print("{},{},{},{},{},{},{},{},{},{},{}\n", s.stretch1, s.stretch2, s.stretch3, load.shear,
               s.nominal1_Pa, s.nominal2_Pa, s.cauchy_Pa(0, 0), s.cauchy_Pa(1, 1), s.cauchy_Pa(0, 1),
               s.energy_Pa, s.exponent);
  }
}

std::string stresses(const MaterialSet& set, const std::vector<SheetLoad>& loads) {
  const auto law = set.plane_law();
  std::string line;
  for (const SheetLoad& load : loads) {
    const SheetState s = sheet_test(*law, set.plane_fibres(), load);
    line += fmt::format("{}{},{}", line.empty() ? "" : ",", s.nominal1_Pa, s.nominal2_Pa);
  }
  return line;
}

void answer_stream(MaterialSet set, const std::vector<SheetLoad>& loads, const std::string& keys_text) {
  const std::vector<std::string> keys = split(keys_text, ',');
  std::string line;
  while (std::getline(std::cin, line)) {
    try {
      const std::vector<std::string> values = split(line, ',');
      if (values.size() != keys.size())
        throw InputError("found {} values; expected {}, for {}", values.size(), keys.size(), keys_text);
      for (std::size_t i = 0; i < keys.size(); ++i) {
        const double value = number(values[i], keys[i]);
        if (keys[i] == "fibre_angle_deg") {
          for (std::size_t f = 0; f < set.fibre_angles_deg.size(); ++f)
            set.fibre_angles_deg[f] = f == 0 ? value : -value;
        } else {
          set.parameters[keys[i]] = value;
        }
      }
      fmt::print("{}\n", stresses(set, loads));
    } catch (const Error& error) {
      fmt::print("error: {}\n", error.what());
    }
    std::fflush(stdout);
  }
}

void run(const Options& o) {
  if (o.list_laws) return list_laws();
  if (o.list_sets) return list_sets();
  if (!o.describe.empty()) return describe(o.describe);
  const MaterialSet set = material_of(o);
  if (o.test.empty() == o.loads_file.empty())
    throw InputError("expected one of --test and --loads\n{}", usage);
  const std::vector<SheetLoad> loads = o.test.empty() ? read_loads(o.loads_file) : loads_of_test(o);
  if (o.stream.empty())
    print_curve(set, loads);
  else
    answer_stream(set, loads, o.stream);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return static_cast<int>(error.code());
  }
}
