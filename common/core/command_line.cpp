#include "core/command_line.hpp"

#include <charconv>

#include "core/errors.hpp"
#include "core/schema.hpp"

namespace valsalva {
namespace {

const std::vector<std::string> known_options{"--set",    "--fidelity",  "--out",    "--from",  "--check",
                                             "--digest", "--estimate",  "--resume", "--steps", "--quiet",
                                             "--help",   "--reference", "--version"};

long positive_integer(const std::string& option, const std::string& text) {
  long value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || value < 1)
    throw InputError("{}: found '{}', expected a positive integer", option, text);
  return value;
}

}  // namespace

CommandLine parse_command_line(int argc, char** argv) {
  CommandLine line;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string option = words[i];
    std::optional<std::string> attached;
    if (option.starts_with("--") && option.find('=') != std::string::npos) {
      attached = option.substr(option.find('=') + 1);
      option.resize(option.find('='));
    }
    const auto value = [&]() -> std::string {
      if (attached) return *attached;
      if (i + 1 >= words.size()) throw InputError("{}: a value is missing; see --help", option);
      return words[++i];
    };
    if (option == "--set")
      line.overrides.push_back(value());
    else if (option == "--fidelity")
      line.fidelity = fidelity_from(value());
    else if (option == "--out")
      line.out = value();
    else if (option == "--from")
      line.from = value();
    else if (option == "--steps")
      line.steps = positive_integer(option, value());
    else if (option == "--check")
      line.check = true;
    else if (option == "--digest")
      line.digest = true;
    else if (option == "--estimate")
      line.estimate = true;
    else if (option == "--resume")
      line.resume = true;
    else if (option == "--quiet")
      line.quiet = true;
    else if (option == "--help" || option == "-h")
      line.help = true;
    else if (option == "--reference")
      line.reference = true;
    else if (option == "--version")
      line.version = true;
    else if (option.starts_with("-")) {
      const std::string near = nearest(option, known_options);
      throw InputError("unknown option '{}'{}; see --help", option,
                       near.empty() ? "" : "; did you mean '" + near + "'?");
    } else if (line.case_file.empty())
      line.case_file = option;
    else
      throw InputError("a second case file '{}' was given after '{}'; a stage runs one case", option,
                       line.case_file.string());
  }
  if (line.case_file.empty() && !line.help && !line.reference && !line.version)
    throw InputError("no case file was given; usage: see --help");
  return line;
}

std::string options_help() {
  return "Options:\n"
         "  --set table.key=value   override a key of the case file (repeatable)\n"
         "                          (of a repeated table: table.NAME.key=value)\n"
         "  --fidelity LEVEL        draft, standard, fine or reference\n"
         "  --out DIR               folder of this stage's results (default runs/<case>/<stage>)\n"
         "  --from STATE.h5         the parent stage's state (default: the newest in runs/<case>/<parent>)\n"
         "  --check                 validate everything and print the effective parameters; nothing is run\n"
         "  --digest                print the digest of the parameters this stage depends on; nothing is "
         "run\n"
         "  --estimate              print the predicted time, memory and accuracy band; nothing is run\n"
         "  --resume                continue from this stage's newest checkpoint\n"
         "  --steps N               stop after N steps, with a checkpoint\n"
         "  --quiet                 no information lines\n"
         "  --reference             print the reference page of all case-file keys (Markdown)\n"
         "  --version, --help\n"
         "Exit codes: 0 done; 2 invalid usage or input (nothing written); 3 numerical failure (last good "
         "state\n"
         "written and named); 4 environment or I/O failure; 130 interrupted (checkpoint written).\n";
}

}  // namespace valsalva
