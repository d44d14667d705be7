// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "convert/tet/mesher_process.h"
#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// The plane of least squares through the points that lie within `near_mm` of that same plane. Found by
/// iteration from `plane`.
InterfacePlane fitted_plane(const std::vector<glm::dvec3>& points_mm, InterfacePlane plane, double near_mm);

/// The plane between two labels; null if their interface is not flat.
const LabelPlane* plane_between(const std::vector<LabelPlane>& planes, std::uint8_t one, std::uint8_t other);

struct FlatInterfaceOptions {
  std::vector<LabelPlane> planes{};  ///< in LPS millimetres; a label is the region's number plus one
  double voxel_mm = 1.0;
  double size_mm = 3.0;  ///< size of elements
  /// No node moves to a position at which one of its elements has a smaller dihedral angle. Splits keep this
  /// bound as SideSplitter does.
  double least_deg = 5.0;
};

/// Assigns each element at a plane between two regions to the region on the side of the element's middle. Mesh_3
/// decides by the middle of the element's circumscribed ball, which at a rim may lie beyond the plane.
void divide_by_planes(Tetrahedra& made, const std::vector<LabelPlane>& planes);

/// Moves the nodes of flat interfaces onto their planes, except where elements around a node would not stay
/// fit. If no plane is known, an interface counts as flat if most of its nodes lie in one plane.
void flatten_interfaces(Tetrahedra& made, const FlatInterfaceOptions& options);

/// Splits elements that have nodes of both regions at the plane between these regions: sides that pass
/// through the plane get a node on it. Leaves elements alone whose parts would not be fit. Then assigns each
/// part to the region on its side. Elements and nodes keep their numbers; new ones come after them. Returns
/// the number of new nodes. `boundary_nodes` are made anew.
std::size_t split_at_planes(Tetrahedra& made, const FlatInterfaceOptions& options);

/// The findings on nodes of a flat interface that stayed off its plane: surfaces in contact interlock there.
std::vector<std::string> bumps(const Tetrahedra& made, const FlatInterfaceOptions& options);

}  // namespace octotomy::convert
