// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "verify/phantom/chance.h"
#include "voxel/space/scene.h"

// Random solids of several classes, among them thin and sharp ones, and scans of them. The intervals of sizes
// are calibrated and tested with them.
namespace octotomy::verify {

/// A solid about the origin of LPS millimetres.
struct DrawnSolid {
  std::string group;
  /// Negative inside. Its absolute value never exceeds the distance to the surface.
  std::function<double(const glm::dvec3& p_mm)> signed_mm;
  double reach_mm = 0.0;  ///< no point of the solid is farther from the origin
  double volume_mm3 = 0.0, area_mm2 = 0.0;
};

/// The classes' names. With `is_held_back` the class was not used to calibrate constants of
/// size_interval.cpp.
struct DrawnGroup {
  std::string name;
  bool is_held_back = false;
};
const std::vector<DrawnGroup>& drawn_groups();

/// A solid of this class with random size and pose, for voxels of 1 mm. Volume and area are closed forms; for
/// "gyroid", "csg" and "ellipsoid" they are numerical, to 0.5 %. Throws std::invalid_argument for an unknown
/// class.
DrawnSolid drawn_solid(const std::string& group, Chance& chance);

/// How a drawn solid is scanned.
struct DrawnScan {
  glm::dvec3 spacing_mm{1.0};
  double blur_voxels = 0.7;  ///< deviation of a Gaussian along each axis
  double noise = 30.0;       ///< deviation, in sample units
  double background = 0.0, contrast = 1000.0;
  /// Distance from the solid at which surroundings of a third density begin, such as air around tissue. None:
  /// there are none.
  std::optional<double> third_from_mm = {};
  double third = 0.0;  ///< in sample units
  double half() const { return background + 0.5 * contrast; }
};
/// A random scan of two densities: spacing up to 1:1:5, blur 0.3 to 1.2 voxels, noise 10 to 60.
DrawnScan drawn_scan(Chance& chance);
/// The mean of the blurred solid over each voxel, with noise. There are seven voxels or more around the
/// solid.
voxel::Scene scan_of(const DrawnSolid& solid, const DrawnScan& how, Chance& chance);

}  // namespace octotomy::verify
