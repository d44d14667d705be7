// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The surfaces of parts that touch: a triangle between two parts is stored once.
struct PartedSurface {
  /// The parts behind and in front of a triangle; 0 is no part. Seen from the front, its corners run
  /// counter-clockwise.
  struct Sides {
    std::int32_t behind = 0, front = 0;
  };

  Triangles triangles;
  std::vector<Sides> sides;          ///< parts on both sides of each triangle; never the same part
  std::map<int, std::string> names;  ///< names of the parts, whose numbers are above 0
};

/// The surface of one part: its triangles (reversed if the part is in front) and the points that they use,
/// both in their original order. Triangles between two parts have the same corners in the surfaces of both.
Triangles surface_of_part(const PartedSurface& parted, int part);

/// Whether write_parts() writes the path's extension.
bool is_parts_file(const std::filesystem::path& path);

/// Writes all parts as one file. .vtp: each triangle once, doubles, with `part_behind` and `part_in_front`
/// per triangle and `part_numbers` and `part_names` for the file; .obj: a group per part, in text from which
/// readers get the same doubles; .glb: a named node per part, all with the same points, single precision,
/// transformed as by write_mesh(). In .obj and .glb both parts contain each triangle between them, one of
/// them reversed. LPS millimetres. Written to a temporary file and renamed into place. Preconditions: each
/// triangle has sides, of two different parts, and every part has a name. Throws std::invalid_argument if
/// not; Error as write_mesh() does.
void write_parts(const PartedSurface& parted, const std::filesystem::path& path);

}  // namespace octotomy::brep
