// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The shells of a surface, triangles that are connected across edges, in the order of their first triangles. Triangles
/// are numbered as in the surface, ascending. Shells may be open. Cost: linear.
std::vector<std::vector<std::uint32_t>> shells(const Linked& surface);

/// Appends a surface to another one. The two share no points afterwards.
void append(const Triangles& more, Triangles& all);

}  // namespace octotomy::brep
