// SPDX-License-Identifier: AGPL-3.0-or-later
// Each step works on a list of triangles that remembers what each was called when it came in, so that changes
// can name it. Steps that need a connected mesh say so where the list makes none.
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
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/triangle_places.h"
#include "brep/shape/fill_holes.h"
#include "brep/shape/untangle.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t is_new = std::numeric_limits<std::uint32_t>::max();
using Face = std::array<std::uint32_t, 3>;

class Mender {
 public:
  explicit Mender(const Triangles& surface) : origin_(surface.faces.size()) {
    repair_.surface = surface;
    std::iota(origin_.begin(), origin_.end(), 0u);
  }

  void weld(double distance_mm) {
    auto& points = repair_.surface.points_mm;
    DisjointSets sets(points.size());
    join_near(points, distance_mm, sets);
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
    std::map<Face, std::size_t> first;
    keep_if([&](std::size_t f) {
      Face key = repair_.surface.faces[f];
      std::sort(key.begin(), key.end());
      const auto [known, is_first] = first.try_emplace(key, f);
      if (!is_first)
        change("duplicates",
               "triangle " + name(f) + " has the points of triangle " + name(known->second) + ": taken out",
               centre(f));
      return is_first;
    });
  }

  void orient() {
    std::vector<std::uint8_t> turned(repair_.surface.faces.size(), 0);
    const std::vector<std::uint32_t> shell = wind_alike(turned);
    place_shells(shell, turned);
    for (std::size_t f = 0; f < turned.size(); ++f) {
      if (!turned[f]) continue;
      change("orient", "triangle " + name(f) + " turned round", centre(f));
      std::swap(repair_.surface.faces[f][1], repair_.surface.faces[f][2]);
    }
  }

  void fill_holes(const std::optional<double>& longest_mm) {
    with_mesh("holes", [&](Mesh& mesh) {
      repair_.surface = triangles_of(mesh);
      for (const Hole& hole : holes(mesh, longest_mm)) {
        const std::string what = "a hole of " + std::to_string(hole.border.size()) + " sides, " +
                                 short_text(hole.perimeter_mm) + " mm round";
        if (hole.faces.empty()) {
          left("holes", what + ", stays", hole.centre_mm);
          continue;
        }
        change("holes", what + ", closed by " + std::to_string(hole.faces.size()) + " triangles",
               hole.centre_mm);
        repair_.surface.faces.insert(repair_.surface.faces.end(), hole.faces.begin(), hole.faces.end());
        origin_.insert(origin_.end(), hole.faces.size(), is_new);
      }
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
    repair_.left.push_back({step, std::move(what), at});
  }

  /// Points in neighbouring cells of a lattice as wide as the distance are all that can be that near.
  static void join_near(const std::vector<glm::dvec3>& points, double distance_mm, DisjointSets& sets) {
    using Cell = std::array<double, 3>;
    std::map<Cell, std::vector<std::uint32_t>> cells;
    const auto cell_of = [&](const glm::dvec3& p) {
      // Equal points need no lattice; 0.0 and -0.0 are equal.
      const glm::dvec3 c = distance_mm > 0.0 ? glm::floor(p / distance_mm) : p + 0.0;
      return Cell{c.x, c.y, c.z};
    };
    for (std::uint32_t v = 0; v < points.size(); ++v) cells[cell_of(points[v])].push_back(v);
    const double reach = distance_mm > 0.0 ? 1.0 : 0.0;
    for (const auto& [cell, members] : cells)
      for (double x = -reach; x <= reach; ++x)
        for (double y = -reach; y <= reach; ++y)
          for (double z = -reach; z <= reach; ++z) {
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

  /// Floods across edges of two triangles; returns the shell of each, which triangles to turn is added to.
  std::vector<std::uint32_t> wind_alike(std::vector<std::uint8_t>& turned) {
    struct Use {
      std::uint32_t face;
      bool upward;
    };
    const auto& faces = repair_.surface.faces;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Use>> edges;
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = faces[f][k], to = faces[f][(k + 1) % 3];
        edges[{std::min(from, to), std::max(from, to)}].push_back({f, from < to});
      }
    std::vector<std::uint32_t> shell(faces.size(), is_new), flood;
    std::size_t twisted = 0;
    for (std::uint32_t seed = 0; seed < faces.size(); ++seed) {
      if (shell[seed] != is_new) continue;
      shell[seed] = seed;
      flood.assign(1, seed);
      while (!flood.empty()) {
        const std::uint32_t f = flood.back();
        flood.pop_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t from = faces[f][k], to = faces[f][(k + 1) % 3];
          const auto& uses = edges[{std::min(from, to), std::max(from, to)}];
          if (uses.size() != 2) continue;
          const Use &own = uses[0].face == f ? uses[0] : uses[1],
                    &other = uses[0].face == f ? uses[1] : uses[0];
          const std::uint8_t wanted = (own.upward == other.upward) != (turned[f] != 0);
          if (shell[other.face] == is_new) {
            shell[other.face] = seed;
            turned[other.face] = wanted;
            flood.push_back(other.face);
          } else if (turned[other.face] != wanted) {
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
    double volume_mm3 = 0.0;
    bool is_closed = true;
  };

  /// By the first triangle of each, wound alike.
  static std::map<std::uint32_t, Shell> shells_of(const Triangles& wound,
                                                  const std::vector<std::uint32_t>& shell,
                                                  const std::vector<std::uint8_t>& turned) {
    std::map<std::uint32_t, Shell> shells;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    const auto edge = [&](const Face& face, std::size_t k) {
      return std::pair(std::min(face[k], face[(k + 1) % 3]), std::max(face[k], face[(k + 1) % 3]));
    };
    for (std::uint32_t f = 0; f < shell.size(); ++f) {
      Shell& own = shells[shell[f]];
      const Face& face = wound.faces[f];
      // About the shell's first point, which keeps digits far from the origin.
      const glm::dvec3 tip = wound.points_mm[wound.faces[shell[f]][0]];
      const glm::dvec3 p = wound.points_mm[face[0]] - tip, q = wound.points_mm[face[1]] - tip,
                       r = wound.points_mm[face[2]] - tip;
      own.volume_mm3 += glm::dot(p, glm::cross(q, r)) / 6.0;
      own.turns += turned[f];
      own.faces.push_back(f);
      for (std::size_t k = 0; k < 3; ++k) ++uses[edge(face, k)];
    }
    for (auto& [first, own] : shells)
      for (const std::uint32_t f : own.faces)
        for (std::size_t k = 0; k < 3; ++k) own.is_closed &= uses.at(edge(wound.faces[f], k)) == 2;
    return shells;
  }

  /// Turns closed shells outward, or inward within an odd number of others; of open ones, so that fewer of
  /// their triangles have been turned.
  void place_shells(const std::vector<std::uint32_t>& shell, std::vector<std::uint8_t>& turned) {
    assert(turned.size() == repair_.surface.faces.size() && shell.size() == turned.size());
    Triangles wound = repair_.surface;
    for (std::size_t f = 0; f < turned.size(); ++f)
      if (turned[f]) std::swap(wound.faces[f][1], wound.faces[f][2]);
    const SurfaceTree tree(wound);
    for (const auto& [first, own] : shells_of(wound, shell, turned)) {
      bool wrong = 2 * own.turns > own.faces.size();
      if (own.is_closed) {
        bool is_within = false;
        for (const Crossing& crossing : tree.crossings(wound.points_mm[wound.faces[first][0]]))
          if (shell[crossing.face] != first) is_within = !is_within;
        wrong = (own.volume_mm3 < 0.0) != is_within;
      }
      if (wrong)
        for (const std::uint32_t f : own.faces) turned[f] ^= 1u;
    }
  }

  template <typename Run>
  void with_mesh(const char* step, const Run& run) {
    Mesh mesh;
    try {
      mesh = mesh_of(repair_.surface);
    } catch (const std::runtime_error& error) {
      left(step, std::string("not tried: ") + error.what(), {});
      return;
    }
    run(mesh);
  }

  /// Puts another surface in place and lists the triangles that are not in it.
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
    throw std::invalid_argument("repair: the distance to weld over must be 0 mm or more");
  if (options.longest_hole_mm && !(*options.longest_hole_mm > 0.0))
    throw std::invalid_argument("repair: the longest border of a hole must be above 0 mm");
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (const std::uint32_t v : surface.faces[f])
      if (v >= surface.points_mm.size() || !std::isfinite(glm::dot(surface.points_mm[v], glm::dvec3(1.0))))
        throw Error(ErrorCode::Input, "repair: triangle " + std::to_string(f) +
                                          " refers to no point, or to one that is not finite");
}

}  // namespace

Repair repair(const Triangles& surface, const RepairOptions& options) {
  check(surface, options);
  Mender mender(surface);
  if (options.weld_mm) mender.weld(*options.weld_mm);
  if (options.remove_flat) mender.remove_repeats();
  if (options.remove_duplicates) mender.remove_duplicates();
  if (options.orient) mender.orient();
  if (options.remove_flat) mender.flip_flat();
  if (options.fill_holes) mender.fill_holes(options.longest_hole_mm);
  // What holes left open has an outside only now.
  if (options.orient && options.fill_holes) mender.orient();
  if (options.remove_intersections) mender.remove_intersections();
  return mender.result();
}

}  // namespace octotomy::brep
