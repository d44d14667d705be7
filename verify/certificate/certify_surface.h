// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "verify/certificate/certify_bounded.h"

namespace octotomy::verify {

/// certify_bounded() for any triangles. The certificate fails, with reasons, if the triangles are no closed,
/// oriented manifold surface. It still compares them with the octree if every edge joins two triangles of one
/// winding. Cost: brep::health() without intersections in addition.
Certificate certify_surface(const voxel::Octree& octree, const brep::Triangles& triangles,
                            const BoundInputs& inputs, const voxel::Progress& progress = {});

}  // namespace octotomy::verify
