#include "coupling/near_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

constexpr double skin_share = 0.5;  // of the range

}  // namespace

NearPairs::NearPairs(double range_mm, Points rest, Points start, std::vector<int> group)
    : range_(range_mm), rest_(std::move(rest)), start_(std::move(start)), group_(std::move(group)) {
  VALSALVA_ASSERT(rest_.size() == group_.size() && start_.size() == group_.size());
  if (!(range_mm > 0))
    throw InputError("coupling: a range of {} mm between leaflets; expected a positive one", range_mm);
}

const std::vector<NearPair>& NearPairs::find(const Points& x) {
  VALSALVA_ASSERT(x.size() == group_.size());
  double moved = listed_at_.empty() ? 1e300 : 0;
  for (std::size_t a = 0; a < listed_at_.size(); ++a)
    if (group_[a] >= 0) moved = std::max(moved, (x[a] - listed_at_[a]).squaredNorm());
  if (moved >= 0.25 * skin_share * skin_share * range_ * range_) list(x);
  pairs_.clear();
  for (NearPair pair : listed_) {
    const double square = (x[pair.a] - x[pair.b]).squaredNorm();
    if (square >= range_ * range_ || square == 0) continue;
    pair.distance_mm = std::sqrt(square);
    pairs_.push_back(pair);
  }
  return pairs_;
}

void NearPairs::list(const Points& x) {
  const double reach = (1 + skin_share) * range_;
  listed_at_ = x;
  listed_.clear();
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (group_[a] < 0) continue;
    low = low.cwiseMin(x[a]);
    high = high.cwiseMax(x[a]);
  }
  if (!(low.x() <= high.x())) return;
  std::array<int, 3> cells;
  for (int d = 0; d < 3; ++d) cells[d] = static_cast<int>((high[d] - low[d]) / reach) + 1;
  const auto cell_of = [&](const Vec3& p) {
    std::array<int, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = std::min(cells[d] - 1, static_cast<int>((p[d] - low[d]) / reach));
    return c;
  };
  const auto flat = [&](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * cells[1] + j) * cells[0] + i;
  };
  // Counting sort of the nodes into cells keeps their order within a cell.
  first_.assign(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2] + 1, 0);
  const auto each_node = [&](auto&& action) {
    for (std::size_t a = 0; a < x.size(); ++a)
      if (group_[a] >= 0) {
        const auto c = cell_of(x[a]);
        action(static_cast<int>(a), flat(c[0], c[1], c[2]));
      }
  };
  each_node([&](int, std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  order_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  each_node([&](int a, std::size_t cell) { order_[next[cell]++] = a; });

  for (int a = 0; a < static_cast<int>(x.size()); ++a) {
    if (group_[a] < 0) continue;
    const auto c = cell_of(x[a]);
    for (int k = std::max(0, c[2] - 1); k <= std::min(cells[2] - 1, c[2] + 1); ++k)
      for (int j = std::max(0, c[1] - 1); j <= std::min(cells[1] - 1, c[1] + 1); ++j) {
        const int begin = first_[flat(std::max(0, c[0] - 1), j, k)];
        const int end = first_[flat(std::min(cells[0] - 1, c[0] + 1), j, k) + 1];
        for (int n = begin; n < end; ++n) {
          const int b = order_[n];
          if (b <= a || group_[b] == group_[a]) continue;
          if ((x[a] - x[b]).squaredNorm() >= reach * reach) continue;
          listed_.push_back({a, b, 0, (rest_[a] - rest_[b]).norm(), (start_[a] - start_[b]).norm()});
        }
      }
  }
  std::sort(listed_.begin(), listed_.end(), [](const NearPair& one, const NearPair& other) {
    return one.a != other.a ? one.a < other.a : one.b < other.b;
  });
}

}  // namespace valsalva::coupling
