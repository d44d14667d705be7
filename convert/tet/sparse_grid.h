// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::convert {

/// A value at each of side^3 places; a value that was never written is Value{}. A page of 4 x 4 x 4 values is
/// made when one of its values is first written. Memory: 4 bytes a page of the cube, and the pages that were
/// made.
template <typename Value>
class SparseGrid {
 public:
  static constexpr int page_side = 4;
  using Page = std::array<Value, 64>;  ///< x fastest

  explicit SparseGrid(int side)
      : side_(side),
        pages_along_((side + page_side - 1) / page_side),
        numbers_(static_cast<std::size_t>(pages_along_) * static_cast<std::size_t>(pages_along_) *
                     static_cast<std::size_t>(pages_along_),
                 no_page) {}

  /// Value{} outside the cube, too.
  Value get(const glm::ivec3& p) const {
    if (!holds(p)) return Value{};
    const std::uint32_t number = numbers_[number_of(p >> 2)];
    return number == no_page ? Value{} : pages_[number][place_in_page(p)];
  }
  /// Makes the page of a place. The reference is valid until the next page is made. Precondition: within the
  /// cube.
  Value& at(const glm::ivec3& p) {
    assert(holds(p));
    std::uint32_t& number = numbers_[number_of(p >> 2)];
    if (number == no_page) {
      number = static_cast<std::uint32_t>(pages_.size());
      pages_.push_back(Page{});
    }
    return pages_[number][place_in_page(p)];
  }

  int pages_along() const { return pages_along_; }
  /// Null if nothing was written there. Precondition: within 0 .. pages_along() - 1.
  const Page* page(const glm::ivec3& number) const {
    const std::uint32_t found = numbers_[number_of(number)];
    return found == no_page ? nullptr : &pages_[found];
  }
  /// All pages, in the order in which they were made.
  std::vector<Page>& pages() { return pages_; }
  const std::vector<Page>& pages() const { return pages_; }

 private:
  static constexpr std::uint32_t no_page = 0xffffffff;

  bool holds(const glm::ivec3& p) const {
    const auto within = [this](int v) { return static_cast<unsigned>(v) < static_cast<unsigned>(side_); };
    return within(p.x) && within(p.y) && within(p.z);
  }
  std::size_t number_of(const glm::ivec3& page) const {
    const auto along = static_cast<std::size_t>(pages_along_);
    return (static_cast<std::size_t>(page.z) * along + static_cast<std::size_t>(page.y)) * along +
           static_cast<std::size_t>(page.x);
  }
  static std::size_t place_in_page(const glm::ivec3& p) {
    return static_cast<std::size_t>((p.x & 3) + 4 * (p.y & 3) + 16 * (p.z & 3));
  }

  int side_, pages_along_;
  std::vector<std::uint32_t> numbers_;
  std::vector<Page> pages_;
};

}  // namespace octotomy::convert
