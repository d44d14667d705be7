// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <vector>

namespace octotomy::planner {
namespace {

char lower(char letter) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
}

std::size_t edits(std::string_view a, std::string_view b) {
  // Three rows of the table of distances between the beginnings of a and b.
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped =
          i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

/// Whether this number of edits changes at most half of the longer word.
bool is_near(std::size_t edits, std::string_view a, std::string_view b) {
  return 2 * edits <= std::max(a.size(), b.size());
}

/// Whether a suggestion is possible at all: the edits are at least the difference of the lengths.
bool may_be_near(std::string_view a, std::string_view b) {
  const std::size_t shorter = std::min(a.size(), b.size()), longer = std::max(a.size(), b.size());
  return longer <= longest_suggested && is_near(longer - shorter, a, b);
}

std::size_t common_beginning(std::string_view a, std::string_view b) {
  std::size_t length = 0;
  while (length < std::min(a.size(), b.size()) && lower(a[length]) == lower(b[length])) ++length;
  return length;
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known) {
  std::optional<std::string> nearest;
  std::size_t fewest = 0, beginning = 0;
  for (const std::string& candidate : known) {
    if (!may_be_near(name, candidate)) continue;
    const std::size_t distance = edits(name, candidate);
    if (!is_near(distance, name, candidate)) continue;
    const std::size_t shared = common_beginning(name, candidate);
    if (nearest && (distance > fewest || (distance == fewest && shared <= beginning))) continue;
    nearest = candidate;
    fewest = distance;
    beginning = shared;
  }
  return nearest;
}

std::string suggestion(std::string_view name, std::span<const std::string> known) {
  if (known.empty()) return ": there are none to choose from";
  std::string text;
  if (const auto nearest = nearest_name(name, known)) text = ", did you mean '" + *nearest + "'?";
  text += text.empty() ? ": known are " : " Known are ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "" : ", ") + known[i];
  return text;
}

}  // namespace octotomy::planner
