// valsalva-phantom: writes the synthetic contrast CT and prints its true figures.
#include <fmt/format.h>

#include <cstring>

#include "core/errors.hpp"
#include "core/mpi.hpp"
#include "from_case.hpp"
#include "scene/scene.hpp"

namespace {

constexpr const char* help =
    "valsalva-phantom: makes a synthetic contrast CT of an aortic root with stenotic leaflets\n\n"
    "Usage: valsalva-phantom OUTPUT [--set phantom.KEY=VALUE]...\n\n"
    "OUTPUT ends in .nrrd, .nii, .nii.gz, .mha or .mhd. The seed is fixed unless phantom.seed is set.\n"
    "  valsalva-phantom root.nrrd --set phantom.annulus_mm=22 --set phantom.sinus_mm=30\n\n";

int run(int argc, char** argv) {
  using namespace valsalva;
  Schema schema;
  declare_all(schema);
  std::string output;
  std::vector<std::string> overrides;
  for (int n = 1; n < argc; ++n) {
    if (!std::strcmp(argv[n], "--help")) {
      fmt::print("{}{}", help, schema.help_of("phantom"));
      return 0;
    }
    if (!std::strcmp(argv[n], "--set") && n + 1 < argc)
      overrides.push_back(argv[++n]);
    else if (output.empty() && argv[n][0] != '-')
      output = argv[n];
    else
      throw InputError("valsalva-phantom: '{}' is not understood; see valsalva-phantom --help", argv[n]);
  }
  if (output.empty())
    throw InputError("valsalva-phantom: no output file is given; see valsalva-phantom --help");
  const Case scene = Case::from_text("", "command line", schema, Fidelity::standard, overrides);
  const segment::Phantom phantom = segment::phantom_of(scene);
  segment::write_image(output, phantom.image);
  fmt::print("{}: {} x {} x {} voxels; calcium {:.0f} mm3; root from annulus to junction {:.0f} mm3\n",
             output, phantom.image.size[0], phantom.image.size[1], phantom.image.size[2], phantom.calcium_mm3,
             phantom.lumen_mm3);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const valsalva::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.code());
  }
}
