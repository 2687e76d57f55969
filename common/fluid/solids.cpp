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

Solids::Solids(const Slab& slab, double density) : slab_(slab), density_(density) {
  names_ = {"wall"};
  motion_.resize(1);
  force_.assign(1, Vec3::Zero());
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
}

void Solids::set_lumen(const Distance& distance) {
  for (auto& owners : owner_) {
    std::replace(owners.begin(), owners.end(), std::uint8_t{1 + wall}, std::uint8_t{0});
  }
  const Vec3 margin = Vec3::Constant(slab_.grid.h);
  mark(wall, slab_.grid.low() - margin, slab_.grid.high() + margin,
       [&](const Vec3& x) { return !(distance(x) < 0); });
}

void Solids::set_lumen(const geometry::GridSdf& distance) {
  set_lumen([&](const Vec3& x) { return distance.value(x); });
}

int Solids::add_body(const std::string& name) {
  if (bodies() == 255) throw InputError("fluid: more than 254 held bodies; '{}' has no number left", name);
  names_.push_back(name);
  motion_.emplace_back();
  force_.push_back(Vec3::Zero());
  return bodies() - 1;
}

void Solids::clear_body(int body) {
  check_body(body);
  for (auto& owners : owner_) {
    std::replace(owners.begin(), owners.end(), static_cast<std::uint8_t>(1 + body), std::uint8_t{0});
  }
  listed_ = false;
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

long Solids::faces(int body) const {
  long count = 0;
  for (int d = 0; d < 3; ++d) {
    count += std::count(owner_[d].begin(), owner_[d].end(), static_cast<std::uint8_t>(1 + body));
  }
  return count;
}

void Solids::list_faces() {
  const Grid& grid = slab_.grid;
  const Field shape(slab_);
  for (int d = 0; d < 3; ++d) {
    held_[d].clear();
    walls_[d].clear();
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          const std::uint8_t of = owner(d, i, j, k);
          if (of == 1 + wall) {
            const std::ptrdiff_t at = shape.index(i, j, k);
            if (i == 0 || owner(d, i - 1, j, k) != of) walls_[d].push_back({at, 0});
            ++walls_[d].back().count;
          }
          if (of <= 1 + wall) continue;
          held_[d].push_back({shape.index(i, j, k), static_cast<std::uint8_t>(of - 1),
                              grid.position(d, i, j, k + slab_.first)});
        }
      }
    }
  }
  listed_ = true;
}

void Solids::penalise(double dt, double eta, FaceField& velocity) {
  prepare();
  std::fill(force_.begin(), force_.end(), Vec3::Zero());
  const double ratio = dt / eta, keep = 1 / (1 + ratio);
  const double mass_rate = density_ * std::pow(slab_.grid.h, 3) / dt;
  for (int d = 0; d < 3; ++d) {
    double* u = velocity[d].data().data();
    double lost = 0;
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
      u[face.index] = after;
    }
  }
}

void Solids::record(double eta, const FaceField& velocity) {
  std::fill(force_.begin(), force_.end(), Vec3::Zero());
  const double factor = density_ * std::pow(slab_.grid.h, 3) / eta;
  for (int d = 0; d < 3; ++d) {
    const double* u = velocity[d].data().data();
    double of_wall = 0;
    for (const Run& run : walls_[d]) {
      for (int i = 0; i < run.count; ++i) of_wall += u[run.first + i];
    }
    force_[wall][d] += factor * of_wall;
    for (const Held& face : held_[d])
      force_[face.body][d] += factor * (u[face.index] - motion_[face.body].at(face.position)[d]);
  }
}

Vec3 Solids::force_on(int body) const {
  Vec3 total = force_[body];
  mpi::sum_in_place(slab_.comm, total.data(), 3);
  return total;
}

}  // namespace valsalva::fluid
