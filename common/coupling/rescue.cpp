#include "coupling/rescue.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

using state::Array;

constexpr long interval = 200, most_recent_returns = 4;
constexpr double after_alarm = 0.6, recovery = 1.25;
const std::string prefix = "rescue/";

/// Everybody gets what rank 0 has.
void broadcast(MPI_Comm comm, Rescue::Arrays& arrays) {
  if (mpi::size(comm) == 1) return;
  const bool first = mpi::rank(comm) == 0;
  const auto text = [&](std::string& s) {
    std::uint64_t n = s.size();
    MPI_Bcast(&n, 1, MPI_UINT64_T, 0, comm);
    s.resize(n);
    MPI_Bcast(s.data(), static_cast<int>(n), MPI_CHAR, 0, comm);
  };
  std::uint64_t count = arrays.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, 0, comm);
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays) names.push_back(name);
  names.resize(count);
  Rescue::Arrays received;
  for (std::string& name : names) {
    text(name);
    Array array;
    std::vector<double> values;
    if (first) {
      array = arrays.at(name);
      values = array.doubles(name);
    }
    std::array<std::uint64_t, 2> sizes{values.size(), array.shape.size()};
    MPI_Bcast(sizes.data(), 2, MPI_UINT64_T, 0, comm);
    values.resize(sizes[0]);
    std::vector<std::uint64_t> shape(array.shape.begin(), array.shape.end());
    shape.resize(sizes[1]);
    MPI_Bcast(shape.data(), static_cast<int>(shape.size()), MPI_UINT64_T, 0, comm);
    MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, 0, comm);
    received[name] = Array::of(std::move(values), std::vector<std::size_t>(shape.begin(), shape.end()));
  }
  arrays = std::move(received);
}

}  // namespace

void Rescue::before_step(long steps, ImmersedFlow& system, const std::function<Arrays()>& save) {
  if (steps_ >= 0 && (steps % interval != 0 || steps == steps_)) return;
  if (steps_ >= 0) {
    system.set_caution(std::min(1.0, system.caution() * recovery));
    recent_ = 0;
  }
  copy_ = save();
  steps_ = steps;
}

void Rescue::go_back(const std::string& why, ImmersedFlow& system,
                     const std::function<void(const state::State&)>& load) {
  ++returns_;
  ++recent_;
  const double caution = system.caution() * after_alarm;
  state::State state;
  state.source = "the copy in memory";
  state.restart = copy_;
  broadcast(comm_, state.restart);
  load(state);
  system.set_caution(caution);
  if (recent_ > most_recent_returns)
    throw NumericalFailure("no way past step {} after {} returns with smaller steps; the last alarm: {}",
                           steps_, most_recent_returns, why);
}

Rescue::Arrays Rescue::save() const {
  Arrays out;
  out[prefix + "counts"] = Array::of(std::vector<double>{
      static_cast<double>(steps_), static_cast<double>(returns_), static_cast<double>(recent_)});
  for (const auto& [name, array] : copy_) out[prefix + "copy/" + name] = array;
  return out;
}

void Rescue::load(const state::State& state) {
  const std::string counts = prefix + "counts", copy = prefix + "copy/";
  const std::vector<double>& values = state.array(counts).doubles(counts);
  if (values.size() != 3)
    throw InputError("{}: {} has {} entries, expected 3", state.source, counts, values.size());
  steps_ = static_cast<long>(values[0]);
  returns_ = static_cast<long>(values[1]);
  recent_ = static_cast<long>(values[2]);
  copy_.clear();
  for (const auto& [name, array] : state.restart)
    if (name.starts_with(copy)) copy_[name.substr(copy.size())] = array;
}

}  // namespace valsalva::coupling
