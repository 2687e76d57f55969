// Meshes of simple shapes, mapped from regular grids. Every shape lives in a frame: origin, three orthonormal
// axes e1, e2, e3. Sides of the grid become groups of nodes: "start1"/"end1" along the first direction of the
// grid, and so on for 2 and 3 (in the order of `divisions`).
//
//   plate     origin + u e1 + v e2
//   cylinder  radius (cos a e1 + sin a e2) + z e3         grid: azimuth, height
//   sphere    radius (sin p (cos a e1 + sin a e2) + cos p e3)   grid: azimuth, polar angle; pole nodes merge
//   annulus   r (cos a e1 + sin a e2), r from the radius by its width   grid: azimuth, outwards
//   disc      radius (a sqrt(1 - b^2/2) e1 + b sqrt(1 - a^2/2) e2), a and b from -1 to 1: a square made round
//   ball      likewise a cube, a sqrt(1 - b^2/2 - c^2/2 + b^2 c^2/3) and so on   grid: along e1, e2, e3
//   corners   bilinear between 4 corners, trilinear between 8
//   line, arc e1; radius (cos a e1 + sin a e2)
// Solids have a third grid direction: the box its third length, cylinder and sphere the wall outwards.
// Nodes that coincide are sewn, as at a closed azimuth and at a pole, unless this is declined; triangles and
// solids are outward (plate: along e3). The nodal fields "grid1", "grid2", "grid3" hold each node's place in
// the grid, from 0 to 1.
#pragma once

#include <functional>
#include <string>

#include "assembly/mesh.hpp"

namespace valsalva::assembly {

struct Frame {
  Vec3 origin = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns e1, e2, e3
  Vec3 at(const Vec3& local) const { return origin + axes * local; }
};

/// Gram-Schmidt. InputError with `what` when a direction is zero or they are parallel.
Frame frame_of(const Vec3& origin, const Vec3& first, const Vec3& second, const std::string& what);

/// From [0, 1]^3 to space; a sheet has third coordinate 0, a curve also the second.
using Map = std::function<Vec3(const Vec3&)>;

Map plate_map(const Frame& frame, const Vec3& size, double twist_deg);
/// wall 0: a sheet.
Map cylinder_map(const Frame& frame, double radius, std::array<double, 2> angle_deg, double height,
                 double wall);
Map sphere_map(const Frame& frame, double radius, std::array<double, 2> angle_deg,
               std::array<double, 2> polar_deg, double wall);

/// Normal (azimuth x outwards) and wall along -e3.
Map annulus_map(const Frame& frame, double radius, std::array<double, 2> angle_deg, double width,
                double wall);
/// Normal along e3, wall along it too.
Map disc_map(const Frame& frame, double radius, double wall);
Map ball_map(const Frame& frame, double radius);
/// Corners of [0, 1]^2 counter-clockwise, or those of the bottom and then those of the top.
Map corner_map(const Points& corners);

/// Element sizes along each direction of the grid in geometric progression: the last over the first is the
/// ratio (in the limit of many elements); 1: even.
Map graded(Map map, const Vec3& ratio);

enum class Pattern { alternating, right, left, crossed };

BodyMesh curve(const Map& map, int divisions, bool sew = true);
BodyMesh sheet(const Map& map, std::array<int, 2> divisions, Pattern pattern, bool sew = true);
BodyMesh block(const Map& map, std::array<int, 3> divisions, structure::Shape shape, bool sew = true);

/// The mesh and its copies turned evenly about the frame's third axis, sewn where they meet. A group holds
/// the nodes of all copies; "<group>_1" those of the first, and so on.
BodyMesh repeated_round(const BodyMesh& mesh, const Frame& frame, int copies);

/// Values on count[0] x count[1] evenly spaced points of the unit square, the first direction running
/// fastest; at least two points each way.
double bilinear(const std::vector<double>& values, std::array<int, 2> count, double u, double v);

}  // namespace valsalva::assembly
