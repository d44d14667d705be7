// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <stop_token>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct NecksOptions {
  double below_mm = 0.6;  ///< only necks narrower than this are returned; above 0
  /// Largest distance of the places that are measured on an edge; above 0.
  double spacing_mm = 0.2;
  /// An edge counts if the angle between its faces, measured inside the solid, is at least 180 degrees plus
  /// this; 1..170. Waves of a rim, as level sets have them, turn by up to 30 degrees.
  double reentrant_deg = 30.0;
  std::stop_token stop = {};
};

/// A ball inside a solid that touches a reentrant edge and a second place nearly opposite to it.
struct Neck {
  glm::dvec3 middle_mm{0.0};  ///< LPS
  double width_mm = 0.0;      ///< the ball's diameter
};

/// The necks of a solid at its reentrant edges, in the order of the edges: for example the narrow places of a
/// union of wide balls, where two balls overlap little. Each ball touches an edge, with its centre opposite
/// to the bisector of the faces' outward normals. It also touches the other side, at least 120 degrees from
/// the edge as seen from its centre. Throws std::invalid_argument if the solid is empty or an option is out
/// of its range; Stopped. The same bits on any number of threads. Cost: n log n for the tree, about log n a
/// place; parallel.
std::vector<Neck> necks(const Solid& solid, const NecksOptions& options);

}  // namespace octotomy::brep
