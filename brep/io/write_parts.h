// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The surfaces of parts that touch: a triangle between two parts is there once.
struct PartedSurface {
  /// Behind a triangle, and in front of it, whence its corners are seen counter-clockwise; 0 is no part.
  struct Sides {
    std::int32_t behind = 0, front = 0;
  };

  Triangles triangles;
  std::vector<Sides> sides;          ///< of each triangle; never the same part twice
  std::map<int, std::string> names;  ///< of the parts, above 0
};

/// The surface of one part: its triangles, those with the part in front turned, and the points that they use,
/// both in their order. Triangles between two parts have the same corners in the surfaces of both.
Triangles surface_of_part(const PartedSurface& parted, int part);

/// Whether write_parts() writes the path's extension.
bool is_parts_file(const std::filesystem::path& path);

/// Writes all parts as one file. .vtp: each triangle once, doubles, with `part_behind` and `part_in_front`
/// by triangle and `part_numbers` and `part_names` for the file; .obj: a group a part, text that reads back
/// to the same doubles; .glb: a named node a part over the same points, single precision, turned and scaled
/// as by write_mesh(). In the latter two a triangle between two parts is in both, turned. LPS millimetres.
/// Written beside and renamed into place. Preconditions: sides fit triangles, and every part has a name.
/// Throws std::invalid_argument where they do not; Error as write_mesh().
void write_parts(const PartedSurface& parted, const std::filesystem::path& path);

}  // namespace octotomy::brep
