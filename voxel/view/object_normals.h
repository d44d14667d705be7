// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/depth_image.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::voxel {

/// The normal at a voxel's face, computed from eight of the voxel's 18 neighbours (Chen et al. 1985; thesis
/// 5.2.1.1, table 5.1). On each side of the face the surface rises, continues or falls. Half the difference
/// between opposite sides is the slope, so there are 25 normals per face. The face is perpendicular to `axis`
/// and faces larger indices if `outward` is 1, smaller ones if it is -1. The result is in index space and not
/// of unit length. Cost: sixteen look-ups in the octree.
glm::dvec3 context_normal(const Octree& octree, const glm::ivec3& voxel, int axis, int outward);

/// The outward normal at a position in index space: the negative gradient of the samples, by central
/// differences (equation 5.3) interpolated trilinearly between voxels. The result is in index space; zero if
/// the samples do not change.
glm::dvec3 grey_normal(const GreyOctree& grey, const glm::dvec3& p_voxel);

enum class ObjectNormals { Context, Grey };
/// Unit normals (right, up, look) of the surface at every pixel, computed from the objects instead of the
/// depth image. Grey falls back to context normals if an object has no samples or they do not change.
/// Background pixels get zero. Precondition: the image shows these objects. Parallel over rows.
std::vector<glm::vec3> object_normals(const DepthImage& image, const std::vector<DrawnObject>& objects,
                                      const ImagePlane& plane, ObjectNormals kind);

}  // namespace octotomy::voxel
