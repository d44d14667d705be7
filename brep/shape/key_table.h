// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace octotomy::brep {

/// Values by the keys of lattice places (kuhn_cells.h), in one array with linear probing. Look-ups may run in
/// parallel while nothing is inserted. Cost: constant each. Memory: at most twice 16 bytes per key if a value
/// has 8 bytes.
template <typename Value>
class KeyTable {
 public:
  std::size_t size() const { return count_; }

  /// The value of a key; null where there is none. An insertion invalidates the pointer.
  const Value* find(std::uint64_t key) const {
    if (count_ == 0) return nullptr;
    const Slot& slot = slots_[slot_of(key)];
    return slot.key == key ? &slot.value : nullptr;
  }
  bool contains(std::uint64_t key) const { return find(key) != nullptr; }
  /// Precondition: the table has the key.
  const Value& at(std::uint64_t key) const {
    const Value* value = find(key);
    assert(value != nullptr);
    return *value;
  }

  /// Adds a key, and returns whether it was new; a key that exists keeps its value.
  bool insert(std::uint64_t key, const Value& value) {
    assert(key != none);
    if (4 * (count_ + 1) > 3 * slots_.size()) grow();
    Slot& slot = slots_[slot_of(key)];
    if (slot.key == key) return false;
    slot.key = key;
    slot.value = value;
    ++count_;
    return true;
  }
  /// Sets the value of a key that the table has.
  void set(std::uint64_t key, const Value& value) {
    Slot& slot = slots_[slot_of(key)];
    assert(slot.key == key);
    slot.value = value;
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};  // keys have 60 bits
  struct Slot {
    std::uint64_t key = none;
    [[no_unique_address]] Value value{};
  };

  /// Coordinates fill single bits of a key: they are mixed, because many keys would otherwise share a slot of
  /// the table.
  std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t mixed = (key ^ key >> 31) * 0x9E3779B97F4A7C15U;
    std::size_t i = static_cast<std::size_t>(mixed ^ mixed >> 29) & (slots_.size() - 1);
    while (slots_[i].key != key && slots_[i].key != none) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow() {
    std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.key != none) slots_[slot_of(slot.key)] = slot;
  }

  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

}  // namespace octotomy::brep
