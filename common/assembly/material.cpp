#include "assembly/material.hpp"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <map>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::assembly {
namespace {

constexpr double rad_per_deg = M_PI / 180;

class ScaledLaw : public materials::PlaneLaw {
 public:
  ScaledLaw(std::shared_ptr<const materials::PlaneLaw> law, double factor)
      : law_(std::move(law)), factor_(factor) {}
  std::string name() const override { return law_->name(); }
  materials::PlaneStress plane_stress(const Eigen::Matrix2d& c, const materials::PlaneFibres& fibres,
                                      double factor) const override {
    materials::PlaneStress s = law_->plane_stress(c, fibres, factor);
    s.energy *= factor_;
    s.stress *= factor_;
    return s;
  }
  materials::PlaneTangent plane_tangent(const Eigen::Matrix2d& c, const materials::PlaneFibres& fibres,
                                        double factor) const override {
    materials::PlaneTangent t = law_->plane_tangent(c, fibres, factor);
    t.at.energy *= factor_;
    t.at.stress *= factor_;
    t.tangent *= factor_;
    return t;
  }

 private:
  std::shared_ptr<const materials::PlaneLaw> law_;
  double factor_;
};

materials::ParameterValues parameters_of(const std::vector<std::string>& texts, const std::string& what) {
  materials::ParameterValues values;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const auto trimmed = [](std::string s) {
      const auto first = s.find_first_not_of(' '), last = s.find_last_not_of(' ');
      return first == std::string::npos ? std::string() : s.substr(first, last - first + 1);
    };
    const std::string key = trimmed(text.substr(0, equals));
    const std::string number = equals == std::string::npos ? "" : trimmed(text.substr(equals + 1));
    double value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (key.empty() || number.empty() || error != std::errc() || end != number.data() + number.size() ||
        !std::isfinite(value))
      throw InputError("{}: law_parameters: found \"{}\", expected \"key = number\"", what, text);
    values[key] = value;
  }
  return values;
}

materials::MaterialSet linear_material(const Case& body, const std::string& what) {
  const double young = body.real("body.young_kPa") * units::pa_per_kPa, nu = body.real("body.poisson");
  if (!(young > 0) || !(nu < 0.5))
    throw InputError(
        "{}: law = \"linear\": found young_kPa {} and poisson {}; expected a positive modulus and a number "
        "below 0.5",
        what, young / units::pa_per_kPa, nu);
  materials::MaterialSet set;
  set.law = "st-venant-kirchhoff";
  set.parameters = {{"lambda_Pa", young * nu / ((1 + nu) * (1 - 2 * nu))}, {"mu_Pa", young / (2 * (1 + nu))}};
  return set;
}

}  // namespace

materials::MaterialSet material_of(const Case& body, const std::string& what) {
  const std::string &name = body.text("body.material"), &law = body.text("body.law");
  if (name.empty() == law.empty())
    throw InputError("{}: found {} material and law; expected exactly one of them", what,
                     name.empty() ? "neither" : "both");
  if (!name.empty()) return materials::MaterialLibrary::built_in().find(name);
  materials::MaterialSet set;
  try {
    if (law == "linear") {
      set = linear_material(body, what);
    } else {
      set.law = law;
      set.parameters = parameters_of(body.texts("body.law_parameters"), what);
    }
    set.name = law;
    set.volumetric = {materials::volumetric_form(body.text("body.volumetric")),
                      body.real("body.bulk_modulus_kPa") * units::pa_per_kPa};
    const bool strain_law = set.law == "st-venant-kirchhoff";  // compressible by itself
    const bool none = set.volumetric.form == materials::Volumetric::Form::none;
    set.split =
        strain_law || body.text("body.split") == "full" ? materials::Split::full : materials::Split::modified;
    set.incompressible_sheet = none && !strain_law;
    (void)set.solid_law();
  } catch (const InputError& error) {
    throw InputError("{}: {}", what, error.what());
  }
  return set;
}

std::shared_ptr<const materials::Superelastic> superelastic_of(const Case& body, const std::string& what) {
  const std::string &name = body.text("body.material"), &law = body.text("body.law");
  if (name.empty() && law != "superelastic") return nullptr;
  try {
    if (!name.empty() && !law.empty())
      throw InputError("found both material and law; expected exactly one of them");
    if (!name.empty()) return std::make_shared<materials::Superelastic>(materials::superelastic_set(name));
    materials::SuperelasticParameters p;
    const std::map<std::string, double*> known{{"austenite_Pa", &p.austenite_Pa},
                                               {"martensite_Pa", &p.martensite_Pa},
                                               {"poisson", &p.poisson},
                                               {"transformation_strain", &p.transformation_strain},
                                               {"loading_start_Pa", &p.loading_start_Pa},
                                               {"loading_finish_Pa", &p.loading_finish_Pa},
                                               {"unloading_start_Pa", &p.unloading_start_Pa},
                                               {"unloading_finish_Pa", &p.unloading_finish_Pa},
                                               {"compression_start_Pa", &p.compression_start_Pa}};
    std::string names;
    for (const auto& [key, value] : known) names += (names.empty() ? "" : ", ") + key;
    for (const auto& [key, value] : parameters_of(body.texts("body.law_parameters"), what)) {
      if (!known.contains(key))
        throw InputError("law_parameters: found '{}', expected any of {}", key, names);
      *known.at(key) = value;
    }
    if (p.compression_start_Pa == 0) p.compression_start_Pa = p.loading_start_Pa;
    return std::make_shared<materials::Superelastic>(p);
  } catch (const InputError& error) {
    throw InputError("{}: {}", what, error.what());
  }
}

std::shared_ptr<const materials::PlaneLaw> scaled(std::shared_ptr<const materials::PlaneLaw> law,
                                                  double factor) {
  if (factor == 1) return law;
  return std::make_shared<ScaledLaw>(std::move(law), factor);
}

RestModuli moduli_at_rest(const materials::PlaneLaw& law, bool fibres) {
  materials::PlaneFibres along;
  along.count = fibres ? 1 : 0;
  const Eigen::Matrix3d d = law.plane_tangent(Eigen::Matrix2d::Identity(), along, 1).tangent;
  const double nu = d(0, 1) / d(0, 0);
  return {d(0, 0) * (1 - nu * nu), nu};
}

FibreFields fibres_of(const Case& body, const materials::MaterialSet& material, const Points& middle,
                      const Points& normal, const std::string& what) {
  const std::string& kind = body.text("body.fibres");
  FibreFields fields;
  if (kind == "none") {
    if (!material.fibre_angles_deg.empty())
      throw InputError("{}: material '{}' has fibres; expected fibres = \"constant\" or \"cylindrical\"",
                       what, material.name);
    return fields;
  }
  std::vector<double> angles = body.reals("body.fibre_angles_deg");
  if (angles.empty()) angles = material.fibre_angles_deg;
  if (angles.empty()) angles = {0};
  if (angles.size() > 2)
    throw InputError("{}: fibre_angles_deg has {} entries; expected one or two families", what,
                     angles.size());
  const auto vector = [&](const char* key) {
    const auto& v = body.reals(key);
    return Vec3(v[0], v[1], v[2]);
  };
  const Vec3 given = vector("body.fibre_direction"), point = vector("body.fibre_axis_point_mm");
  if (!(given.norm() > 0)) throw InputError("{}: fibre_direction is zero; expected a direction", what);
  const Vec3 axis = given.normalized();
  for (std::size_t e = 0; e < middle.size(); ++e) {
    Vec3 n = normal[e], mean = axis;
    if (kind == "cylindrical") {
      Vec3 radial = middle[e] - point;
      radial -= radial.dot(axis) * axis;
      if (!(radial.norm() > 0))
        throw InputError("{}: element {} lies on the axis of the cylindrical fibres", what, e);
      radial.normalize();
      if (n.isZero()) n = radial;
      const double turn = rad_per_deg * body.real("body.fibre_mean_deg");
      mean = std::cos(turn) * axis.cross(radial) + std::sin(turn) * axis;
    }
    mean -= mean.dot(n) * n;
    if (!(mean.norm() > 1e-6))
      throw InputError("{}: the fibre direction is normal to element {}; expected a direction within it",
                       what, e);
    mean.normalize();
    for (std::size_t i = 0; i < angles.size(); ++i)
      (i == 0 ? fields.first : fields.second).push_back(Eigen::AngleAxisd(rad_per_deg * angles[i], n) * mean);
  }
  return fields;
}

}  // namespace valsalva::assembly
