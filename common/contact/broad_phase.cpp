#include "contact/broad_phase.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::contact {
namespace {

class BoxGrid {
 public:
  explicit BoxGrid(const std::vector<Box>& boxes) : boxes_(boxes) {
    low_ = boxes[0].low;
    Vec3 high = boxes[0].high;
    double extent = 0;
    for (const Box& box : boxes) {
      low_ = low_.cwiseMin(box.low);
      high = high.cwiseMax(box.high);
      extent += (box.high - box.low).maxCoeff();
    }
    cell_ = std::max(extent / static_cast<double>(boxes.size()), 1e-9);
    const Vec3 size = (high - low_).cwiseMax(cell_);
    constexpr double most_cells = 2e6;
    cell_ = std::max(cell_, std::cbrt(size.prod() / most_cells));
    for (int d = 0; d < 3; ++d) count_[d] = static_cast<int>(size[d] / cell_) + 1;
    fill();
  }

  /// Calls visit(j) once for every stored box j that overlaps the query.
  template <class Visit>
  void query(const Box& query, Visit&& visit) const {
    const auto [first, last] = cells(query);
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i)
          for (int entry = start_[index(i, j, k)]; entry < start_[index(i, j, k) + 1]; ++entry) {
            const int stored = entries_[entry];
            const auto& own = lowest_[stored];
            // Two boxes share a block of cells; only its lowest cell reports them.
            if (i != std::max(own[0], first[0]) || j != std::max(own[1], first[1]) ||
                k != std::max(own[2], first[2]))
              continue;
            if (query.overlaps(boxes_[stored])) visit(stored);
          }
  }

 private:
  using Index = std::array<int, 3>;
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * count_[1] + j) * count_[0] + i;
  }
  std::pair<Index, Index> cells(const Box& box) const {
    Index first, last;
    for (int d = 0; d < 3; ++d) {
      const auto cell = [&](double x) {
        return static_cast<int>(std::clamp(std::floor((x - low_[d]) / cell_), 0.0, count_[d] - 1.0));
      };
      first[d] = cell(box.low[d]);
      last[d] = cell(box.high[d]);
    }
    return {first, last};
  }
  void fill() {
    start_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
    lowest_.resize(boxes_.size());
    const auto each_cell = [&](std::size_t box, auto&& action) {
      const auto [first, last] = cells(boxes_[box]);
      lowest_[box] = first;
      for (int k = first[2]; k <= last[2]; ++k)
        for (int j = first[1]; j <= last[1]; ++j)
          for (int i = first[0]; i <= last[0]; ++i) action(index(i, j, k));
    };
    for (std::size_t b = 0; b < boxes_.size(); ++b)
      each_cell(b, [&](std::size_t cell) { ++start_[cell + 1]; });
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    entries_.resize(start_.back());
    std::vector<int> next(start_.begin(), start_.end() - 1);
    for (std::size_t b = 0; b < boxes_.size(); ++b)
      each_cell(b, [&](std::size_t cell) { entries_[next[cell]++] = static_cast<int>(b); });
  }

  const std::vector<Box>& boxes_;
  Vec3 low_;
  double cell_ = 1;
  Index count_{};
  std::vector<int> start_, entries_;
  std::vector<Index> lowest_;
};

}  // namespace

std::vector<IndexPair> overlapping_boxes(const std::vector<Box>& queries, const std::vector<Box>& stored,
                                         bool upper) {
  if (queries.empty() || stored.empty()) return {};
  const BoxGrid grid(stored);
  constexpr int chunk = 512;
  const int chunks = (static_cast<int>(queries.size()) + chunk - 1) / chunk;
  std::vector<std::vector<IndexPair>> found(chunks);
#pragma omp parallel for schedule(dynamic)
  for (int c = 0; c < chunks; ++c) {
    const int end = std::min(static_cast<int>(queries.size()), (c + 1) * chunk);
    for (int i = c * chunk; i < end; ++i) {
      const std::size_t before = found[c].size();
      grid.query(queries[i], [&](int j) {
        if (!upper || j > i) found[c].push_back({i, j});
      });
      std::sort(found[c].begin() + static_cast<std::ptrdiff_t>(before), found[c].end());
    }
  }
  std::vector<IndexPair> all;
  std::size_t total = 0;
  for (const auto& part : found) total += part.size();
  all.reserve(total);
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<IndexPair> overlapping_boxes_brute_force(const std::vector<Box>& queries,
                                                     const std::vector<Box>& stored, bool upper) {
  std::vector<IndexPair> all;
  for (int i = 0; i < static_cast<int>(queries.size()); ++i)
    for (int j = upper ? i + 1 : 0; j < static_cast<int>(stored.size()); ++j)
      if (queries[i].overlaps(stored[j])) all.push_back({i, j});
  return all;
}

}  // namespace valsalva::contact
