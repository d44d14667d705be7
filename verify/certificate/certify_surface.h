// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "verify/certificate/certify_bounded.h"

namespace octotomy::verify {

/// As certify_bounded(), for triangles in any state. The certificate fails, with reasons, if the triangles
/// are no closed, oriented manifold surface. If every edge still joins two triangles of one winding, they are
/// compared with the octree all the same. Cost: brep::health() without intersections in addition.
Certificate certify_surface(const voxel::Octree& octree, const brep::Triangles& triangles,
                            const BoundInputs& inputs, const voxel::Progress& progress = {});

}  // namespace octotomy::verify
