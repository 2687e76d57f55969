// Benchmark flows on a grid of choice (docs/verification/fluid-cases.md):
//
//   study_fluid cavity RE N END [convection]
//   study_fluid cylinder N END [wall]
//   study_fluid sphere RE CELLS_A_DIAMETER WIDTH END [wall]
//   study_fluid taylor-green N END scheme     upwind3, centred2, upwind3+vreman, conserving4, ...
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "cases.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto number = [&](std::size_t i) { return i < words.size() ? std::atof(words[i].c_str()) : 0; };
  const auto word = [&](std::size_t i, const char* otherwise) {
    return i < words.size() ? words[i] : std::string(otherwise);
  };
  const bool speaks = mpi::rank(MPI_COMM_WORLD) == 0;
  const std::string name = word(0, "");
  if (name == "cavity" && words.size() >= 4) {
    const Cavity r =
        cavity(number(1), static_cast<int>(number(2)), number(3), convection_from(word(4, "centred4")));
    if (speaks)
      std::printf("rms u %.5f, rms v %.5f, least u %.5f, least v %.5f, most v %.5f, last change %.1e\n",
                  r.rms_u, r.rms_v, r.least_u, r.least_v, r.most_v, r.change);
  } else if (name == "cylinder" && words.size() >= 3) {
    const Cylinder r = cylinder(static_cast<int>(number(1)), number(2), wall_from(word(3, "interpolated")));
    if (speaks)
      std::printf("drag %.4f, lift %.5f, pressure difference %.5f, last change %.1e\n", r.drag, r.lift,
                  r.pressure_difference, r.change);
  } else if (name == "sphere" && words.size() >= 5) {
    const Sphere r = sphere(number(1), number(2), number(3), number(4), wall_from(word(5, "interpolated")));
    if (speaks) std::printf("drag %.4f, last change %.1e\n", r.drag, r.change);
  } else if (name == "taylor-green" && words.size() >= 4) {
    FlowParameters scheme;
    const std::string text = word(3, "upwind3"), convection = text.substr(0, text.find('+'));
    scheme.convection = convection_from(convection);
    if (scheme.convection == Convection::conserving4) scheme.order = 4;
    if (text.ends_with("+vreman")) scheme.extra_viscosity.vreman = 0.07;
    const Dissipation r = taylor_green(static_cast<int>(number(1)), number(2), scheme);
    if (speaks) {
      for (std::size_t i = 0; i < r.time.size(); ++i)
        std::printf("%.3f %.6f %.6f\n", r.time[i], r.rate[i], r.energy[i]);
      std::printf("peak %.5f at t = %.2f; difference from the reference %.3f of its mean\n", r.peak,
                  r.peak_time, r.rms);
    }
  } else {
    std::fprintf(stderr, "usage: study_fluid cavity|cylinder|sphere|taylor-green ...; see study.cpp\n");
    return 2;
  }
}
