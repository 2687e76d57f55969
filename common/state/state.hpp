// State files: HDF5, written whole to *.part, flushed, closed, fsynced, renamed; never appended to
// afterwards.
//
// Root attributes: schema, schema_version, stage, case, time_s, step, final, version, parameters,
// parameters_sha256, parents (one "path sha256" a line), complete (= 1, written last).
//   /meshes/<body>   each mesh once, in VTKHDF-1.0 shape (UnstructuredGrid, or ImageData with point data)
//   /restart/...     everything else that the continuation needs
//
// Convention for bodies: `points` are the current positions; the point data `reference` (3 components) is the
// stress-free shape. Lengths mm, time s, pressure Pa, velocity mm/s.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/types.hpp"

namespace valsalva::state {

/// Row-major array of any rank.
struct Array {
  std::vector<std::size_t> shape;
  std::variant<std::vector<double>, std::vector<float>, std::vector<std::int64_t>> data;

  static Array scalar(double value);
  static Array of(std::vector<double> values);
  static Array of(std::vector<std::int64_t> values);
  static Array of(std::vector<double> values, std::vector<std::size_t> shape);
  static Array of(std::vector<float> values, std::vector<std::size_t> shape);
  static Array of(const Points& points);  ///< shape {n, 3}
  std::size_t size() const;
  /// Each throws InputError when type or shape differ; `what` names the array in the message.
  const std::vector<double>& doubles(const std::string& what) const;
  const std::vector<float>& floats(const std::string& what) const;
  const std::vector<std::int64_t>& integers(const std::string& what) const;
  double number(const std::string& what) const;
  Points points(const std::string& what) const;
};

/// VTK cell types in use.
enum class Cell : std::uint8_t { vertex = 1, line = 3, triangle = 5, tetra = 10 };

struct Mesh {
  Points points;
  std::vector<std::int64_t> connectivity;  ///< flat
  std::vector<std::int64_t> offsets;       ///< cells + 1
  std::vector<std::uint8_t> types;
  std::map<std::string, Array> point_data;  ///< first dimension: points
  std::map<std::string, Array> cell_data;   ///< first dimension: cells

  std::size_t cells() const { return types.size(); }
  static Mesh of_triangles(const Points& points, const std::vector<Triangle>& triangles);
  static Mesh of_tetrahedra(const Points& points, const std::vector<Tetrahedron>& tetrahedra);
  static Mesh of_lines(const Points& points, const std::vector<Edge>& edges);
  /// InputError when a cell has another type; `what` names the mesh.
  std::vector<Triangle> triangles(const std::string& what) const;
  std::vector<Tetrahedron> tetrahedra(const std::string& what) const;
  std::vector<Edge> lines(const std::string& what) const;
};

/// A regular grid with point data, x fastest in every array (shape {nz, ny, nx} or {nz, ny, nx, 3}).
struct Image {
  std::array<std::int64_t, 3> dimensions{};  ///< nx, ny, nz
  Vec3 origin = Vec3::Zero();
  Vec3 spacing = Vec3::Ones();
  std::map<std::string, Array> point_data;
};

struct State {
  std::string stage, case_name, version, parameters, parameters_sha256;
  std::vector<std::string> parents;  ///< "path sha256"
  double time_s = 0;
  std::int64_t step = 0;
  bool final = false;  ///< the stage is done; a next stage may start from here
  std::map<std::string, Mesh> meshes;
  std::map<std::string, Image> images;       ///< written below /meshes too
  std::map<std::string, Array> restart;      ///< "group/name" -> array
  std::map<std::string, std::string> texts;  ///< "group/name" -> text, below /restart

  /// InputError that names the missing entry, the file (if read) and the stage that writes it.
  const Mesh& mesh(const std::string& name) const;
  const Array& array(const std::string& name) const;
  const Array& point_data(const std::string& mesh, const std::string& name) const;
  const Array& cell_data(const std::string& mesh, const std::string& name) const;
  bool has_mesh(const std::string& name) const { return meshes.count(name) > 0; }
  bool has_array(const std::string& name) const { return restart.count(name) > 0; }
  std::string source;  ///< the file this was read from
};

/// EnvironmentError on any I/O failure (the old file, if any, is untouched); NumericalFailure when a value is
/// not finite (nothing is written).
void write(const std::filesystem::path& path, const State& state);

/// InputError when it is not a complete Valsalva state of this schema, when shapes do not agree, or a value
/// is not finite. expected_stage empty: any stage.
State read(const std::filesystem::path& path, const std::string& expected_stage);

/// The same, and refuses a state that is not final ("stage X has not finished: run ... --resume").
State read_final(const std::filesystem::path& path, const std::string& expected_stage);

/// view_<body>.hdf for every mesh and image of the state (tiny: an external link into the state file), and
/// view_<body>.hdf.series that lists them by time. ParaView 5.11 opens both.
void write_views(const std::filesystem::path& folder, const std::filesystem::path& state_file);

}  // namespace valsalva::state
