// A closed lumen surface from a file.
#pragma once

#include <filesystem>

#include "geometry/mesh.hpp"

namespace valsalva::segment {

/// STL, PLY, OBJ, OFF (through CGAL) and VTP; polygons are cut into triangles; positions are LPS, mm.
/// InputError: unreadable, empty, a value that is not finite, or an extent that cannot be millimetres.
geometry::TriMesh read_surface(const std::filesystem::path& path);

/// VTK's XML PolyData as VTK's own writer makes it: inline ASCII or inline base64, uncompressed or zlib, and
/// appended base64; polygons only. InputError otherwise, with the setting to change.
geometry::TriMesh read_vtp(const std::filesystem::path& path);

}  // namespace valsalva::segment
