// A straight superelastic beam along x in implicit equilibrium.
#pragma once

#include <cstdio>

#include "solve/statics.hpp"
#include "structure/beam.hpp"
#include "structure/dead_load.hpp"

namespace valsalva {

using materials::Superelastic;
using materials::SuperelasticParameters;
using materials::SuperelasticState;

struct BeamScene {
  structure::System system;
  std::shared_ptr<structure::BeamNetwork> network;
  std::shared_ptr<structure::BeamTerm> term;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  solve::Supports supports;
  std::unique_ptr<solve::Statics> statics;
  structure::Body body;

  BeamScene(double length, int elements, double width, double depth, const SuperelasticParameters& alloy,
            structure::FibreGrid grid) {
    structure::BeamMesh mesh;
    for (int i = 0; i <= elements; ++i) mesh.reference.emplace_back(length * i / elements, 0, 0);
    for (int i = 0; i < elements; ++i) mesh.elements.push_back({i, i + 1});
    mesh.width_mm.assign(elements, width);
    mesh.depth_mm.assign(elements, depth);
    mesh.depth_axis.assign(elements, Vec3::UnitZ());
    network = std::make_shared<structure::BeamNetwork>(
        mesh, structure::BeamMaterial{0, 0, 6.45e-3, std::make_shared<Superelastic>(alloy), grid});
    body = system.add_rotational_body(
        "beam", mesh.reference, network->lumped_mass(),
        std::vector<Eigen::Quaterniond>(mesh.reference.size(), Eigen::Quaterniond::Identity()),
        network->lumped_inertia());
    term = std::make_shared<structure::BeamTerm>(network, body);
    terms = {term};
  }

  void load(const Points& force, const Points& moment, std::function<double(double)> factor) {
    terms.push_back(std::make_shared<structure::DeadLoadTerm>("load", force, moment, std::move(factor)));
  }

  /// Time: 1 a step of the test.
  solve::Statics& solver() {
    if (!statics) {
      solve::StaticsSettings settings;
      settings.first_step = settings.max_step = 1;
      settings.min_step = 1e-3;
      settings.newton.max_iterations = 40;
      statics = std::make_unique<solve::Statics>(system, terms, supports, settings);
    }
    return *statics;
  }

  /// What has been dissipated up to the present equilibrium (the term counts up to the last accepted one).
  double dissipated_nJ() const {
    structure::FibreHistory now = term->history();
    network->advance(system.state.x, system.state.rotation, now);
    return now.dissipated_nJ;
  }
};

}  // namespace valsalva
