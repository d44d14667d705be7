// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// The numbers for the three axes, from one number for all or one for each. Precondition: check_axes()
/// passes.
inline glm::ivec3 of_axes(const std::vector<int>& numbers) {
  return numbers.size() == 1 ? glm::ivec3(numbers[0]) : glm::ivec3(numbers[0], numbers[1], numbers[2]);
}

/// Refuses lists that have neither one number nor three.
inline void check_axes(const std::vector<int>& numbers, const FieldLocation& place) {
  if (numbers.size() != 1 && numbers.size() != 3) place.refuse("must be one number, or one for each axis");
}

}  // namespace octotomy::planner
