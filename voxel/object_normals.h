// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/drawn.h"

namespace octotomy::voxel {

/// Normal of a voxel's face from the eight of the voxel's 18 neighbours that bear on it (Chen et al. 1985;
/// thesis 5.2.1.1, table 5.1): on either side of the face the surface rises, goes on or falls, and half the
/// difference is its slope, which gives 25 normals a face. The face looks along `axis`, to larger indices
/// where `outward` is 1, to smaller ones where it is -1. In index space, not of unit length.
/// Cost: sixteen looks into the octree.
glm::dvec3 context_normal(const Octree& octree, const glm::ivec3& voxel, int axis, int outward);

/// Outward normal at a position in index space: against the gradient of the samples by central differences
/// (equation 5.3), trilinear between voxels, in index space; no length where the samples do not change.
glm::dvec3 grey_normal(const GreyOctree& grey, const glm::dvec3& p_voxel);

enum class ObjectNormals { Context, Grey };
/// Unit normals (right, up, look) of what every pixel sees, from the objects instead of the picture; those of
/// Grey are context normals where an object has no samples or they do not change. Zero where nothing is seen.
/// Precondition: the objects that the image was drawn of. Parallel over rows.
std::vector<glm::vec3> object_normals(const DepthImage& image, const std::vector<Drawn>& objects,
                                      const ImagePlane& plane, ObjectNormals kind);

}  // namespace octotomy::voxel
