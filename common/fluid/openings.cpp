#include "fluid/openings.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::fluid {

namespace {

constexpr double depth_cells = 4;     // of what is cut off
constexpr double still = 1e-9;        // mm/s: below, round-off does not decide what enters
constexpr double extended_cells = 3;  // beyond the plane: what convection and viscosity read

}  // namespace

Openings::Openings(const Slab& slab, double kinematic_viscosity)
    : slab_(slab), nu_(kinematic_viscosity), beyond_(slab) {}

int Openings::add(const OpeningPlane& plane) {
  planes_.push_back(plane);
  planes_.back().normal.normalize();
  pressure_.push_back(0);
  flow_.push_back(0);
  area_.push_back(0);
  return count() - 1;
}

// Fluid cells lie at least this deep before the plane; round-off does not decide where the plane is on faces.
double Openings::margin(int opening) const {
  return (0.5 * planes_[opening].normal.cwiseAbs().maxCoeff() - 1e-6) * slab_.grid.h;
}

void Openings::build(Solids& solids) {
  if (body_ < 0) body_ = solids.add_body("beyond the openings");
  FaceField open(slab_);
  const Grid& grid = slab_.grid;
  mark_cells();
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          // Faces of known flow are held since the first time.
          bool high = false;
          const int owner = solids.owner(d, i, j, k);
          const bool of_flow = owner == 1 + body_ && opening_between(d, i, j, k, high) >= 0;
          open[d](i, j, k) = owner == 0 || of_flow ? 1 : 0;
        }
      }
    }
    exchange_planes(slab_, open[d], ghosts);
  }
  find_faces(open);
  find_beyond(open);
  close(solids);
}

void Openings::mark_cells() {
  const Grid& grid = slab_.grid;
  beyond_.fill(0);
  for (int o = 0; o < count(); ++o) {
    for (int k = -ghosts; k < slab_.planes + ghosts; ++k) {
      const int z = k + slab_.first;
      if (z < 0 || z >= grid.cells[2]) continue;
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          const Vec3 x = grid.position(3, i, j, z);
          const double s = height(o, x);
          if (s <= -margin(o) || s >= depth_cells * grid.h || is_beyond(i, j, k)) continue;
          if ((x - planes_[o].centre - s * planes_[o].normal).norm() < planes_[o].radius)
            beyond_(i, j, k) = 1 + o;
        }
      }
    }
  }
}

// The opening that the face (d, i, j, k) belongs to, or -1.
int Openings::opening_between(int d, int i, int j, int k, bool& high_is_beyond) const {
  if ((d == 0 ? i : d == 1 ? j : k + slab_.first) < 1) return -1;
  const std::array<int, 3> low{i - (d == 0), j - (d == 1), k - (d == 2)};
  const bool low_beyond = is_beyond(low[0], low[1], low[2]), high_beyond = is_beyond(i, j, k);
  if (low_beyond == high_beyond) return -1;
  high_is_beyond = high_beyond;
  const int o = static_cast<int>(high_beyond ? beyond_(i, j, k) : beyond_(low[0], low[1], low[2])) - 1;
  const Vec3 fluid = high_beyond ? slab_.grid.position(3, low[0], low[1], low[2] + slab_.first)
                                 : slab_.grid.position(3, i, j, k + slab_.first);
  return height(o, fluid) <= -margin(o) ? o : -1;
}

Openings::CellFaces Openings::faces_of(int i, int j, int k, int opening, const FaceField& open) const {
  CellFaces out;
  for (int d = 0; d < 3; ++d) {
    const std::array<int, 3> up{i + (d == 0), j + (d == 1), k + (d == 2)};
    const std::ptrdiff_t low = open[d].index(i, j, k), high = open[d].index(up[0], up[1], up[2]);
    out.of[d] = {low, high};
    bool high_is_beyond = false;
    if (opening_between(d, up[0], up[1], up[2], high_is_beyond) == opening && high_is_beyond) {
      if (open[d](up[0], up[1], up[2]) > 0) out.of[d] = {high, high};
    } else if (opening_between(d, i, j, k, high_is_beyond) == opening && !high_is_beyond) {
      if (open[d](i, j, k) > 0) out.of[d] = {low, low};
    }
  }
  return out;
}

void Openings::find_faces(const FaceField& open) {
  const Grid& grid = slab_.grid;
  const double h = grid.h;
  faces_.clear();
  known_.clear();
  std::vector<double> sums(2 * count(), 0.0);  // area, and flow of the profile
  const auto inverse = [&](int o, int d, const Vec3& cell) {
    return h * std::abs(planes_[o].normal[d]) / -height(o, cell);
  };
  const auto at_profile = [&](int o, const Vec3& x) {
    return planes_[o].profile(x - height(o, x) * planes_[o].normal);
  };
  std::string beside;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          bool high = false;
          const int o = opening_between(d, i, j, k, high);
          if (open[d](i, j, k) == 0) continue;
          const std::array<int, 3> low{i - (d == 0), j - (d == 1), k - (d == 2)};
          const int at = d == 0 ? i : d == 1 ? j : k + slab_.first;
          if (o >= 0) {
            const std::array<int, 3> c = high ? low : std::array<int, 3>{i, j, k};
            const double normal = std::abs(planes_[o].normal[d]);
            Face face;
            face.opening = o;
            face.d = d;
            face.of_face = {i, j, k};
            face.of_cell = c;
            face.face = open[d].index(i, j, k);
            face.cell = open[d].index(c[0], c[1], c[2]);
            face.outward = high ? 1 : -1;
            face.inverse = inverse(o, d, grid.position(3, c[0], c[1], c[2] + slab_.first));
            face.near = faces_of(c[0], c[1], c[2], o, open);
            face.shape = 0;
            if (known_flow(o)) {
              const double value = normal * at_profile(o, grid.position(d, i, j, k + slab_.first));
              face.shape = face.outward * value;
              sums[2 * o + 1] += h * h * value;
            }
            sums[2 * o] += h * h * normal;
            faces_.push_back(face);
          } else if (at > 0 && at < grid.cells[d] &&
                     is_beyond(i, j, k) != is_beyond(low[0], low[1], low[2])) {
            const bool above = is_beyond(i, j, k);
            const int of = static_cast<int>(above ? beyond_(i, j, k) : beyond_(low[0], low[1], low[2])) - 1;
            if (of >= 0 && height(of, grid.position(d, i, j, k + slab_.first)) < 1.5 * h)
              beside = planes_[of].name;
          }
        }
      }
    }
  }
  // Cells of known pressure belong to the rank of the cell, faces to that of the face.
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        if (is_beyond(i, j, k)) continue;
        for (int d = 0; d < 3; ++d) {
          for (int up = 0; up < 2; ++up) {
            const std::array<int, 3> f{i + up * (d == 0), j + up * (d == 1), k + up * (d == 2)};
            if (f[0] >= grid.cells[0] || f[1] >= grid.cells[1] || f[2] + slab_.first >= grid.cells[2])
              continue;
            bool high = false;
            const int o = opening_between(d, f[0], f[1], f[2], high);
            if (o < 0 || high != (up == 1) || open[d](f[0], f[1], f[2]) == 0) continue;
            known_.push_back(
                {i, j, k, o, known_flow(o) ? 0.0 : inverse(o, d, grid.position(3, i, j, k + slab_.first))});
          }
        }
      }
    }
  }
  if (mpi::any(slab_.comm, !beside.empty()))
    throw InputError(
        "fluid: there is fluid beside the opening{}: its radius does not reach across the vessel; enlarge "
        "it, "
        "or move the opening to where the vessel is clear of others",
        beside.empty() ? std::string() : " '" + beside + "'");
  mpi::sum_in_place(slab_.comm, sums.data(), sums.size());
  for (int o = 0; o < count(); ++o) {
    area_[o] = sums[2 * o];
    if (!(area_[o] > 0))
      throw InputError(
          "fluid: no fluid in the opening '{}'; its plane must cut the vessel inside the box, its normal "
          "points "
          "out of the fluid",
          planes_[o].name);
    if (known_flow(o) && !(sums[2 * o + 1] > 0))
      throw InputError("fluid: the profile of the opening '{}' carries no flow through the vessel",
                       planes_[o].name);
  }
  for (Face& face : faces_)
    if (known_flow(face.opening)) face.shape /= sums[2 * face.opening + 1];
  profile_flow_.resize(count());
  for (int o = 0; o < count(); ++o) profile_flow_[o] = sums[2 * o + 1];
}

// Where a face beyond the plane takes its velocity from: the face of its kind, and the fluid cell, nearest to
// where the normal through it meets the plane.
void Openings::find_beyond(const FaceField& open) {
  const Grid& grid = slab_.grid;
  const double h = grid.h;
  behind_.clear();
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          const std::array<int, 3> low{i - (d == 0), j - (d == 1), k - (d == 2)};
          const double mark = std::max(beyond_(i, j, k), beyond_(low[0], low[1], low[2]));
          bool high = false;
          if (mark == 0 || opening_between(d, i, j, k, high) >= 0) continue;
          const int o = static_cast<int>(mark) - 1;
          const Vec3& n = planes_[o].normal;
          const Vec3 x = grid.position(d, i, j, k + slab_.first);
          const double s = height(o, x);
          if (s > extended_cells * h) continue;
          const Vec3 foot = x - s * n;
          Beyond out{o, d, open[d].index(i, j, k), -1, false, 0, false, {}};
          const auto nearest = [&](int e, const auto& fits, const auto& take) {
            const Vec3 at = (foot - grid.position(e, 0, 0, slab_.first)) / h;
            double best = 1e300;
            std::array<int, 3> from;
            for (int f = 0; f < 3; ++f) from[f] = static_cast<int>(std::lround(at[f])) - 2;
            for (int r = from[2]; r <= from[2] + 4; ++r) {
              if (r < 1 - ghosts || r > slab_.planes + ghosts - 2) continue;
              for (int q = std::max(0, from[1]); q <= std::min(from[1] + 4, grid.cells[1] - 1); ++q) {
                for (int p = std::max(0, from[0]); p <= std::min(from[0] + 4, grid.cells[0] - 1); ++p) {
                  if (!fits(p, q, r)) continue;
                  const Vec3 away = Vec3(p, q, r) - at;
                  const double along = away.dot(n);
                  const double distance = away.squaredNorm() - 0.75 * along * along;
                  if (distance >= best - 1e-9) continue;
                  best = distance;
                  take(p, q, r);
                }
              }
            }
          };
          nearest(
              d,
              [&](int p, int q, int r) {
                bool up = false;
                return opening_between(d, p, q, r, up) >= 0 ||
                       (!is_beyond(p, q, r) && !is_beyond(p - (d == 0), q - (d == 1), r - (d == 2)) &&
                        height(o, grid.position(d, p, q, r + slab_.first)) <= 0);
              },
              [&](int p, int q, int r) {
                out.source = open[d].index(p, q, r);
                out.fluid = open[d](p, q, r) > 0;
              });
          nearest(
              3,
              [&](int p, int q, int r) {
                if (is_beyond(p, q, r) || height(o, grid.position(3, p, q, r + slab_.first)) > -margin(o))
                  return false;
                return open[0](p, q, r) + open[0](p + 1, q, r) + open[1](p, q, r) + open[1](p, q + 1, r) +
                           open[2](p, q, r) + open[2](p, q, r + 1) >
                       0;
              },
              [&](int p, int q, int r) {
                out.near = faces_of(p, q, r, o, open);
                out.has_cell = true;
              });
          if (out.source < 0) continue;
          if (known_flow(o) && out.fluid) out.shape = n[d] * planes_[o].profile(foot) / profile_flow_[o];
          behind_.push_back(out);
        }
      }
    }
  }
}

void Openings::close(Solids& solids) const {
  const Grid& grid = slab_.grid;
  for (int k = 0; k < slab_.w_planes(); ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        for (int d = k < slab_.planes ? 0 : 2; d < (k < slab_.planes ? 4 : 3); ++d) {
          const std::array<int, 3> low{i - (d == 0), j - (d == 1), k - (d == 2)};
          if (!is_beyond(i, j, k) && (d == 3 || !is_beyond(low[0], low[1], low[2]))) continue;
          bool high = false;
          const int o = d < 3 ? opening_between(d, i, j, k, high) : -1;
          if (o < 0 || (known_flow(o) && solids.owner(d, i, j, k) == 0)) solids.claim(body_, d, i, j, k);
        }
      }
    }
  }
}

void Openings::apply(FaceField& conductance, Field& known) const {
  for (const Face& face : faces_) conductance[face.d].data()[face.face] = 0;
  for (const KnownCell& cell : known_) known(cell.i, cell.j, cell.k) += cell.conductance;
}

void Openings::add_known_pressure(int k, const std::vector<double>& known, const CellRows& b) const {
  const double h = slab_.grid.h;
  for (const KnownCell& cell : known_) {
    if (cell.k == k) b(cell.i, cell.j) -= cell.conductance * known[cell.opening] / (h * h);
  }
}

void Openings::keep_joined(const std::function<bool(int, int, int)>& solves, Solids& solids) {
  const double face_area = slab_.grid.h * slab_.grid.h;
  std::vector<double> left(2 * count(), 0.0);  // faces, and flow of the profile
  std::erase_if(faces_, [&](const Face& face) {
    if (solves(face.of_cell[0], face.of_cell[1], face.of_cell[2])) {
      left[2 * face.opening] += 1;
      left[2 * face.opening + 1] += face_area * face.outward * face.shape;
      return false;
    }
    shut(solids, face.d, face.of_face[0], face.of_face[1], face.of_face[2]);
    return true;
  });
  mpi::sum_in_place(slab_.comm, left.data(), left.size());
  for (int o = 0; o < count(); ++o) {
    if (left[2 * o] == 0 || (known_flow(o) && !(left[2 * o + 1] > 0)))
      throw InputError(
          "fluid: the opening '{}' is joined with no place of known pressure; give the vessel an opening or "
          "an "
          "outflow side of known pressure that it reaches",
          planes_[o].name);
  }
  for (Face& face : faces_)
    if (known_flow(face.opening)) face.shape /= left[2 * face.opening + 1];
  for (Beyond& face : behind_)
    if (known_flow(face.opening)) face.shape /= left[2 * face.opening + 1];
  kept_rate_.assign(faces_.size(), 0.0);
}

void Openings::keep_rates(const FaceField& rate) {
  for (std::size_t f = 0; f < faces_.size(); ++f) kept_rate_[f] = rate[faces_[f].d].data()[faces_[f].face];
}

void Openings::advance(const FaceField& velocity, const Advance& step, FaceField& rate,
                       FaceField& next) const {
  const double h = slab_.grid.h;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    if (known_flow(face.opening)) continue;
    const double* q = velocity[face.d].data().data() + face.face;
    double& now = rate[face.d].data()[face.face];
    const Vec3 mean = face.near.velocity(velocity);
    const Vec3& n = planes_[face.opening].normal;
    if (face.outward * q[0] < -still) {
      // At least the face's own speed: a stream through one face into the cell and out of the next takes from
      // the reservoir too.
      const double w = std::min(0.0, mean.dot(n));
      const double head = std::max(w * w, q[0] * q[0]) / 2;
      const double laplacian = (q[1] + q[-1]) + (q[slab_.stride_y] + q[-slab_.stride_y]) +
                               (q[slab_.stride_z] + q[-slab_.stride_z]) - 6 * q[0];
      now = face.outward * face.inverse * head / h + nu_ / (h * h) * laplacian;
    }
    // Towards flow along the normal, over the time in which it crosses a cell.
    now -= (std::abs(q[0]) + mean.norm()) / h * (q[0] - mean.dot(n) * n[face.d]);
    double out = q[0] + step.dt * (step.weight_new * now + step.weight_old * kept_rate_[f]);
    if (step.pressure) {
      const double rise = pressure_[face.opening] - step.pressure->data()[face.cell];
      out -= step.dt / step.density * face.outward * face.inverse * rise / h;
    }
    if (step.force) out += step.dt / step.density * (*step.force)[face.d].data()[face.face];
    next[face.d].data()[face.face] = out;
  }
}

void Openings::prescribe(FaceField& velocity) const {
  for (const Face& face : faces_)
    if (known_flow(face.opening)) velocity[face.d].data()[face.face] = face.shape * flow_[face.opening];
}

void Openings::correct(double factor, const std::vector<double>& known, const Field& phi,
                       FaceField& velocity) const {
  for (const Face& face : faces_) {
    if (known_flow(face.opening)) continue;
    velocity[face.d].data()[face.face] -=
        factor * face.outward * face.inverse * (known[face.opening] - phi.data()[face.cell]);
  }
}

void Openings::extend(FaceField& velocity) const {
  for (const Beyond& face : behind_) {
    double& u = velocity[face.d].data()[face.face];
    if (known_flow(face.opening)) {
      u = face.shape * flow_[face.opening];
      continue;
    }
    const Vec3& n = planes_[face.opening].normal;
    const double w = face.fluid && face.has_cell ? face.near.velocity(velocity).dot(n) : 0;
    u = w < -still ? w * n[face.d] : velocity[face.d].data()[face.source];
  }
}

double Openings::outflow(int opening, const FaceField& velocity) const {
  double sum = 0;
  for (const Face& face : faces_)
    if (face.opening == opening) sum += face.outward * velocity[face.d].data()[face.face];
  return mpi::sum(slab_.comm, sum) * slab_.grid.h * slab_.grid.h;
}

double Openings::largest_prescribed() const {
  double largest = 0;
  for (const Face& face : faces_) {
    const Vec3& n = planes_[face.opening].normal;
    const double speed = std::abs(face.shape * flow_[face.opening] / n[face.d]);
    largest = std::max(largest, speed * n.lpNorm<1>());
  }
  return largest;
}

double Openings::largest_speed(const FaceField& velocity) const {
  double largest = 0;
  for (const Face& face : faces_) largest = std::max(largest, face.near.velocity(velocity).lpNorm<1>());
  return largest;
}

}  // namespace valsalva::fluid
