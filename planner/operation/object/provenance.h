// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "voxel/solid/region_mask.h"

// Facts that an object inherits from its operands: the planes that cut it, its scan and spacing, the walls of
// masks, and the samples that define its surface.
namespace octotomy::planner {

/// Whether an object's voxels were digitised from its mesh. For such an object, a motion or mirror digitises
/// the moved mesh, because moving the voxels would shift the surface by up to half a voxel.
bool is_voxelised(const Object& object);
/// Digitises a mesh and stores the voxels in `made`.
void voxelise(const brep::Solid& mesh, const voxel::Universe& universe, VoxelSide& made,
              const voxel::Progress& progress = {});

/// Whether an object is known by whole voxels only, without samples or shapes that place its surface between
/// the voxels' centres.
bool is_whole_voxels(const VoxelSide& side);

/// The planes of a scan's ends. The ends of mesh and voxels may differ there by half a sample instead of half
/// a voxel.
std::vector<CutPlane> ends_of(const voxel::Box& scan, const glm::dvec3& sample_mm,
                              const glm::dvec3& voxel_mm);

/// Whether the centre of every voxel within the scan is the position of one of its samples, except for
/// rounding.
bool on_samples(const voxel::Lattice& scan, const voxel::Lattice& universe);
/// Whether a scan has samples below and above a window. Then the mesh kernel has layers of the window between
/// neighbouring samples, which voxels at the samples do not show.
bool on_both_sides(const voxel::Scene& scan, double low, double high);

/// The planes of a mask's edges that are normal to an axis of the universe, within the rounding of the view's
/// unit vectors.
std::vector<CutPlane> planes_of(const voxel::RegionMask& mask);

/// Adds the cut walls and bound terms of an operand to those of an object that is made from it.
void inherit(const Object& operand, Object& made);

/// Does the same as inherit() for an object that is an image of another one: moved, mirrored, scaled or
/// sheared. Walls, planes, windows and samples move with it. Precondition: the mesh kernel's object is
/// complete, if there is one.
void carry(const std::string& object, const glm::dmat4& moved_from_still, const BoundBench& bench,
           Object& made);

/// The volume of the part of an object's image that lies outside of the universe, counted in voxels.
double outside_mm3(const voxel::Octree& still, const glm::dmat4& image_from_still);

/// The samples that define the surface of an object that is made of several: those of its operands if they
/// agree. Masks have none. None if the surface follows no single scan, as for a union of several windows or
/// of pieces that were moved apart.
std::optional<Shown> shown_in_common(const Objects& objects, const std::vector<std::string>& names);

/// The finding of cut_finding() on an object that the scan's border cuts off; none if it does not. It is
/// computed from the mesh's faces on the border, or without a mesh from the voxels at the border.
std::optional<std::string> border_finding_of(const Object& object);

/// The area in mm2 of triangles on the planes: one number for each axis, weighted by the planes' errors.
glm::dvec3 area_on_planes(const brep::Triangles& triangles, const std::vector<CutPlane>& planes);

}  // namespace octotomy::planner
