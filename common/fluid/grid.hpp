// The staggered (MAC) grid, its division into slabs of z-planes, and the fields on it. Lengths in mm.
//
//   cell (i, j, k)       centre at origin + h (i + 1/2, j + 1/2, k + 1/2)
//   velocity component d on the cell's low face normal to d: u at i, v at j, w at k (so u(i) lies between the
//   cells i - 1 and i); pressure at the cell's centre
//
// A rank owns the planes [first, first + planes) of cells, and the faces with the same indices; the last rank
// also owns the faces w(nz) when z is not periodic. Every field has `ghosts` layers around the owned block.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#include "core/mpi.hpp"
#include "core/types.hpp"

namespace valsalva::fluid {

inline constexpr int ghosts = 3;

/// Along a direction: one between periodic sides (a plane flow), unless the pressure is that of the fluid's
/// cells alone.
inline int fewest_cells(bool periodic, bool fluid_cells_alone) {
  return periodic && !fluid_cells_alone ? 1 : ghosts;
}

struct Grid {
  std::array<int, 3> cells{1, 1, 1};
  Vec3 origin = Vec3::Zero();  ///< the low corner of the box
  double h = 1;                ///< mm, the same in all directions

  /// Position of face d (0, 1, 2) of cell (i, j, k), with k counted in the whole grid; d = 3: the cell's
  /// centre.
  Vec3 position(int d, int i, int j, int k) const {
    return origin + h * Vec3(i + (d == 0 ? 0.0 : 0.5), j + (d == 1 ? 0.0 : 0.5), k + (d == 2 ? 0.0 : 0.5));
  }
  Vec3 low() const { return origin; }
  Vec3 high() const { return origin + h * Vec3(cells[0], cells[1], cells[2]); }
  std::size_t plane_cells() const { return static_cast<std::size_t>(cells[0]) * cells[1]; }
  std::size_t all_cells() const { return plane_cells() * cells[2]; }
};

/// The part of the grid that one rank owns. InputError when there are more ranks than planes / ghosts allow.
struct Slab {
  MPI_Comm comm = MPI_COMM_SELF;
  int rank = 0, ranks = 1;
  Grid grid;
  int first = 0;   ///< the first owned plane of cells, in the whole grid
  int planes = 1;  ///< owned planes
  bool periodic_z = false;
  std::ptrdiff_t stride_y = 0, stride_z = 0;  ///< of every Field, in doubles (x is contiguous)

  Slab(MPI_Comm comm, const Grid& grid, bool periodic_z);
  /// First plane of any rank (rank == ranks gives nz); the division is a function of (nz, ranks) alone.
  int first_of(int of_rank) const;
  bool is_lowest() const { return rank == 0; }
  bool is_highest() const { return rank == ranks - 1; }
  /// Owned planes of faces w: one more than `planes` on the highest rank of a box that is not periodic.
  int w_planes() const { return planes + (is_highest() && !periodic_z ? 1 : 0); }
  std::size_t size() const { return static_cast<std::size_t>(stride_z) * (planes + 2 * ghosts); }
};

/// Local planes from <= k < to; those that are not there are left out.
struct Planes {
  int from = std::numeric_limits<int>::min(), to = std::numeric_limits<int>::max();
  bool has(int k) const { return k >= from && k < to; }
};

/// Memory in which cell 0 of every row begins a cache line, so that whole vectors of a row lie in one line
/// each.
template <class T>
struct RowAligned {
  using value_type = T;
  static constexpr std::size_t line = 64, lead = line - ghosts * sizeof(T) % line;
  RowAligned() = default;
  template <class U>
  RowAligned(const RowAligned<U>&) {}
  T* allocate(std::size_t count) {
    char* raw = static_cast<char*>(::operator new(count * sizeof(T) + lead, std::align_val_t(line)));
    return reinterpret_cast<T*>(raw + lead);
  }
  void deallocate(T* data, std::size_t) {
    ::operator delete(reinterpret_cast<char*>(data) - lead, std::align_val_t(line));
  }
  bool operator==(const RowAligned&) const = default;
};

/// One scalar on the owned block with its ghosts; indices i, j and the *local* plane k run from -ghosts on.
/// A field keeps the strides of its slab and no reference to it.
class Field {
 public:
  using Data = std::vector<double, RowAligned<double>>;
  explicit Field(const Slab& slab);
  double& operator()(int i, int j, int k) { return data_[index(i, j, k)]; }
  double operator()(int i, int j, int k) const { return data_[index(i, j, k)]; }
  /// Address of (0, j, k).
  double* row(int j, int k) { return data_.data() + index(0, j, k); }
  const double* row(int j, int k) const { return data_.data() + index(0, j, k); }
  std::ptrdiff_t index(int i, int j, int k) const {
    return (k + ghosts) * stride_z_ + (j + ghosts) * stride_y_ + i + ghosts;
  }
  std::ptrdiff_t stride_y() const { return stride_y_; }
  std::ptrdiff_t stride_z() const { return stride_z_; }
  Data& data() { return data_; }
  const Data& data() const { return data_; }
  void fill(double value) { data_.assign(data_.size(), value); }
  void swap(Field& other) noexcept { data_.swap(other.data_); }

 private:
  std::ptrdiff_t stride_y_, stride_z_;
  Data data_;
};

/// A vector on the faces: velocity (mm/s), force density (micronewton/mm3), rate of change (mm/s2).
struct FaceField {
  explicit FaceField(const Slab& slab) : component{Field(slab), Field(slab), Field(slab)} {}
  Field& operator[](int d) { return component[d]; }
  const Field& operator[](int d) const { return component[d]; }
  void fill(double value) {
    for (Field& field : component) field.fill(value);
  }
  void swap(FaceField& other) noexcept {
    for (int d = 0; d < 3; ++d) component[d].swap(other.component[d]);
  }
  std::array<Field, 3> component;
};

}  // namespace valsalva::fluid
