// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/field.h"

#include <array>

namespace octotomy::planner {

std::string unit_of_name(const std::string& name) {
  static const std::array<std::pair<const char*, const char*>, 6> endings{{{"_mm", "mm"},
                                                                           {"_mm2", "mm\u00b2"},
                                                                           {"_mm3", "mm\u00b3"},
                                                                           {"_mpa", "MPa"},
                                                                           {"_deg", "\u00b0"},
                                                                           {"degrees", "\u00b0"}}};
  for (const auto& [ending, unit] : endings)
    if (name.ends_with(ending)) return unit;
  // Thresholds have no fixed unit, because they are in the unit of the scan's samples. Switches have no unit.
  return "";
}

std::string Field::unit() const {
  return unit_of_name(name);
}

}  // namespace octotomy::planner
