#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "core/errors.hpp"
#include "state/hdf5.hpp"
#include "state/schema.hpp"
#include "state/state.hpp"

namespace valsalva::state {
namespace {

namespace fs = std::filesystem;

/// Reads one file; every complaint names it.
class Reader {
 public:
  explicit Reader(fs::path path) : path_(std::move(path)) {}

  State read(const std::string& expected_stage) {
    const hdf5::Quiet quiet;
    if (!fs::is_regular_file(path_))
      refuse("no such file; give the state_NNNNNN.h5 of the stage before, or run that stage");
    try {
      const hdf5::Handle file = hdf5::open_file(path_.string());
      read_header(file, expected_stage);
      read_meshes(file);
      read_restart(hdf5::open_group(file, "restart"), "");
    } catch (const hdf5::Hdf5Failure& failure) {
      refuse(fmt::format(
          "it is no readable Valsalva state (at '{}'): cut short, damaged, or another kind of file; rerun "
          "the stage that writes it",
          failure.what()));
    }
    return std::move(state_);
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError("{}: {}", path_.string(), message);
  }

  void read_header(hid_t file, const std::string& expected_stage) {
    if (!hdf5::has_attribute(file, "schema") || hdf5::read_text_attribute(file, "schema") != schema_name)
      refuse("it is HDF5 but no Valsalva state; give a state_NNNNNN.h5");
    const std::int64_t found_version = hdf5::read_integer_attribute(file, "schema_version");
    if (found_version != schema_version)
      refuse(fmt::format("its schema version is {}, this program reads {}; rerun the stage that writes it",
                         found_version, schema_version));
    if (!hdf5::has_attribute(file, "complete") || hdf5::read_integer_attribute(file, "complete") != 1)
      refuse("it is not complete: its writing was cut off; use the state before it or rerun the stage");
    state_.source = path_.string();
    state_.stage = hdf5::read_text_attribute(file, "stage");
    if (!expected_stage.empty() && state_.stage != expected_stage)
      refuse(fmt::format("it is a state of stage '{}', expected one of stage '{}'", state_.stage,
                         expected_stage));
    state_.case_name = hdf5::read_text_attribute(file, "case");
    state_.time_s = hdf5::read_real_attribute(file, "time_s");
    state_.step = hdf5::read_integer_attribute(file, "step");
    state_.final = hdf5::read_integer_attribute(file, "final") == 1;
    state_.version = hdf5::read_text_attribute(file, "version");
    state_.parameters = hdf5::read_text_attribute(file, "parameters");
    state_.parameters_sha256 = hdf5::read_text_attribute(file, "parameters_sha256");
    std::istringstream parents(hdf5::read_text_attribute(file, "parents"));
    for (std::string line; std::getline(parents, line);) state_.parents.push_back(line);
    if (!std::isfinite(state_.time_s)) refuse("its time is not finite");
  }

  Array checked_array(hid_t group, const std::string& name, const std::string& label) const {
    Array array = hdf5::read_array(group, name);
    const auto look = [&](const auto& values) {
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(static_cast<double>(values[i])))
          refuse(fmt::format(
              "entry '{}' holds a value that is not finite (at {}); rerun the stage that writes it", label,
              i));
    };
    std::visit(look, array.data);
    return array;
  }

  std::map<std::string, Array> read_fields(hid_t group, const std::string& where, std::size_t count,
                                           const std::string& label) const {
    std::map<std::string, Array> fields;
    const hdf5::Handle data = hdf5::open_group(group, where);
    for (const std::string& name : hdf5::names(data)) {
      Array array = checked_array(data, name, label + "/" + name);
      if (array.shape.empty() || array.shape[0] != count)
        refuse(fmt::format("field '{}/{}' has {} entries, expected {}; rerun the stage that writes it", label,
                           name, array.shape.empty() ? 0 : array.shape[0], count));
      fields.emplace(name, std::move(array));
    }
    return fields;
  }

  void read_meshes(hid_t file) {
    const hdf5::Handle meshes = hdf5::open_group(file, "meshes");
    for (const std::string& name : hdf5::names(meshes)) {
      const hdf5::Handle group = hdf5::open_group(meshes, name);
      if (hdf5::read_text_attribute(group, "Type") == "ImageData")
        state_.images.emplace(name, read_image(group, name));
      else
        state_.meshes.emplace(name, read_mesh(group, name));
    }
  }

  Mesh read_mesh(hid_t group, const std::string& name) const {
    Mesh mesh;
    mesh.points = checked_array(group, "Points", name + "/Points").points(name + "/Points");
    mesh.connectivity = hdf5::read_array(group, "Connectivity").integers(name + "/Connectivity");
    mesh.offsets = hdf5::read_array(group, "Offsets").integers(name + "/Offsets");
    mesh.types = hdf5::read_bytes(group, "Types");
    const bool offsets_fit = mesh.offsets.size() == mesh.types.size() + 1 && mesh.offsets.front() == 0 &&
                             mesh.offsets.back() == std::ssize(mesh.connectivity) &&
                             std::is_sorted(mesh.offsets.begin(), mesh.offsets.end());
    const auto inside = [&](std::int64_t node) { return node >= 0 && node < std::ssize(mesh.points); };
    if (!offsets_fit || !std::all_of(mesh.connectivity.begin(), mesh.connectivity.end(), inside))
      refuse(fmt::format("mesh '{}': its cells do not agree with its points; rerun the stage that writes it",
                         name));
    mesh.point_data = read_fields(group, "PointData", mesh.points.size(), name);
    mesh.cell_data = read_fields(group, "CellData", mesh.cells(), name);
    return mesh;
  }

  Image read_image(hid_t group, const std::string& name) const {
    Image image;
    const std::vector<double> extent = hdf5::read_reals_attribute(group, "WholeExtent");
    const std::vector<double> origin = hdf5::read_reals_attribute(group, "Origin");
    const std::vector<double> spacing = hdf5::read_reals_attribute(group, "Spacing");
    if (extent.size() != 6 || origin.size() != 3 || spacing.size() != 3)
      refuse(fmt::format("image '{}': its extent, origin or spacing is malformed", name));
    for (int d = 0; d < 3; ++d) {
      image.dimensions[d] = static_cast<std::int64_t>(extent[2 * d + 1]) + 1;
      image.origin[d] = origin[d];
      image.spacing[d] = spacing[d];
    }
    image.point_data = read_fields(group, "PointData", static_cast<std::size_t>(image.dimensions[2]), name);
    return image;
  }

  void read_restart(const hdf5::Handle& group, const std::string& prefix) {
    for (const std::string& name : hdf5::names(group)) {
      const std::string full = prefix + name;
      if (hdf5::is_group(group, name)) {
        read_restart(hdf5::open_group(group, name), full + "/");
      } else if (hdf5::is_bytes(group, name)) {
        const std::vector<std::uint8_t> bytes = hdf5::read_bytes(group, name);
        state_.texts[full] = std::string(bytes.begin(), bytes.end());
      } else {
        state_.restart.emplace(full, checked_array(group, name, full));
      }
    }
  }

  fs::path path_;
  State state_;
};

}  // namespace

State read(const fs::path& path, const std::string& expected_stage) {
  return Reader(path).read(expected_stage);
}

State read_final(const fs::path& path, const std::string& expected_stage) {
  State state = read(path, expected_stage);
  if (!state.final)
    throw InputError(
        "{}: stage '{}' has not finished (it stands at step {}); continue it with --resume first",
        path.string(), state.stage, state.step);
  return state;
}

}  // namespace valsalva::state
