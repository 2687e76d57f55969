// A thin shell without own mass that moves with the fluid: its nodes carry forces to the grid and take their
// velocity from it. Clamped nodes stay where they are; what the shell pulls at them is the reaction of
// whatever holds it. The work is divided among the ranks, positions and forces are the same on all of them.
#pragma once

#include <vector>

#include "core/mpi.hpp"
#include "coupling/immersed_body.hpp"
#include "coupling/near_pairs.hpp"
#include "coupling/repulsion.hpp"
#include "structure/shell.hpp"

namespace valsalva::coupling {

/// Between leaflets.
struct Spacing {
  RepulsionParameters repulsion;
  double standoff_mm = 0;  ///< standoff.hpp; 0: none
};

class ImmersedShell : public ImmersedBody {
 public:
  /// rest: where neighbours neither repel each other nor stand off. clamped: one a node. group: leaflet of
  /// each node.
  ImmersedShell(MPI_Comm comm, structure::Shell shell, Points rest, Points start,
                std::vector<std::uint8_t> clamped, std::vector<int> group, const Spacing& spacing);

  const structure::Shell& shell() const { return shell_; }
  const Points& x() const override { return x_; }
  /// Where the shell couples to the grid (standoff.hpp).
  const Points& coupling_points() const override { return coupled_; }
  void set_x(Points x) override;
  bool clamped(std::size_t node) const { return clamped_[node] != 0; }

  /// Elastic force and repulsion on every node, uN; zero at clamped nodes (collective).
  void begin_step(double dt_s, const Points& last_velocity, double lead) override;
  double lead() const override { return step_lead; }
  double least_lead() const override { return least_step_lead; }
  void forces(Points& out) override;
  /// Force of the shell on what holds its clamped nodes, uN, at the last forces().
  const Vec3& pull_on_clamps() const { return pull_; }
  /// Ranges of the repulsion, from those of the start (0) to the full ones (1).
  void set_repulsion_growth(double growth) { repulsion_.set_growth(growth); }
  /// The smallest node distance between leaflets at the last forces().
  double nearest() const { return repulsion_.nearest(); }

  /// The tangent (positive semi-definite) at the present shape; then out = K direction (collective).
  void update_tangent() override;
  void tangent_product(const Points& direction, Points& out) const override;

  /// x += dt u for free nodes. NumericalFailure when a node is not finite or faster than 2e4 mm/s.
  void move(Points& velocity, double dt) override;
  /// (collective)
  EdgeStretch edge_stretch(const Points& since) const override;
  double stiffening(double strain) const override;
  std::map<std::string, state::Array> save() const override;
  void load(const state::State& state) override;

 private:
  void moved();

  MPI_Comm comm_;
  structure::Part part_;
  structure::Shell shell_;
  structure::ShellTangent tangent_;
  double standoff_;
  NearPairs near_;
  Repulsion repulsion_;
  std::vector<Edge> edges_;                  // of this rank
  std::vector<double> square_of_reference_;  // of their lengths
  Points x_, coupled_, ahead_;
  const std::vector<NearPair>* pairs_ = nullptr;  // of near_, at x_
  std::vector<std::uint8_t> clamped_;
  Vec3 pull_ = Vec3::Zero();
  // The largest modulus of a law's exponential over its value at rest: with the last forces, those before,
  // and the first after the tangent.
  double modulus_ = 1, modulus_before_ = 1, modulus_of_tangent_ = 1;
  bool tangent_is_new_ = false;
  mutable Points free_direction_;
};

}  // namespace valsalva::coupling
