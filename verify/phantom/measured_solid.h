// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "verify/phantom/chance.h"
#include "verify/phantom/solid_phantom.h"

// Solids of known volume and area in random poses, as surgeons' objects are: smooth, with edges, cut by
// planes across and along the lattice, thin.
namespace octotomy::verify {

/// "smooth", "edges", "cut across", "cut along", "thin".
const std::vector<std::string>& measured_groups();

/// A solid of a group in a random pose and size, at least six of the longest edges across but for "thin",
/// which is two to four of them thick. `kind` takes the group's kinds in turn. Volume, area and centroid are
/// closed forms (the centroid of cut solids is left at the pose's centre). Precondition: the group is one of
/// them, no edge is longer than five of the shortest.
SolidPhantom measured_solid(std::string_view group, std::uint64_t kind, const glm::dvec3& spacing_mm,
                            Chance& chance);

}  // namespace octotomy::verify
