// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "brep/boolean/boolean.h"
#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Both kernels' answers to a Boolean of two unchanged sets of voxels, which may have coplanar faces and
/// touching edges, and the certificate of the answers.
struct SetsAnswer {
  voxel::Octree octree;
  /// The mesh kernel's solid in LPS millimetres, as corefined. None: the mesh kernel cannot represent the
  /// result, and the certificate states the reason.
  std::optional<brep::Solid> solid;
  /// bound of the distance between the solid's surface and the sets' surface
  double shift_mm = 0.0;
  std::vector<std::string> findings;  ///< of the corefinement
  Certificate certificate;
};

/// Combines the octrees, and corefines the sets' cuberilles (tier Exact). Where voxels of a set meet only at
/// an edge or corner, the sheets of its surface are moved apart. Where faces coincide, corefinement may move
/// an operand. Both moves are a few millionths of the universe's extent. So each triangle of the answer must
/// lie within that distance of a plane between voxels, and its corners are rounded to the plane. Then both
/// volumes must be the same whole number of voxels, and the same voxel centres must lie inside the mesh. FAIL
/// if anything differs, WARN without a mesh. Throws std::invalid_argument if the universes differ;
/// voxel::Stopped. Cost: some 10 us a face of the sets.
SetsAnswer certify_sets(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b,
                        const voxel::Progress& progress = {});

/// As above, for an expression of named sets in the grammar of voxel::parse_expression(). Each kernel parses
/// the text with its own parser. `set` returns the set with a given name. Throws std::invalid_argument also
/// if the text is no expression; as `set`.
SetsAnswer certify_sets(std::string_view expression,
                        const std::function<voxel::Octree(std::string_view name)>& set,
                        const voxel::Progress& progress = {});

}  // namespace octotomy::verify
