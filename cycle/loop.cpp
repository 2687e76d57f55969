// valsalva-circulation: the periodic beat of a case's left heart and Windkessel, with an ideal valve between
// them instead of the flow domain (circulation/closed_loop.hpp): where a beat starts, and what the
// calibration (pipelines/circulation/calibrate.py) compares with its targets.
//
//   valsalva-circulation CASE.toml [--set table.key=value]... [--valve-resistance R] [--inertance L]
//   valsalva-circulation CASE.toml --effective              the parameters, one "key = value" a line
//   valsalva-circulation CASE.toml --stream circulation.compliance_mL_per_mmHg,...
//
// R in mmHg s/mL (default 0.02: an orifice of about 1.7 cm2), L in g/mm4 (2e-4). Prints CSV: a header and a
// row of figures. --stream reads rows of values for the named keys from standard input and answers each by a
// row, or by "error: ..." where there is no periodic beat.
// Exit codes: 0 done, 2 wrong usage or input, 3 no periodic beat, 4 a file cannot be read.
#include <fmt/format.h>

#include <iostream>
#include <sstream>

#include "circulation/closed_loop.hpp"
#include "circulation_case.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"
#include "scene/scene.hpp"

using namespace valsalva;

namespace {

struct Options {
  std::string file;
  std::vector<std::string> overrides, stream;
  bool effective = false;
  circulation::IdealValve valve{0.02 * units::resistance_per_mmHg_s_per_mL, 2e-4};
};

constexpr const char* usage =
    "usage: valsalva-circulation CASE.toml [--set table.key=value]... [--valve-resistance MMHG_S_PER_ML]\n"
    "         [--inertance G_PER_MM4] [--effective | --stream key,key...]\n";

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::string part;
  std::istringstream in(text);
  while (std::getline(in, part, ',')) parts.push_back(part);
  return parts;
}

double number(const std::string& text, const std::string& option) {
  std::size_t read = 0;
  double value = 0;
  try {
    value = std::stod(text, &read);
  } catch (const std::exception&) {
  }
  if (read == 0 || read != text.size()) throw InputError("{}: '{}' is no number; expected one", option, text);
  return value;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string {
      if (i + 1 == argc) throw InputError("{}: a value is missing\n{}", word, usage);
      return argv[++i];
    };
    if (word == "--set")
      options.overrides.push_back(value());
    else if (word == "--effective")
      options.effective = true;
    else if (word == "--stream")
      options.stream = split(value());
    else if (word == "--valve-resistance")
      options.valve.resistance = number(value(), word) * units::resistance_per_mmHg_s_per_mL;
    else if (word == "--inertance")
      options.valve.inertance = number(value(), word);
    else if (word.starts_with("--") || !options.file.empty())
      throw InputError("unknown option '{}'\n{}", word, usage);
    else
      options.file = word;
  }
  if (options.file.empty()) throw InputError("no case file was given\n{}", usage);
  return options;
}

std::string row_of(const Schema& schema, const Options& options, const std::vector<std::string>& overrides) {
  const Case scene = Case::load(options.file, schema, Fidelity::standard, overrides);
  const cycle::CirculationParameters p = cycle::read_circulation(scene);
  if (p.upstream != cycle::Upstream::heart || p.downstream != cycle::Downstream::windkessel)
    throw InputError("{}: the 0D loop needs circulation.upstream = \"heart\" and downstream = \"windkessel\"",
                     options.file);
  const circulation::PeriodicBeat b = circulation::periodic_beat(p.heart, p.windkessel, options.valve);
  const double mmHg = units::pa_per_mmHg, mL = units::mm3_per_mL;
  return fmt::format("{},{},{},{},{},{},{},{},{}", b.stroke_volume / mL, b.greatest_aortic_pressure / mmHg,
                     b.least_aortic_pressure / mmHg, b.mean_aortic_pressure / mmHg,
                     b.peak_ventricular_pressure / mmHg, b.ventricular_pressure / mmHg, b.peak_flow / mL,
                     b.ejection_s, b.beats);
}

void run(const Options& options) {
  Schema schema;
  declare_all(schema);
  if (options.effective) {
    const Case scene = Case::load(options.file, schema, Fidelity::standard, options.overrides);
    fmt::print("{}", scene.effective({"circulation"}));
    return;
  }
  fmt::print(
      "stroke_volume_mL,systolic_pressure_mmHg,diastolic_pressure_mmHg,mean_pressure_mmHg,"
      "peak_ventricular_pressure_mmHg,end_diastolic_pressure_mmHg,peak_flow_mL_per_s,ejection_s,beats\n");
  if (options.stream.empty()) {
    fmt::print("{}\n", row_of(schema, options, options.overrides));
    return;
  }
  std::string line;
  while (std::getline(std::cin, line)) {
    const std::vector<std::string> values = split(line);
    try {
      if (values.size() != options.stream.size())
        throw InputError("{} values; expected {}", values.size(), options.stream.size());
      std::vector<std::string> overrides = options.overrides;
      for (std::size_t i = 0; i < values.size(); ++i)
        overrides.push_back(options.stream[i] + "=" + values[i]);
      fmt::print("{}\n", row_of(schema, options, overrides));
    } catch (const std::exception& error) {
      fmt::print("error: {}\n", error.what());
    }
    std::fflush(stdout);
  }
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
