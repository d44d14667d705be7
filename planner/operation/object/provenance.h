// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "voxel/solid/region_mask.h"

// What an object inherits from its operands: the planes that cut it, its scan and spacing, the walls of
// masks, and the samples that define its surface.
namespace octotomy::planner {

/// Whether an object's voxels were digitised from its mesh. A motion or mirror digitises the moved mesh
/// again: moving the voxels would shift their surface by up to half a voxel.
bool is_voxelised(const Object& object);
/// Digitises a mesh and stores the voxels as the object's.
void voxelise(const brep::Solid& mesh, const voxel::Universe& universe, VoxelSide& made);

/// Whether only an object's whole voxels are available, without samples or shapes that place its surface
/// between the voxels' centres.
bool is_whole_voxels(const VoxelSide& side);

/// The planes of a scan's ends. There the ends of mesh and voxels may be half a sample apart, rather than
/// half a voxel.
std::vector<CutPlane> ends_of(const voxel::Box& scan, const glm::dvec3& sample_mm,
                              const glm::dvec3& voxel_mm);

/// Whether every voxel's centre within the scan coincides with one of its samples, up to rounding.
bool on_samples(const voxel::Lattice& scan, const voxel::Lattice& universe);
/// Whether a scan has samples both below and above a window. The mesh kernel then has layers of the window between
/// neighbouring samples, which no voxel at a sample shows.
bool on_both_sides(const voxel::Scene& scan, double low, double high);

/// The planes through a mask's edges that are normal to an axis of the universe, up to the rounding of the
/// view's unit vectors.
std::vector<CutPlane> planes_of(const voxel::RegionMask& mask);

/// Adds an operand's walls and bound terms to those of an object made of it.
void inherit(const Object& operand, Object& made);

/// Like inherit(), for an object that is another one moved, mirrored, scaled or sheared; walls, planes, windows and
/// samples move with it. Precondition: the mesh kernel's object is complete, if there is one.
void carry(const std::string& object, const glm::dmat4& moved_from_still, const BoundBench& bench,
           Object& made);

/// Volume that the image of an object's voxels has outside of the universe after a motion or mirror.
double outside_mm3(const voxel::Octree& still, const glm::dmat4& image_from_still);

/// The samples that define the surface of an object made of several: the samples of its operands if these
/// agree. Masks have none. The surface of a union of several windows, or of pieces moved apart, follows no
/// single scan.
std::optional<Shown> shown_in_common(const Objects& objects, const std::vector<std::string>& names);

/// The finding, as cut_finding(), on an object that the scan's border cuts off. It is derived from the mesh's
/// faces on the border, or without a mesh from the voxels beside it.
std::optional<std::string> border_finding_of(const Object& object);

/// Area of triangles on the planes, per axis of the planes and weighted by the planes' errors.
glm::dvec3 area_on_planes(const brep::Triangles& triangles, const std::vector<CutPlane>& planes);

}  // namespace octotomy::planner
