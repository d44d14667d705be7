// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/place_limit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <tbb/parallel_for.h>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate/place_fault.h"

namespace octotomy::verify {
namespace {

/// Steps from a voxel to its neighbours within six voxels, the nearest first.
std::vector<glm::ivec3> steps_outward() {
  std::vector<glm::ivec3> steps;
  for (int z = -6; z <= 6; ++z)
    for (int y = -6; y <= 6; ++y)
      for (int x = -6; x <= 6; ++x)
        if (x * x + y * y + z * z <= 36) steps.emplace_back(x, y, z);
  std::stable_sort(steps.begin(), steps.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
    return a.x * a.x + a.y * a.y + a.z * a.z < b.x * b.x + b.y * b.y + b.z * b.z;
  });
  return steps;
}

/// The size, in voxels, of the smallest error around `from` that is detected. The error consists of the
/// voxels nearest to `from` that have the same state, inside or outside. It is detected as soon as one of
/// them contradicts the witness when its state in the octree is reversed. Returns the number of all such
/// voxels within six voxels if none does.
std::size_t unseen_voxels(const voxel::Octree& octree, const voxel::Octree& digitised, const glm::ivec3& from,
                          const std::vector<glm::ivec3>& steps, const Witness& witness) {
  const bool inside = octree.contains(from);
  std::size_t count = 0;
  for (const glm::ivec3& step : steps) {
    const glm::ivec3 at = from + step;
    if (!is_within(at, octree) || octree.contains(at) != inside) continue;
    ++count;
    if (digitised.contains(at) != inside) continue;
    const Reading reading = witness.allowed_sides(octree.universe().lattice().lps_mm(glm::dvec3(at)));
    if (fault_of(reading, !inside, inside) != PlaceFault::None) return count;
  }
  return count;
}

/// Whether step 1 of judge_places() compares a voxel outside the mesh: it is in the octree or beside the
/// octree's boundary.
bool is_compared(const voxel::Octree& octree, const glm::ivec3& voxel) {
  const auto has = [&](const glm::ivec3& at) { return is_within(at, octree) && octree.contains(at); };
  for (int axis = 0; axis < 3; ++axis)
    for (const int by : {-1, 1}) {
      glm::ivec3 neighbour = voxel;
      neighbour[axis] += by;
      if (has(neighbour)) return true;
    }
  return has(voxel);
}

/// Whether two losses of a piece of the mesh are detected: by the mesh alone, and by both kernels. The piece
/// must hold the centre of a compared voxel at which the mesh fails without the piece, and the centre of a
/// sampled voxel at which both kernels fail without it. Tries points beneath the piece's triangles, up to two
/// voxels deep. A piece of more than 4096 triangles counts as detected.
bool is_seen(const brep::Triangles& mesh, const brep::Component& piece, const voxel::Octree& octree,
             const Witness& witness) {
  constexpr std::size_t most_faces = 4096, most_tried = 64;
  if (piece.faces.size() > most_faces) return true;
  brep::Triangles own;
  for (const std::uint32_t face : piece.faces) {
    const auto first = static_cast<std::uint32_t>(own.points_mm.size());
    for (const std::uint32_t corner : mesh.faces[face]) own.points_mm.push_back(mesh.points_mm[corner]);
    own.faces.push_back({first, first + 1, first + 2});
  }
  const voxel::Lattice lattice = octree.universe().lattice();
  const glm::dvec3 voxel_mm = lattice.spacing_mm();
  const bool is_small = std::abs(piece.volume_mm3) < chance_voxels * lattice.voxel_mm3();
  const std::size_t stride = 1 + own.faces.size() / most_tried;
  bool seen_alone = false, seen_in_both = !witness.lines();
  const auto is_lost = [&](const glm::ivec3& at, bool in_voxels) {
    const glm::dvec3 centre = lattice.lps_mm(glm::dvec3(at));
    const PlaceFault fault = fault_of(witness.allowed_sides(centre), in_voxels, false);
    return fault != PlaceFault::None && !(fault == PlaceFault::Apart && is_small) &&
           brep::is_inside(centre, own);
  };
  const auto is_lost_in_both = [&](const glm::ivec3& at) {
    const glm::dvec3 centre = lattice.lps_mm(glm::dvec3(at));
    return !witness.mesh_sides(centre).allows(false) && brep::is_inside(centre, own);
  };
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec3& p : own.points_mm) {
    low = glm::min(low, lattice.voxel(p));
    high = glm::max(high, lattice.voxel(p));
  }
  for (std::size_t i = 0; i < own.faces.size(); i += stride)
    for (const double voxels : {0.5, 1.0, 2.0}) {
      const auto& [a, b, c] = own.faces[i];
      const glm::dvec3 &p = own.points_mm[a], &q = own.points_mm[b], &r = own.points_mm[c];
      const glm::dvec3 across = glm::cross(q - p, r - p);
      const double length = glm::length(across);
      if (!(length > 0.0)) continue;
      const glm::dvec3 beneath = (p + q + r) / 3.0 - voxels / length * across * voxel_mm;
      const glm::ivec3 voxel(glm::round(lattice.voxel(beneath)));
      if (!seen_alone && is_compared(octree, voxel)) seen_alone = is_lost(voxel, octree.contains(voxel));
      if (!seen_in_both) seen_in_both = is_lost_in_both(sampled_in_block(voxel));
      if (seen_alone && seen_in_both) return true;
    }
  // A small piece contains few sampled voxels, so all of them are tried.
  const glm::dvec3 box = glm::ceil(high) - glm::floor(low) + 1.0;
  constexpr double most_voxels = 16384.0;
  if (!seen_alone || box.x * box.y * box.z > most_voxels) return false;
  for (int z = static_cast<int>(std::floor(low.z)); z <= high.z; ++z)
    for (int y = static_cast<int>(std::floor(low.y)); y <= high.y; ++y)
      for (int x = static_cast<int>(std::floor(low.x)); x <= high.x; ++x)
        if (is_sampled({x, y, z}) && is_lost_in_both({x, y, z})) return true;
  return false;
}

/// The volume of the largest whole piece of the mesh whose loss is not detected. Any other lost or added part
/// leaves vertices where the witness has no surface; step 2 of judge_places() detects those.
double piece_limit_mm3(const brep::Solid& solid, const brep::Triangles& mesh, const voxel::Octree& octree,
                       const Witness& witness) {
  const std::vector<brep::Component>& pieces = solid.components();
  std::vector<double> lost_mm3(pieces.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (!is_seen(mesh, pieces[i], octree, witness)) lost_mm3[i] = std::abs(pieces[i].volume_mm3);
  });
  return pieces.empty() ? 0.0 : *std::max_element(lost_mm3.begin(), lost_mm3.end());
}

/// Number of places of an object at which errors are injected.
constexpr std::size_t tried_places = 1024;
/// Number of triangles that are tested for each shift.
constexpr std::size_t tried_triangles = 4096;

double place_limit_mm3(const voxel::Octree& octree, const voxel::Octree& digitised,
                       const std::vector<voxel::VoxelFace>& boundary, const Witness& witness) {
  const std::vector<glm::ivec3> steps = steps_outward();
  std::mt19937_64 random(1);
  std::vector<glm::ivec3> from;
  for (std::size_t i = 0; i < tried_places; ++i) {
    const voxel::VoxelFace& face = boundary[random() % boundary.size()];
    from.push_back(face.voxel);
    // Of the injected errors, every second one adds voxels.
    if (i % 2 == 1) from.back()[face.axis] += face.side;
  }
  std::vector<std::size_t> counts(from.size(), 0);
  tbb::parallel_for(std::size_t{0}, from.size(), [&](std::size_t i) {
    counts[i] = unseen_voxels(octree, digitised, from[i], steps, witness);
  });
  const std::size_t most = std::max<std::size_t>(*std::max_element(counts.begin(), counts.end()), 1);
  return static_cast<double>(std::bit_ceil(most)) * octree.universe().lattice().voxel_mm3();
}

/// The smallest tried shift that moves at least one sampled triangle off the surface in each of six
/// directions. None if the largest tried shift, four voxels, does not.
std::optional<double> shift_limit_mm(const brep::Triangles& mesh, double voxel_mm, const Witness& witness) {
  std::mt19937_64 random(2);
  std::vector<glm::dvec3> points_mm;
  for (std::size_t i = 0; i < tried_triangles; ++i)
    points_mm.push_back(centred_face(mesh, random() % mesh.faces.size()).centroid_mm);
  for (const double voxels : {0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0}) {
    bool seen_everywhere = true;
    for (int direction = 0; direction < 6 && seen_everywhere; ++direction) {
      glm::dvec3 by_mm(0.0);
      by_mm[direction / 2] = (direction % 2 == 0 ? 1.0 : -1.0) * voxels * voxel_mm;
      seen_everywhere = std::any_of(points_mm.begin(), points_mm.end(), [&](const glm::dvec3& p_mm) {
        return !witness.mesh_sides(p_mm + by_mm).near;
      });
    }
    if (seen_everywhere) return voxels * voxel_mm;
  }
  return std::nullopt;
}

}  // namespace

DetectionLimit place_limit(const voxel::Octree& octree, const voxel::Octree& digitised,
                           const brep::Solid& solid, const std::vector<voxel::VoxelFace>& boundary,
                           const Witness& witness) {
  const brep::Triangles& mesh = solid.triangles();
  const glm::dvec3 voxel_mm = octree.universe().lattice().spacing_mm();
  DetectionLimit limit;
  limit.volume_mm3 = piece_limit_mm3(solid, mesh, octree, witness);
  if (!boundary.empty())
    limit.volume_mm3 = std::max(limit.volume_mm3, place_limit_mm3(octree, digitised, boundary, witness));
  if (!mesh.faces.empty())
    limit.shift_mm = shift_limit_mm(mesh, std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z}), witness);
  return limit;
}

}  // namespace octotomy::verify
