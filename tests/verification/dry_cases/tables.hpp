// Pieces of case files that scenes of the tests have in common.
#pragma once

#include <string>

namespace valsalva::test {

/// The set of nodes that a group of the body's mesh is, by the group's name.
inline std::string group(const std::string& body, const std::string& name) {
  return "[[nodes]]\nname = \"" + name + "\"\nbody = \"" + body + "\"\nselect = \"group\"\ngroup = \"" +
         name + "\"\n";
}

/// A support of such a set: what it holds, as a TOML list, and further keys.
inline std::string support(const std::string& group, const std::string& hold, const std::string& more = "") {
  return "[[support]]\nname = \"" + group + "\"\nnodes = \"" + group + "\"\nhold = " + hold + "\n" + more;
}

/// Both.
inline std::string held(const std::string& body, const std::string& name, const std::string& hold,
                        const std::string& more = "") {
  return group(body, name) + support(name, hold, more);
}

inline std::string symmetry(const std::string& body, const std::string& name, const std::string& normal) {
  return held(body, name, "[\"symmetry\"]", "normal = " + normal + "\n");
}

/// Soft tissue: shear modulus 100 kPa, bulk modulus 500 kPa.
inline const std::string tissue = R"(
law = "neo-hookean"
law_parameters = ["mu_Pa = 1e5"]
volumetric = "j-ln-j"
bulk_modulus_kPa = 500
)";

}  // namespace valsalva::test
