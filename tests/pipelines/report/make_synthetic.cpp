// make_synthetic FOLDER [stage...]: writes a made-up run folder (all stages by default), to look at the
// report.
#include <fmt/format.h>

#include "core/errors.hpp"
#include "synthetic.hpp"

int main(int argc, char** argv) {
  using namespace valsalva::report::synthetic;
  if (argc < 2) {
    fmt::print(stderr, "usage: make_synthetic FOLDER [stage...]\n");
    return 2;
  }
  try {
    write_run(argv[1], argc > 2 ? std::set<std::string>(argv + 2, argv + argc) : all_stages);
  } catch (const valsalva::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
