// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Shells. Triangles that share an edge belong to one shell. Its volume is that of the tetrahedra from the
//   shell's own first point, so that no digits cancel far from the origin.
// 2 Crossings. For each small shell, the rows of centres along the universe's first axis are intersected with
//   its triangles. The shell encloses a centre if a centre lies between a row's first and second crossing, or
//   third and fourth, and so on.
#include "verify/certificate/specks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <tbb/parallel_for.h>
#include <tuple>
#include <utility>
#include <vector>

namespace octotomy::verify {
namespace {

constexpr std::uint32_t no_shell = std::numeric_limits<std::uint32_t>::max();

/// The connected sets of a mesh's triangles, in the order of their first triangles.
struct Shells {
  std::vector<double> volumes_mm3;  ///< negative for a cavity
  std::vector<std::uint32_t> of_face;
};

Shells shells_of(const brep::Linked& linked) {
  const brep::Triangles& mesh = linked.triangles;
  Shells found;
  found.of_face.assign(mesh.faces.size(), no_shell);
  std::vector<std::uint32_t> reached;
  for (std::uint32_t first = 0; first < mesh.faces.size(); ++first) {
    if (found.of_face[first] != no_shell) continue;
    const auto number = static_cast<std::uint32_t>(found.volumes_mm3.size());
    double volume_mm3 = 0.0;
    const glm::dvec3 origin = mesh.points_mm[mesh.faces[first][0]];
    found.of_face[first] = number;
    reached.push_back(first);
    while (!reached.empty()) {
      const std::uint32_t face = reached.back();
      reached.pop_back();
      const auto& [a, b, c] = mesh.faces[face];
      const glm::dvec3 p = mesh.points_mm[a] - origin, q = mesh.points_mm[b] - origin,
                       r = mesh.points_mm[c] - origin;
      volume_mm3 += glm::dot(p, glm::cross(q, r)) / 6.0;
      for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
        const std::uint32_t opposite = linked.opposite[side];
        if (opposite == brep::Linked::none || found.of_face[opposite / 3] != no_shell) continue;
        found.of_face[opposite / 3] = number;
        reached.push_back(opposite / 3);
      }
    }
    found.volumes_mm3.push_back(volume_mm3);
  }
  return found;
}

/// Largest volume of a tested shell, in voxels. A larger shell without a voxel's centre would be a sheet of
/// thousands of voxels between two layers of centres.
constexpr double most_voxels = 4096.0;

/// Returns for each shell its faces if it is small, and no faces otherwise.
std::vector<std::vector<std::uint32_t>> faces_of_small(const Shells& found, double voxel_mm3) {
  std::vector<std::vector<std::uint32_t>> faces(found.volumes_mm3.size());
  const auto is_small = [&](std::uint32_t shell) {
    return std::abs(found.volumes_mm3[shell]) <= most_voxels * voxel_mm3;
  };
  for (std::uint32_t face = 0; face < found.of_face.size(); ++face)
    if (is_small(found.of_face[face])) faces[found.of_face[face]].push_back(face);
  return faces;
}

/// A crossing of a row of voxel centres with a shell.
struct Crossing {
  std::int64_t z = 0, y = 0;  ///< of the row
  double x = 0.0;

  auto row() const { return std::pair(z, y); }
  bool operator<(const Crossing& other) const {
    return std::tuple(z, y, x) < std::tuple(other.z, other.y, other.x);
  }
};

/// Twice the signed area of a triangle in the plane of y and z.
double twice_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Adds the crossings of a triangle with rows of voxel centres along x. Corners are in voxels. Rows are moved
/// by a part of a voxel that no lattice of samples has, so that they meet no corner or edge of a mesh along
/// the lattice.
void add_crossings(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                   std::vector<Crossing>& crossings) {
  constexpr double by_y = 1.37e-7, by_z = 2.71e-7;
  const glm::dvec2 p(a.y - by_y, a.z - by_z), q(b.y - by_y, b.z - by_z), r(c.y - by_y, c.z - by_z);
  const glm::dvec2 low = glm::ceil(glm::min(p, glm::min(q, r))),
                   high = glm::floor(glm::max(p, glm::max(q, r)));
  const double whole = twice_area(p, q, r);
  if (whole == 0.0) return;
  for (double z = low.y; z <= high.y; ++z)
    for (double y = low.x; y <= high.x; ++y) {
      const glm::dvec2 row(y, z);
      const double at_a = twice_area(row, q, r) / whole, at_b = twice_area(p, row, r) / whole,
                   at_c = twice_area(p, q, row) / whole;
      if (at_a < 0.0 || at_b < 0.0 || at_c < 0.0) continue;
      crossings.push_back(
          {static_cast<std::int64_t>(z), static_cast<std::int64_t>(y), at_a * a.x + at_b * b.x + at_c * c.x});
    }
}

/// Whether a closed shell encloses no voxel's centre. If rounding lost or doubled a crossing, returns false.
bool is_between_centres(const brep::Triangles& mesh, const std::vector<std::uint32_t>& faces,
                        const voxel::Lattice& lattice) {
  std::vector<Crossing> crossings;
  for (const std::uint32_t face : faces) {
    const auto& [a, b, c] = mesh.faces[face];
    add_crossings(lattice.voxel(mesh.points_mm[a]), lattice.voxel(mesh.points_mm[b]),
                  lattice.voxel(mesh.points_mm[c]), crossings);
  }
  std::sort(crossings.begin(), crossings.end());
  if (crossings.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < crossings.size(); i += 2) {
    const Crossing &enters = crossings[i], &leaves = crossings[i + 1];
    if (enters.row() != leaves.row() || std::floor(leaves.x) >= enters.x) return false;
  }
  return true;
}

/// The place of a speck with these faces.
WorstPlace place_of(const brep::Triangles& mesh, const std::vector<std::uint32_t>& faces, double volume_mm3) {
  glm::dvec3 low_mm(std::numeric_limits<double>::infinity()), high_mm(-low_mm);
  for (const std::uint32_t face : faces)
    for (const std::uint32_t corner : mesh.faces[face]) {
      low_mm = glm::min(low_mm, mesh.points_mm[corner]);
      high_mm = glm::max(high_mm, mesh.points_mm[corner]);
    }
  const glm::dvec3 extent_mm = high_mm - low_mm;
  return {0.5 * (low_mm + high_mm), std::max({extent_mm.x, extent_mm.y, extent_mm.z}),
          volume_mm3 < 0.0 ? part_of_voxels_only : part_of_mesh_only, std::abs(volume_mm3)};
}

}  // namespace

Specks specks_of(const brep::Solid& solid, const voxel::Lattice& lattice) {
  const brep::Triangles& mesh = solid.triangles();
  const Shells found = shells_of(solid.linked());
  const std::vector<std::vector<std::uint32_t>> faces = faces_of_small(found, lattice.voxel_mm3());
  std::vector<std::uint8_t> is_speck(found.volumes_mm3.size(), 0);
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t i) {
    is_speck[i] = !faces[i].empty() && is_between_centres(mesh, faces[i], lattice) ? 1 : 0;
  });
  Specks specks;
  std::optional<std::size_t> largest;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (is_speck[i] == 0) continue;
    const double volume_mm3 = std::abs(found.volumes_mm3[i]);
    ++specks.count;
    specks.volume_mm3 += volume_mm3;
    if (!largest || volume_mm3 > std::abs(found.volumes_mm3[*largest])) largest = i;
  }
  if (!largest) return specks;
  specks.largest = place_of(mesh, faces[*largest], found.volumes_mm3[*largest]);
  specks.others.points_mm = mesh.points_mm;
  for (std::size_t face = 0; face < mesh.faces.size(); ++face)
    if (is_speck[found.of_face[face]] == 0) specks.others.faces.push_back(mesh.faces[face]);
  return specks;
}

}  // namespace octotomy::verify
