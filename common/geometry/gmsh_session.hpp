// gmsh's library between its start and its end; silent, one thread. Whoever includes this links gmsh.
#pragma once

#include <gmsh.h>

namespace valsalva::geometry {

struct GmshSession {
  GmshSession() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
  }
  ~GmshSession() { gmsh::finalize(); }
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

}  // namespace valsalva::geometry
