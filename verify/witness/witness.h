// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "brep/mesh/solid.h"
#include "verify/witness/reading.h"
#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

// Witnesses of windows, of drawn shapes, and of the results of operations on them. Each reads the scan and
// the plan with code of its own.
namespace octotomy::verify {

/// A witness of the samples of a scan in the window low..high, both bounds included. The mesh kernel's
/// surface lies in the scan's own cells. Its vertices lie where samples interpolated along an edge reach a
/// bound; an edge from below the window to above it has two. The voxel kernel interpolates trilinearly
/// between the scan's samples, and rounds to a multiple of `step` at the centres of the universe's voxels:
/// its grey octree keeps the scan (GreyOctree::with_scan()). Shares the scan.
Witness witness_of_window(std::shared_ptr<const voxel::Scene> scan, double low, double high,
                          const voxel::Universe& universe, double step = 1.0);

/// A region that was drawn in a view, by its polygons.
struct DrawnRegion {
  std::string view;                                  ///< "anterior", "35,15"
  std::vector<std::vector<glm::dvec2>> polygons_mm;  ///< by the even-odd rule
};
/// A witness of the points whose projection lies inside every region. Throws std::invalid_argument for an
/// unknown view.
Witness witness_of_regions(const std::vector<DrawnRegion>& regions);
Witness witness_of_box(const voxel::Box& box);
/// The cut of a saw along a line of straight pieces. LPS.
struct DrawnBlade {
  std::vector<glm::dvec3> line_mm;      ///< LPS
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< direction in which the blade enters; of any length
  double depth_mm = 100.0;              ///< from the line's point that comes first along `direction`
  double kerf_mm = 1.0;                 ///< width of the cut, half on either side of the line
};
/// A witness of the blade's cut. Each piece is an intersection of half-spaces. Adjacent pieces meet in the
/// plane that bisects their corner; the ends of the line are square. Throws std::invalid_argument unless two
/// points of the line are apart as seen along the direction.
Witness witness_of_blade(const DrawnBlade& blade);
/// A witness of a solid that comes from no scan. It decides whether a point is near the surface, but not
/// which side is inside.
Witness witness_of_surface(brep::Solid solid);

Witness both(Witness a, Witness b);
Witness without(Witness a, Witness b);
/// The object under an affine map that has an inverse, LPS to LPS: moved, reflected, scaled or sheared.
Witness carried(Witness still, const glm::dmat4& moved_from_still);
/// The object with surfaces that may be off by `by_mm`, for instance because corefinement moves operands that
/// touch.
Witness loosened(Witness tight, double by_mm);
/// The object if the voxel kernel's surface may be off by `by_mm`, as that of whole voxels is under a motion.
/// The mesh's sides do not change.
Witness with_voxels_within(Witness tight, double by_mm);
/// The object after a step that chose some of its connected parts. For a point inside the whole object both
/// sides are allowed, because its part may not have been chosen.
Witness witness_of_parts(Witness whole);
/// The connected parts that each kernel chose. `decided_mm`: the necks that the plan keeps or cuts;
/// `kept_mm`: the necks that it keeps. Both are places in LPS millimetres. `sample_mm`: the spacing of the
/// scan's samples.
struct ChosenParts {
  voxel::Octree voxels;
  brep::Solid mesh;
  std::vector<glm::dvec3> decided_mm = {}, kept_mm = {};
  glm::dvec3 sample_mm{0.0};
};
/// As above, with the kernels' choices. If the choices differ beyond a thin neck, all objects computed from
/// them may differ, too.
Witness witness_of_parts(Witness whole, ChosenParts chosen);
/// The object after a step that filled some of its cavities. For a point outside the hollow object both sides
/// are allowed, because the point may lie in a filled cavity.
Witness witness_of_filled(Witness hollow);
/// The object of an expression. `lookup` returns the witness of a name. If one of these witnesses is empty,
/// the result is empty. Throws std::invalid_argument as MeshExpressions::evaluate().
Witness witness_of_expression(std::string_view text,
                              const std::function<Witness(const std::string&)>& lookup);

}  // namespace octotomy::verify
