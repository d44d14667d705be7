// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "verify/phantom/chance.h"
#include "voxel/space/scene.h"

// Solids drawn at random from classes, thin ones and sharp ones among them, and scans of them: what intervals
// of sizes are calibrated with and judged by.
namespace octotomy::verify {

/// A solid about the origin of LPS millimetres.
struct DrawnSolid {
  std::string group;
  /// Negative inside; its amount never exceeds the distance to the surface.
  std::function<double(const glm::dvec3& p_mm)> signed_mm;
  double reach_mm = 0.0;  ///< no point of it is farther from the origin
  double volume_mm3 = 0.0, area_mm2 = 0.0;
};

/// The classes' names; `is_held_back`: those that no constant of size_interval.cpp was calibrated with.
struct DrawnGroup {
  std::string name;
  bool is_held_back = false;
};
const std::vector<DrawnGroup>& drawn_groups();

/// A solid of this class with size and pose by chance, for voxels of 1 mm. Volume and area are closed forms;
/// of "gyroid", "csg" and "ellipsoid" they are numerical, to 0.5 %. Throws std::invalid_argument for an
/// unknown class.
DrawnSolid drawn_solid(const std::string& group, Chance& chance);

/// How a drawn solid is scanned.
struct DrawnScan {
  glm::dvec3 spacing_mm{1.0};
  double blur_voxels = 0.7;  ///< deviation of a Gaussian along each axis
  double noise = 30.0;       ///< deviation, in sample units
  double background = 0.0, contrast = 1000.0;
  /// Surroundings of another density from this far off the solid, as air about tissue; none: nowhere.
  std::optional<double> third_from_mm = {};
  double third = 0.0;  ///< in sample units
  double half() const { return background + 0.5 * contrast; }
};
/// Spacing to 1:1:5, blur 0.3 to 1.2 voxels, noise 10 to 60, by chance. Of two densities.
DrawnScan drawn_scan(Chance& chance);
/// The mean over each voxel of the blurred solid, with noise; seven voxels or more about the solid.
voxel::Scene scan_of(const DrawnSolid& solid, const DrawnScan& how, Chance& chance);

}  // namespace octotomy::verify
