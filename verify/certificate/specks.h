// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "brep/mesh/solid.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate/certificate.h"
#include "voxel/space/lattice.h"

// Parts and cavities of a solid that no set of voxels can have, for instance from noise in a scan.
namespace octotomy::verify {

/// Closed shells that enclose no voxel's centre.
struct Specks {
  std::uint64_t count = 0;
  double volume_mm3 = 0.0;  ///< sum over parts and cavities, without sign
  /// The speck of largest volume; its size is the longest side of its box.
  std::optional<WorstPlace> largest;
  /// The solid's other triangles. Empty if there are no specks; then use the solid's own triangles.
  brep::Triangles others;
};
/// Finds the specks. Triangles that share an edge belong to one shell. Shells of more than 4096 voxels are no
/// specks. Cost: linear. Parallel in parts; same answer on any thread count.
Specks specks_of(const brep::Solid& solid, const voxel::Lattice& lattice);

}  // namespace octotomy::verify
