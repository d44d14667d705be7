// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "verify/phantom/chance.h"
#include "verify/phantom/solid_phantom.h"

// Solids of known volume and area in random poses, similar to surgical objects: smooth, with edges, cut by
// planes across and along the lattice, thin.
namespace octotomy::verify {

/// "smooth", "edges", "cut across", "cut along", "thin".
const std::vector<std::string>& measured_groups();

/// A solid of a group in a random pose and size. It is at least six of the longest voxel edges across; one of
/// "thin" is two to four of them thick. `kind`, modulo the number of the group's kinds, selects the kind.
/// Volume, area and centroid are closed forms (cut solids have the pose's centre as centroid). Precondition:
/// the group is one of measured_groups(), and no voxel edge is longer than five of the shortest.
SolidPhantom measured_solid(std::string_view group, std::uint64_t kind, const glm::dvec3& spacing_mm,
                            Chance& chance);

}  // namespace octotomy::verify
