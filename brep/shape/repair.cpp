// SPDX-License-Identifier: AGPL-3.0-or-later
// Each step works on a list of triangles with their numbers in the input, by which changes name them. Steps
// that need a connected mesh report it if the list does not form one.
#include "brep/shape/repair.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/health.h"
#include "brep/mesh/line_volume.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/sides.h"
#include "brep/mesh/split_fans.h"
#include "brep/mesh/triangle_places.h"
#include "brep/shape/decimate.h"
#include "brep/shape/enclose.h"
#include "brep/shape/fill_holes.h"
#include "brep/shape/offset.h"
#include "brep/shape/unite_shells.h"
#include "brep/shape/untangle.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t is_new = std::numeric_limits<std::uint32_t>::max();
using Face = std::array<std::uint32_t, 3>;

/// A closed shell counts as empty if its volume is below this share of its area to the power of 1.5: a plate
/// of 100 mm would be 30 nm thick, below the resolution of files with single precision.
constexpr double film_share() {
  return 1e-8;
}

/// If a solid is requested and merging equal points leaves the surface open, points within this share of the
/// extent are merged: sixteen times the rounding error of single precision.
constexpr double weld_share() {
  return 0x1p-20;
}

/// Whether the mesh has the reversed triangle, and no other neighbours of it.
bool is_lone(const Face& face, const Mesh& mesh) {
  const auto side = mesh.find_halfedge(Mesh::VertexHandle(static_cast<int>(face[1])),
                                       Mesh::VertexHandle(static_cast<int>(face[0])));
  if (!side.is_valid() || mesh.is_boundary(side)) return false;
  const auto next = mesh.next_halfedge_handle(side), last = mesh.prev_halfedge_handle(side);
  const auto is_border = [&](Mesh::HalfedgeHandle h) {
    return mesh.is_boundary(mesh.opposite_halfedge_handle(h));
  };
  return is_border(side) && is_border(next) && is_border(last);
}

/// A reconstructed surface without the slivers and surplus triangles of the lattice; unchanged if it is large
/// or if collapses would make it intersect itself.
Triangles thinned(const Enclosed& made) {
  constexpr std::size_t most_thinned = 300'000;
  if (made.solid.triangles().faces.size() > most_thinned) return made.solid.triangles();
  DecimateOptions options;
  options.max_error_mm = made.cell_mm / 20.0;
  try {
    return triangles_of(decimate(made.solid, options));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Geometry) throw;
    return made.solid.triangles();
  }
}

class Mender {
 public:
  explicit Mender(const Triangles& surface) : origin_(surface.faces.size()) {
    repair_.surface = surface;
    std::iota(origin_.begin(), origin_.end(), 0u);
  }

  void weld(double distance_mm) {
    auto& points = repair_.surface.points_mm;
    DisjointSets sets(points.size());
    if (distance_mm > 0.0) {
      join_near(points, distance_mm, sets);
    } else {
      const std::vector<std::uint32_t> first = first_equal_points(points);
      for (std::uint32_t v = 0; v < first.size(); ++v) sets.join(first[v], v);
    }
    std::vector<std::uint8_t> used(points.size(), 0);
    for (const Face& face : repair_.surface.faces)
      for (const std::uint32_t v : face) used[v] = 1;
    for (std::uint32_t v = 0; v < points.size(); ++v)
      if (used[v] && sets.set_of(v) != v)
        change("weld",
               "point " + std::to_string(v) + " became point " + std::to_string(sets.set_of(v)) + ", " +
                   short_text(glm::distance(points[v], points[sets.set_of(v)])) + " mm away",
               points[v]);
    for (Face& face : repair_.surface.faces)
      for (std::uint32_t& v : face) v = sets.set_of(v);
  }

  void remove_repeats() {
    keep_if([&](std::size_t f) {
      const Face& face = repair_.surface.faces[f];
      if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) return true;
      change("flat", "triangle " + name(f) + " repeats a point: taken out", centre(f));
      return false;
    });
  }

  void flip_flat() {
    if (!has_flat_triangles(repair_.surface)) return;
    with_mesh("flat", [&](Mesh& mesh) {
      const FlatTriangles done = take_out_flat_triangles(mesh);
      replace(triangles_of(mesh), "flat", "cut along another diagonal, or taken out, about one without area");
      if (done.left > 0) left("flat", std::to_string(done.left) + " triangles without area stay", {});
    });
  }

  void remove_duplicates() {
    std::vector<std::pair<Face, std::uint32_t>> keys;
    for (std::uint32_t f = 0; f < repair_.surface.faces.size(); ++f) {
      keys.emplace_back(repair_.surface.faces[f], f);
      std::sort(keys.back().first.begin(), keys.back().first.end());
    }
    tbb::parallel_sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> first(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i)
      first[keys[i].second] =
          i > 0 && keys[i].first == keys[i - 1].first ? first[keys[i - 1].second] : keys[i].second;
    keep_if([&](std::size_t f) {
      if (first[f] == f) return true;
      change("duplicates",
             "triangle " + name(f) + " has the points of triangle " + name(first[f]) + ": taken out",
             centre(f));
      return false;
    });
  }

  /// How closed shells within others are oriented. Alternating: inward within an odd number of them,
  /// otherwise outward. AsGiven: a shell with consistent winding in the input keeps it. An outward shell is a
  /// body to unite; an inward shell is a cavity, if the shells around it form a body there.
  enum class Nested { Alternating, AsGiven };

  /// Orients triangles; returns whether any was reversed.
  bool orient(Nested nested = Nested::Alternating) {
    std::vector<std::uint8_t> turned(repair_.surface.faces.size(), 0);
    const Across across = across_of(repair_.surface);
    const std::vector<std::uint32_t> shell = wind_alike(across, turned);
    place_shells(across, shell, nested, turned);
    bool any = false;
    for (std::size_t f = 0; f < turned.size(); ++f) {
      if (!turned[f]) continue;
      change("orient", "triangle " + name(f) + " turned round", centre(f));
      std::swap(repair_.surface.faces[f][1], repair_.surface.faces[f][2]);
      any = true;
    }
    return any;
  }

  void remove_not_finite() {
    const auto& points = repair_.surface.points_mm;
    keep_if([&](std::size_t f) {
      const Face& face = repair_.surface.faces[f];
      if (std::all_of(face.begin(), face.end(),
                      [&](std::uint32_t v) { return std::isfinite(glm::dot(points[v], glm::dvec3(1.0))); }))
        return true;
      change("flat", "triangle " + name(f) + " has a point that is not finite: taken out", {});
      return false;
    });
    for (glm::dvec3& p : repair_.surface.points_mm)
      if (!std::isfinite(glm::dot(p, glm::dvec3(1.0)))) p = glm::dvec3(0.0);
  }

  /// Splits fans so that mesh_of() accepts the surface.
  void split() {
    SplitFans done = split_fans(repair_.surface);
    for (const std::uint32_t f : done.left_out)
      change("flat", "triangle " + name(f) + " repeats a point: taken out", centre(f));
    for (const SplitEdge& edge : done.edges) change("fans", to_string(edge), edge.at_mm);
    std::map<std::uint32_t, std::size_t> copies;
    for (std::size_t v = repair_.surface.points_mm.size(); v < done.origin.size(); ++v)
      ++copies[done.origin[v]];
    for (const auto& [v, count] : copies)
      change("fans",
             std::to_string(count + 1) + " fans of triangles met at point " + std::to_string(v) +
                 ": each further one got a copy of it",
             repair_.surface.points_mm[v]);
    std::vector<std::uint32_t> origin;
    for (const std::uint32_t f : done.face_origin) origin.push_back(origin_[f]);
    origin_ = std::move(origin);
    repair_.surface = std::move(done.surface);
  }

  /// Replaces the shells by their union; false if Booleans find none.
  bool unite(const std::stop_token& stop) {
    split();
    std::optional<UnitedShells> united = united_shells(repair_.surface, stop);
    if (!united || !health(united->surface).solid()) return false;
    replace(std::move(united->surface), "solid", "cut or taken out, as closed shells were united");
    change("solid", std::to_string(united->bodies) + " closed shells were united by a Boolean", {});
    for (const std::string& finding : united->findings) change("solid", "of the union: " + finding, {});
    return true;
  }

  void enclose(const RepairOptions& options) {
    const Enclosed made = brep::enclose(repair_.surface, {options.cell_mm, options.hull, options.progress});
    repair_.surface = thinned(made);
    origin_.assign(repair_.surface.faces.size(), is_new);
    repair_.enclosed_cell_mm = made.cell_mm;
    repair_.left.clear();
    change(
        "solid",
        "made anew of " + std::to_string(repair_.surface.faces.size()) +
            " triangles around the region that the surface encloses, in cells of " +
            short_text(made.cell_mm) + " mm; " + std::to_string(made.points_across_holes) +
            " points lie across holes" +
            (made.cavities_filled > 0 ? ", " + std::to_string(made.cavities_filled) + " shells within filled"
                                      : ""),
        {});
  }

  /// Takes a solid made anew in cells of that size.
  void replace(const Solid& solid, double cell_mm, const std::string& what) {
    repair_.surface = solid.triangles();
    origin_.assign(repair_.surface.faces.size(), is_new);
    repair_.enclosed_cell_mm = cell_mm;
    repair_.left.clear();
    change("solid", what, {});
  }

  const Triangles& surface() const { return repair_.surface; }
  /// The lattice's where the surface was made anew.
  const std::optional<double>& cell_mm() const { return repair_.enclosed_cell_mm; }
  /// Whether a side of a triangle is not shared by just one other.
  bool is_open() const {
    const Across across = across_of(repair_.surface);
    return std::find(across.face.begin(), across.face.end(), is_new) != across.face.end();
  }
  double extent_mm() const {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const Face& face : repair_.surface.faces)
      for (const std::uint32_t v : face) {
        low = glm::min(low, repair_.surface.points_mm[v]);
        high = glm::max(high, repair_.surface.points_mm[v]);
      }
    const glm::dvec3 extent = high - low;
    return repair_.surface.faces.empty() ? 0.0 : std::max({extent.x, extent.y, extent.z});
  }

  void fill_holes(const std::optional<double>& longest_mm) {
    if (!is_open()) return;
    with_mesh("holes", [&](Mesh& mesh) {
      repair_.surface = triangles_of(mesh);
      for (const Hole& hole : holes(mesh, longest_mm)) {
        const std::string what = "a hole of " + std::to_string(hole.border.size()) + " sides, " +
                                 short_text(hole.perimeter_mm) + " mm round";
        if (hole.faces.empty()) {
          left("holes", what + ", stays", hole.centre_mm);
          continue;
        }
        if (hole.faces.size() == 1 && is_lone(hole.faces[0], mesh)) {
          left("holes", "a triangle without neighbours stays", hole.centre_mm);
          continue;
        }
        change("holes", what + ", closed by " + std::to_string(hole.faces.size()) + " triangles",
               hole.centre_mm);
        repair_.surface.faces.insert(repair_.surface.faces.end(), hole.faces.begin(), hole.faces.end());
        origin_.insert(origin_.end(), hole.faces.size(), is_new);
      }
    });
  }

  /// Removes triangles without neighbours, and closed shells without content: two coincident sheets.
  void remove_films() {
    const Across across = across_of(repair_.surface);
    std::vector<std::uint8_t> turned(repair_.surface.faces.size(), 0);
    const std::vector<std::uint32_t> shell = wind_alike(across, turned);
    const std::map<std::uint32_t, Shell> shells = shells_of(repair_.surface, across, shell, turned);
    keep_if([&](std::size_t f) {
      const Shell& own = shells.at(shell[f]);
      const bool is_film =
          own.is_closed && std::abs(own.volume_mm3) <= film_share() * std::pow(own.area_mm2, 1.5);
      if (!is_film && own.faces.size() > 1) return true;
      change("films",
             "triangle " + name(f) + (is_film ? " of a shell that encloses nothing" : " without neighbours") +
                 ": taken out",
             centre(f));
      return false;
    });
  }

  void remove_intersections() {
    with_mesh("intersections", [&](Mesh& mesh) {
      Untangled done = untangle(mesh);
      if (!done.is_done) left("intersections", "triangles still intersect", {});
      if (done.removed.empty() && done.added == 0) return;
      replace(std::move(done.surface), "intersections", "replaced about an intersection");
    });
  }

  Repair result() {
    drop_unused_points();
    return std::move(repair_);
  }

 private:
  std::string name(std::size_t f) const {
    assert(f < origin_.size());
    return origin_[f] == is_new ? "of a closed hole" : std::to_string(origin_[f]);
  }
  glm::dvec3 centre(std::size_t f) const {
    assert(f < repair_.surface.faces.size());
    const Face& face = repair_.surface.faces[f];
    const auto& points = repair_.surface.points_mm;
    return (points[face[0]] + points[face[1]] + points[face[2]]) / 3.0;
  }
  void change(const char* step, std::string what, const glm::dvec3& at) {
    repair_.changes.push_back({step, std::move(what), at});
  }
  void left(const char* step, std::string what, const glm::dvec3& at) {
    const auto same = [&](const Change& known) { return known.step == step && known.what == what; };
    if (std::none_of(repair_.left.begin(), repair_.left.end(), same))
      repair_.left.push_back({step, std::move(what), at});
  }

  /// Compares only points in neighbouring cells of a lattice whose cells are as wide as the distance.
  static void join_near(const std::vector<glm::dvec3>& points, double distance_mm, DisjointSets& sets) {
    using Cell = std::array<double, 3>;
    std::map<Cell, std::vector<std::uint32_t>> cells;
    const auto cell_of = [&](const glm::dvec3& p) {
      const glm::dvec3 c = glm::floor(p / distance_mm);
      return Cell{c.x, c.y, c.z};
    };
    for (std::uint32_t v = 0; v < points.size(); ++v) cells[cell_of(points[v])].push_back(v);
    for (const auto& [cell, members] : cells)
      for (double x = -1.0; x <= 1.0; ++x)
        for (double y = -1.0; y <= 1.0; ++y)
          for (double z = -1.0; z <= 1.0; ++z) {
            const auto other = cells.find({cell[0] + x, cell[1] + y, cell[2] + z});
            if (other == cells.end() || other->first < cell) continue;
            for (const std::uint32_t v : members)
              for (const std::uint32_t w : other->second)
                if (glm::distance(points[v], points[w]) <= distance_mm) sets.join(v, w);
          }
  }

  template <typename Keep>
  void keep_if(const Keep& keep) {
    std::vector<std::uint8_t> kept;
    for (std::size_t f = 0; f < repair_.surface.faces.size(); ++f) kept.push_back(keep(f));
    std::size_t count = 0;
    for (std::size_t f = 0; f < kept.size(); ++f) {
      if (!kept[f]) continue;
      repair_.surface.faces[count] = repair_.surface.faces[f];
      origin_[count++] = origin_[f];
    }
    assert(origin_.size() == kept.size());
    repair_.surface.faces.resize(count);
    origin_.resize(count);
  }

  /// The neighbour at side k of triangle f, at index 3 f + k, if there is exactly one; otherwise `is_new`.
  struct Across {
    std::vector<std::uint32_t> face;
    std::vector<std::uint8_t> same_way;  ///< the neighbour runs along the side in the same direction
  };
  static Across across_of(const Triangles& surface) {
    Across across{std::vector<std::uint32_t>(3 * surface.faces.size(), is_new),
                  std::vector<std::uint8_t>(3 * surface.faces.size(), 0)};
    each_edge(sorted_sides(surface), [&](const Side* begin, const Side* end) {
      if (end - begin != 2) return;
      const std::uint32_t c = begin[0].corner, d = begin[1].corner;
      across.face[c] = d / 3;
      across.face[d] = c / 3;
      across.same_way[c] = across.same_way[d] = begin[0].upward == begin[1].upward;
    });
    return across;
  }

  /// Floods across edges of two triangles. Returns the shell of each triangle and marks in `turned` the
  /// triangles to reverse.
  std::vector<std::uint32_t> wind_alike(const Across& across, std::vector<std::uint8_t>& turned) {
    std::vector<std::uint32_t> shell(turned.size(), is_new), flood;
    std::size_t twisted = 0;
    for (std::uint32_t seed = 0; seed < turned.size(); ++seed) {
      if (shell[seed] != is_new) continue;
      shell[seed] = seed;
      flood.assign(1, seed);
      while (!flood.empty()) {
        const std::uint32_t f = flood.back();
        flood.pop_back();
        for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c) {
          const std::uint32_t other = across.face[c];
          if (other == is_new) continue;
          const std::uint8_t wanted = (across.same_way[c] != 0) != (turned[f] != 0);
          if (shell[other] == is_new) {
            shell[other] = seed;
            turned[other] = wanted;
            flood.push_back(other);
          } else if (turned[other] != wanted) {
            ++twisted;
          }
        }
      }
    }
    if (twisted > 0)
      left("orient",
           std::to_string(twisted / 2) +
               " edges of a shell that is twisted like a Moebius strip: their triangles wind against each "
               "other",
           {});
    return shell;
  }

  struct Shell {
    std::vector<std::uint32_t> faces;
    std::size_t turns = 0;
    double volume_mm3 = 0.0, area_mm2 = 0.0;
    bool is_closed = true;
    /// Its furthest points in both directions along each axis, without points that other shells share.
    std::array<std::optional<std::uint32_t>, 6> probes;
  };

  /// The shells, consistently wound, by their first triangle.
  static std::map<std::uint32_t, Shell> shells_of(const Triangles& wound, const Across& across,
                                                  const std::vector<std::uint32_t>& shell,
                                                  const std::vector<std::uint8_t>& turned) {
    std::map<std::uint32_t, Shell> shells;
    // For each position, the shell with corners there, or `several`.
    const std::vector<std::uint32_t> place = first_equal_points(wound.points_mm);
    constexpr std::uint32_t several = is_new - 1;
    std::vector<std::uint32_t> owner(wound.points_mm.size(), is_new);
    for (std::uint32_t f = 0; f < shell.size(); ++f)
      for (const std::uint32_t v : wound.faces[f]) {
        std::uint32_t& own = owner[place[v]];
        own = own == is_new || own == shell[f] ? shell[f] : several;
      }
    for (std::uint32_t f = 0; f < shell.size(); ++f) {
      Shell& own = shells[shell[f]];
      const Face& face = wound.faces[f];
      // Sums relative to the shell's first point, which preserves digits far from the origin.
      const glm::dvec3 tip = wound.points_mm[wound.faces[shell[f]][0]];
      const glm::dvec3 p = wound.points_mm[face[0]] - tip, q = wound.points_mm[face[1]] - tip,
                       r = wound.points_mm[face[2]] - tip;
      own.volume_mm3 += glm::dot(p, glm::cross(q, r)) / 6.0;
      own.area_mm2 += 0.5 * glm::length(glm::cross(q - p, r - p));
      own.turns += turned[f];
      own.faces.push_back(f);
      for (std::size_t k = 0; k < 3; ++k) {
        own.is_closed &= across.face[3 * f + k] != is_new;
        const std::uint32_t v = face[k];
        if (owner[place[v]] != shell[f]) continue;
        for (std::size_t way = 0; way < 6; ++way) {
          const auto along = [&](std::uint32_t w) {
            return (way < 3 ? 1.0 : -1.0) * wound.points_mm[w][static_cast<int>(way % 3)];
          };
          if (!own.probes[way] || along(v) > along(*own.probes[way])) own.probes[way] = v;
        }
      }
    }
    return shells;
  }

  /// The other closed shells that contain all of a shell's probes, by their first triangles. Shells that
  /// cross it do not contain all.
  static std::vector<std::uint32_t> shells_around(std::uint32_t first, const Shell& own,
                                                  const std::map<std::uint32_t, Shell>& shells,
                                                  const std::vector<std::uint32_t>& shell,
                                                  const Triangles& wound, const SurfaceTree& tree) {
    std::map<std::uint32_t, std::size_t> containing;
    std::size_t probes = 0;
    for (const auto& probe : own.probes) {
      if (!probe) continue;
      ++probes;
      std::map<std::uint32_t, bool> within;
      for (const Crossing& crossing : tree.crossings(wound.points_mm[*probe]))
        if (shell[crossing.face] != first) within[shell[crossing.face]] ^= true;
      for (const auto& [other, is_within] : within) containing[other] += is_within;
    }
    std::vector<std::uint32_t> around;
    for (const auto& [other, count] : containing)
      if (count == probes && probes > 0 && shells.at(other).is_closed) around.push_back(other);
    return around;
  }

  /// Orients closed shells outward or inward by `nested`, and open shells so that fewer of their triangles
  /// are reversed.
  void place_shells(const Across& across, const std::vector<std::uint32_t>& shell, Nested nested,
                    std::vector<std::uint8_t>& turned) {
    assert(turned.size() == repair_.surface.faces.size() && shell.size() == turned.size());
    Triangles wound = repair_.surface;
    for (std::size_t f = 0; f < turned.size(); ++f)
      if (turned[f]) std::swap(wound.faces[f][1], wound.faces[f][2]);
    const std::map<std::uint32_t, Shell> shells = shells_of(wound, across, shell, turned);
    const SurfaceTree tree(wound);
    std::map<std::uint32_t, std::vector<std::uint32_t>> around;
    for (const auto& [first, own] : shells)
      if (own.is_closed) around[first] = shells_around(first, own, shells, shell, wound, tree);
    // If an outermost shell was inward or inconsistent in the input, the orientation of shells carries no
    // information.
    const bool ways_hold =
        nested == Nested::AsGiven && std::all_of(around.begin(), around.end(), [&](const auto& place) {
          const Shell& own = shells.at(place.first);
          return !place.second.empty() || (own.turns == 0 && own.volume_mm3 > 0.0);
        });
    for (const auto& [first, own] : shells) {
      bool wrong = 2 * own.turns > own.faces.size();
      if (own.is_closed) {
        const std::vector<std::uint32_t>& others = around.at(first);
        wrong = (own.volume_mm3 < 0.0) != (others.size() % 2 == 1);
        int winding = 0;
        for (const std::uint32_t other : others) winding += shells.at(other).volume_mm3 > 0.0 ? 1 : -1;
        if (ways_hold && own.turns == 0 && !others.empty())
          wrong = own.volume_mm3 < 0.0 ? winding < 1 : winding < 0;
      }
      if (wrong)
        for (const std::uint32_t f : own.faces) turned[f] ^= 1u;
    }
  }

  template <typename Run>
  void with_mesh(const char* step, const Run& run) {
    split();
    if (repair_.surface.faces.empty())
      left(step, "not tried: no triangles are left", {});
    else if (Mesh mesh = mesh_of(repair_.surface); true)
      run(mesh);
  }

  /// Replaces the surface and lists the triangles that are no longer in it.
  void replace(Triangles other, const char* step, const std::string& how) {
    std::multimap<Places, std::size_t> before;
    for (std::size_t f = 0; f < repair_.surface.faces.size(); ++f)
      before.emplace(places_of(repair_.surface, repair_.surface.faces[f]), f);
    std::vector<std::uint32_t> origin;
    for (const Face& face : other.faces) {
      const auto known = before.find(places_of(other, face));
      origin.push_back(known == before.end() ? is_new : origin_[known->second]);
      if (known != before.end()) before.erase(known);
    }
    std::vector<std::size_t> gone;
    for (const auto& [places, f] : before) gone.push_back(f);
    std::sort(gone.begin(), gone.end());
    for (const std::size_t f : gone) change(step, "triangle " + name(f) + " " + how, centre(f));
    repair_.surface = std::move(other);
    origin_ = std::move(origin);
  }

  void drop_unused_points() {
    auto& surface = repair_.surface;
    std::vector<std::uint32_t> number(surface.points_mm.size(), is_new);
    std::vector<glm::dvec3> points;
    for (const Face& face : surface.faces)
      for (const std::uint32_t v : face) number[v] = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == is_new) continue;
      number[v] = static_cast<std::uint32_t>(points.size());
      points.push_back(surface.points_mm[v]);
    }
    for (Face& face : surface.faces)
      for (std::uint32_t& v : face) v = number[v];
    surface.points_mm = std::move(points);
  }

  Repair repair_;
  std::vector<std::uint32_t> origin_;
};

void check(const Triangles& surface, const RepairOptions& options) {
  if (options.weld_mm && !(*options.weld_mm >= 0.0 && std::isfinite(*options.weld_mm)))
    throw InvalidInput("repair: the distance to weld over must be 0 mm or more");
  if (options.longest_hole_mm && !(*options.longest_hole_mm > 0.0))
    throw InvalidInput("repair: the longest border of a hole must be above 0 mm");
  if (options.wall_mm && !(*options.wall_mm > 0.0)) throw InvalidInput("repair: a wall is thicker than 0 mm");
  if (!(options.max_volume_share > 0.0))
    throw InvalidInput("repair: the largest share of the volume must be above 0");
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (const std::uint32_t v : surface.faces[f])
      if (v >= surface.points_mm.size() ||
          (!options.solid && !std::isfinite(glm::dot(surface.points_mm[v], glm::dvec3(1.0)))))
        throw Error(ErrorCode::Input, "repair: triangle " + std::to_string(f) +
                                          " refers to no point, or to one that is not finite; a solid can be "
                                          "made without such triangles");
}

/// The volume inside, for comparison; lines through holes are left out.
double volume_inside_mm3(const Triangles& surface) {
  const LineVolumes volumes = line_volumes(surface, {});
  const auto closed = static_cast<double>(volumes.lines - volumes.open_lines);
  return closed > 0.0 ? volumes.all.a_mm3 * static_cast<double>(volumes.lines) / closed : 0.0;
}

bool is_within_share(double before_mm3, double now_mm3, const RepairOptions& options) {
  return std::abs(now_mm3 - before_mm3) <= options.max_volume_share * before_mm3;
}

[[noreturn]] void refuse_volume(double before_mm3, double now_mm3, const RepairOptions& options,
                                const char* step, const std::string& ways) {
  throw Error(ErrorCode::Geometry, std::string("repair: ") + step + " took the volume from " +
                                       short_text(before_mm3) + " to " + short_text(now_mm3) +
                                       " mm3, more than its share of " +
                                       short_text(options.max_volume_share) + ": " + ways);
}

void check_volume(double before_mm3, const Triangles& now, const RepairOptions& options, const char* step) {
  const double now_mm3 = volume_inside_mm3(now);
  if (!is_within_share(before_mm3, now_mm3, options))
    refuse_volume(before_mm3, now_mm3, options, step,
                  "take --solid instead, which unites closed shells and rebuilds other surfaces, or "
                  "accept the change by --max-volume-share " +
                      short_text(1.01 * std::abs(now_mm3 - before_mm3) / before_mm3));
}

/// An answer that was tried, if it has one.
std::optional<double> enclosed_mm3(const Triangles& surface, double cell_mm, bool hull,
                                   const Progress& progress) {
  try {
    return size_of(brep::enclose(surface, {cell_mm, hull, progress}).solid).volume_mm3;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Geometry) throw;
    return std::nullopt;
  }
}

/// Cells of a wall: half of it, so that none of it is missed.
double wall_cell_mm(double wall_mm, const RepairOptions& options) {
  return std::min(options.cell_mm.value_or(0.5 * wall_mm), 0.5 * wall_mm);
}

/// The surface as given made a wall, without triangles that have no place or repeat a point.
Solid wall_of(const Triangles& given, double wall_mm, const RepairOptions& options) {
  Mender finite(given);
  finite.remove_not_finite();
  finite.remove_repeats();
  if (finite.surface().faces.empty()) return {};
  return thickened(finite.surface(), {0.5 * wall_mm, wall_cell_mm(wall_mm, options), options.progress});
}

/// The wall that a sheet could be given: a 50th of its extent. Empty if that fails.
std::string wall_way(const Triangles& given, double extent_mm, const RepairOptions& options) {
  const std::string wall = short_text(0.02 * extent_mm);
  try {
    const Solid solid = wall_of(given, std::stod(wall), options);
    if (solid.empty()) return {};
    return "--wall " + wall + " makes the surface, where it is a sheet, a wall of " + wall + " mm, " +
           short_text(solid.measures().volume_mm3) + " mm3";
  } catch (const TooLarge&) {
    return {};
  }
}

/// What would be accepted in place of an enclosing that changed the volume by too much: smaller cells and the
/// hull are tried.
std::string ways_that_work(const Triangles& surface, const Triangles& given, double before_mm3,
                           double now_mm3, double cell_mm, const RepairOptions& options) {
  std::string ways;
  const auto add = [&](const std::string& way) { ways += (ways.empty() ? "" : "; or ") + way; };
  for (const double part : {0.5, 0.25}) {
    const std::string cell = short_text(part * cell_mm);
    const std::optional<double> finer_mm3 = enclosed_mm3(surface, std::stod(cell), false, options.progress);
    if (!finer_mm3 || !is_within_share(before_mm3, *finer_mm3, options)) continue;
    add("--cell " + cell + " encloses " + short_text(*finer_mm3) + " mm3, which is within it");
    break;
  }
  if (const std::optional<double> hull_mm3 = enclosed_mm3(surface, cell_mm, true, options.progress))
    add("--hull takes the outermost shells as full, " + short_text(*hull_mm3) + " mm3");
  if (const std::string wall = wall_way(given, Mender(given).extent_mm(), options); !wall.empty()) add(wall);
  const double share = std::abs(now_mm3 - before_mm3) / before_mm3;
  add("what winds round by half or more has a share of " + short_text(share) +
      ", accepted by --max-volume-share " + short_text(1.01 * share) +
      ": look at it, as thin sheets may be lost or closed gaps filled");
  return ways;
}

/// The order matters: splitting fans needs orientation, orienting needs the shells that splitting closes, and
/// shells with holes can be oriented only after these are filled.
void connect(Mender& mender, const RepairOptions& options) {
  const bool solid = options.solid;
  if (solid) mender.remove_not_finite();
  if (options.weld_mm || solid) mender.weld(options.weld_mm.value_or(0.0));
  if (solid && !options.weld_mm && mender.is_open()) mender.weld(weld_share() * mender.extent_mm());
  if (options.remove_flat || solid) mender.remove_repeats();
  if (options.remove_duplicates || solid) mender.remove_duplicates();
  const auto nested = solid ? Mender::Nested::AsGiven : Mender::Nested::Alternating;
  if (options.orient || solid) mender.orient(nested);
  if (options.remove_flat || solid) mender.flip_flat();
  if (solid) mender.split();
  if (solid) mender.remove_films();
  if (options.fill_holes || solid) mender.fill_holes(options.longest_hole_mm);
  if (solid) mender.remove_films();
  if ((options.orient && options.fill_holes) || solid) mender.orient(nested);
}

/// With more triangles, a solid is enclosed at once, without trying to preserve the rest of the surface.
constexpr std::size_t most_untangled = 100'000;

/// With more shells, their union by Booleans would take longer than enclosing them.
constexpr std::size_t most_united = 1000;

void make_solid(Mender& mender, double before_mm3, const RepairOptions& options) {
  Health now = health(mender.surface());
  if (now.solid() && !options.hull) return;
  if (now.closed && now.shells > 1 && now.shells <= most_united && !options.hull && !options.cell_mm &&
      mender.unite(options.progress.stop))
    return;
  const std::size_t triangles = mender.surface().faces.size();
  if (!options.hull && !options.cell_mm && now.closed && triangles <= most_untangled &&
      now.self_intersections <= triangles / 10) {
    Mender tried = mender;
    tried.remove_intersections();
    tried.split();
    tried.orient();
    const double share = std::abs(volume_inside_mm3(tried.surface()) - before_mm3) / before_mm3;
    if (share <= options.max_volume_share && health(tried.surface()).solid()) {
      mender = std::move(tried);
      return;
    }
  }
  mender.enclose(options);
}

Repair mended(const Triangles& surface, const RepairOptions& options, bool offers_ways);

/// Suggests the option --weld for a surface in loose pieces if joining their points closes it; else empty.
std::string weld_way(const Triangles& given, double extent_mm, const RepairOptions& options) {
  if (options.weld_mm) return {};
  for (const double share : {3e-4, 1e-3, 3e-3}) {
    RepairOptions welded = options;
    const std::string apart = short_text(share * extent_mm);
    welded.weld_mm = std::stod(apart);
    try {
      const Repair made = mended(given, welded, false);
      // Rejects an answer in which a few pieces closed by chance and the others were removed.
      constexpr double most = 0.8;
      if (size_of(made.surface).area_mm2 < most * size_of(given).area_mm2) continue;
      return "--weld " + apart + " joins points up to " + apart + " mm apart and encloses " +
             short_text(size_of(made.surface).volume_mm3) + " mm3";
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Geometry) throw;
    }
  }
  return {};
}

Repair mended(const Triangles& surface, const RepairOptions& options, bool offers_ways) {
  Mender mender(surface);
  if (options.solid && options.wall_mm) {
    mender.replace(wall_of(surface, *options.wall_mm, options), wall_cell_mm(*options.wall_mm, options),
                   "made a wall of " + short_text(*options.wall_mm) + " mm about the surface as given");
    return mender.result();
  }
  connect(mender, options);
  if (!options.remove_intersections && !options.solid) {
    mender.split();
    if (options.orient) mender.orient();
    return mender.result();
  }
  options.progress.at(0.2);
  const double before_mm3 = volume_inside_mm3(mender.surface());
  if (options.solid) {
    const Triangles connected = mender.surface();
    try {
      make_solid(mender, before_mm3, options);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Geometry || !offers_ways) throw;
      std::string ways;
      const double extent_mm = Mender(surface).extent_mm();
      for (const std::string& way :
           {weld_way(surface, extent_mm, options), wall_way(surface, extent_mm, options)})
        if (!way.empty()) ways += "; or " + way;
      throw Error(ErrorCode::Geometry, error.what() + ways);
    }
    const double now_mm3 = options.hull ? before_mm3 : volume_inside_mm3(mender.surface());
    if (!is_within_share(before_mm3, now_mm3, options))
      refuse_volume(before_mm3, now_mm3, options, "enclosing",
                    mender.cell_mm() && offers_ways
                        ? ways_that_work(connected, surface, before_mm3, now_mm3, *mender.cell_mm(), options)
                        : "allow a larger one, --max-volume-share");
  } else {
    mender.remove_intersections();
    check_volume(before_mm3, mender.surface(), options, "taking out intersections");
  }
  mender.split();
  // Shells that intersected can be placed only now; each orientation may make another one necessary.
  for (int turns = 0; (options.orient || options.solid) && turns < 3 && mender.orient(); ++turns) continue;
  return mender.result();
}

}  // namespace

Repair repair(const Triangles& surface, const RepairOptions& options) {
  check(surface, options);
  return mended(surface, options, true);
}

RepairEffect repair_effect(const Triangles& before, const Triangles& after, const KnownSolids& solids) {
  const auto finite_of = [](const Triangles& surface) {
    Triangles finite{surface.points_mm, {}};
    const auto is_finite = [](const glm::dvec3& p) { return std::isfinite(glm::dot(p, glm::dvec3(1.0))); };
    for (const Face& face : surface.faces)
      if (std::all_of(face.begin(), face.end(),
                      [&](std::uint32_t v) { return is_finite(surface.points_mm[v]); }))
        finite.faces.push_back(face);
    return finite;
  };
  const Triangles was = finite_of(before), is = finite_of(after);
  RepairEffect effect;
  const LineVolumes volumes = line_volumes(was, {});
  effect.volume_before_mm3 = volumes.all.a_mm3;
  if (volumes.lines > 0)
    effect.open_line_share = static_cast<double>(volumes.open_lines) / static_cast<double>(volumes.lines);
  const Size size_before = size_of(was), size_after = size_of(is);
  if (solids.before) effect.volume_before_mm3 = size_before.volume_mm3;
  effect.volume_after_mm3 = solids.after ? size_after.volume_mm3 : line_volumes(is, {}).all.a_mm3;
  effect.area_before_mm2 = size_before.area_mm2;
  effect.area_after_mm2 = size_after.area_mm2;
  const auto measure = [&](const Triangles& from, const Triangles& to) {
    if (from.faces.empty() || to.faces.empty()) return;
    // Collects each point once, then the triangles' middles.
    std::vector<glm::dvec3> points;
    std::vector<std::uint32_t> place(from.points_mm.size(), is_new);
    for (const Face& face : from.faces)
      for (const std::uint32_t v : face) {
        if (place[v] != is_new) continue;
        place[v] = static_cast<std::uint32_t>(points.size());
        points.push_back(from.points_mm[v]);
      }
    for (const Face& face : from.faces)
      points.push_back((from.points_mm[face[0]] + from.points_mm[face[1]] + from.points_mm[face[2]]) / 3.0);
    const std::vector<double> distances = SurfaceTree(to, SurfaceTree::Build::Hasty).distances_mm(points);
    // Among equally distant positions, stores the first in the order of the triangles.
    const auto add = [&](std::size_t i) {
      if (distances[i] <= effect.largest_distance_mm) return;
      effect.largest_distance_mm = distances[i];
      effect.largest_at_mm = points[i];
    };
    const std::size_t middles = points.size() - from.faces.size();
    for (std::size_t f = 0; f < from.faces.size(); ++f) {
      for (const std::uint32_t v : from.faces[f]) add(place[v]);
      add(middles + f);
    }
  };
  measure(was, is);
  measure(is, was);
  return effect;
}

TurnedAlike turned_alike(const Triangles& surface) {
  RepairOptions options;
  options.weld_mm = 0.0;
  options.orient = true;
  Repair repaired = repair(surface, options);
  const auto turned = std::count_if(repaired.changes.begin(), repaired.changes.end(),
                                    [](const Change& change) { return change.step == "orient"; });
  return {std::move(repaired.surface), static_cast<std::size_t>(turned)};
}

}  // namespace octotomy::brep
