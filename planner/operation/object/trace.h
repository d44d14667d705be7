// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "planner/operation/table/object.h"
#include "voxel/solid/region_mask.h"

// What an object inherits from those it is made of: the planes that cut it, its scan and spacing, the walls
// of masks, and the samples that show its surface.
namespace octotomy::planner {

/// Whether an object's voxels are those of its mesh. Where such an object is moved or mirrored they are made
/// anew: voxels that are moved are off by up to a half, and the mesh is not.
bool is_voxelised(const Object& object);
/// Makes the voxels of a mesh an object's own.
void voxelise(const brep::Solid& mesh, const voxel::Universe& universe, VoxelSide& made);

/// Whether an answer is known by whole voxels alone, and not by samples or forms that show its surface
/// between their centres.
bool is_whole_voxels(const VoxelSide& side);

/// The planes of a scan's ends: there mesh and voxels end up to half a sample apart, not half a voxel.
std::vector<CutPlane> ends_of(const voxel::Box& scan, const glm::dvec3& sample_mm,
                              const glm::dvec3& voxel_mm);

/// Whether every voxel's centre within the scan is one of its samples, but for rounding.
bool on_samples(const voxel::Lattice& scan, const voxel::Lattice& universe);

/// The planes through a mask's edges that are normal to an axis of the universe, but for the rounding of a
/// view's unit vectors.
std::vector<CutPlane> planes_of(const voxel::RegionMask& mask);

/// Adds an operand's walls and bound terms to those of an object made of it.
void inherit(const Object& operand, Object& made);

/// The same for an object that is another one moved or mirrored: its walls, planes, windows and samples move
/// along. Precondition: the mesh kernel has made its answer, if it has one.
void carry(const std::string& object, const glm::dmat4& moved_from_still, const BoundBench& bench,
           Object& made);

/// Volume of an object's voxels whose centres lie outside of the universe after a motion or mirror.
double outside_mm3(const voxel::Octree& still, const glm::dmat4& image_from_still);

/// The samples that show the surface of an object made of several: those of its operands, where they agree.
/// Masks have none. A union of several windows, or of pieces moved apart, does not lie where one scan says.
std::optional<Shown> shown_in_common(const Objects& objects, const std::vector<std::string>& names);

/// What is told of an object that the scan's border cuts off, as cut_finding(): of its mesh the faces on the
/// border, of voxels alone those beside it.
std::optional<std::string> border_finding_of(const Object& object);

/// Area of triangles on the planes, by the planes' axes and weighted by their errors.
glm::dvec3 area_on_planes(const brep::Triangles& triangles, const std::vector<CutPlane>& planes);

}  // namespace octotomy::planner
