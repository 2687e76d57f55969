#include "surface_file.hpp"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include "core/errors.hpp"

namespace valsalva::segment {

geometry::TriMesh read_surface(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    throw InputError("{}: no such surface; supply this file, or set anatomy.image to yours", path.string());
  geometry::TriMesh mesh;
  if (path.extension() == ".vtp") {
    mesh = read_vtp(path);
  } else {
    using Point = CGAL::Simple_cartesian<double>::Point_3;
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> polygons;
    const std::string extension = path.extension().string();
    if (extension != ".stl" && extension != ".ply" && extension != ".obj" && extension != ".off")
      throw InputError(
          "{}: the ending is none that is known for a surface; expected .stl, .ply, .obj, .off or .vtp",
          path.string());
    if (!CGAL::IO::read_polygon_soup(path.string(), points, polygons))
      throw InputError("{}: cannot be read as a surface; is it cut short, or of another format?",
                       path.string());
    for (const Point& p : points) mesh.points.emplace_back(p.x(), p.y(), p.z());
    for (const auto& polygon : polygons)
      for (std::size_t n = 2; n < polygon.size(); ++n)
        mesh.triangles.push_back({int(polygon[0]), int(polygon[n - 1]), int(polygon[n])});
  }
  if (mesh.triangles.empty())
    throw InputError("{}: holds no polygon; expected a closed surface", path.string());
  Vec3 low = mesh.points.front(), high = low;
  for (const Vec3& p : mesh.points) {
    if (!p.allFinite())
      throw InputError("{}: has a coordinate that is not finite; export it again", path.string());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double extent = (high - low).maxCoeff();
  if (extent < 10 || extent > 1000)
    throw InputError("{}: its largest extent is {:g}, expected 10 to 1000 mm; scale it to millimetres",
                     path.string(), extent);
  return mesh;
}

}  // namespace valsalva::segment
