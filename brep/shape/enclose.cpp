// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 list the cells that each triangle may pass; 2 find the winding number at their corners; 3 while the
// surface of winding number 1/2 leaves the listed cells, add the cells beyond; 4 on each tetrahedron's edge
// whose ends lie on different sides, compute the point where a triangle crosses it or, across a hole, where
// the winding number is 1/2; 5 join those points; 6 for the hull, leave out cavities and their contents. Pass
// 3 finds the whole surface: away from the triangles the winding number is harmonic, so no closed part of the
// surface lies there.
#include "brep/shape/enclose.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/winding_number.h"
#include "brep/shape/kuhn_cells.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_cells = std::size_t{1} << 24;

bool is_finite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The triangles with finite points and three different corners.
Triangles sound_triangles(const Triangles& surface) {
  Triangles sound;
  sound.points_mm = surface.points_mm;
  for (glm::dvec3& p : sound.points_mm)
    if (!is_finite(p)) p = glm::dvec3(0.0);
  for (const auto& face : surface.faces)
    if (std::all_of(face.begin(), face.end(), [&](std::uint32_t v) {
          return v < surface.points_mm.size() && is_finite(surface.points_mm[v]);
        }))
      sound.faces.push_back(face);
  if (sound.faces.empty())
    throw Error(
        ErrorCode::Geometry,
        "nothing encloses a volume: there are only sheets, single triangles or points that are not finite");
  return sound;
}

struct Lattice {
  glm::dvec3 origin_mm{0.0};
  double cell_mm = 1.0;
  LatticePoint cells{0};

  glm::dvec3 at(const LatticePoint& p) const { return origin_mm + cell_mm * glm::dvec3(p); }
  bool has_cell(const LatticePoint& p) const {
    return glm::all(glm::greaterThanEqual(p, LatticePoint(0))) && glm::all(glm::lessThan(p, cells));
  }
  bool is_border(const LatticePoint& p) const {
    return glm::any(glm::lessThanEqual(p, LatticePoint(0))) || glm::any(glm::greaterThanEqual(p, cells));
  }
};

double mean_side_mm(const Triangles& surface) {
  double sum = 0.0;
  for (const auto& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k)
      sum += glm::distance(surface.points_mm[face[k]], surface.points_mm[face[(k + 1) % 3]]);
  return sum / (3.0 * static_cast<double>(surface.faces.size()));
}

Lattice lattice_about(const Triangles& surface, const EncloseOptions& options) {
  if (options.cell_mm && !(*options.cell_mm > 0.0 && std::isfinite(*options.cell_mm)))
    throw InvalidInput("enclose: the cells' edge must be above 0 mm");
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) {
      low = glm::min(low, surface.points_mm[v]);
      high = glm::max(high, surface.points_mm[v]);
    }
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  if (!(extent > 0.0) || !std::isfinite(extent))
    throw Error(ErrorCode::Geometry, "the triangles have no extent: they enclose nothing");
  Lattice lattice;
  lattice.cell_mm =
      options.cell_mm.value_or(std::clamp(mean_side_mm(surface), extent / 1000.0, extent / 60.0));
  // Shifted by irregular shares of a cell, so that planes at round coordinates do not coincide with lattice
  // planes.
  lattice.origin_mm = low - lattice.cell_mm * glm::dvec3(2.27182818, 2.31415926, 2.14142135);
  const glm::dvec3 cells = glm::ceil((high - lattice.origin_mm) / lattice.cell_mm) + 2.0;
  if (!(std::max({cells.x, cells.y, cells.z}) < (1 << side_bits) - 2))
    throw Error(ErrorCode::Geometry, "cells of " + short_text(lattice.cell_mm) +
                                         " mm are too small for an extent of " + short_text(extent) +
                                         " mm, because at most 2^20 cells fit along it: choose larger cells");
  lattice.cells = LatticePoint(cells);
  return lattice;
}

/// A triangle in a cell, sorted by cell.
struct Passage {
  std::uint64_t cell;
  std::uint32_t face;
  bool operator<(const Passage& other) const {
    return std::tie(cell, face) < std::tie(other.cell, other.face);
  }
};

/// A triangle in lattice coordinates.
class Crossed {
 public:
  Crossed(const Triangles& surface, std::uint32_t f, const Lattice& lattice) {
    for (std::size_t k = 0; k < 3; ++k)
      p_[k] = (surface.points_mm[surface.faces[f][k]] - lattice.origin_mm) / lattice.cell_mm;
    low_ = LatticePoint(glm::floor(glm::min(p_[0], glm::min(p_[1], p_[2])) - slack));
    high_ = LatticePoint(glm::floor(glm::max(p_[0], glm::max(p_[1], p_[2])) + slack));
    normal_ = glm::cross(p_[1] - p_[0], p_[2] - p_[0]);
    const glm::dvec3 size = glm::abs(normal_);
    reach_ = 0.5 * (size.x + size.y + size.z) * (1.0 + slack);
    steep_ = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
  }

  /// Calls visit(cell) for each cell near the triangle; may include more cells, never fewer. Cost:
  /// proportional to the triangle's area and length in cells.
  template <typename Visit>
  void each_cell(const Visit& visit) const {
    // Iterates over columns along the steepest axis, in which the triangle passes only a few cells.
    const int u = (steep_ + 1) % 3, v = (steep_ + 2) % 3;
    LatticePoint cell{0};
    for (cell[v] = low_[v]; cell[v] <= high_[v]; ++cell[v]) {
      const auto [from, to] = row(u, v, cell[v]);
      for (cell[u] = from; cell[u] <= to; ++cell[u]) {
        const auto [first, last] = column(cell);
        for (cell[steep_] = first; cell[steep_] <= last; ++cell[steep_])
          if (std::abs(glm::dot(normal_, glm::dvec3(cell) + 0.5 - p_[0])) <= reach_) visit(cell);
      }
    }
  }

  /// A lower bound on the number of columns that each_cell() visits.
  double least_cells() const { return 0.5 * std::abs(normal_[steep_]); }

 private:
  static constexpr double slack = 1e-6;

  /// The range of cells along `u` in which the triangle's projection meets the row v .. v + 1.
  std::pair<int, int> row(int u, int v, int at) const {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const double low = at - slack, high = at + 1 + slack;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &a = p_[k], &b = p_[(k + 1) % 3];
      // The part of the side within the row.
      const double along = b[v] - a[v];
      double begin = 0.0, end = 1.0;
      if (along == 0.0) {
        if (a[v] < low || a[v] > high) continue;
      } else {
        const auto [near, far] = std::minmax({(low - a[v]) / along, (high - a[v]) / along});
        begin = std::max(begin, near);
        end = std::min(end, far);
        if (begin > end) continue;
      }
      for (const double share : {begin, end}) {
        const double place = a[u] + share * (b[u] - a[u]);
        least = std::min(least, place);
        most = std::max(most, place);
      }
    }
    if (least > most) return {0, -1};
    const double rounding = slack * (1.0 + std::abs(least) + std::abs(most));
    return {std::max(low_[u], static_cast<int>(std::floor(least - rounding))),
            std::min(high_[u], static_cast<int>(std::floor(most + rounding)))};
  }

  /// The range of cells of a column near the plane, plus one at each end for rounding.
  std::pair<int, int> column(LatticePoint cell) const {
    if (normal_[steep_] == 0.0) return {low_[steep_], high_[steep_]};
    cell[steep_] = 0;
    const double middle = -glm::dot(normal_, glm::dvec3(cell) + 0.5 - p_[0]) / normal_[steep_];
    const double half = reach_ / std::abs(normal_[steep_]) + 1.0;
    return {static_cast<int>(std::max<double>(low_[steep_], std::ceil(middle - half))),
            static_cast<int>(std::min<double>(high_[steep_], std::floor(middle + half)))};
  }

  std::array<glm::dvec3, 3> p_;
  LatticePoint low_{0}, high_{0};
  glm::dvec3 normal_{0.0};
  double reach_ = 0.0;
  int steep_ = 0;
};

std::vector<Passage> passages_of(const Triangles& surface, const Lattice& lattice) {
  const std::size_t count = surface.faces.size();
  std::vector<std::size_t> begin(count + 1, 0);
  const auto each_face = [&](const auto& visit) {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(count), 1024),
                      [&](const auto& range) {
                        for (std::uint32_t f = range.begin(); f != range.end(); ++f) visit(f);
                      });
  };
  constexpr std::size_t most_passages = 8 * most_cells;
  std::atomic<std::size_t> sum = 0;
  each_face([&](std::uint32_t f) {
    const Crossed crossed(surface, f, lattice);
    // Counting stops once there are too many.
    std::size_t cells = 0;
    if (sum > most_passages || crossed.least_cells() > static_cast<double>(most_passages))
      cells = most_passages + 1;
    else
      crossed.each_cell([&](const LatticePoint&) { ++cells; });
    begin[f + 1] = cells;
    sum += cells;
  });
  if (sum > most_passages)
    throw Error(ErrorCode::Geometry, "cells of " + short_text(lattice.cell_mm) +
                                         " mm are too many along the surface: take larger ones, --cell");
  for (std::size_t f = 0; f < count; ++f) begin[f + 1] += begin[f];
  std::vector<Passage> passages(begin.back());
  each_face([&](std::uint32_t f) {
    std::size_t at = begin[f];
    Crossed(surface, f, lattice).each_cell([&](const LatticePoint& cell) {
      passages[at++] = {key_of(cell), f};
    });
  });
  tbb::parallel_sort(passages.begin(), passages.end());
  return passages;
}

/// Adds the keys that are new to `list`; both lists ascend. Returns the new keys, ascending.
std::vector<std::uint64_t> add_new(const std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& list) {
  std::vector<std::uint64_t> fresh, all;
  std::set_difference(keys.begin(), keys.end(), list.begin(), list.end(), std::back_inserter(fresh));
  all.reserve(list.size() + fresh.size());
  std::merge(list.begin(), list.end(), fresh.begin(), fresh.end(), std::back_inserter(all));
  list = std::move(all);
  return fresh;
}

/// 1/2 minus the winding number at lattice points: negative inside.
class Field {
 public:
  Field(const Triangles& surface, const Lattice& lattice) : tree_(surface), lattice_(lattice) {}

  std::vector<double> at(const std::vector<glm::dvec3>& points_mm) const {
    std::vector<double> values = tree_.at(points_mm);
    for (double& value : values) value = 0.5 - value;
    return values;
  }

  void learn(const std::vector<std::uint64_t>& cells) {
    const std::vector<std::uint64_t> fresh = add_new(points_about(cells, 1), keys_);
    std::vector<glm::dvec3> points_mm(fresh.size());
    for (std::size_t i = 0; i < fresh.size(); ++i) points_mm[i] = lattice_.at(place_of(fresh[i]));
    std::vector<double> found = at(points_mm), all(keys_.size());
    // Border points of the lattice always count as outside.
    for (std::size_t i = 0; i < fresh.size(); ++i)
      if (lattice_.is_border(place_of(fresh[i]))) found[i] = std::max(found[i], 0.5);
    for (std::size_t i = 0, old = 0, now = 0; i < all.size(); ++i)
      all[i] = now < fresh.size() && keys_[i] == fresh[now] ? found[now++] : values_[old++];
    values_ = std::move(all);
  }

  double at(const LatticePoint& p) const {
    const auto found = std::lower_bound(keys_.begin(), keys_.end(), key_of(p));
    assert(found != keys_.end() && *found == key_of(p));
    return values_[static_cast<std::size_t>(found - keys_.begin())];
  }

  std::array<double, 8> about(const LatticePoint& cell) const {
    std::array<double, 8> values{};
    for (int k = 0; k < 8; ++k) values[static_cast<std::size_t>(k)] = at(cell + corner_place(k));
    return values;
  }

  std::size_t size() const { return keys_.size(); }

 private:
  WindingTree tree_;
  const Lattice& lattice_;
  std::vector<std::uint64_t> keys_;  // ascending
  std::vector<double> values_;
};

/// Adds the cells beyond those sides of a cell that the surface passes.
void add_neighbours(const LatticePoint& cell, const std::array<double, 8>& values, const Lattice& lattice,
                    std::vector<std::uint64_t>& cells) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, 1}) {
      int inside = 0;
      for (int k = 0; k < 8; ++k)
        if ((k >> axis & 1) == end) inside += values[static_cast<std::size_t>(k)] < 0.0;
      if (inside == 0 || inside == 4) continue;
      LatticePoint beyond = cell;
      beyond[axis] += end == 1 ? 1 : -1;
      if (lattice.has_cell(beyond)) cells.push_back(key_of(beyond));
    }
}

/// Every cell that the surface passes, and some others, ascending.
std::vector<std::uint64_t> cells_of(const std::vector<Passage>& passages, const Lattice& lattice,
                                    Field& field, const Progress& progress) {
  std::vector<std::uint64_t> cells, fresh;
  for (const Passage& passage : passages)
    if (fresh.empty() || fresh.back() != passage.cell) fresh.push_back(passage.cell);
  cells = fresh;
  while (!fresh.empty()) {
    progress.at(0.2);
    const bool may_learn = cells.size() <= most_cells;
    if (may_learn) field.learn(fresh);
    if (!may_learn || field.size() > 2 * most_cells)
      throw Error(ErrorCode::Geometry, "the surface passes more than 2^24 cells of " +
                                           short_text(lattice.cell_mm) + " mm: take larger ones, --cell");
    std::vector<std::uint64_t> beyond =
        appended<std::uint64_t>(fresh, [&](std::uint64_t key, std::vector<std::uint64_t>& found) {
          const LatticePoint cell = place_of(key);
          add_neighbours(cell, field.about(cell), lattice, found);
        });
    tbb::parallel_sort(beyond.begin(), beyond.end());
    beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
    fresh = add_new(beyond, cells);
  }
  return cells;
}

/// The position at which a segment from a to b crosses a triangle, as a share of its length.
std::optional<double> crossing(const glm::dvec3& a, const glm::dvec3& b, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 along = b - a, u = t[1] - t[0], v = t[2] - t[0], h = glm::cross(along, v);
  const double det = glm::dot(u, h);
  if (det == 0.0) return std::nullopt;
  const glm::dvec3 from = a - t[0], q = glm::cross(from, u);
  const double s = glm::dot(from, h) / det, r = glm::dot(along, q) / det, share = glm::dot(v, q) / det;
  constexpr double slack = 1e-9;
  if (s < -slack || r < -slack || s + r > 1.0 + slack || share < 0.0 || share > 1.0) return std::nullopt;
  return share;
}

/// The points on the edges, and the number of edges that no triangle crosses.
struct EdgePoints {
  std::vector<glm::dvec3> points_mm;
  std::size_t across_holes = 0;
};

EdgePoints points_on(const std::vector<LatticeEdge>& edges, const std::vector<Passage>& passages,
                     const Triangles& surface, const Lattice& lattice, const Field& field) {
  // Edges run from inside to outside; the crossing nearest to the outside end is on the surface.
  std::vector<double> share(edges.size(), -1.0), at_from(edges.size()), at_to(edges.size());
  const auto ends = [&](std::size_t i) {
    const LatticePoint from = place_of(edges[i].from());
    return std::pair(from, from + corner_place(edges[i].along()));
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, edges.size(), 512), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto [from, to] = ends(i);
      at_from[i] = field.at(from);
      at_to[i] = field.at(to);
      const glm::dvec3 a = lattice.at(from), b = lattice.at(to);
      auto passage = std::lower_bound(passages.begin(), passages.end(), Passage{edges[i].from(), 0});
      for (; passage != passages.end() && passage->cell == edges[i].from(); ++passage) {
        const auto& face = surface.faces[passage->face];
        const std::optional<double> found = crossing(
            a, b, {surface.points_mm[face[0]], surface.points_mm[face[1]], surface.points_mm[face[2]]});
        if (!found) continue;
        if (share[i] < 0.0 || (at_from[i] < 0.0 ? *found > share[i] : *found < share[i])) share[i] = *found;
      }
    }
  });
  // Bisects across holes: the winding number is smooth there but steep near the rims.
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (share[i] < 0.0) open.push_back(i);
  std::vector<double> low(open.size(), 0.0), high(open.size(), 1.0);
  for (int round = 0; round < 10 && !open.empty(); ++round) {
    std::vector<glm::dvec3> tried_mm(open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
      const auto [from, to] = ends(open[k]);
      tried_mm[k] = glm::mix(lattice.at(from), lattice.at(to), 0.5 * (low[k] + high[k]));
    }
    const std::vector<double> values = field.at(tried_mm);
    for (std::size_t k = 0; k < open.size(); ++k)
      ((values[k] < 0.0) == (at_from[open[k]] < 0.0) ? low[k] : high[k]) = 0.5 * (low[k] + high[k]);
  }
  for (std::size_t k = 0; k < open.size(); ++k) share[open[k]] = 0.5 * (low[k] + high[k]);
  EdgePoints found;
  found.across_holes = open.size();
  found.points_mm.resize(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [from, to] = ends(i);
    assert((at_from[i] < 0.0) != (at_to[i] < 0.0));
    found.points_mm[i] =
        glm::mix(lattice.at(from), lattice.at(to), std::clamp(share[i], nearest_end, 1.0 - nearest_end));
  }
  return found;
}

/// Leaves out shells that face inward and those within others; returns how many.
std::size_t keep_hull(Triangles& surface) {
  DisjointSets sets(surface.points_mm.size());
  for (const auto& face : surface.faces) {
    sets.join(face[0], face[1]);
    sets.join(face[1], face[2]);
  }
  std::map<std::uint32_t, double> volumes;
  for (const auto& face : surface.faces) {
    const std::uint32_t shell = sets.set_of(face[0]);
    const glm::dvec3 tip = surface.points_mm[shell];
    volumes[shell] +=
        glm::dot(surface.points_mm[face[0]] - tip,
                 glm::cross(surface.points_mm[face[1]] - tip, surface.points_mm[face[2]] - tip));
  }
  const SurfaceTree tree(surface);
  std::map<std::uint32_t, bool> stays;
  for (const auto& [shell, volume] : volumes) {
    // The parity of crossings from one point of a shell shows which other shells contain the shell. Outermost
    // shells lie in no other.
    std::map<std::uint32_t, int> about;
    for (const Crossing& crossed : tree.crossings(surface.points_mm[shell])) {
      const std::uint32_t other = sets.set_of(surface.faces[crossed.face][0]);
      if (other != shell && volumes.at(other) > 0.0) about[other] ^= 1;
    }
    stays[shell] = volume > 0.0 &&
                   std::none_of(about.begin(), about.end(), [](const auto& one) { return one.second == 1; });
  }
  Triangles hull;
  std::vector<std::uint32_t> number(surface.points_mm.size(), 0);
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    const auto known = stays.find(sets.set_of(v));
    if (known == stays.end() || !known->second) continue;
    number[v] = static_cast<std::uint32_t>(hull.points_mm.size());
    hull.points_mm.push_back(surface.points_mm[v]);
  }
  for (const auto& face : surface.faces)
    if (stays.at(sets.set_of(face[0])))
      hull.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  surface = std::move(hull);
  return static_cast<std::size_t>(
      std::count_if(stays.begin(), stays.end(), [](const auto& shell) { return !shell.second; }));
}

}  // namespace

Enclosed enclose(const Triangles& given, const EncloseOptions& options) {
  const Triangles surface = sound_triangles(given);
  const Lattice lattice = lattice_about(surface, options);
  const std::vector<Passage> passages = passages_of(surface, lattice);
  options.progress.at(0.1);
  Field field(surface, lattice);
  const std::vector<std::uint64_t> cells = cells_of(passages, lattice, field, options.progress);
  options.progress.at(0.6);
  const auto triangles =
      appended<EdgeTriangle>(cells, [&](std::uint64_t key, std::vector<EdgeTriangle>& made) {
        const LatticePoint cell = place_of(key);
        add_triangles(cell, field.about(cell), made);
      });
  if (triangles.empty())
    throw Error(ErrorCode::Geometry,
                "the triangles enclose nothing that is resolved by cells of " + short_text(lattice.cell_mm) +
                    " mm: the surface is a sheet, inside out, or thinner; orient it, or use smaller cells");
  const std::vector<LatticeEdge> edges = edges_of(triangles);
  EdgePoints points = points_on(edges, passages, surface, lattice, field);
  options.progress.at(0.9);
  Enclosed made;
  made.cell_mm = lattice.cell_mm;
  made.points_across_holes = points.across_holes;
  Triangles result{std::move(points.points_mm), numbered(triangles, edges)};
  if (options.hull) made.cavities_filled = keep_hull(result);
  options.progress.at(1.0);
  made.solid = trusted_solid(std::move(result), Proof::Construction);
  return made;
}

}  // namespace octotomy::brep
