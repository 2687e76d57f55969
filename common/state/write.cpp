#include <cmath>

#include "core/errors.hpp"
#include "core/provenance.hpp"
#include "core/run_folder.hpp"
#include "state/hdf5.hpp"
#include "state/schema.hpp"
#include "state/state.hpp"

namespace valsalva::state {
namespace {

namespace fs = std::filesystem;

void require_finite(const Array& array, const std::string& what) {
  const auto look = [&](const auto& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(static_cast<double>(values[i])))
        throw NumericalFailure(
            "'{}' holds a value that is not finite (entry {}); the state was not written and the "
            "last good one stands",
            what, i);
  };
  std::visit(look, array.data);
}

void require_finite(const Points& points, const std::string& what) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw NumericalFailure(
          "body '{}', node {}: the position is not finite; the state was not written and the last "
          "good one stands",
          what, i);
}

void require_finite(const State& state) {
  for (const auto& [name, mesh] : state.meshes) {
    require_finite(mesh.points, name);
    for (const auto& [field, array] : mesh.point_data) require_finite(array, name + "/" + field);
    for (const auto& [field, array] : mesh.cell_data) require_finite(array, name + "/" + field);
  }
  for (const auto& [name, image] : state.images)
    for (const auto& [field, array] : image.point_data) require_finite(array, name + "/" + field);
  for (const auto& [name, array] : state.restart) require_finite(array, name);
}

void write_fields(hid_t group, const std::string& where, const std::map<std::string, Array>& fields) {
  const hdf5::Handle data = hdf5::create_group(group, where);
  for (const auto& [name, array] : fields) hdf5::write_array(data, name, array);
}

void write_mesh(hid_t parent, const std::string& name, const Mesh& mesh) {
  const hdf5::Handle group = hdf5::create_group(parent, name);
  hdf5::write_attribute(group, "Version", std::vector<std::int64_t>{1, 0});
  hdf5::write_attribute(group, "Type", std::string("UnstructuredGrid"));
  hdf5::write_array(group, "NumberOfPoints", Array::of(std::vector<std::int64_t>{std::ssize(mesh.points)}));
  hdf5::write_array(group, "NumberOfCells", Array::of(std::vector<std::int64_t>{std::ssize(mesh.types)}));
  hdf5::write_array(group, "NumberOfConnectivityIds",
                    Array::of(std::vector<std::int64_t>{std::ssize(mesh.connectivity)}));
  hdf5::write_array(group, "Points", Array::of(mesh.points));
  hdf5::write_array(group, "Connectivity", Array::of(mesh.connectivity));
  hdf5::write_array(group, "Offsets", Array::of(mesh.offsets));
  hdf5::write_bytes(group, "Types", mesh.types);
  write_fields(group, "PointData", mesh.point_data);
  write_fields(group, "CellData", mesh.cell_data);
}

void write_image(hid_t parent, const std::string& name, const Image& image) {
  const hdf5::Handle group = hdf5::create_group(parent, name);
  hdf5::write_attribute(group, "Version", std::vector<std::int64_t>{1, 0});
  hdf5::write_attribute(group, "Type", std::string("ImageData"));
  const auto& n = image.dimensions;
  hdf5::write_attribute(group, "WholeExtent",
                        std::vector<std::int64_t>{0, n[0] - 1, 0, n[1] - 1, 0, n[2] - 1});
  const auto list = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  hdf5::write_attribute(group, "Origin", list(image.origin));
  hdf5::write_attribute(group, "Spacing", list(image.spacing));
  hdf5::write_attribute(group, "Direction", std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  write_fields(group, "PointData", image.point_data);
}

void write_header(hid_t file, const State& state) {
  hdf5::write_attribute(file, "schema", std::string(schema_name));
  hdf5::write_attribute(file, "schema_version", schema_version);
  hdf5::write_attribute(file, "stage", state.stage);
  hdf5::write_attribute(file, "case", state.case_name);
  hdf5::write_attribute(file, "time_s", state.time_s);
  hdf5::write_attribute(file, "step", state.step);
  hdf5::write_attribute(file, "final", std::int64_t{state.final ? 1 : 0});
  hdf5::write_attribute(file, "version", state.version.empty() ? version() : state.version);
  hdf5::write_attribute(file, "parameters", state.parameters);
  hdf5::write_attribute(file, "parameters_sha256", state.parameters_sha256);
  std::string parents;
  for (const std::string& parent : state.parents) parents += parent + '\n';
  hdf5::write_attribute(file, "parents", parents);
}

std::string content_of(const State& state) {
  const hdf5::Handle file = hdf5::create_file_in_memory();
  write_header(file, state);
  const hdf5::Handle meshes = hdf5::create_group(file, "meshes");
  for (const auto& [name, mesh] : state.meshes) write_mesh(meshes, name, mesh);
  for (const auto& [name, image] : state.images) write_image(meshes, name, image);
  const hdf5::Handle restart = hdf5::create_group(file, "restart");
  for (const auto& [name, array] : state.restart) hdf5::write_array(restart, name, array);
  for (const auto& [name, text] : state.texts) hdf5::write_bytes(restart, name, {text.begin(), text.end()});
  hdf5::write_attribute(file, "complete", std::int64_t{1});
  return hdf5::image_of(file);
}

}  // namespace

void write(const fs::path& path, const State& state) {
  require_finite(state);
  const hdf5::Quiet quiet;
  std::string bytes;
  try {
    bytes = content_of(state);
  } catch (const hdf5::Hdf5Failure& failure) {
    throw EnvironmentError(
        "{}: the state could not be composed in memory (at '{}'); use a larger machine or a "
        "coarser fidelity",
        path.string(), failure.what());
  }
  write_atomically(path, bytes);
}

}  // namespace valsalva::state
