// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace octotomy::planner {

/// A Boolean expression of earlier objects.
struct Combine {
  std::string expression;
};

}  // namespace octotomy::planner
