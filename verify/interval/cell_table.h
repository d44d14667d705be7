// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

namespace octotomy::verify {

/// A hash table from a lattice cell's number to a value. Precondition: no cell's number is all ones, because
/// that number marks an empty slot.
template <typename Value>
class CellTable {
 public:
  /// Returns the value of a cell. Adds a default value for a new cell. The reference is valid until the next
  /// call.
  Value& at(std::uint64_t cell) {
    assert(cell != none);
    if (2 * count_ >= slots_.size()) grow();
    Slot& slot = slot_of(cell);
    if (slot.cell == none) {
      slot.cell = cell;
      ++count_;
    }
    return slot.value;
  }

  /// Calls visit(value) in the order of the cells' numbers.
  template <typename Visit>
  void each(const Visit& visit) const {
    std::vector<std::pair<std::uint64_t, const Value*>> sorted;
    sorted.reserve(count_);
    for (const Slot& slot : slots_)
      if (slot.cell != none) sorted.emplace_back(slot.cell, &slot.value);
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [cell, value] : sorted) visit(*value);
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t cell = none;
    Value value{};
  };

  /// The cell's slot, or the empty slot at which the cell must be inserted.
  Slot& slot_of(std::uint64_t cell) {
    const std::size_t last = slots_.size() - 1;
    std::size_t at = (cell * 0x9E3779B97F4A7C15ULL) >> (64 - bits_);
    while (slots_[at].cell != none && slots_[at].cell != cell) at = (at + 1) & last;
    return slots_[at];
  }
  void grow() {
    const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(std::size_t{1} << ++bits_));
    for (const Slot& slot : before)
      if (slot.cell != none) slot_of(slot.cell) = slot;
  }

  int bits_ = 9;
  std::size_t count_ = 0;
  std::vector<Slot> slots_;  ///< 2^bits_ slots, at least half of them empty; no slots at first
};

}  // namespace octotomy::verify
