// A network of straight beams with rectangular section, elastic or superelastic: nodes with positions and
// rotations.
//
// Corotational energy of an element of reference length L between the nodes a and b. With the chord p = (x_b
// - x_a)/l and the nodal triads t_i = R E_i (E_1 along the reference chord, E_2 along the section's width,
// E_3 its depth),
//   theta_z = -asin(p . t_2),  theta_y = asin(p . t_3) at each end,  phi = asin((t^a_3 . t^b_2 - t^a_2 .
//   t^b_3)/2), U = EA/(2L) (l - L)^2 + sum_{z,y} EI/(2L (1 + Phi)) [(4 + Phi)(theta_a^2 + theta_b^2) +
//   (4 - 2 Phi) theta_a theta_b] + GJ/(2L) phi^2,  Phi = 12 EI/(G A_s L^2),
// each angle minus its value in the reference; Phi = 0 without shear flexibility (Timoshenko's beam:
// Przemieniecki 1968, Theory of Matrix Structural Analysis, section 5.6). Exact under rigid motion; small
// strain; end rotations below 90 degrees to the chord, twist below 90 degrees an element. Forces and moments
// are the exact gradient. A beam in its reference shape with identity rotations has exactly zero force. After
// Crisfield 1990 (A consistent corotational formulation for nonlinear 3D beam elements), sections 2 and 3.
//
// Section: width b along E_2 (circumferential), depth d along E_3 (radial):
//   I_z = d b^3/12 (bending along the width), I_y = b d^3/12, J = b d^3 (1/3 - 0.21 d/b (1 - d^4/(12 b^4))),
//   b >= d (J of the formula, unless the mesh gives it).
//
// Superelastic: in place of the energy of stretch and bending, fibres over the section at stations along the
// element (beam_fibres.hpp), torsion elastic with the shear modulus of austenite. Forces then depend on a
// FibreHistory, which BeamTerm keeps: it is advanced at the begin of a step to the configuration that was
// accepted, and trial configurations leave it alone, so that a refused step is undone by restoring positions
// and the term's snapshot.
// Lengths mm, moduli Pa, forces uN, moments uN mm, energy nJ.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "structure/beam_fibres.hpp"
#include "structure/force_term.hpp"

namespace valsalva::structure {

struct BeamMesh {
  Points reference;
  std::vector<Edge> elements;
  std::vector<double> width_mm;  ///< per element
  std::vector<double> depth_mm;  ///< per element
  std::vector<Vec3> depth_axis;  ///< per element: the direction of the depth in the reference; any that is
                                 ///< not parallel to the element
  /// Empty, or one an element: J in place of the rectangle's. A published "J" may be the polar moment
  /// b d (b^2 + d^2)/12, which for a square is 1.19 times the true one.
  std::vector<double> torsion_mm4 = {};
  /// Empty (no shear flexibility), or one an element: A_s, for shear along the width and along the depth
  /// alike; 5/6 of a rectangle's area.
  std::vector<double> shear_area_mm2 = {};
};

struct BeamMaterial {
  double young_Pa = 0;
  double poisson = 0.3;
  double density_g_per_mm3 = 0;
  /// Given: the moduli are those of this law, and young_Pa and poisson are not used.
  std::shared_ptr<const materials::Superelastic> superelastic = nullptr;
  FibreGrid fibres = {};
};

/// The direction away from the z axis at the middle of every element: the depth axis of a stent's struts.
std::vector<Vec3> radial_directions(const Points& reference, const std::vector<Edge>& elements);

/// Torsion constant of a rectangle, mm4 (Timoshenko and Goodier, within 0.5 %).
double torsion_constant(double width_mm, double depth_mm);

struct BeamState {
  double axial_strain = 0;
  double max_strain = 0;  ///< axial and bending at the worst corner
};

class BeamNetwork {
 public:
  /// InputError names the element that has no length or a wrong section.
  BeamNetwork(BeamMesh mesh, const BeamMaterial& material);
  int nodes() const { return static_cast<int>(mesh_.reference.size()); }
  int elements() const { return static_cast<int>(mesh_.elements.size()); }
  const BeamMesh& mesh() const { return mesh_; }
  std::vector<double> lumped_mass() const;
  /// Half the mass of every adjacent element times L^2/12 or the section's gyration, whichever is larger.
  std::vector<double> lumped_inertia() const;

  bool superelastic() const { return fibres_.has_value(); }
  /// All austenite, nothing dissipated; empty for elastic beams.
  FibreHistory rest() const;
  /// Positions x[offset + a], rotations rotation[rotation_offset + a]; returns the stored energy. `history`
  /// (null: at rest) matters to superelastic beams only.
  double add_forces(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, Points& force,
                    Points& moment, int offset = 0, int rotation_offset = 0,
                    const FibreHistory* history = nullptr) const;
  /// Takes the history to this configuration.
  void advance(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, FibreHistory& history,
               int offset = 0, int rotation_offset = 0) const;
  void add_stiffness_bound(const Points& x, StiffnessBound& out, int offset = 0,
                           int rotation_offset = 0) const;
  /// 12x12 a beam: B^T D B with the section's tangent D and the gradients B of the measures, plus the
  /// change of B at constant section forces, by central differences over positions and spins (1e-6 of its
  /// length, 1e-6 rad: eight digits). Not symmetric where a moment acts.
  void add_tangent(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, BlockMatrix& out,
                   int offset = 0, int rotation_offset = 0, const FibreHistory* history = nullptr) const;
  BeamState element_state(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, int element,
                          int offset = 0, int rotation_offset = 0) const;

 private:
  struct Angles {  // of the two ends about the section's axes, and the twist
    double length;
    double az, ay, bz, by, twist;
  };
  struct Slopes {  // M_a = bend (near theta_a + far theta_b)
    double near = 4, far = 2;
  };
  struct Element {
    double length;
    Mat3 axes;                              // columns E_1, E_2, E_3
    double axial, bend_z, bend_y, torsion;  // EA/L, EI_z/L, EI_y/L, GJ/L
    Slopes slopes_z, slopes_y;
    Angles rest;
    double mass;
  };
  struct Sines;
  struct Ends {  // forces and moments on the two ends
    std::array<Vec3, 2> force, moment;
  };
  Sines sines(const Vec3& xa, const Vec3& xb, const Eigen::Quaterniond& ra, const Eigen::Quaterniond& rb,
              int element) const;
  Sines sines(const Points& x, const std::vector<Eigen::Quaterniond>& rotation, int element, int offset,
              int rotation_offset) const;
  static Angles angles_of(const Sines& s);
  BeamMeasures measures(const Sines& s, int element) const;
  /// Section forces at q, returns the stored energy; the tangent unless null.
  double section(const BeamMeasures& q, int element, const FibreHistory* history, BeamMeasures& force,
                 BeamStiffness* stiffness) const;
  static Ends on_ends(const Sines& s, const BeamMeasures& force);
  const materials::SuperelasticState* fibres_of(const FibreHistory* history, int element) const;
  FibreSection::Shape shape(int element) const {
    return {elements_[element].length, mesh_.width_mm[element], mesh_.depth_mm[element]};
  }

  BeamMesh mesh_;
  std::optional<FibreSection> fibres_;
  std::vector<materials::SuperelasticState> austenite_;  // of one element
  std::vector<Element> elements_;
  double coupling_length_;  // scales rotations against positions in the stiffness bound
};

/// A beam network as one force term of a System.
class BeamTerm : public ForceTerm {
 public:
  /// `history`: what a former run left in the fibres; empty: rest. InputError when it belongs to another
  /// network.
  BeamTerm(std::shared_ptr<const BeamNetwork> network, const Body& body, FibreHistory history = {});
  std::string name() const override { return body_.name; }
  void begin_step(const Configuration& now, double) override {
    network_->advance(now.x, now.rotation, history_, body_.offset, body_.rotation_offset);
  }
  double add_forces(const Configuration& now, Forces& out) const override {
    return network_->add_forces(now.x, now.rotation, out.force, out.moment, body_.offset,
                                body_.rotation_offset, &history_);
  }
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override {
    network_->add_stiffness_bound(now.x, out, body_.offset, body_.rotation_offset);
  }
  void add_tangent(const Configuration& now, BlockMatrix& out) const override {
    network_->add_tangent(now.x, now.rotation, out, body_.offset, body_.rotation_offset, &history_);
  }
  Snapshot save() const override;
  void restore(const Snapshot& snapshot) override;
  const BeamNetwork& network() const { return *network_; }
  /// As of the last begin_step.
  const FibreHistory& history() const { return history_; }
  double dissipated_nJ() const { return history_.dissipated_nJ; }
  /// Largest fraction of martensite of any fibre.
  double largest_martensite() const;

 private:
  std::shared_ptr<const BeamNetwork> network_;
  Body body_;
  FibreHistory history_;
};

}  // namespace valsalva::structure
