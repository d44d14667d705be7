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

/// Two neighbouring sections. Contours are closed and turned with the object on their left.
struct Slab {
  const std::vector<Contour>& lower;
  const std::vector<Contour>& upper;
  double low_mm = 0.0, high_mm = 1.0;
};

/// The surface between two sections. Points are numbered: the lower section's in the order of its contours,
/// the upper section's, then `inner_mm`.
struct SlabSurface {
  std::vector<glm::dvec3> inner_mm;  ///< all half way up
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::vector<std::uint32_t> group;  ///< of each face: contours that the surface connects are one group
  /// Of each group, its contours by their numbers in the sections.
  struct Group {
    std::vector<std::uint32_t> lower, upper;
  };
  std::vector<Group> groups;
};

/// Contours of one section cross or touch each other.
struct ContoursMeet : Error {
  explicit ContoursMeet(const std::string& message) : Error(ErrorCode::Geometry, message) {}
};
/// A point of one section stands exactly over a point or side of the other's: move one by a little.
struct SectionsCoincide : Error {
  explicit SectionsCoincide(const std::string& message) : Error(ErrorCode::Geometry, message) {}
};

/// The surface of an object between two sections, oriented outward, whose border are both sections' contours:
/// manifold and free of self-intersection whatever they are (but for the rounding of points where contours
/// cross). Where the sections laid over each other agree there is none; over the rest, which lies in one of
/// them only, runs one height: the section's own at its contours, half way where contours of both cross and
/// over what only one contour bounds. So contours that overlap are connected, branches join in saddles half
/// way, and what has nothing over it closes in a roof half way. Throws ContoursMeet and SectionsCoincide.
/// Cost: n log n, exact arithmetic, some 20 us a point.
SlabSurface overlay(const Slab& slab);

}  // namespace octotomy::brep
