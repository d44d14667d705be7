// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace octotomy::tests {

/// The number of occurrences of a part in a text.
inline int times(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

}  // namespace octotomy::tests
