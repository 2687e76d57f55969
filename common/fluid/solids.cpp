#include "fluid/solids.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::fluid {

namespace {

double squared_distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double length2 = e.squaredNorm();
  const double t = length2 > 0 ? std::clamp((x - a).dot(e) / length2, 0.0, 1.0) : 0;
  return (x - a - t * e).squaredNorm();
}

double squared_distance_to_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const bool inside = n.squaredNorm() > 0 && (b - a).cross(x - a).dot(n) >= 0 &&
                      (c - b).cross(x - b).dot(n) >= 0 && (a - c).cross(x - c).dot(n) >= 0;
  if (inside) return std::pow((x - a).dot(n), 2) / n.squaredNorm();
  return std::min({squared_distance_to_segment(x, a, b), squared_distance_to_segment(x, b, c),
                   squared_distance_to_segment(x, c, a)});
}

}  // namespace

Wall wall_from(const std::string& name) {
  if (name == "staircase") return Wall::staircase;
  if (name == "interpolated") return Wall::interpolated;
  throw InputError("wall '{}'; expected staircase or interpolated", name);
}

Solids::Solids(const Slab& slab, double density, Wall form) : slab_(slab), density_(density), form_(form) {
  names_ = {"wall"};
  cut_cells_.resize(slab.planes);
  motion_.resize(1);
  force_.assign(1, Vec3::Zero());
  moment_.assign(1, Vec3::Zero());
  const std::size_t cells = slab.grid.plane_cells() * slab.planes;
  for (int d = 0; d < 4; ++d) owner_[d].assign(cells + (d == 2 ? slab.grid.plane_cells() : 0), 0);
}

void Solids::check_body(int body) const {
  VALSALVA_ASSERT(body > wall && body < bodies());
}

template <class Inside>
void Solids::mark(int body, const Vec3& low, const Vec3& high, const Inside& inside) {
  const Grid& grid = slab_.grid;
  const auto owner = static_cast<std::uint8_t>(1 + body);
  for (int d = 0; d < 4; ++d) {
    const Vec3 zero = grid.position(d, 0, 0, 0);
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    std::array<int, 3> from, to;
    for (int e = 0; e < 3; ++e) {
      const int first = e == 2 ? slab_.first : 0, count = e == 2 ? planes : grid.cells[e];
      from[e] = static_cast<int>(
          std::clamp(std::ceil((low[e] - zero[e]) / grid.h), double(first), double(first + count)));
      to[e] = static_cast<int>(
          std::clamp(std::floor((high[e] - zero[e]) / grid.h) + 1, double(first), double(first + count)));
    }
    for (int k = from[2]; k < to[2]; ++k) {
      for (int j = from[1]; j < to[1]; ++j) {
        for (int i = from[0]; i < to[0]; ++i) {
          std::uint8_t& at = owner_[d][index(i, j, k - slab_.first)];
          if (at == 0 && inside(grid.position(d, i, j, k))) at = owner;
        }
      }
    }
  }
  listed_ = false;
  ++version_;
}

void Solids::set_lumen(const Distance& distance) {
  for (auto& owners : owner_) {
    std::replace(owners.begin(), owners.end(), std::uint8_t{1 + wall}, std::uint8_t{0});
  }
  const Vec3 margin = Vec3::Constant(slab_.grid.h);
  mark(wall, slab_.grid.low() - margin, slab_.grid.high() + margin,
       [&](const Vec3& x) { return !(distance(x) < 0); });
  if (form_ != Wall::interpolated) return;
  find_ghosts(distance);
  find_cut_cells(distance);
}

void Solids::find_ghosts(const Distance& distance) {
  const Grid& grid = slab_.grid;
  const double h = grid.h;
  const Field shape(slab_);
  const auto gradient = [&](const Vec3& x) {
    Vec3 g;
    for (int e = 0; e < 3; ++e) {
      const Vec3 step = 0.5 * h * Vec3::Unit(e);
      g[e] = (distance(x + step) - distance(x - step)) / h;
    }
    return g;
  };
  still_ghosts_ = 0;
  for (int d = 0; d < 3; ++d) {
    ghosts_[d].clear();
    const auto inside = [&](int i, int j, int k) { return distance(grid.position(d, i, j, k)) < 0; };
    // Component e at a point; false where one of its faces is not in the lumen, or out of the slab's reach
    // from the plane k.
    const auto read_at = [&](int e, const Vec3& x, int k, Ghost& ghost) {
      const Vec3 at = (x - grid.position(e, 0, 0, slab_.first)) / h;
      std::array<int, 3> corner;
      for (int f = 0; f < 3; ++f) corner[f] = static_cast<int>(std::floor(at[f]));
      for (int f = 0; f < 2; ++f)
        if (corner[f] < -1 || corner[f] >= grid.cells[f]) return false;
      if (corner[2] < k - ghosts || corner[2] > k + ghosts - 1 || corner[2] >= slab_.planes + ghosts - 1)
        return false;
      for (int c = 0; c < 8; ++c) {
        double& weight = ghost.weight[e][c] = 1;
        std::array<int, 3> of = corner;
        for (int f = 0; f < 3; ++f) {
          const int up = c >> f & 1;
          weight *= up ? at[f] - corner[f] : 1 - (at[f] - corner[f]);
          of[f] += up;
        }
        if (!(distance(grid.position(e, of[0], of[1], of[2] + slab_.first)) < 0)) return false;
      }
      ghost.corner[e] = shape.index(corner[0], corner[1], corner[2]);
      return true;
    };
    const auto interpolate = [&](Ghost& ghost, const Vec3& x, int k) {
      const Vec3 g = gradient(x);
      const double size = g.norm();
      if (!(size > 0.1)) return false;
      const Vec3 n = g / size;
      const double s = std::max(0.0, distance(x) / size);
      for (int quarters = 4; quarters < 10; ++quarters) {
        const double delta = 0.25 * quarters * h;
        const Vec3 to = x - (s + delta) * n;
        if (!read_at(0, to, k, ghost) || !read_at(1, to, k, ghost) || !read_at(2, to, k, ghost)) continue;
        const double ratio = s / delta;
        for (int e = 0; e < 3; ++e) {
          const double share = (e == d ? -ratio : 0) + (ratio + ratio * ratio) * n[d] * n[e];
          for (double& weight : ghost.weight[e]) weight *= share;
        }
        return true;
      }
      return false;
    };
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      const int z = k + slab_.first;
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          if (owner(d, i, j, k) != 1 + wall) continue;
          if (!(inside(i - 1, j, z) || inside(i + 1, j, z) || inside(i, j - 1, z) || inside(i, j + 1, z) ||
                inside(i, j, z - 1) || inside(i, j, z + 1)))
            continue;
          Ghost ghost{shape.index(i, j, k), {}, {}};
          if (interpolate(ghost, grid.position(d, i, j, z), k)) {
            ghosts_[d].push_back(ghost);
          } else {
            ++still_ghosts_;
          }
        }
      }
    }
  }
}

void Solids::find_cut_cells(const Distance& distance) {
  const Grid& grid = slab_.grid;
  for (int k = 0; k < slab_.planes; ++k) {
    cut_cells_[k].clear();
    const int z = k + slab_.first;
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        CutCell cell{j * grid.cells[0] + i, {}};
        bool whole = true;
        for (int d = 0; d < 3; ++d) {
          for (int up = 0; up < 2; ++up) {
            const Vec3 x = grid.position(d, i + (d == 0) * up, j + (d == 1) * up, z + (d == 2) * up);
            cell.open[d][up] = distance(x) < 0;
            whole = whole && cell.open[d][up];
          }
        }
        if (!whole) cut_cells_[k].push_back(cell);
      }
    }
  }
}

long Solids::ghost_faces() const {
  return static_cast<long>(ghosts_[0].size() + ghosts_[1].size() + ghosts_[2].size());
}

void Solids::set_lumen(const geometry::GridSdf& distance) {
  set_lumen([&](const Vec3& x) { return distance.value(x); });
}

int Solids::add_body(const std::string& name) {
  if (bodies() == 255) throw InputError("fluid: more than 254 held bodies; '{}' has no number left", name);
  names_.push_back(name);
  motion_.emplace_back();
  force_.push_back(Vec3::Zero());
  moment_.push_back(Vec3::Zero());
  return bodies() - 1;
}

void Solids::clear_body(int body) {
  check_body(body);
  for (auto& owners : owner_) {
    std::replace(owners.begin(), owners.end(), static_cast<std::uint8_t>(1 + body), std::uint8_t{0});
  }
  listed_ = false;
  ++version_;
}

void Solids::mark_triangles(int body, const Points& points, const std::vector<Triangle>& triangles,
                            double radius) {
  check_body(body);
  const Vec3 margin = Vec3::Constant(radius);
  for (const auto& [a, b, c] : triangles) {
    const Vec3 &xa = points[a], &xb = points[b], &xc = points[c];
    mark(body, xa.cwiseMin(xb).cwiseMin(xc) - margin, xa.cwiseMax(xb).cwiseMax(xc) + margin,
         [&](const Vec3& x) { return squared_distance_to_triangle(x, xa, xb, xc) <= radius * radius; });
  }
}

void Solids::mark_segments(int body, const Points& points, const std::vector<Edge>& segments, double radius) {
  check_body(body);
  const Vec3 margin = Vec3::Constant(radius);
  for (const auto& [a, b] : segments) {
    const Vec3 &xa = points[a], &xb = points[b];
    mark(body, xa.cwiseMin(xb) - margin, xa.cwiseMax(xb) + margin,
         [&](const Vec3& x) { return squared_distance_to_segment(x, xa, xb) <= radius * radius; });
  }
}

void Solids::mark_inside(int body, const Distance& distance, const Vec3& low, const Vec3& high) {
  check_body(body);
  mark(body, low, high, [&](const Vec3& x) { return distance(x) < 0; });
}

void Solids::set_motion(int body, const RigidMotion& motion) {
  check_body(body);
  motion_[body] = motion;
}

void Solids::list_faces() {
  const Grid& grid = slab_.grid;
  const Field shape(slab_);
  for (int d = 0; d < 3; ++d) {
    held_[d].clear();
    walls_[d].clear();
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    auto ghost = ghosts_[d].begin();  // in the order of their index
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        bool open = false;  // the last run ends here
        for (int i = 0; i < grid.cells[0]; ++i) {
          const std::uint8_t of = owner(d, i, j, k);
          const std::ptrdiff_t at = shape.index(i, j, k);
          while (ghost != ghosts_[d].end() && ghost->index < at) ++ghost;
          const bool still = of == 1 + wall && (ghost == ghosts_[d].end() || ghost->index != at);
          if (still) {
            if (!open) walls_[d].push_back({at, 0});
            ++walls_[d].back().count;
          }
          open = still;
          if (of <= 1 + wall) continue;
          held_[d].push_back({shape.index(i, j, k), static_cast<std::uint8_t>(of - 1),
                              grid.position(d, i, j, k + slab_.first)});
        }
      }
    }
  }
  listed_ = true;
}

void Solids::penalise(double dt, double eta, const FaceField& last, FaceField& velocity) {
  prepare();
  std::fill(force_.begin(), force_.end(), Vec3::Zero());
  std::fill(moment_.begin(), moment_.end(), Vec3::Zero());
  const double ratio = dt / eta, keep = 1 / (1 + ratio);
  const double mass_rate = density_ * std::pow(slab_.grid.h, 3) / dt;
  Vec3 carried = Vec3::Zero();
  for (int d = 0; d < 3; ++d) {
    double* u = velocity[d].data().data();
    double lost = 0;
    for (const Ghost& ghost : ghosts_[d]) {
      const double after = keep * (u[ghost.index] + ratio * target(ghost, last));
      lost += u[ghost.index] - after;
      carried[d] += after;
      u[ghost.index] = after;
    }
    for (const Run& run : walls_[d]) {
      double* at = u + run.first;
#pragma omp simd reduction(+ : lost)
      for (int i = 0; i < run.count; ++i) {
        const double after = keep * at[i];
        lost += at[i] - after;
        at[i] = after;
      }
    }
    force_[wall][d] += mass_rate * lost;
    for (const Held& face : held_[d]) {
      const double after = keep * (u[face.index] + ratio * motion_[face.body].at(face.position)[d]);
      force_[face.body][d] += mass_rate * (u[face.index] - after);
      moment_[face.body] += mass_rate * (u[face.index] - after) * face.position.cross(Vec3::Unit(d));
      u[face.index] = after;
    }
  }
  count_carried(dt, carried);
}

// The sum of all ranks is subtracted by the first, so that a continued run has the same bits.
void Solids::count_carried(double dt, const Vec3& now) {
  if (!interpolated()) return;
  const double mass_rate = density_ * std::pow(slab_.grid.h, 3) / dt;
  if (carried_known_) {
    Vec3 before = carried_;
    mpi::sum_in_place(slab_.comm, before.data(), 3);
    force_[wall] += mass_rate * (slab_.rank == 0 ? Vec3(now - before) : now);
  }
  carried_before_ = carried_known_ ? carried_ : now;
  carried_ = now;
  carried_known_ = true;
}

std::vector<double> Solids::carried() const {
  Vec3 all = carried_;
  mpi::sum_in_place(slab_.comm, all.data(), 3);
  return {carried_known_ ? 1.0 : 0.0, all[0], all[1], all[2]};
}

void Solids::restore_carried(const std::vector<double>& carried) {
  VALSALVA_ASSERT(carried.size() == 4);
  carried_known_ = carried[0] != 0;
  carried_ = slab_.rank == 0 ? Vec3(carried[1], carried[2], carried[3]) : Vec3::Zero();
}

void Solids::still(FaceField& velocity, Planes within) {
  prepare();
  for (int d = 0; d < 3; ++d) {
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    const std::ptrdiff_t from = velocity[d].index(-ghosts, -ghosts, std::clamp(within.from, 0, planes)),
                         to = velocity[d].index(-ghosts, -ghosts, std::clamp(within.to, 0, planes));
    double* u = velocity[d].data().data();
    // The lists are in the order of the index.
    const auto each_within = [&](const auto& faces, auto index, const auto& action) {
      auto face = std::lower_bound(faces.begin(), faces.end(), from,
                                   [&](const auto& one, std::ptrdiff_t at) { return one.*index < at; });
      for (; face != faces.end() && (*face).*index < to; ++face) action(*face);
    };
    each_within(ghosts_[d], &Ghost::index, [&](const Ghost& ghost) { u[ghost.index] = 0; });
    each_within(walls_[d], &Run::first, [&](const Run& run) { std::fill_n(u + run.first, run.count, 0.0); });
    each_within(held_[d], &Held::index, [&](const Held& face) { u[face.index] = 0; });
  }
}

void Solids::record(double dt, double eta, const FaceField& before, const FaceField& velocity) {
  std::fill(force_.begin(), force_.end(), Vec3::Zero());
  std::fill(moment_.begin(), moment_.end(), Vec3::Zero());
  const double factor = density_ * std::pow(slab_.grid.h, 3) / eta;
  Vec3 carried = Vec3::Zero();
  for (int d = 0; d < 3; ++d) {
    const double* u = velocity[d].data().data();
    double of_wall = 0;
    for (const Ghost& ghost : ghosts_[d]) {
      of_wall += u[ghost.index] - target(ghost, before);
      carried[d] += u[ghost.index];
    }
    for (const Run& run : walls_[d]) {
      for (int i = 0; i < run.count; ++i) of_wall += u[run.first + i];
    }
    force_[wall][d] += factor * of_wall;
    for (const Held& face : held_[d]) {
      const double slip = u[face.index] - motion_[face.body].at(face.position)[d];
      force_[face.body][d] += factor * slip;
      moment_[face.body] += factor * slip * face.position.cross(Vec3::Unit(d));
    }
  }
  count_carried(dt, carried);
}

Vec3 Solids::force_on(int body) const {
  Vec3 total = force_[body];
  mpi::sum_in_place(slab_.comm, total.data(), 3);
  return total;
}

Vec3 Solids::moment_on(int body, const Vec3& about) const {
  check_body(body);
  std::array<double, 6> all;
  for (int d = 0; d < 3; ++d) {
    all[d] = force_[body][d];
    all[3 + d] = moment_[body][d];
  }
  mpi::sum_in_place(slab_.comm, all.data(), all.size());
  return Vec3(all[3], all[4], all[5]) - about.cross(Vec3(all[0], all[1], all[2]));
}

std::array<Vec3, 2> Solids::inertia(int body, const std::function<Vec3(const Vec3&)>& acceleration,
                                    const Vec3& about) {
  prepare();
  const double mass = density_ * std::pow(slab_.grid.h, 3);
  std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
  for (int d = 0; d < 3; ++d) {
    for (const Held& face : held_[d]) {
      if (face.body != body) continue;
      const Vec3 force = mass * acceleration(face.position)[d] * Vec3::Unit(d);
      sum[0] += force;
      sum[1] += (face.position - about).cross(force);
    }
  }
  for (Vec3& each : sum) mpi::sum_in_place(slab_.comm, each.data(), 3);
  return sum;
}

}  // namespace valsalva::fluid
