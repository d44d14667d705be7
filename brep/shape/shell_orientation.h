// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "brep/mesh/triangles.h"

// The triangles of each shell, and the triangles to reverse so that the shell is consistently oriented.
namespace octotomy::brep {

/// For each side of each triangle, the other triangle that shares it.
struct Neighbours {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> face;  ///< at 3 f + k, the neighbour at side k of triangle f; none unless there
                                    ///< is exactly one
  std::vector<std::uint8_t> same_way;  ///< 1 if the neighbour runs along the side in the same direction

  /// Whether any side is not shared by exactly one other triangle.
  bool is_open() const;
};
/// Cost: n log n.
Neighbours neighbours_of(const Triangles& surface);

/// Sets of triangles that are connected across sides shared by exactly two triangles.
struct Shells {
  std::vector<std::uint32_t> of;     ///< of each triangle, the first triangle of its shell
  std::vector<std::uint8_t> turned;  ///< 1 for each triangle to reverse, so that each shell winds one way
  std::size_t twisted_sides = 0;     ///< sides whose triangles still wind against each other, each counted
                                     ///< twice: a Moebius strip has some
};
Shells wind_alike(const Neighbours& neighbours);

struct Shell {
  std::vector<std::uint32_t> faces;
  std::size_t turns = 0;  ///< number of its triangles that were reversed
  double volume_mm3 = 0.0, area_mm2 = 0.0;
  bool is_closed = true;
  /// The shell's farthest points in both directions along each axis. Points that other shells share are left
  /// out.
  std::array<std::optional<std::uint32_t>, 6> probes;
};
/// The shells of a surface whose triangles wind alike, by their first triangle.
std::map<std::uint32_t, Shell> shells_of(const Triangles& wound, const Neighbours& neighbours,
                                         const Shells& shells);

/// How closed shells within others are oriented. Alternating: inward if the shell lies within an odd number
/// of other shells, otherwise outward. AsGiven: a shell with consistent winding in the input keeps it. An
/// outward shell is a body to unite; an inward shell is a cavity, if the shells around it form a body there.
enum class Nested { Alternating, AsGiven };

/// Orients closed shells outward or inward by `nested`, and each open shell so that fewer of its triangles
/// are reversed: changes `shells.turned`. Cost: n log n for a tree of the surface, and six rays for each
/// closed shell.
void place_shells(const Triangles& surface, const Neighbours& neighbours, Nested nested, Shells& shells);

}  // namespace octotomy::brep
