// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/mender.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tbb/parallel_sort.h>
#include <utility>

#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/health.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/split_fans.h"
#include "brep/mesh/triangle_places.h"
#include "brep/shape/decimate.h"
#include "brep/shape/enclose.h"
#include "brep/shape/fill_holes.h"
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

/// Whether the triangle's only neighbour in the mesh is its own reverse.
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

/// A reconstructed surface without slivers and surplus triangles of the lattice. Returned unchanged if it is
/// large or if collapses would make it intersect itself.
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

}  // namespace

Mender::Mender(const Triangles& surface) : origin_(surface.faces.size()) {
  repair_.surface = surface;
  std::iota(origin_.begin(), origin_.end(), 0u);
}

template <typename Keep>
void Mender::keep_if(const Keep& keep) {
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

template <typename Run>
void Mender::with_mesh(const char* step, const Run& run) {
  split();
  if (repair_.surface.faces.empty())
    left(step, "not tried: no triangles are left", {});
  else if (Mesh mesh = mesh_of(repair_.surface); true)
    run(mesh);
}

void Mender::weld(double distance_mm) {
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

void Mender::remove_repeats() {
  keep_if([&](std::size_t f) {
    const Face& face = repair_.surface.faces[f];
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) return true;
    change("flat", "triangle " + name(f) + " repeats a point: taken out", centre(f));
    return false;
  });
}

void Mender::flip_flat() {
  if (!has_flat_triangles(repair_.surface)) return;
  with_mesh("flat", [&](Mesh& mesh) {
    const FlatTriangles done = take_out_flat_triangles(mesh);
    replace(triangles_of(mesh), "flat",
            "was replaced or taken out, because it or a triangle beside it has no area");
    if (done.left > 0) left("flat", std::to_string(done.left) + " triangles without area stay", {});
  });
}

void Mender::remove_duplicates() {
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

bool Mender::orient(Nested nested) {
  const Neighbours neighbours = neighbours_of(repair_.surface);
  Shells shells = wound_alike(neighbours);
  place_shells(repair_.surface, neighbours, nested, shells);
  bool any = false;
  for (std::size_t f = 0; f < shells.turned.size(); ++f) {
    if (!shells.turned[f]) continue;
    change("orient", "triangle " + name(f) + " turned round", centre(f));
    std::swap(repair_.surface.faces[f][1], repair_.surface.faces[f][2]);
    any = true;
  }
  return any;
}

void Mender::remove_not_finite() {
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

void Mender::split() {
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
               ": each fan but the first got a copy of the point",
           repair_.surface.points_mm[v]);
  std::vector<std::uint32_t> origin;
  for (const std::uint32_t f : done.face_origin) origin.push_back(origin_[f]);
  origin_ = std::move(origin);
  repair_.surface = std::move(done.surface);
}

bool Mender::unite(const std::stop_token& stop) {
  split();
  std::optional<UnitedShells> united = united_shells(repair_.surface, stop);
  if (!united || !health(united->surface).solid()) return false;
  replace(std::move(united->surface), "solid", "cut or taken out when closed shells were united");
  change("solid", std::to_string(united->bodies) + " closed shells were united by a Boolean", {});
  for (const std::string& finding : united->findings) change("solid", "of the union: " + finding, {});
  return true;
}

void Mender::enclose(const RepairOptions& options) {
  const Enclosed made = brep::enclose(repair_.surface, {options.cell_mm, options.hull, options.progress});
  repair_.surface = thinned(made);
  origin_.assign(repair_.surface.faces.size(), is_new);
  repair_.enclosed_cell_mm = made.cell_mm;
  repair_.left.clear();
  change("solid",
         "made anew of " + std::to_string(repair_.surface.faces.size()) +
             " triangles around the region that the surface encloses, in cells of " +
             short_text(made.cell_mm) + " mm; " + std::to_string(made.points_across_holes) +
             " points lie across holes" +
             (made.cavities_filled > 0 ? ", " + std::to_string(made.cavities_filled) + " shells within filled"
                                       : ""),
         {});
}

void Mender::replace(const Solid& solid, double cell_mm, const std::string& what) {
  repair_.surface = solid.triangles();
  origin_.assign(repair_.surface.faces.size(), is_new);
  repair_.enclosed_cell_mm = cell_mm;
  repair_.left.clear();
  change("solid", what, {});
}

bool Mender::is_open() const {
  return neighbours_of(repair_.surface).is_open();
}

double Mender::extent_mm() const {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Face& face : repair_.surface.faces)
    for (const std::uint32_t v : face) {
      low = glm::min(low, repair_.surface.points_mm[v]);
      high = glm::max(high, repair_.surface.points_mm[v]);
    }
  const glm::dvec3 extent = high - low;
  return repair_.surface.faces.empty() ? 0.0 : std::max({extent.x, extent.y, extent.z});
}

void Mender::fill_holes(const std::optional<double>& longest_mm) {
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

void Mender::remove_films() {
  const Neighbours neighbours = neighbours_of(repair_.surface);
  const Shells shells = wound_alike(neighbours);
  const std::map<std::uint32_t, Shell> found = shells_of(repair_.surface, neighbours, shells);
  keep_if([&](std::size_t f) {
    const Shell& own = found.at(shells.of[f]);
    const bool is_film =
        own.is_closed && std::abs(own.volume_mm3) <= film_share() * std::pow(own.area_mm2, 1.5);
    if (!is_film && own.faces.size() > 1) return true;
    change("films",
           "triangle " + name(f) +
               (is_film ? " of a shell that encloses almost no volume" : " without neighbours") +
               ": taken out",
           centre(f));
    return false;
  });
}

void Mender::remove_intersections() {
  with_mesh("intersections", [&](Mesh& mesh) {
    Untangled done = untangle(mesh);
    if (!done.is_done) left("intersections", "triangles still intersect", {});
    if (done.removed.empty() && done.added == 0) return;
    replace(std::move(done.surface), "intersections", "replaced about an intersection");
  });
}

Repair Mender::result() {
  drop_unused_points();
  return std::move(repair_);
}

std::string Mender::name(std::size_t f) const {
  assert(f < origin_.size());
  return origin_[f] == is_new ? "of a closed hole" : std::to_string(origin_[f]);
}

glm::dvec3 Mender::centre(std::size_t f) const {
  assert(f < repair_.surface.faces.size());
  const Face& face = repair_.surface.faces[f];
  const auto& points = repair_.surface.points_mm;
  return (points[face[0]] + points[face[1]] + points[face[2]]) / 3.0;
}

void Mender::change(const char* step, std::string what, const glm::dvec3& at) {
  repair_.changes.push_back({step, std::move(what), at});
}

void Mender::left(const char* step, std::string what, const glm::dvec3& at) {
  const auto same = [&](const Change& known) { return known.step == step && known.what == what; };
  if (std::none_of(repair_.left.begin(), repair_.left.end(), same))
    repair_.left.push_back({step, std::move(what), at});
}

Shells Mender::wound_alike(const Neighbours& neighbours) {
  Shells shells = wind_alike(neighbours);
  if (shells.twisted_sides > 0)
    left(
        "orient",
        std::to_string(shells.twisted_sides / 2) +
            " edges of a shell that is twisted like a Moebius strip: their triangles wind against each other",
        {});
  return shells;
}

void Mender::join_near(const std::vector<glm::dvec3>& points, double distance_mm, DisjointSets& sets) {
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

void Mender::replace(Triangles other, const char* step, const std::string& how) {
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

void Mender::drop_unused_points() {
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

}  // namespace octotomy::brep
