// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stop_token>

#include "brep/contour/tile_sections.h"
#include "brep/mesh/solid.h"
#include "planner/operation/table/object.h"
#include "verify/witness/reading.h"
#include "voxel/solid/slice_mask.h"

// The volume that regions on parallel slices enclose, as a mesh and as a witness. Both follow the rule of
// voxel::SliceMask between slices.
namespace octotomy::planner {

/// The largest distance between the sections that tiles join, mm.
constexpr double tile_step_mm() {
  return 1.0;
}

struct TiledSlices {
  brep::Solid solid;
  std::size_t sections = 0;  ///< tiled sections, the drawn slices among them
};

/// The surface tiled from the slices and from sections between them (brep::sections_between()), LPS. `cost`
/// as in brep::TileSectionsOptions. Throws brep::Error (Geometry) that names the slice's position where
/// contours of a slice cross or touch, or if the interpolated slices span more than 10 m; brep::Stopped.
/// Precondition: the mask passes check().
TiledSlices tiled_slices(const voxel::SliceMask& mask,
                         std::optional<brep::TileCost> cost = brep::TileCost::shortest_span,
                         std::stop_token stop = {});

/// The witness against which both kernels' answers are compared. It computes the regions' inside by its own
/// code.
verify::Witness witness_of(const voxel::SliceMask& mask);

/// The mean distance by which straight tiles leave the interpolated surface: (1 + 1/4) step^2 / (8 r), where
/// r is the radius of a circle with the contours' ratio of area to length, and at most half a step. None if
/// slices are not interpolated. Computed from the drawn contours, so that it does not depend on the answers.
double tiles_apart_mm(const voxel::SliceMask& mask);

/// The planes of flat faces across the slices, and of sides of polygons of 5 mm or more, that are parallel to the
/// universe's planes.
std::vector<CutPlane> planes_of(const voxel::SliceMask& mask);

}  // namespace octotomy::planner
