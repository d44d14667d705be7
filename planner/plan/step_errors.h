// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/operation/table/fault.h"

namespace octotomy::planner {

/// Runs the work of a step and returns its result. Rethrows an exception of the work with the same type and
/// the step's id: "step 'cut': ...".
template <typename Work>
auto name_step_in_errors(const std::string& id, const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    rethrow_at("step '" + id + "': ", error);
  }
}

}  // namespace octotomy::planner
