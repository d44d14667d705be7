// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>

#include "tests/voxel/field_scene.h"
#include "voxel/space/scene.h"

namespace octotomy::tests {

/// A field that linear interpolation reproduces, and that every flip, turn or exchange of axes changes.
/// Over a head it runs through air, -1000, as a CT does.
inline double linear_field(const glm::dvec3& p_mm) {
  return -700.0 + 17.0 * p_mm.x - 5.0 * p_mm.y + 3.0 * p_mm.z;
}

/// The field at the lattice's points, rounded.
inline voxel::Scene linear_scene(const voxel::Lattice& lattice) {
  return field_scene<std::int16_t>(lattice, linear_field);
}

/// A lattice turned out of all axes, about 40 mm wide, with different spacings.
inline voxel::Lattice oblique_lattice(bool left_handed = false) {
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.9, 0.3, -0.2));
  const glm::dvec3 b = glm::normalize(glm::cross(glm::dvec3(0.1, -0.4, 1.0), a));
  const glm::dvec3 c = glm::cross(a, b) * (left_handed ? -1.0 : 1.0);
  return {glm::ivec3(40, 30, 20), glm::dmat4(glm::dvec4(0.9 * a, 0), glm::dvec4(1.3 * b, 0),
                                             glm::dvec4(2.1 * c, 0), glm::dvec4(-23.7, 11.3, 101.9, 1))};
}

inline const voxel::Finding* finding(const voxel::Scene& scene, const std::string& check) {
  for (const voxel::Finding& line : scene.audit)
    if (line.check == check) return &line;
  return nullptr;
}

/// The verdict of a check; a missing check fails the test.
inline voxel::Verdict verdict(const voxel::Scene& scene, const std::string& check) {
  const voxel::Finding* line = finding(scene, check);
  if (line == nullptr) throw std::logic_error("the audit has no check '" + check + "'");
  return line->verdict;
}

}  // namespace octotomy::tests
