// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "verify/phantom/chance.h"
#include "voxel/space/scene.h"

// Random solids of several classes, among them thin and sharp ones, and scans of these solids. They serve to
// calibrate and to test the intervals of volume and area (size_interval.h).
namespace octotomy::verify {

/// A solid at the origin. Lengths and points are in LPS millimetres.
struct DrawnSolid {
  std::string group;
  /// A function of position: negative inside; its absolute value never exceeds the distance to the surface.
  std::function<double(const glm::dvec3& p_mm)> signed_mm;
  double reach_mm = 0.0;  ///< no point of the solid is farther from the origin
  double volume_mm3 = 0.0, area_mm2 = 0.0;
};

/// A class of solids. Classes with `is_held_back` were not used to calibrate the constants of
/// size_interval.cpp.
struct DrawnGroup {
  std::string name;
  bool is_held_back = false;
};
const std::vector<DrawnGroup>& drawn_groups();

/// Returns a solid of a class with random size and pose, for voxels of 1 mm. Volume and area are closed
/// forms; for "gyroid", "csg" and "ellipsoid" they are numerical, to 0.5 %. Throws std::invalid_argument for
/// an unknown class.
DrawnSolid drawn_solid(const std::string& group, Chance& chance);

/// How a drawn solid is scanned. Densities are in sample units.
struct DrawnScan {
  glm::dvec3 spacing_mm{1.0};
  double blur_voxels = 0.7;  ///< deviation of a Gaussian along each axis
  double noise = 30.0;       ///< deviation, in sample units
  double background = 0.0, contrast = 1000.0;
  /// Distance from the solid beyond which the surroundings have a third density, such as air around tissue.
  /// None: there is no third density.
  std::optional<double> third_from_mm = {};
  double third = 0.0;  ///< in sample units
  double half() const { return background + 0.5 * contrast; }
};
/// A random scan of two densities: spacing up to 1:1:5, blur 0.3 to 1.2 voxels, noise 10 to 60.
DrawnScan drawn_scan(Chance& chance);
/// Scans a solid: each sample is the mean of the blurred solid over its voxel, with noise. The solid keeps
/// seven voxels or more from the scan's border.
voxel::Scene scan_of(const DrawnSolid& solid, const DrawnScan& how, Chance& chance);

}  // namespace octotomy::verify
