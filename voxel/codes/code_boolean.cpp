// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/code_boolean.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace octotomy::voxel {
namespace {

void check_universes(const Universe& a, const Universe& b) {
  if (!(a == b)) throw std::invalid_argument("Boolean of codes: the universes differ");
}

template <typename Word>
Word combined_words(Word a, Word b, SetOperation operation) {
  switch (operation) {
    case SetOperation::Intersection:
      return static_cast<Word>(a & b);
    case SetOperation::Union:
      return static_cast<Word>(a | b);
    default:
      return static_cast<Word>(a & ~b);
  }
}

/// The Boolean of two ascending lists of intervals, by a sweep over the intervals' ends. An interval has the
/// fields first and last, both included.
template <typename Interval>
std::vector<Interval> combined_lists(const std::vector<Interval>& a, const std::vector<Interval>& b,
                                     SetOperation operation) {
  constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  using Position = decltype(Interval::first);
  std::vector<Interval> merged;
  std::size_t i = 0, j = 0;
  bool in_a = false, in_b = false, is_in = false;
  const auto next = [&](const std::vector<Interval>& list, std::size_t at, bool inside) -> std::uint64_t {
    if (at == list.size()) return none;
    return inside ? std::uint64_t{list[at].last} + 1 : std::uint64_t{list[at].first};
  };
  const auto pass = [](std::size_t& at, bool& inside) {
    if (inside) ++at;
    inside = !inside;
  };
  for (;;) {
    const std::uint64_t a_next = next(a, i, in_a), b_next = next(b, j, in_b);
    const std::uint64_t position = std::min(a_next, b_next);
    if (position == none) return merged;
    if (a_next == position) pass(i, in_a);
    if (b_next == position) pass(j, in_b);
    const bool was_in = is_in;
    is_in = combined_words<unsigned>(in_a ? 1 : 0, in_b ? 1 : 0, operation) != 0;
    if (is_in && !was_in) merged.push_back({static_cast<Position>(position), 0});
    if (!is_in && was_in) merged.back().last = static_cast<Position>(position - 1);
  }
}

/// Combines the slices and rows of two indices; `of_rows` combines two rows, one of which may be null.
template <typename Index, typename OfRows>
Index combined_rows(const Index& a, const Index& b, const OfRows& of_rows) {
  check_universes(a.universe, b.universe);
  const auto side = static_cast<std::size_t>(a.universe.side());
  Index result{a.universe, std::vector<typename Index::Slice>(side)};
  const typename Index::Row null;
  for (std::size_t z = 0; z < side; ++z) {
    if (a.slices[z].empty() && b.slices[z].empty()) continue;
    typename Index::Slice slice(side);
    bool any = false;
    for (std::size_t y = 0; y < side; ++y) {
      slice[y] =
          of_rows(a.slices[z].empty() ? null : a.slices[z][y], b.slices[z].empty() ? null : b.slices[z][y]);
      any = any || !slice[y].empty();
    }
    if (any) result.slices[z] = std::move(slice);
  }
  return result;
}

}  // namespace

BinaryArray combined(const BinaryArray& a, const BinaryArray& b, SetOperation operation) {
  check_universes(a.universe, b.universe);
  BinaryArray result = a;
  for (std::size_t i = 0; i < a.bytes.size(); ++i)
    result.bytes[i] = combined_words(a.bytes[i], b.bytes[i], operation);
  return result;
}

MarginalIndex combined(const MarginalIndex& a, const MarginalIndex& b, SetOperation operation) {
  using Row = MarginalIndex::Row;
  return combined_rows(a, b, [&](const Row& of_a, const Row& of_b) {
    if (of_a.empty() && (operation != SetOperation::Union || of_b.empty())) return Row();
    Row row(std::max(of_a.size(), of_b.size()));
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = combined_words(of_a.empty() ? 0 : of_a[i], of_b.empty() ? 0 : of_b[i], operation);
    return std::all_of(row.begin(), row.end(), [](std::uint64_t word) { return word == 0; }) ? Row() : row;
  });
}

RunLength combined(const RunLength& a, const RunLength& b, SetOperation operation) {
  check_universes(a.universe, b.universe);
  return {a.universe, combined_lists(a.runs, b.runs, operation)};
}

SegmentIndex combined(const SegmentIndex& a, const SegmentIndex& b, SetOperation operation) {
  return combined_rows(a, b, [&](const SegmentIndex::Row& of_a, const SegmentIndex::Row& of_b) {
    return combined_lists(of_a, of_b, operation);
  });
}

}  // namespace octotomy::voxel
