#include "inputs.hpp"

#include "bodies/frame.hpp"
#include "bodies/frame_law.hpp"
#include "bodies/level_set.hpp"
#include "bodies/shell.hpp"
#include "core/errors.hpp"

namespace valsalva::deploy {
namespace {

Points zero_or(const state::State& file, const std::string& name, std::size_t count) {
  if (!file.has_array(name)) return Points(count, Vec3::Zero());
  Points points = file.array(name).points(name);
  if (points.size() != count)
    throw InputError("{}: '{}' has {} entries; expected {}", file.source, name, points.size(), count);
  return points;
}

FrameBody read_frame(const state::State& crimp, const Parameters& p) {
  FrameBody frame;
  frame.network = std::make_shared<structure::BeamNetwork>(bodies::read_frame(crimp), p.frame);
  frame.points = crimp.mesh("frame").points;
  frame.velocity = zero_or(crimp, "frame/velocity", frame.points.size());
  frame.angular_velocity = zero_or(crimp, "frame/angular_velocity", frame.points.size());
  frame.rotation = bodies::read_rotations(crimp, frame.points.size());
  frame.fibres = bodies::read_fibres(crimp, *frame.network);
  return frame;
}

ShellBody read_shell(const state::State& file, const std::string& name, const Tissue& tissue, double factor,
                     bool native) {
  ShellBody body;
  body.name = name;
  body.points = file.mesh(name).points;
  body.velocity = zero_or(file, name + "/velocity", body.points.size());
  body.mounted = native ? body.points : file.point_data(name, "mounted").points(name + "/mounted");
  body.attached = bodies::read_attached(file, name);
  body.shell = std::make_shared<structure::Shell>(bodies::read_shell(file, name, factor),
                                                  std::make_shared<materials::Hgo>(tissue.law),
                                                  structure::Bending{tissue.bending_modulus_Pa, 0.5});
  body.density = tissue.density;
  return body;
}

}  // namespace

Inputs read_inputs(const std::filesystem::path& crimp, const std::filesystem::path& mesher,
                   const Parameters& p) {
  Inputs in;
  in.crimp = state::read_final(crimp, "crimp");
  in.mesher = state::read_final(mesher, "mesher");
  in.frame = read_frame(in.crimp, p);
  for (const char* name : {"leaflets", "skirt"}) {
    if (!in.crimp.has_mesh(name)) continue;
    in.tissue.push_back(read_shell(in.crimp, name, p.device, 1, false));
    in.ties.push_back(
        bodies::read_ties(in.crimp, name, in.tissue.back().shell->nodes(), in.frame.network->nodes()));
  }
  if (in.mesher.has_mesh("native_leaflets"))
    in.native = read_shell(in.mesher, "native_leaflets", p.native, p.stenosis_factor, true);
  in.wall = bodies::read_level_set(in.mesher, "lumen");
  return in;
}

}  // namespace valsalva::deploy
