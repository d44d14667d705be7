// SPDX-License-Identifier: AGPL-3.0-or-later
//
// With D a voxel's diagonal, h its longest edge, b the length of the offset, c the mesh kernel's cells and d
// the distance of a point from the operand (or, inward, from its outside), at single points:
//   voxels  The kernel measures to points of the operand's surface in each of its cells. In a cell that cuts
//           off a corner the nearest one is the middle of the triangle through the three edges, at most
//           2/3 D from the corner, so that d is off by at most that. Between voxels' centres, as under a
//           motion, the kernel interpolates distances at a cell's corners, D / 2 from its middle.
//           If only whole voxels of an object are known, its surface may lie up to h / 2 elsewhere, too.
//   mesh    The surface's triangles have vertices within c / 1000 of the surface and are thinned by at most
//           c / 50. Between vertices they lie within c / 16 of it where distances are linear; elsewhere
//           edges are at most sqrt(3) c / 4, so that a point is within c / 4 of a vertex (Jung), and distances
//           change by at most the distance between points. The bound that is used is c, because triangles
//           between levels are longer.
//   witness An edge between voxels' centres meets the operand's surface between a place that is certainly
//           inside and one that is certainly outside. The places between, h / 8 apart, are all taken. Any
//           point of the surface is within 2/3 D of such an edge's crossing, as above.
//   thin    A wall or gap that passes between voxels' centres has no such edge. The mesh kernel has it, and its
//           operand's triangles that are farther than 5/6 of own_error_mm() from all crossings propose places. A
//           place counts where the operand's witness has the surface within half a voxel along the normal: at the
//           scan's samples, not at voxels. Points of a triangle are within 1/6 of own_error_mm() of a proposed
//           place, so no surface is farther from both kinds of places than allowed. There the mesh kernel must
//           have the wall, and the voxel kernel, which resampled it away, may answer either.
// On the mean over the surface (offset_allowance_mm):
//   voxels  On a plane, the nearest point to which the kernel measures is at most D / sqrt(12) away. The mean
//           of the squared distance is a third of that squared: D^2 / 36. That lengthens d by
//           D^2 / 72 (1 / d + 1 / r), r the operand's radius of curvature. r is three voxels at least, because
//           voxels do not resolve smaller radii.
//           If only whole voxels are known, an offset follows those that stick out farthest, up to h / 2.
//   mesh    Chords: a third of the kernel's tolerance, c^2 / (4 b), and the two shares of c above.
//   edges   Across an operand's edge with an exterior angle t the offset is a sector of a ball. A cell cuts
//           the edge off: with u and v how far its two crossings lie from the voxel's centre the sector's
//           radius is low by min(u cos s, v sin s) h in direction s, over a right angle at most 0.59 h, which
//           is 0.75 times half the angle. An edge that is parallel to the lattice has one u and v all along.
//           So half the sum of length times angle, times 0.75 h b, and c^2 / 4 times that half sum for
//           inward edges, where the mesh's triangles pass straight from one side to the other. An edge is one
//           that bends by more than a ball of a radius of two voxels does across a voxel: half a radian.
//           No mean exceeds the largest error at a point: edges count at most 2/3 D and c / 4, which
//           matters for small surfaces on rough operands and for those of which a part of the offset is kept.
//   thin    The mesh kernel has walls that pass between voxels' centres, on which an offset builds: their
//           area times b. That is area of the operand's mesh, within the universe, with no voxel's face
//           within D.
#include "verify/witness/offset_witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "convert/voxel/voxelise.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::verify {
namespace {

constexpr double cut_corner = 2.0 / 3.0;           ///< of a voxel's diagonal
constexpr double mesh_error = 1.0 + 0.02 + 0.001;  ///< of a cell
constexpr double sharp_rad = 0.5;
constexpr int steps_a_voxel = 8;

constexpr double thin_share = 5.0 / 6.0;  ///< of own_error_mm()

double diagonal_of(const voxel::Universe& universe) {
  return glm::length(universe.lattice().spacing_mm());
}
double longest_edge_of(const voxel::Universe& universe) {
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  return std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
}

/// Largest distance of a point of the surface from the nearest place at a voxel's face.
double own_error_mm(const voxel::Universe& universe) {
  return cut_corner * diagonal_of(universe) + longest_edge_of(universe) / (2 * steps_a_voxel);
}

double whole_voxels_mm(const OffsetOperand& operand) {
  return operand.is_whole_voxels ? 0.5 * longest_edge_of(operand.voxels.universe()) : 0.0;
}

/// Points, sorted into the cells of a grid.
class PointGrid {
 public:
  PointGrid(std::vector<glm::dvec3> points_mm, double cell_mm) : cell_mm_(cell_mm) {
    if (points_mm.empty()) return;
    glm::dvec3 high = low_ = points_mm.front();
    for (const glm::dvec3& p : points_mm) {
      low_ = glm::min(low_, p);
      high = glm::max(high, p);
    }
    // The edge of the cells is doubled until there are not many more cells than points, which bounds memory.
    const auto cells_at = [&](double edge_mm) {
      const glm::dvec3 cells = glm::floor((high - low_) / edge_mm) + 1.0;
      return cells.x * cells.y * cells.z;
    };
    while (cells_at(cell_mm_) > 64.0 * static_cast<double>(points_mm.size()) + 4096.0) cell_mm_ *= 2.0;
    dims_ = glm::ivec3(glm::floor((high - low_) / cell_mm_)) + 1;
    first_.assign(index({0, 0, dims_.z}) + 1, 0);
    for (const glm::dvec3& p : points_mm) ++first_[index(cell_of(p)) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    points_.resize(points_mm.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const glm::dvec3& p : points_mm) points_[next[index(cell_of(p))]++] = p;
  }

  bool has_within(const glm::dvec3& p, double reach_mm) const {
    if (points_.empty() || !(reach_mm >= 0.0)) return false;
    const glm::ivec3 from = glm::max(cell_of(p - reach_mm), glm::ivec3(0)),
                     to = glm::min(cell_of(p + reach_mm), dims_ - 1);
    for (int z = from.z; z <= to.z; ++z)
      for (int y = from.y; y <= to.y; ++y)
        for (int x = from.x; x <= to.x; ++x) {
          const std::size_t cell = index({x, y, z});
          for (std::size_t i = first_[cell]; i < first_[cell + 1]; ++i) {
            const glm::dvec3 apart = points_[i] - p;
            if (glm::dot(apart, apart) <= reach_mm * reach_mm) return true;
          }
        }
    return false;
  }

 private:
  glm::ivec3 cell_of(const glm::dvec3& p) const {
    return glm::ivec3(glm::clamp(glm::floor((p - low_) / cell_mm_), glm::dvec3(-1.0), glm::dvec3(dims_)));
  }
  std::size_t index(const glm::ivec3& cell) const {
    return static_cast<std::size_t>(cell.x) +
           static_cast<std::size_t>(dims_.x) *
               (static_cast<std::size_t>(cell.y) +
                static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(cell.z));
  }

  double cell_mm_ = 1.0;
  glm::dvec3 low_{0.0};
  glm::ivec3 dims_{0};
  std::vector<std::uint32_t> first_;  ///< of a cell's points
  std::vector<glm::dvec3> points_;
};

/// Possible positions of the operand's surface: for each edge between voxel centres a place certainly inside,
/// a place certainly outside, and the places between them.
struct SurfacePlaces {
  std::vector<glm::dvec3> in_mm, out_mm, between_mm;

  void add(const SurfacePlaces& other) {
    in_mm.insert(in_mm.end(), other.in_mm.begin(), other.in_mm.end());
    out_mm.insert(out_mm.end(), other.out_mm.begin(), other.out_mm.end());
    between_mm.insert(between_mm.end(), other.between_mm.begin(), other.between_mm.end());
  }
};

/// The sides that at least one kernel may have for the operand at a point.
AllowedSides common_sides(const Reading& reading) {
  return {reading.voxel.in || reading.mesh.in, reading.voxel.out || reading.mesh.out,
          reading.voxel.near || reading.mesh.near};
}

/// Returns the places of the surface on the edge between the two voxels of a face, and up to a voxel farther
/// on either side.
SurfacePlaces places_at(const voxel::VoxelFace& face, const OffsetOperand& operand,
                        const voxel::Octree& digitised) {
  const voxel::Lattice lattice = operand.voxels.universe().lattice();
  glm::dvec3 step(0.0);
  step[face.axis] = face.side;
  const auto at = [&](int eighths) {
    return lattice.lps_mm(glm::dvec3(face.voxel) + static_cast<double>(eighths) / steps_a_voxel * step);
  };
  const auto allowed = [&](int eighths) { return common_sides(operand.witness.allowed_sides(at(eighths))); };
  constexpr int middle = steps_a_voxel / 2, most = 3 * steps_a_voxel / 2;
  SurfacePlaces places;
  int in = middle, out = middle;
  while (in > middle - most && allowed(in).out) --in;
  while (out < middle + most && allowed(out).in) ++out;
  const bool both_have_voxel = operand.voxels.contains(face.voxel) && digitised.contains(face.voxel);
  if (allowed(in) == certainly_in || (in < 0 && both_have_voxel)) {
    in = allowed(in) == certainly_in ? in : 0;
    places.in_mm.push_back(at(in));
  }
  if (allowed(out) == certainly_out) places.out_mm.push_back(at(out));
  for (int i = in; i <= out; ++i) places.between_mm.push_back(at(i));
  return places;
}

std::vector<voxel::VoxelFace> faces_of(const OffsetOperand& operand, const voxel::Octree& digitised) {
  std::vector<voxel::VoxelFace> faces = voxel::voxel_boundary(operand.voxels);
  // Faces of the digitised mesh count where the voxels have no face.
  for (const voxel::VoxelFace& face : voxel::voxel_boundary(digitised)) {
    glm::ivec3 beyond = face.voxel;
    beyond[face.axis] += face.side;
    if (!operand.voxels.contains(face.voxel) || operand.voxels.contains(beyond)) faces.push_back(face);
  }
  return faces;
}

SurfacePlaces places_of(const OffsetOperand& operand) {
  const voxel::Octree digitised = convert::voxelise(operand.voxels.universe(), operand.mesh.linked());
  const std::vector<voxel::VoxelFace> faces = faces_of(operand, digitised);
  constexpr std::size_t some = 4096;
  std::vector<SurfacePlaces> parts((faces.size() + some - 1) / some);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    for (std::size_t i = part * some; i < std::min(faces.size(), (part + 1) * some); ++i)
      parts[part].add(places_at(faces[i], operand, digitised));
  });
  SurfacePlaces all;
  for (const SurfacePlaces& part : parts) all.add(part);
  return all;
}

/// Divides a triangle into equal parts whose edges are at most `edge_mm`, and calls `take` with the centroid
/// of each. A search for the surface starts there.
template <typename Take>
void for_parts(const std::array<glm::dvec3, 3>& corners_mm, double edge_mm, const Take& take) {
  const auto& [p, q, r] = corners_mm;
  const double longest_mm = std::max({glm::distance(p, q), glm::distance(q, r), glm::distance(r, p)});
  const int parts = std::max(1, static_cast<int>(std::ceil(longest_mm / edge_mm)));
  for (int i = 0; i < parts; ++i)
    for (int j = 0; j < parts - i; ++j)
      for (const double at : {1.0 / 3.0, 2.0 / 3.0}) {
        if (at > 0.5 && i + j + 1 >= parts) continue;
        take(p + (i + at) / parts * (q - p) + (j + at) / parts * (r - p));
      }
}

/// Searches the surface of the operand's witness along the outward normal of the operand's mesh, near a point
/// of the mesh. Returns the positions of the surface; empty if there is none within a voxel.
SurfacePlaces places_near(const glm::dvec3& p_mm, const glm::dvec3& normal, double step_mm,
                          const Witness& witness) {
  const auto at = [&](int step) { return p_mm + step * step_mm * normal; };
  const auto allowed = [&](int step) { return witness.mesh_sides(at(step)); };
  int in = 0, out = 0;
  while (in > -steps_a_voxel && allowed(in).in && allowed(in).out) --in;
  while (out < steps_a_voxel && allowed(out).in && allowed(out).out) ++out;
  // If the point is certainly outside, the surface lies inward of it; if it is certainly inside, outward.
  if (allowed(0) == certainly_out)
    while (in > -steps_a_voxel && allowed(in).out) --in;
  if (allowed(0) == certainly_in)
    while (out < steps_a_voxel && allowed(out).in) ++out;
  SurfacePlaces places;
  if (allowed(in) == certainly_in) places.in_mm.push_back(at(in));
  if (allowed(out) == certainly_out) places.out_mm.push_back(at(out));
  const bool has_both = !places.in_mm.empty() && !places.out_mm.empty();
  if (!has_both && !allowed(0).near) return {};
  places.between_mm.push_back(p_mm);
  if (has_both)
    for (int i = in; i <= out; ++i) places.between_mm.push_back(at(i));
  return places;
}

/// Returns the places of walls and gaps that pass between the voxels' centres and are not near places at
/// voxels' faces.
SurfacePlaces thin_places_of(const OffsetOperand& operand, const std::vector<glm::dvec3>& between_mm) {
  const voxel::Universe& universe = operand.voxels.universe();
  const voxel::Box world = voxel::bounds(universe.lattice());
  const double error_mm = own_error_mm(universe);
  const PointGrid known(between_mm, 2.0 * diagonal_of(universe));
  const brep::Triangles& mesh = operand.mesh.triangles();
  constexpr std::size_t some = 4096;
  std::vector<SurfacePlaces> found((mesh.faces.size() + some - 1) / some);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t part) {
    for (std::size_t i = part * some; i < std::min(mesh.faces.size(), (part + 1) * some); ++i) {
      const auto& [a, b, c] = mesh.faces[i];
      const std::array<glm::dvec3, 3> corners_mm{mesh.points_mm[a], mesh.points_mm[b], mesh.points_mm[c]};
      const glm::dvec3 across = glm::cross(corners_mm[1] - corners_mm[0], corners_mm[2] - corners_mm[0]);
      const double length = glm::length(across);
      if (!(length > 0.0)) continue;
      // Each point of a part is within 2/3 of the part's longest edge of the part's centroid. So the parts
      // reach all points within the remaining share of the error.
      for_parts(corners_mm, 1.5 * (1.0 - thin_share) * error_mm, [&](const glm::dvec3& p_mm) {
        const bool is_here =
            glm::all(glm::greaterThan(p_mm, world.low_mm)) && glm::all(glm::lessThan(p_mm, world.high_mm));
        if (is_here && !known.has_within(p_mm, thin_share * error_mm))
          found[part].add(places_near(p_mm, across / length, 0.5 * longest_edge_of(universe) / steps_a_voxel,
                                      operand.witness));
      });
    }
  });
  SurfacePlaces all;
  for (const SurfacePlaces& part : found) all.add(part);
  return all;
}

class OffsetWitness {
 public:
  OffsetWitness(const OffsetOperand& operand, const WitnessedOffset& asked, SurfacePlaces places,
                SurfacePlaces thin)
      : operand_(operand.witness),
        voxel_from_lps_(glm::inverse(operand.voxels.universe().lps_from_voxel)),
        by_mm_(asked.by_mm),
        diagonal_mm_(diagonal_of(operand.voxels.universe())),
        whole_voxels_mm_(whole_voxels_mm(operand)),
        mesh_error_mm_(mesh_error * asked.cell_mm),
        own_error_mm_(own_error_mm(operand.voxels.universe())),
        thin_error_mm_((1.0 - thin_share) * own_error_mm_ +
                       longest_edge_of(operand.voxels.universe()) / (4 * steps_a_voxel)),
        in_(std::move(places.in_mm), grid_mm()),
        out_(std::move(places.out_mm), grid_mm()),
        between_(std::move(places.between_mm), grid_mm()),
        thin_in_(std::move(thin.in_mm), grid_mm()),
        thin_out_(std::move(thin.out_mm), grid_mm()),
        thin_between_(std::move(thin.between_mm), grid_mm()) {}

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) const {
    const Reading own = operand_(p_mm, slack_mm, ReadingNeeds::BothSides);
    const AllowedSides voxel = needs_voxels(asked)
                                   ? voxel_sides(own.voxel, p_mm, voxel_error_mm(p_mm) + slack_mm)
                                   : AllowedSides{},
                       mesh = mesh_sides(own.mesh, p_mm, mesh_error_mm_ + slack_mm);
    // A vertex of the mesh may lie wherever the surface may.
    return {voxel, mesh, mesh.near ? 2 : 0};
  }

 private:
  double grid_mm() const { return std::max(2.0 * diagonal_mm_, 0.25 * std::abs(by_mm_)); }

  double voxel_error_mm(const glm::dvec3& p_mm) const {
    const glm::dvec3 p = glm::dvec3(voxel_from_lps_ * glm::dvec4(p_mm, 1.0));
    constexpr double on_centre = 1e-6;
    const bool is_centre = glm::all(glm::lessThan(glm::abs(p - glm::round(p)), glm::dvec3(on_centre)));
    return (is_centre ? cut_corner : cut_corner + 0.5) * diagonal_mm_ + whole_voxels_mm_;
  }

  /// The sides allowed by the places at voxels' faces. None: no such place moves the surface to this point.
  std::optional<AllowedSides> allowed(const AllowedSides& own, const glm::dvec3& p_mm,
                                      double error_mm) const {
    const AllowedSides beyond = by_mm_ > 0.0 ? certainly_in : certainly_out;
    const PointGrid& sure = by_mm_ > 0.0 ? in_ : out_;
    if (own == beyond || sure.has_within(p_mm, std::abs(by_mm_) - error_mm)) return beyond;
    if (own.near || between_.has_within(p_mm, std::abs(by_mm_) + error_mm + own_error_mm_)) return on_surface;
    return std::nullopt;
  }

  bool is_near_thin(const glm::dvec3& p_mm, double error_mm) const {
    return thin_between_.has_within(p_mm, std::abs(by_mm_) + error_mm + thin_error_mm_);
  }

  /// If a wall or gap passes between voxels' centres, the voxel kernel cannot compute its offset.
  AllowedSides voxel_sides(const AllowedSides& own, const glm::dvec3& p_mm, double error_mm) const {
    if (const std::optional<AllowedSides> known = allowed(own, p_mm, error_mm)) return *known;
    return is_near_thin(p_mm, error_mm) ? either_side : own;
  }

  AllowedSides mesh_sides(const AllowedSides& own, const glm::dvec3& p_mm, double error_mm) const {
    const PointGrid& thin = by_mm_ > 0.0 ? thin_in_ : thin_out_;
    if (thin.has_within(p_mm, std::abs(by_mm_) - error_mm))
      return by_mm_ > 0.0 ? certainly_in : certainly_out;
    if (const std::optional<AllowedSides> known = allowed(own, p_mm, error_mm)) return *known;
    return is_near_thin(p_mm, error_mm) ? on_surface : own;
  }

  Witness operand_;
  glm::dmat4 voxel_from_lps_;
  double by_mm_, diagonal_mm_, whole_voxels_mm_, mesh_error_mm_, own_error_mm_, thin_error_mm_;
  PointGrid in_, out_, between_, thin_in_, thin_out_, thin_between_;
};

/// Half the sum of length times exterior angle over the mesh's sharp edges.
double sharp_half_sum_mm(const brep::Triangles& mesh) {
  struct Side {
    std::uint64_t key;
    std::uint32_t face;
    bool operator<(const Side& other) const {
      return std::pair{key, face} < std::pair{other.key, other.face};
    }
  };
  std::vector<Side> sides;
  std::vector<glm::dvec3> normals(mesh.faces.size());
  for (std::uint32_t i = 0; i < mesh.faces.size(); ++i) {
    const auto& face = mesh.faces[i];
    const glm::dvec3& a = mesh.points_mm[face[0]];
    normals[i] = glm::cross(mesh.points_mm[face[1]] - a, mesh.points_mm[face[2]] - a);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(face[k], face[(k + 1) % 3]);
      sides.push_back({std::uint64_t{low} << 32 | high, i});
    }
  }
  std::sort(sides.begin(), sides.end());
  double sum_mm = 0.0;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].key != sides[i - 1].key) continue;
    const glm::dvec3 &n = normals[sides[i].face], &m = normals[sides[i - 1].face];
    const double angle = std::atan2(glm::length(glm::cross(n, m)), glm::dot(n, m));
    const auto low = static_cast<std::size_t>(sides[i].key >> 32),
               high = static_cast<std::size_t>(sides[i].key & 0xFFFFFFFFU);
    if (angle > sharp_rad) sum_mm += 0.5 * angle * glm::distance(mesh.points_mm[low], mesh.points_mm[high]);
  }
  return sum_mm;
}

/// Area of those triangles of the operand's mesh that pass between voxels' centres.
double thin_mm2(const OffsetOperand& operand) {
  const double diagonal_mm = diagonal_of(operand.voxels.universe());
  const voxel::Lattice lattice = operand.voxels.universe().lattice();
  const voxel::Box world = voxel::bounds(lattice);
  std::vector<glm::dvec3> faces_mm;
  for (const voxel::VoxelFace& face : voxel::voxel_boundary(operand.voxels)) {
    glm::dvec3 at(face.voxel);
    at[face.axis] += 0.5 * face.side;
    faces_mm.push_back(lattice.lps_mm(at));
  }
  const PointGrid grid(std::move(faces_mm), 2.0 * diagonal_mm);
  const brep::Triangles& mesh = operand.mesh.triangles();
  std::vector<double> areas_mm2(mesh.faces.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, mesh.faces.size(), [&](std::size_t i) {
    const auto& [a, b, c] = mesh.faces[i];
    const glm::dvec3 &p = mesh.points_mm[a], &q = mesh.points_mm[b], &r = mesh.points_mm[c];
    const glm::dvec3 centroid_mm = (p + q + r) / 3.0;
    const bool is_here = glm::all(glm::greaterThan(centroid_mm, world.low_mm)) &&
                         glm::all(glm::lessThan(centroid_mm, world.high_mm));
    if (is_here && !grid.has_within(centroid_mm, diagonal_mm))
      areas_mm2[i] = 0.5 * glm::length(glm::cross(q - p, r - p));
  });
  return std::accumulate(areas_mm2.begin(), areas_mm2.end(), 0.0);
}

}  // namespace

Witness witness_of_offset(const OffsetOperand& operand, const WitnessedOffset& asked) {
  if (!operand.witness) return {};
  SurfacePlaces places = places_of(operand);
  SurfacePlaces thin = thin_places_of(operand, places.between_mm);
  if (places.between_mm.empty() && thin.between_mm.empty()) return {};
  const auto read = std::make_shared<const OffsetWitness>(operand, asked, std::move(places), std::move(thin));
  return Witness([read](const glm::dvec3& p_mm, double slack_mm, ReadingNeeds needed) {
           return (*read)(p_mm, slack_mm, needed);
         })
      .with_choices(operand.witness.choices());
}

double offset_allowance_mm(const OffsetOperand& operand, const WitnessedOffset& asked, double area_mm2) {
  if (!(area_mm2 > 0.0)) return 0.0;
  const double b = std::abs(asked.by_mm), c = asked.cell_mm;
  const double diagonal_mm = diagonal_of(operand.voxels.universe()),
               edge_mm = longest_edge_of(operand.voxels.universe());
  const double of_voxels_mm = diagonal_mm * diagonal_mm / 72.0 * (1.0 / b + 1.0 / (3.0 * edge_mm));
  const double of_mesh_mm = c * c / (12.0 * b) + (mesh_error - 1.0) * c;
  const double of_edges_mm3 =
      sharp_half_sum_mm(operand.mesh.triangles()) * (0.75 * edge_mm * b + 0.25 * c * c);
  const double of_edges_mm = std::min(of_edges_mm3 / area_mm2, cut_corner * diagonal_mm + 0.25 * c);
  return of_voxels_mm + whole_voxels_mm(operand) + of_mesh_mm + of_edges_mm +
         thin_mm2(operand) * b / area_mm2;
}

}  // namespace octotomy::verify
