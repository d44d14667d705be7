// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/table/field.h"

namespace octotomy::planner {

/// A volume of interest: the intersection of the back-projections of regions drawn in views.
struct Mask {
  struct Region {
    std::string view;  ///< as the views of pictures are called: "anterior", "35,15"
    Polygons polygons_mm;
  };
  std::vector<Region> regions;
};

}  // namespace octotomy::planner
