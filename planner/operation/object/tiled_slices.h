// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>

#include "brep/contour/tile_sections.h"
#include "brep/mesh/solid.h"
#include "planner/operation/table/object.h"
#include "verify/witness/reading.h"
#include "voxel/solid/slice_mask.h"

// The volume that regions on parallel slices enclose, as a mesh and as a witness. Between slices both follow
// the rule of voxel::SliceMask.
namespace octotomy::planner {

/// Neighbouring sections that are joined by tiles are at most this far apart, in mm.
constexpr double tile_step_mm() {
  return 1.0;
}

struct TiledSlices {
  brep::Solid solid;
  std::size_t sections = 0;  ///< number of tiled sections, including the drawn slices
};

/// Tiles the surface from the slices and from sections between them (brep::sections_between()), LPS. `cost`
/// is that of brep::TileSectionsOptions. Throws brep::Error (Geometry) that names the slice's position if
/// contours of a slice cross or touch, or if the interpolated slices span more than 10 m; brep::Stopped.
/// Precondition: the mask passes check().
TiledSlices tiled_slices(const voxel::SliceMask& mask,
                         std::optional<brep::TileCost> cost = brep::TileCost::shortest_span,
                         std::stop_token stop = {});

/// The witness with which the answers of both kernels are compared. Its code for the inside of regions is
/// separate from theirs.
verify::Witness witness_of(const voxel::SliceMask& mask);

/// The mean distance in mm between straight tiles and the interpolated surface: (1 + 1/4) step^2 / (8 r), at
/// most half a step. Here r is the radius of the circle with the contours' ratio of area to length. 0 if
/// slices are not interpolated. It is computed from the drawn contours, so that it does not depend on the
/// answers.
double tiles_apart_mm(const voxel::SliceMask& mask);

/// The planes of the object's flat faces that are parallel to the universe's planes: faces across the slices,
/// and faces along sides of polygons of at least 5 mm.
std::vector<CutPlane> planes_of(const voxel::SliceMask& mask);

}  // namespace octotomy::planner
