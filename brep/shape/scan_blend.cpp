// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 A weight at every point: 1 where the scan counts, 0 where the solid does. It grows along the width of the
//   border with the least of four lengths: the distance of the scan's nearest point from the scan's border,
//   the height of the point above the depth, its distance within the radius of the chosen crowns, and the
//   remaining reach.
// 2 In a box about the crowns: the surface on which the mixed distances, (1 - w) solid + w scan, are 0. It is made
//   from cells of one size, of six tetrahedra each; its corners are searched on the cells' edges. It ends at the box's
//   walls. Blocks of cells far from it are skipped and keep one value.
// 3 The solid less a slightly smaller box, united with that. Between both boxes the new surface lies a little
//   within the solid, so that both cross each other nowhere but at the box.
//
// The side of a point of the scan follows from the scan's winding number. Above the plane through its border,
// this number is at least 1/2 inside a scan of crowns and at most 0 outside. Between these values, which
// occur inside a flat scan, the normal at the nearest point decides. Normals alone fail where noise makes the
// scan cross itself, as it does between teeth that touch: points up to a millimetre or more away from the
// scan have their nearest point there.
//
// Where the weight changes, the slope of mixed distances exceeds 1: it is up to 1 plus the distance between scan and
// solid times 1.5 / width, the steepest slope of the weight.
#include "brep/shape/scan_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "brep/boolean/boolean.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/winding_number.h"
#include "brep/shape/kuhn_cells.h"
#include "brep/shape/prism.h"

namespace octotomy::brep {
namespace {

/// Points in the cells of a grid, for the distance to the nearest one up to the cell's edge.
class NearPoints {
 public:
  explicit NearPoints(double cell_mm) : cell_mm_(cell_mm) {}
  void add(const glm::dvec3& p_mm) { cells_[cell_of(p_mm)].push_back(p_mm); }
  /// The distance to the nearest point, or the cell's edge if that is less.
  double distance_mm(const glm::dvec3& p_mm) const {
    double least = cell_mm_;
    const auto [x, y, z] = cell_of(p_mm);
    for (long k = z - 1; k <= z + 1; ++k)
      for (long j = y - 1; j <= y + 1; ++j)
        for (long i = x - 1; i <= x + 1; ++i)
          if (const auto found = cells_.find({i, j, k}); found != cells_.end())
            for (const glm::dvec3& q : found->second) least = std::min(least, glm::distance(p_mm, q));
    return least;
  }

 private:
  using Cell = std::tuple<long, long, long>;
  Cell cell_of(const glm::dvec3& p_mm) const {
    const glm::dvec3 cell = glm::floor(p_mm / cell_mm_);
    return {static_cast<long>(cell.x), static_cast<long>(cell.y), static_cast<long>(cell.z)};
  }
  double cell_mm_;
  std::map<Cell, std::vector<glm::dvec3>> cells_;
};

/// The points along the scan's border, no further apart than a tenth of the border's width.
NearPoints border_of(const Mesh& scan, double width_mm) {
  NearPoints border(width_mm);
  for (const auto edge : scan.edges()) {
    if (!scan.is_boundary(edge)) continue;
    const auto side = scan.halfedge_handle(edge, 0);
    const Mesh::Point &a = scan.point(scan.from_vertex_handle(side)),
                      &b = scan.point(scan.to_vertex_handle(side));
    const int steps = 1 + static_cast<int>((b - a).norm() / (0.1 * width_mm));
    for (int i = 0; i <= steps; ++i) {
      const Mesh::Point p = a + (b - a) * (double(i) / steps);
      border.add({p[0], p[1], p[2]});
    }
  }
  return border;
}

/// The triangles of the scan that have a point no deeper than `depth_mm`.
Triangles down_to(const Mesh& scan, const ScanBlendOptions& options, double depth_mm) {
  Triangles part = triangles_of(scan);
  const auto is_deep = [&](std::uint32_t i) {
    return glm::dot(part.points_mm[i], options.to_roots) - options.tips_mm > depth_mm;
  };
  std::erase_if(part.faces, [&](const auto& face) { return std::all_of(face.begin(), face.end(), is_deep); });
  return part;
}

/// Normals at points, weighted by area and averaged once over neighbours: noise turns small triangles over,
/// and their own normals would put points on the wrong side.
std::vector<glm::dvec3> smooth_normals(const Triangles& surface) {
  std::vector<glm::dvec3> normals(surface.points_mm.size(), glm::dvec3(0.0));
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 normal =
        glm::cross(surface.points_mm[b] - surface.points_mm[a], surface.points_mm[c] - surface.points_mm[a]);
    for (const std::uint32_t corner : {a, b, c}) normals[corner] += normal;
  }
  std::vector<glm::dvec3> smooth = normals;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 sum = normals[a] + normals[b] + normals[c];
    for (const std::uint32_t corner : {a, b, c}) smooth[corner] += sum;
  }
  return smooth;
}

/// The scan's distance and weight at a point.
struct Mixed {
  double scan_mm = 0.0, weight = 0.0;
};

class Weight {
 public:
  Weight(const Mesh& scan, const ScanBlendOptions& options)
      : options_(options),
        far_mm_(options.reach_mm + options.blend_mm),
        border_(border_of(scan, options.blend_mm)),
        scan_(down_to(scan, options, options.depth_mm + 2.0 * far_mm_)),
        normals_(smooth_normals(scan_)),
        tree_(scan_),
        turns_(triangles_of(scan)) {}

  double far_mm() const { return far_mm_; }

  /// How far inside the depth and the surroundings of the chosen crowns a point lies, mm; negative outside.
  double within_mm(const glm::dvec3& p_mm) const {
    double within = options_.depth_mm + options_.tips_mm - glm::dot(p_mm, options_.to_roots);
    if (options_.about_mm.empty()) return within;
    double chosen = -std::numeric_limits<double>::infinity();
    for (const glm::dvec3& q : options_.about_mm)
      chosen = std::max(chosen, options_.radius_mm - glm::distance(p_mm, q));
    return std::min(within, chosen);
  }

  std::vector<Mixed> at(const std::vector<glm::dvec3>& points_mm) const {
    // Between these winding numbers the nearest triangle's normal decides. The numbers on both sides differ
    // by 1, so a third is far above their error.
    constexpr double surely_inside = 2.0 / 3.0, surely_outside = 0.0;
    const std::vector<Foot> feet = tree_.feet(points_mm);
    const std::vector<double> turns = turns_.at(points_mm);
    std::vector<Mixed> mixed(points_mm.size());
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      const Foot& foot = feet[i];
      const double within = std::min(within_mm(points_mm[i]), far_mm_ - foot.distance_mm);
      if (within <= 0.0) continue;
      const auto& face = scan_.faces[foot.face];
      const glm::dvec3 normal = foot.weights.x * normals_[face[0]] + foot.weights.y * normals_[face[1]] +
                                foot.weights.z * normals_[face[2]];
      const bool is_inside = turns[i] > surely_inside ||
                             (turns[i] >= surely_outside && glm::dot(points_mm[i] - foot.p_mm, normal) < 0.0);
      const double share =
          std::clamp(std::min(within, border_.distance_mm(foot.p_mm)) / options_.blend_mm, 0.0, 1.0);
      mixed[i] = {is_inside ? -foot.distance_mm : foot.distance_mm, share * share * (3.0 - 2.0 * share)};
    }
    return mixed;
  }

 private:
  const ScanBlendOptions& options_;
  double far_mm_;
  NearPoints border_;
  Triangles scan_;
  std::vector<glm::dvec3> normals_;
  SurfaceTree tree_;
  WindingTree turns_;
};

/// A box that is turned against all axes, so that no plane of a cut lies in its sides.
struct TurnedBox {
  glm::dvec3 right, up, look, low{0.0}, high{0.0};

  TurnedBox(const glm::dvec3& to_roots, const std::vector<glm::dvec3>& points_mm, double margin_mm) {
    look = glm::normalize(to_roots + glm::dvec3(0.0123, 0.0217, 0.0171));
    const glm::dvec3 beside = std::abs(look.x) < 0.6 ? glm::dvec3(1, 0.031, 0) : glm::dvec3(0.031, 1, 0);
    up = glm::normalize(glm::cross(look, beside));
    right = glm::cross(look, up);
    low = glm::dvec3(std::numeric_limits<double>::infinity());
    high = -low;
    for (const glm::dvec3& p : points_mm) {
      low = glm::min(low, in_box(p));
      high = glm::max(high, in_box(p));
    }
    low -= margin_mm;
    high += margin_mm;
  }
  glm::dvec3 in_box(const glm::dvec3& p) const {
    return {glm::dot(p, right), glm::dot(p, up), glm::dot(p, look)};
  }
  /// The signed distance to the box, negative inside: exact inside, a lower bound outside.
  double distance_mm(const glm::dvec3& p) const {
    const glm::dvec3 q = in_box(p), beyond = glm::max(low - q, q - high);
    return std::max({beyond.x, beyond.y, beyond.z});
  }
  Size size() const {
    Size size{.low_mm = glm::dvec3(std::numeric_limits<double>::infinity()), .high_mm = {}};
    size.high_mm = -size.low_mm;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 q((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                         (corner & 4) != 0 ? high.z : low.z);
      const glm::dvec3 p = right * q.x + up * q.y + look * q.z;
      size.low_mm = glm::min(size.low_mm, p);
      size.high_mm = glm::max(size.high_mm, p);
    }
    return size;
  }
  Solid solid(double inset_mm) const {
    const glm::dvec3 a = low + inset_mm, b = high - inset_mm;
    return solid_of(Prism{look, up, right, {{{a.x, a.y}, {b.x, a.y}, {b.x, b.y}, {a.x, b.y}}}, a.z, b.z});
  }
};

/// The mixed distances, which end at the walls of the box. Within `strip_mm` of the walls the surface lies
/// `inset_mm` inside the solid's surface.
class MixedField {
 public:
  MixedField(const Solid& solid, const Weight& weight, const TurnedBox& box, double strip_mm, double inset_mm,
             std::stop_token stop)
      : solid_(solid),
        weight_(weight),
        box_(box),
        strip_mm_(strip_mm),
        inset_mm_(inset_mm),
        stop_(std::move(stop)) {}

  /// The field's values at points. Throws Stopped less than a second after a stop is requested.
  std::vector<double> at(const std::vector<glm::dvec3>& points_mm) const {
    constexpr std::size_t part = 1 << 14;
    std::vector<double> values;
    values.reserve(points_mm.size());
    for (std::size_t from = 0; from < points_mm.size(); from += part) {
      Progress{stop_, {}}.at(0.0);
      const std::size_t to = std::min(from + part, points_mm.size());
      const std::vector<double> more = values_of({points_mm.begin() + static_cast<std::ptrdiff_t>(from),
                                                  points_mm.begin() + static_cast<std::ptrdiff_t>(to)});
      values.insert(values.end(), more.begin(), more.end());
    }
    return values;
  }

 private:
  std::vector<double> values_of(const std::vector<glm::dvec3>& points_mm) const {
    const double far_mm = weight_.far_mm();
    std::vector<double> values(points_mm.size());
    std::vector<std::size_t> inside;
    std::vector<glm::dvec3> inside_mm;
    for (std::size_t i = 0; i < points_mm.size(); ++i) {
      values[i] = box_.distance_mm(points_mm[i]);
      if (values[i] >= far_mm) continue;
      inside.push_back(i);
      inside_mm.push_back(points_mm[i]);
    }
    if (inside.empty()) return values;
    std::vector<std::uint32_t> nearest(inside.size(), SurfaceTree::unknown_triangle);
    const std::vector<double> solid_mm = solid_.tree().signed_distances_mm(inside_mm, nearest);
    const std::vector<Mixed> mixed = weight_.at(inside_mm);
    for (std::size_t k = 0; k < inside.size(); ++k) {
      const double kept_mm = std::clamp(solid_mm[k], -far_mm, far_mm);
      const double value = kept_mm + mixed[k].weight * (mixed[k].scan_mm - kept_mm);
      double& at = values[inside[k]];
      at = std::max(at, value + inset_mm_ * std::clamp(1.0 + at / strip_mm_, 0.0, 1.0));
    }
    return values;
  }

  const Solid& solid_;
  const Weight& weight_;
  const TurnedBox& box_;
  double strip_mm_, inset_mm_;
  std::stop_token stop_;
};

/// The field's values at the points of a lattice about the box, in blocks of points, x fastest. A block
/// farther from the surface than its size has only the value of its middle: there, only the sign counts.
class LatticeValues {
 public:
  static constexpr int block = 4, block_points = block * block * block;

  glm::dvec3 origin_mm{0.0};
  double step_mm = 1.0;
  glm::ivec3 blocks{0};
  std::vector<double> middles;
  /// For each block: the index of its first value, or far_block.
  std::vector<std::uint32_t> first;
  std::vector<double> values;
  static constexpr std::uint32_t far_block = 0xFFFFFFFFU;

  glm::dvec3 at_mm(const glm::dvec3& place) const { return origin_mm + step_mm * place; }
  static LatticePoint place_in_block(int k) { return {k % block, k / block % block, k / (block * block)}; }
  std::size_t block_number(const glm::ivec3& b) const {
    return static_cast<std::size_t>(b.x) +
           static_cast<std::size_t>(blocks.x) *
               (static_cast<std::size_t>(b.y) +
                static_cast<std::size_t>(blocks.y) * static_cast<std::size_t>(b.z));
  }
  double at(const LatticePoint& p) const {
    const std::size_t number = block_number(p / block);
    if (first[number] == far_block) return middles[number];
    const LatticePoint in = p % block;
    return values[first[number] + static_cast<std::size_t>(in.x + block * (in.y + block * in.z))];
  }
  /// Whether the surface may pass cells of this block, or between it and the next ones.
  bool may_have_surface(const glm::ivec3& b) const {
    const std::size_t number = block_number(b);
    for (int corner = 0; corner < 8; ++corner) {
      const std::size_t next = block_number(glm::min(b + corner_place(corner), blocks - 1));
      if (first[next] != far_block || (middles[next] < 0.0) != (middles[number] < 0.0)) return true;
    }
    return false;
  }
};

LatticeValues values_about(const Size& size, const MixedField& field, double steepness,
                           const ScanBlendOptions& options) {
  constexpr int block = LatticeValues::block;
  LatticeValues lattice;
  lattice.step_mm = options.cell_mm;
  // Irregular shares of a cell keep the lattice off planes at round coordinates.
  lattice.origin_mm = size.low_mm - options.cell_mm * glm::dvec3(1.2718281828, 1.3141592653, 1.1414213562);
  lattice.blocks = glm::ivec3(
      glm::ceil((size.high_mm + 2.0 * options.cell_mm - lattice.origin_mm) / (block * options.cell_mm)));
  // A block takes 48 bytes. Near the surface, each point of a block takes 32 bytes, and 32 more while the
  // list of points grows.
  constexpr double most_blocks = double(1 << 21);
  constexpr std::size_t most_near_blocks = 1 << 17;
  const auto too_many = [&] {
    return TooLarge("cells of " + short_text(options.cell_mm) +
                    " mm are too small for the crowns of this scan: take larger cells, or fewer crowns");
  };
  if (double(lattice.blocks.x) * lattice.blocks.y * lattice.blocks.z > most_blocks) throw too_many();
  std::vector<LatticePoint> lowest;
  std::vector<glm::dvec3> middles_mm;
  for (int z = 0; z < lattice.blocks.z; ++z)
    for (int y = 0; y < lattice.blocks.y; ++y)
      for (int x = 0; x < lattice.blocks.x; ++x) {
        lowest.emplace_back(block * LatticePoint(x, y, z));
        middles_mm.push_back(lattice.at_mm(glm::dvec3(lowest.back()) + 0.5 * (block - 1)));
      }
  lattice.middles = field.at(middles_mm);
  options.progress.at(0.1);
  // The distance from a block's middle to one cell beyond its farthest point, as a change of the field.
  const double reach_mm = steepness * options.cell_mm * (0.5 * std::sqrt(3.0) * (block - 1) + 1.0);
  std::vector<glm::dvec3> points_mm;
  lattice.first.assign(lowest.size(), LatticeValues::far_block);
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    if (std::abs(lattice.middles[i]) > reach_mm) continue;
    if (points_mm.size() >= LatticeValues::block_points * most_near_blocks) throw too_many();
    lattice.first[i] = static_cast<std::uint32_t>(points_mm.size());
    for (int k = 0; k < LatticeValues::block_points; ++k)
      points_mm.push_back(lattice.at_mm(glm::dvec3(lowest[i] + LatticeValues::place_in_block(k))));
  }
  lattice.values = field.at(points_mm);
  options.progress.at(0.4);
  return lattice;
}

/// The triangles between lattice points inside and outside. They form a closed surface for any values.
std::vector<EdgeTriangle> triangles_between(const LatticeValues& lattice, const ScanBlendOptions& options) {
  std::vector<EdgeTriangle> triangles;
  const LatticePoint last = LatticeValues::block * lattice.blocks - 1;
  for (int z = 0; z < lattice.blocks.z; ++z) {
    options.progress.at(0.4);
    for (int y = 0; y < lattice.blocks.y; ++y)
      for (int x = 0; x < lattice.blocks.x; ++x) {
        if (!lattice.may_have_surface({x, y, z})) continue;
        for (int k = 0; k < LatticeValues::block_points; ++k) {
          const LatticePoint cell =
              LatticeValues::block * LatticePoint(x, y, z) + LatticeValues::place_in_block(k);
          if (glm::any(glm::greaterThanEqual(cell, last))) continue;
          std::array<double, 8> corners{};
          int inside = 0;
          for (int corner = 0; corner < 8; ++corner) {
            const double value = lattice.at(cell + corner_place(corner));
            corners[static_cast<std::size_t>(corner)] = value;
            inside += value < 0.0 ? 1 : 0;
          }
          if (inside != 0 && inside != 8) add_triangles(cell, corners, triangles);
        }
      }
  }
  return triangles;
}

/// A part of a lattice's edge that the surface crosses: shares of the edge and the values there.
struct CrossedEdge {
  double from = 0.0, to = 1.0, at_from = 0.0, at_to = 0.0;

  /// Where the surface is if values are linear in between.
  double share() const {
    return std::clamp(from + (to - from) * at_from / (at_from - at_to), nearest_end, 1.0 - nearest_end);
  }
  void narrow(double share, double value) {
    const bool is_like_from = (value < 0.0) == (at_from < 0.0);
    (is_like_from ? from : to) = share;
    (is_like_from ? at_from : at_to) = value;
  }
};

/// The surface between lattice points inside and outside. Its corners lie where the field itself is 0: distances bend at
/// cusps and between teeth, so the values at the ends of an edge do not suffice to place the corners.
Solid surface_of(const LatticeValues& lattice, const MixedField& field, const ScanBlendOptions& options) {
  constexpr int rounds = 2;
  const std::vector<EdgeTriangle> triangles = triangles_between(lattice, options);
  const std::vector<LatticeEdge> edges = edges_of(triangles);
  std::vector<CrossedEdge> crossed;
  for (const LatticeEdge& edge : edges) {
    const LatticePoint from = place_of(edge.from());
    crossed.push_back({.at_from = lattice.at(from), .at_to = lattice.at(from + corner_place(edge.along()))});
  }
  Triangles surface;
  surface.faces = numbered(triangles, edges);
  surface.points_mm.resize(edges.size());
  const auto place = [&] {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const glm::dvec3 from(place_of(edges[i].from()));
      surface.points_mm[i] =
          lattice.at_mm(from + crossed[i].share() * glm::dvec3(corner_place(edges[i].along())));
    }
  };
  place();
  for (int round = 0; round < rounds; ++round) {
    const std::vector<double> values = field.at(surface.points_mm);
    for (std::size_t i = 0; i < edges.size(); ++i) crossed[i].narrow(crossed[i].share(), values[i]);
    place();
    options.progress.at(0.4 + 0.15 * (round + 1));
  }
  return trusted_solid(std::move(surface), Proof::Construction);
}

/// Removes the specks that mixed distances leave at the scan's border, where the nearest point of the scan
/// jumps.
Solid without_specks(const Solid& solid, ScanBlend& made) {
  constexpr double least_mm3 = 2.0;
  const std::vector<Component>& parts = solid.components();
  std::vector<std::uint32_t> kept;
  std::size_t specks = 0;
  for (const Component& part : parts) {
    if (std::abs(part.volume_mm3) < least_mm3)
      ++specks;
    else
      kept.insert(kept.end(), part.faces.begin(), part.faces.end());
  }
  if (specks == 0) return solid;
  made.findings.push_back(std::to_string(specks) + " specks of less than " + short_text(least_mm3) +
                          " mm³ at the border of the scan are left out");
  std::sort(kept.begin(), kept.end());
  return trusted_solid(part_of(solid.mesh(), kept), proof_of_part(solid.proof()));
}

/// Measures the surface's area by source, and the largest distance to the former solid from the part that the
/// scan supplied.
void find_sources(const Solid& before, const Weight& weight, const TurnedBox& box, ScanBlend& made) {
  const Triangles& surface = made.solid.triangles();
  std::vector<glm::dvec3> middles_mm;
  std::vector<double> areas_mm2;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
    const double area_mm2 = 0.5 * glm::length(glm::cross(q - p, r - p));
    const glm::dvec3 middle_mm = (p + q + r) / 3.0;
    if (box.distance_mm(middle_mm) > 0.0) {
      made.sources.solid_mm2 += area_mm2;
      continue;
    }
    middles_mm.push_back(middle_mm);
    areas_mm2.push_back(area_mm2);
  }
  const std::vector<Mixed> mixed = weight.at(middles_mm);
  std::vector<glm::dvec3> of_scan_mm;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    double& area_mm2 = mixed[i].weight >= 1.0  ? made.sources.scan_mm2
                       : mixed[i].weight > 0.0 ? made.sources.border_mm2
                                               : made.sources.solid_mm2;
    area_mm2 += areas_mm2[i];
    if (mixed[i].weight >= 1.0) of_scan_mm.push_back(middles_mm[i]);
  }
  if (of_scan_mm.empty()) return;
  const std::vector<double> moves_mm = before.tree().distances_mm(of_scan_mm);
  made.largest_move_mm = *std::max_element(moves_mm.begin(), moves_mm.end());
}

void check(const Solid& solid, const ScanBlendOptions& options) {
  if (solid.empty()) throw InvalidInput("an empty solid has no crowns");
  for (const double mm :
       {options.depth_mm, options.blend_mm, options.reach_mm, options.radius_mm, options.cell_mm})
    if (!(mm > 0.0) || !std::isfinite(mm))
      throw InvalidInput("depth, border, reach, radius and cells of a scan's crowns must be above 0 mm");
}

/// The largest slope of the mixed distances where the scan lies within half of the reach from the solid. Only streaks
/// lie farther from the scan.
double steepness_of(const ScanBlendOptions& options) {
  return 1.0 + 0.75 * options.reach_mm / options.blend_mm;
}

}  // namespace

double scan_blend_allowance_mm(const ScanBlendOptions& options) {
  // In a cell's tetrahedron, values that are interpolated between corners differ from those of a field of
  // slope 1 by at most the weighted mean distance from the corners. This mean is largest in the middle of the
  // cell's diagonal, where it is half of the diagonal.
  return 0.5 * std::sqrt(3.0) * options.cell_mm;
}

ScanBlend blended_with_scan(const Solid& solid, const Mesh& scan, const ScanBlendOptions& options) {
  check(solid, options);
  const Weight weight(scan, options);
  std::vector<glm::dvec3> crowns_mm;
  for (const auto v : scan.vertices()) {
    const Mesh::Point& p = scan.point(v);
    if (const glm::dvec3 at(p[0], p[1], p[2]); weight.within_mm(at) > 0.0) crowns_mm.push_back(at);
  }
  if (crowns_mm.empty())
    throw Error(ErrorCode::Geometry,
                "the scan shows none of the crowns that it is to replace: give points on crowns in the scan");
  const double strip_mm = 2.0 * options.cell_mm, inset_mm = options.cell_mm / 8.0;
  const TurnedBox box(options.to_roots, crowns_mm, weight.far_mm() + 2.0 * strip_mm);
  ScanBlend made;
  const MixedField field(solid, weight, box, strip_mm, inset_mm, options.progress.stop);
  const LatticeValues values = values_about(box.size(), field, steepness_of(options), options);
  const Solid anew = without_specks(surface_of(values, field, options), made);
  const BooleanResult rest =
      boolean(solid, Operation::Difference, box.solid(strip_mm), options.progress.stop);
  if (rest.solid.empty()) {
    made.solid = anew;
  } else {
    const BooleanResult united = boolean(rest.solid, Operation::Union, anew, options.progress.stop);
    made.solid = united.solid;
    made.shift_mm = rest.shift_mm + united.shift_mm;
    made.findings.insert(made.findings.end(), rest.findings.begin(), rest.findings.end());
    made.findings.insert(made.findings.end(), united.findings.begin(), united.findings.end());
  }
  find_sources(solid, weight, box, made);
  return made;
}

}  // namespace octotomy::brep
