// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/contour/contour.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {

/// Two neighbouring sections. Contours are closed and have the object on their left.
struct Slab {
  const std::vector<Contour>& lower;
  const std::vector<Contour>& upper;
  double low_mm = 0.0, high_mm = 1.0;
};

/// The surface between two sections. Points are numbered in this order: those of the lower section's
/// contours, those of the upper section's, then `inner_mm`.
struct SlabSurface {
  std::vector<glm::dvec3> inner_mm;  ///< all at half height
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> group;  ///< group of each face: contours that the surface connects form one
                                     ///< group
  /// The contours of a group, by their numbers in the sections.
  struct Group {
    std::vector<std::uint32_t> lower, upper;
  };
  std::vector<Group> groups;
};

/// Contours of one section cross or touch each other.
struct ContoursMeet : Error {
  explicit ContoursMeet(const std::string& message) : Error(ErrorCode::Geometry, message) {}
};
/// A point of one section lies exactly over a point or side of the other. Remedy: move one section slightly.
struct SectionsCoincide : Error {
  explicit SectionsCoincide(const std::string& message) : Error(ErrorCode::Geometry, message) {}
};

/// The surface of an object between two sections, oriented outward and bounded by both sections' contours. It
/// is manifold and does not intersect itself for any contours (except for the rounding of points where
/// contours cross). Projected onto the plane, it covers the area that lies in exactly one section. At a
/// section's contours it has the section's height. It is half way between the sections where contours of both
/// cross, and in the middle of areas that only one contour bounds. Contours that overlap are thus connected,
/// branches join in saddles half way, and a contour with nothing over it is closed by a roof half way. Throws
/// ContoursMeet and SectionsCoincide. Cost: n log n in exact arithmetic, about 20 us per point.
SlabSurface overlay(const Slab& slab);

}  // namespace octotomy::brep
