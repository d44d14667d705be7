// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace octotomy::verify {

/// What is gathered of a surface, by the cells of a lattice that name its parts. Neighbours are mostly of one
/// cell: what was asked for lately is found without the table.
template <typename Value>
class CellTable {
 public:
  Value& at(std::uint64_t cell) {
    Recent& recent = recent_[(cell * 0x9E3779B97F4A7C15ULL) >> (64 - recent_bits)];
    if (recent.value == nullptr || recent.cell != cell) recent = {cell, &values_[cell]};
    return *recent.value;
  }

  /// Calls visit(value) in the order of the cells' numbers.
  template <typename Visit>
  void each(const Visit& visit) const {
    std::vector<std::pair<std::uint64_t, const Value*>> sorted;
    sorted.reserve(values_.size());
    for (const auto& [cell, value] : values_) sorted.emplace_back(cell, &value);
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [cell, value] : sorted) visit(*value);
  }

 private:
  static constexpr int recent_bits = 12;
  struct Recent {
    std::uint64_t cell = 0;
    Value* value = nullptr;
  };
  std::unordered_map<std::uint64_t, Value> values_;
  std::vector<Recent> recent_{std::size_t{1} << recent_bits};
};

}  // namespace octotomy::verify
