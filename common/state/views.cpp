#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"
#include "core/run_folder.hpp"
#include "state/hdf5.hpp"
#include "state/kept.hpp"
#include "state/state.hpp"

namespace valsalva::state {
namespace {

namespace fs = std::filesystem;

/// A file of a few hundred bytes in which /VTKHDF is an external link to the mesh inside the state.
void write_link(const fs::path& path, const std::string& target_file, const std::string& target_object) {
  const hdf5::Quiet quiet;
  const fs::path part = path.string() + ".part";
  try {
    hdf5::Handle file = hdf5::create_file(part.string());
    hdf5::check(H5Lcreate_external(target_file.c_str(), target_object.c_str(), file, "VTKHDF", H5P_DEFAULT,
                                   H5P_DEFAULT),
                "link");
    file.close("close");
    fs::rename(part, path);
  } catch (const hdf5::Hdf5Failure& failure) {
    throw EnvironmentError("{}: the view could not be written ({})", path.string(), failure.what());
  }
}

struct Described {
  double time_s = 0;
  std::vector<std::string> bodies;
};

Described describe(const fs::path& state_file) {
  const hdf5::Quiet quiet;
  try {
    const hdf5::Handle file = hdf5::open_file(state_file.string());
    return {hdf5::read_real_attribute(file, "time_s"), hdf5::names(hdf5::open_group(file, "meshes"))};
  } catch (const hdf5::Hdf5Failure& failure) {
    throw InputError("{}: it is no readable Valsalva state (at '{}')", state_file.string(), failure.what());
  }
}

}  // namespace

void write_views(const fs::path& folder, const fs::path& state_file) {
  const Described newest = describe(state_file);
  std::map<long, fs::path> states = kept_states(folder);
  for (const fs::path& state : RunFolder(folder).states()) states.emplace(RunFolder::index_of(state), state);
  for (const std::string& body : newest.bodies) {
    nlohmann::json series;
    series["file-series-version"] = "1.0";
    series["files"] = nlohmann::json::array();
    // One view a kept state, so that the series can be played; views of removed states go with them.
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("view_" + body + "_") && name.ends_with(".hdf")) fs::remove(entry.path());
    }
    for (const auto& [index, state] : states) {
      const Described described = describe(state);
      if (std::find(described.bodies.begin(), described.bodies.end(), body) == described.bodies.end())
        continue;
      const std::string name = fmt::format("view_{}_{:06d}.hdf", body, index);
      write_link(folder / name, state.filename().string(), "/meshes/" + body);
      series["files"].push_back({{"name", name}, {"time", described.time_s}});
    }
    write_link(folder / fmt::format("view_{}.hdf", body), state_file.filename().string(), "/meshes/" + body);
    write_atomically(folder / fmt::format("view_{}.hdf.series", body), series.dump(2) + "\n");
  }
}

}  // namespace valsalva::state
