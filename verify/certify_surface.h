// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "verify/certificate.h"

namespace octotomy::verify {

/// As certify_bounded(), of triangles of which nothing is known: where they are no closed and oriented
/// manifold surface, the certificate fails and says why, with what can still be compared. Cost: that of
/// brep::health() without intersections besides.
Certificate certify_surface(const voxel::Octree& octree, const brep::Triangles& triangles,
                            const BoundInputs& inputs);

}  // namespace octotomy::verify
