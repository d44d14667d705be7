// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "verify/phantom/chance.h"
#include "verify/phantom/solid_phantom.h"

// Solids of known volume and area in random poses, similar to objects of surgery: smooth ones, ones with
// edges, ones cut by planes across or along the lattice, and thin ones.
namespace octotomy::verify {

/// Returns the names "smooth", "edges", "cut across", "cut along" and "thin".
const std::vector<std::string>& measured_groups();

/// Returns a solid of a group in a random pose and size. It is at least six of the longest voxel edges
/// across; a solid of "thin" is two to four of them thick. `kind`, modulo the number of the group's kinds,
/// selects the kind. Volume and area are closed forms, and so is the centroid of an uncut solid; the
/// `centroid_mm` of a cut solid is the centre of the uncut one. Precondition: the group is one of
/// measured_groups(), and no voxel edge is longer than five of the shortest.
SolidPhantom measured_solid(std::string_view group, std::uint64_t kind, const glm::dvec3& spacing_mm,
                            Chance& chance);

}  // namespace octotomy::verify
