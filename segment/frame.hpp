// The annulus frame: origin in the annulus plane, z downstream, x towards the patient's left as far as the
// plane allows.
#pragma once

#include "geometry/planes.hpp"

namespace valsalva::segment {

struct Frame {
  Vec3 origin = Vec3::Zero();    ///< LPS, mm
  Mat3 axes = Mat3::Identity();  ///< columns: x, y, z of the frame in LPS

  static Frame at(const Vec3& centre, const Vec3& normal) {
    const geometry::Plane plane = geometry::Plane::at(centre, normal);
    Frame frame{centre, {}};
    frame.axes << plane.u, plane.v, plane.normal;
    return frame;
  }
  Vec3 to_scanner(const Vec3& local) const { return origin + axes * local; }
  Vec3 from_scanner(const Vec3& lps) const { return axes.transpose() * (lps - origin); }
};

}  // namespace valsalva::segment
