// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/tetrahedralise.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "convert/tet/element_faces.h"
#include "convert/tet/improve_tetrahedra.h"
#include "convert/tet/isosurface_stuffing.h"
#include "convert/tet/mesh3_tetrahedra.h"
#include "convert/tet/mesher_process.h"
#include "convert/tet/sharp_edges.h"
#include "convert/tet/surface_sizes.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

// 1 The surface becomes points and triangles. Surfaces on which TetGen would abort are refused here.
// 2 A cavity is a connected part of the surface that is inside out. Half way from one of its triangles to
//   the next surface in front of it lies a point in the cavity and in nothing else: the hole point.
// 3 TetGen runs, with fewer and fewer demands. Its answer counts only if all volumes are positive and their
//   sum is the volume that the surface encloses: a wrong sum shows filled cavities and leaks.
// 4 Nodes inside move to improve flat elements. If that is not enough and the surface need not be kept,
//   Mesh_3 makes a new surface.
// 5 Where Mesh_3 fails, too, or leaves elements too flat for a solver, a lattice's cells are cut to the
// surface.

namespace octotomy::convert {
namespace {

using voxel::rounded;

/// Throws because the surface cannot be filled.
[[noreturn]] void refuse_surface(const std::string& why) {
  throw voxel::Error(voxel::ErrorCode::Geometry, "tetrahedralise: " + why);
}
/// Throws because an option is out of its range.
[[noreturn]] void refuse_option(const std::string& why) {
  throw voxel::InvalidInput("tetrahedralise: " + why);
}

/// A number in the form of TetGen's switches.
std::string switch_number(double value) {
  std::ostringstream text;
  text << std::setprecision(6) << value;
  return text.str();
}

/// Largest relative difference between the sum of the tetrahedra's volumes and the surface's. Both are sums
/// of n terms no larger than the bounding box, rounded to the machine's epsilon: sqrt(n) epsilon is 3e-13 for
/// two million. 1e-9 leaves room for thin solids, whose volume is a small part of their box, and is a
/// thousandth of the smallest cavity that a scan could show.
constexpr double volume_tolerance() {
  return 1e-9;
}

/// The volume, relative to the cube of the largest extent, below which a solid is flat for TetGen: TetGen
/// treats points within 1e-8 of the largest extent as coplanar, so such a thin plate has no inside.
constexpr double flat_volume() {
  return 1e-8;
}

/// The smallest extent of a solid. No scanner resolves a smaller one, and TetGen's absolute tolerances take
/// effect only some orders of magnitude below.
constexpr double tiny_extent_mm() {
  return 1e-3;
}

struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool meets(const Bounds& other) const {
    return glm::all(glm::lessThanEqual(low, other.high)) && glm::all(glm::lessThanEqual(other.low, high));
  }
};

/// The solid's faces for TetGen, without vertices that have no face: TetGen would connect these to the mesh.
MesherInput surface_of(const brep::Mesh& solid) {
  MesherInput input;
  constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(solid.n_vertices(), unused);
  for (const auto face : solid.faces()) {
    std::array<std::uint32_t, 3> triangle{};
    std::size_t corner = 0;
    for (const auto halfedge : solid.fh_range(face)) {
      const auto vertex = solid.to_vertex_handle(halfedge);
      const OpenMesh::Vec3d& p = solid.point(vertex);
      if (solid.is_boundary(solid.opposite_halfedge_handle(halfedge)))
        refuse_surface("the surface is open at " + rounded({p[0], p[1], p[2]}) +
                       " mm, so it has no inside: close its holes first");
      if (!std::isfinite(p[0] + p[1] + p[2]))
        refuse_surface("vertex " + std::to_string(vertex.idx()) + " is not finite");
      std::uint32_t& known = number[static_cast<std::size_t>(vertex.idx())];
      if (known == unused) {
        known = static_cast<std::uint32_t>(input.points_mm.size());
        input.points_mm.emplace_back(p[0], p[1], p[2]);
      }
      triangle.at(corner++) = known;
    }
    input.triangles.push_back(triangle);
  }
  return input;
}

/// A part of the surface connected by points.
struct Part {
  std::vector<std::uint32_t> triangles;
  Bounds bounds;
  double six_volumes_mm3 = 0.0;
};

/// Parts in the order of their first triangle. Volumes are taken about the surface's first point.
std::vector<Part> parts_of(const MesherInput& surface) {
  brep::DisjointSets sets(surface.points_mm.size());
  for (const auto& [a, b, c] : surface.triangles) {
    sets.join(a, b);
    sets.join(a, c);
  }
  std::vector<Part> parts;
  constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> part_of_set(surface.points_mm.size(), unknown);
  const glm::dvec3 origin = surface.points_mm.front();
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    std::uint32_t& number = part_of_set[sets.set_of(a)];
    if (number == unknown) {
      number = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    Part& part = parts[number];
    part.triangles.push_back(t);
    for (const std::uint32_t v : surface.triangles[t]) part.bounds.add(surface.points_mm[v]);
    part.six_volumes_mm3 += glm::dot(glm::cross(surface.points_mm[a] - origin, surface.points_mm[b] - origin),
                                     surface.points_mm[c] - origin);
  }
  return parts;
}

/// The distance along a ray to a triangle, or infinity. Triangles count as a little larger than they are: a
/// false hit only brings the hole point nearer to its start.
double distance_along(const glm::dvec3& from, const glm::dvec3& direction, const glm::dvec3& a,
                      const glm::dvec3& b, const glm::dvec3& c) {
  constexpr double missed = std::numeric_limits<double>::infinity();
  // A hundred million times the rounding of the barycentric coordinates below.
  constexpr double margin = 1e-8;
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 across = glm::cross(direction, ac);
  const double scale = glm::dot(ab, across);
  if (scale == 0.0) return missed;
  const glm::dvec3 offset = from - a;
  const double u = glm::dot(offset, across) / scale;
  const glm::dvec3 turned = glm::cross(offset, ab);
  const double v = glm::dot(direction, turned) / scale;
  if (!(u >= -margin && v >= -margin && u + v <= 1.0 + margin)) return missed;
  const double t = glm::dot(ac, turned) / scale;
  return t > 0.0 ? t : missed;
}

double nearest_hit(const MesherInput& surface, const Part& part, std::uint32_t start, const glm::dvec3& from,
                   const glm::dvec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : part.triangles) {
    if (t == start) continue;
    const auto& [a, b, c] = surface.triangles[t];
    nearest = std::min(nearest, distance_along(from, direction, surface.points_mm[a], surface.points_mm[b],
                                               surface.points_mm[c]));
  }
  return nearest;
}

/// A point inside the cavity that a part encloses: half way from its largest triangle along the normal, which
/// points out of the solid and into the cavity, to the next surface. That surface is the part itself, or an
/// island in the cavity, whose bounds then meet the segment.
glm::dvec3 hole_point(const MesherInput& surface, const std::vector<Part>& parts, const Part& cavity) {
  const auto normal_of = [&](std::uint32_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    return glm::cross(surface.points_mm[b] - surface.points_mm[a],
                      surface.points_mm[c] - surface.points_mm[a]);
  };
  const auto area = [&](std::uint32_t t) { return glm::length(normal_of(t)); };
  const std::uint32_t start =
      *std::max_element(cavity.triangles.begin(), cavity.triangles.end(),
                        [&](std::uint32_t s, std::uint32_t t) { return area(s) < area(t); });
  const auto& [a, b, c] = surface.triangles[start];
  const glm::dvec3 from = (surface.points_mm[a] + surface.points_mm[b] + surface.points_mm[c]) / 3.0;
  const glm::dvec3 direction = glm::normalize(normal_of(start));

  double nearest = nearest_hit(surface, cavity, start, from, direction);
  if (!std::isfinite(nearest))
    refuse_surface(
        "a cavity at " + rounded(from) +
        " mm has no other side: its triangles do not all face the same way; check the mesh's health");
  Bounds way;
  way.add(from);
  way.add(from + nearest * direction);
  for (const Part& part : parts)
    if (&part != &cavity && part.bounds.meets(way))
      nearest = std::min(nearest, nearest_hit(surface, part, start, from, direction));
  return from + 0.5 * nearest * direction;
}

/// The volume requested from meshers, relative to the largest that is allowed: nodes that move to mend flat
/// elements enlarge some of their neighbours, by up to a tenth in balls and boxes.
constexpr double asked_volume_share() {
  return 0.85;
}

/// The switches to try, the most demanding first. The bound of volumes is dropped last.
std::vector<std::string> ladder(const TetOptions& options) {
  const std::string quality = "q" + switch_number(options.radius_edge);
  const std::string volume =
      options.max_volume_mm3 ? "a" + switch_number(asked_volume_share() * *options.max_volume_mm3) : "";
  std::vector<std::string> switches = {(options.keep_boundary ? "pY" : "p") + quality + volume};
  for (const std::string& bound : {volume, std::string()}) {
    if (options.keep_boundary) switches.push_back("pY" + bound);
    switches.push_back("p" + bound);
    if (volume.empty()) break;
  }
  return switches;
}

/// Divides the triangles of a surface that TetGen keeps, in their planes, where a regular element on a
/// triangle would be larger than allowed. Returns the number of triangles before, if any was divided.
std::optional<std::size_t> divide_for_volume(MesherInput& surface, double max_volume_mm3) {
  constexpr double regular =
      0.75;  // halving leaves right triangles, whose elements are as large as those of equilateral triangles
             // with sides 4/3 as long
  const double side_mm = regular * std::cbrt(6.0 * std::sqrt(2.0) * max_volume_mm3);
  brep::Triangles given{std::move(surface.points_mm), std::move(surface.triangles)};
  const std::size_t before = given.faces.size();
  brep::Triangles divided = refined_surface(given, SizingField({Refinement{{}, given, side_mm}}));
  surface.points_mm = std::move(divided.points_mm);
  surface.triangles = std::move(divided.faces);
  return surface.triangles.size() == before ? std::nullopt : std::optional(before);
}

/// Reports elements that are larger than requested.
std::optional<std::string> too_large(const Tetrahedra& made, double max_volume_mm3) {
  std::size_t count = 0, largest = 0;
  double most_mm3 = max_volume_mm3;
  for (std::size_t t = 0; t < made.tets.size(); ++t) {
    const double mm3 = six_volumes(corners_mm(made, t)) / 6.0;
    count += mm3 > max_volume_mm3;
    if (mm3 <= most_mm3) continue;
    most_mm3 = mm3;
    largest = t;
  }
  if (count == 0) return std::nullopt;
  const TetCorners corners = corners_mm(made, largest);
  return std::to_string(count) + " of " + std::to_string(made.tets.size()) +
         " elements are larger than the " + rounded(max_volume_mm3) + " mm3 requested, the largest " +
         rounded(most_mm3) + " mm3 at " +
         rounded(0.25 * (corners[0] + corners[1] + corners[2] + corners[3])) +
         " mm: request smaller ones, or use another mesher";
}

void check(const TetOptions& options) {
  // TetGen's refinement is only proven to end from 2 on; under 1 it never does.
  if (!(options.radius_edge >= 1.0) || !std::isfinite(options.radius_edge))
    refuse_option("the radius-edge bound must be 1 or more, not " + rounded(options.radius_edge));
  if (!(options.min_dihedral_deg >= 0.0 && options.min_dihedral_deg <= 30.0))
    refuse_option("the smallest dihedral angle to reach must be 0 to 30 degrees, not " +
                  rounded(options.min_dihedral_deg));
  if (options.max_volume_mm3 && !(*options.max_volume_mm3 > 0.0))
    refuse_option("the largest volume must be positive, not " + rounded(*options.max_volume_mm3) + " mm3");
}

/// Volume of the solid. Throws if it is flat, tiny or inside out.
double checked_volume_mm3(const MesherInput& surface, const std::vector<Part>& parts) {
  Bounds bounds;
  double six = 0.0;
  for (const Part& part : parts) {
    bounds.add(part.bounds.low);
    bounds.add(part.bounds.high);
    six += part.six_volumes_mm3;
  }
  const glm::dvec3 extent = bounds.high - bounds.low;
  const double largest = std::max({extent.x, extent.y, extent.z});
  if (largest < tiny_extent_mm())
    refuse_surface("the solid is only " + rounded(largest) + " mm large: is its unit millimetres?");
  const double volume = six / 6.0;
  if (std::abs(volume) < flat_volume() * largest * largest * largest)
    refuse_surface("the solid is flat: " + rounded(volume) + " mm3 within " + rounded(largest) + " mm, of " +
                   std::to_string(surface.triangles.size()) + " triangles");
  if (volume < 0.0)
    refuse_surface("the surface is inside out: it encloses " + rounded(volume) + " mm3; flip its triangles");
  return volume;
}

/// The failures of meshers.
struct Attempts {
  std::vector<std::string> findings;
  voxel::ErrorCode code = voxel::ErrorCode::Geometry;  ///< code of the last failure
  int rounds_left = 0;                                 ///< rounds of improvement that remained for TetGen's
                                                       ///< elements
};

ImproveOptions improve_options(const TetOptions& options) {
  ImproveOptions improving;
  improving.min_dihedral_deg = options.min_dihedral_deg;
  improving.progress.stop = options.progress.stop;
  return improving;
}

std::optional<Tetrahedra> by_tetgen(MesherInput surface, double surface_mm3, const TetOptions& options,
                                    Attempts& attempts) {
  std::optional<std::size_t> before;
  if (options.max_volume_mm3 && options.keep_boundary)
    before = divide_for_volume(surface, *options.max_volume_mm3);
  for (const std::string& switches : ladder(options)) {
    MesherOutcome outcome = run_tetgen(surface, switches + "Q",
                                       {options.time_limit, options.memory_limit_bytes, options.progress});
    if (!outcome.failure) {
      Tetrahedra made;
      made.nodes_mm = std::move(outcome.points_mm);
      made.tets = std::move(outcome.tetrahedra);
      made.method = "TetGen -" + switches;
      const std::optional<std::string> fault = fault_in_filling(made, surface_mm3, volume_tolerance());
      if (!fault) {
        made.boundary_nodes = boundary_nodes(made.tets);
        ImproveOptions improving = improve_options(options);
        improving.all_or_nothing = options.mesher == Mesher::Best;
        attempts.rounds_left = improve(made, improving);
        if (before)
          made.findings.push_back("the surface's " + std::to_string(*before) +
                                  " triangles were divided in their planes to " +
                                  std::to_string(surface.triangles.size()) +
                                  ", because larger ones would have elements larger than requested");
        return made;
      }
      outcome.failure = made.method + "Q " + *fault;
      outcome.worth_another_try = true;
    }
    attempts.findings.push_back(*outcome.failure);
    attempts.code = outcome.code;
    if (!outcome.worth_another_try) break;
  }
  return std::nullopt;
}

/// The surface with start points for Mesh_3 in place of hole points: corners of triangles spread over every
/// part, at least eight of each and about one of a hundred.
MesherInput starting(MesherInput surface, const std::vector<Part>& parts) {
  constexpr std::size_t least = 8, one_of = 100;
  surface.holes_mm.clear();
  for (const Part& part : parts) {
    const std::size_t count = std::max(least, part.triangles.size() / one_of);
    const std::size_t step = std::max<std::size_t>(1, part.triangles.size() / count);
    for (std::size_t i = 0; i < part.triangles.size(); i += step)
      surface.holes_mm.push_back(surface.points_mm[surface.triangles[part.triangles[i]][0]]);
  }
  return surface;
}

/// Divides the surface at the refinements. Returns the limits of Mesh_3's sizes.
SizeLimits refine(MesherInput& surface, const std::vector<Refinement>& finer) {
  if (finer.empty()) return {};
  const SizingField sizes(finer);
  SizeLimits limits;
  limits.mean_mm = mean_side_mm(surface);
  brep::Triangles divided =
      refined_surface({std::move(surface.points_mm), std::move(surface.triangles)}, sizes);
  surface.points_mm = std::move(divided.points_mm);
  surface.triangles = std::move(divided.faces);
  limits.most_mm = sizes.at_mm(surface.points_mm);
  return limits;
}

/// The largest relative difference of volume that stuffing may leave. Equal to the tolerance of repair.
constexpr double stuffed_volume_tolerance() {
  return 0.05;
}

/// Smaller cells are tried until the volume's relative difference is at most this, which is a tenth of a
/// voxel about a thick bone.
constexpr double stuffed_volume_goal() {
  return 0.01;
}

/// The number of elements that a solver on a workstation can handle.
constexpr double most_stuffed_elements() {
  return 2e6;
}

/// More triangles than this are too many for the meshers within a time limit: Mesh_3 fills about three
/// triangles a millisecond of bones, and TetGen with quality needed more than a minute for a million. Depends
/// on the time limit alone, so the answer is the same on any machine.
std::size_t most_meshed_triangles(std::chrono::milliseconds time_limit) {
  return 5 * static_cast<std::size_t>(std::max<std::int64_t>(time_limit.count(), 0));
}

std::optional<Tetrahedra> by_stuffing(const MesherInput& surface, double surface_mm3,
                                      const TetOptions& options, Attempts& attempts) {
  const brep::Triangles triangles{surface.points_mm, surface.triangles};
  double cell_mm = std::max(mean_side_mm(surface), cell_of_elements_mm(surface_mm3, most_stuffed_elements()));
  if (options.max_volume_mm3) cell_mm = std::min(cell_mm, cell_of_elements_mm(*options.max_volume_mm3, 1.0));
  constexpr int tries = 3;
  constexpr double smaller = 0.7;
  Tetrahedra made;
  double off = 1.0;
  for (int i = 0; i < tries; ++i, cell_mm *= smaller) {
    made = stuff(triangles, {cell_mm, options.progress});
    off = made.tets.empty() ? 1.0 : std::abs(quality(made).volume_mm3 / surface_mm3 - 1.0);
    if (off <= stuffed_volume_goal() || i + 1 == tries) break;
    if (cell_of_elements_mm(surface_mm3, 2.0 * most_stuffed_elements()) > smaller * cell_mm) break;
  }
  if (off > stuffed_volume_tolerance()) {
    attempts.findings.push_back("isosurface stuffing by cells of " + rounded(cell_mm) + " mm misses " +
                                rounded(100.0 * off) + " % of the volume: the solid is thinner than cells");
    attempts.code = voxel::ErrorCode::Geometry;
    return std::nullopt;
  }
  // Just below stuffed_dihedral_deg(), the least angle that isosurface stuffing guarantees.
  constexpr double least_deg = 10.0;
  put_on_sharp_edges(made, {triangles, brep::SurfaceTree(triangles)}, least_deg);
  std::vector<double> apart_mm = brep::SurfaceTree(surface_of(made)).distances_mm(surface.points_mm);
  std::sort(apart_mm.begin(), apart_mm.end());
  made.findings.push_back("isosurface stuffing made the elements; their nodes on the surface lie on the " +
                          std::string("given one, with cells of ") + rounded(cell_mm) + " mm: volume " +
                          switch_number(quality(made).volume_mm3) + " of " + switch_number(surface_mm3) +
                          " mm3; 95 % of the given surface's points are within " +
                          rounded(apart_mm[apart_mm.size() * 95 / 100]) +
                          " mm of the elements' surface, all within " + rounded(apart_mm.back()) + " mm");
  if (!options.finer.empty())
    made.findings.push_back("elements are not finer where requested: stuffing makes elements of one size");
  return made;
}

/// Replaces the best elements by others if the others' smallest angle is larger.
void take_better(std::optional<Tetrahedra>& best, std::optional<Tetrahedra> other, const std::string& who,
                 Attempts& attempts) {
  if (!other) return;
  if (best) {
    const double kept_deg = quality(*best).min_dihedral_deg;
    const bool is_better = kept_deg < quality(*other).min_dihedral_deg;
    attempts.findings.push_back(
        best->method.substr(0, best->method.find(' ')) + " reached only " + rounded(kept_deg) + " degrees" +
        (best->method == "Mesh_3" ? "" : " with the surface kept") +
        (attempts.rounds_left > 0 ? " when smoothing was stopped as hopeless" : "") + ", so " + who +
        " remeshed it" + (is_better ? "" : "; its angles were no better"));
    if (!is_better) return;
  }
  best = std::move(other);
}

}  // namespace

std::optional<std::string> fault_in_filling(const Tetrahedra& tetrahedra, double surface_mm3,
                                            double tolerance) {
  if (tetrahedra.tets.empty()) return "gave no tetrahedra";
  double sum = 0.0;
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const double six = six_volumes(corners_mm(tetrahedra, t));
    if (!(six > 0.0))
      return "gave tetrahedron " + std::to_string(t) + " a volume of " + rounded(six / 6.0) + " mm3";
    sum += six;
  }
  if (std::abs(sum / 6.0 - surface_mm3) > tolerance * surface_mm3)
    return "filled " + switch_number(sum / 6.0) + " mm3 of a surface that encloses " +
           switch_number(surface_mm3) + " mm3";
  return std::nullopt;
}

std::optional<std::string> fault_in_shape(const Tetrahedra& tetrahedra) {
  const double least_deg = quality(tetrahedra).min_dihedral_deg;
  if (least_deg >= fit_dihedral_deg()) return std::nullopt;
  return tetrahedra.method + " left dihedral angles down to " + rounded(least_deg) +
         " degrees; a solver needs " + rounded(fit_dihedral_deg());
}

Tetrahedra tetrahedralise(const brep::Mesh& solid, const TetOptions& options) {
  check(options);
  MesherInput surface = surface_of(solid);
  const SizeLimits limits = refine(surface, options.finer);
  if (surface.triangles.size() < 4)
    refuse_surface("a surface of " + std::to_string(surface.triangles.size()) +
                   " triangles encloses nothing");
  const std::vector<Part> parts = parts_of(surface);
  const double surface_mm3 = checked_volume_mm3(surface, parts);
  constexpr double most_elements = 2e7;
  if (options.max_volume_mm3 && surface_mm3 > most_elements * *options.max_volume_mm3)
    refuse_option("elements of at most " + rounded(*options.max_volume_mm3) +
                  " mm3 would be more than 20 million in " + rounded(surface_mm3) +
                  " mm3: allow larger ones");
  for (const Part& part : parts)
    if (part.six_volumes_mm3 < 0.0) surface.holes_mm.push_back(hole_point(surface, parts, part));

  std::optional<Tetrahedra> best;
  Attempts attempts;
  const bool too_many = surface.triangles.size() > most_meshed_triangles(options.time_limit);
  if (options.mesher == Mesher::Best && too_many) {
    attempts.findings.push_back(
        std::to_string(surface.triangles.size()) +
        " triangles are more than TetGen and Mesh_3 fill in their time, so they were " +
        "not tried: simplify the surface, or allow more time");
    best = by_stuffing(surface, surface_mm3, options, attempts);
  }
  const bool any = options.mesher == Mesher::Best && !best;
  const auto reaches = [](const std::optional<Tetrahedra>& made, double deg) {
    return made && quality(*made).min_dihedral_deg >= deg;
  };
  if (any || options.mesher == Mesher::TetGen) best = by_tetgen(surface, surface_mm3, options, attempts);
  if (options.mesher == Mesher::Mesh3 || (any && !reaches(best, options.min_dihedral_deg))) {
    Mesh3Filling filling = fill_by_mesh3(starting(surface, parts), limits, surface_mm3, options);
    attempts.findings.insert(attempts.findings.end(), filling.findings.begin(), filling.findings.end());
    attempts.code = filling.code;
    if (attempts.rounds_left > 0 && !reaches(filling.tetrahedra, options.min_dihedral_deg)) {
      ImproveOptions improving = improve_options(options);
      improving.rounds = std::exchange(attempts.rounds_left, 0);
      improve(*best, improving);
    }
    take_better(best, std::move(filling.tetrahedra), "Mesh_3", attempts);
  }
  if (options.mesher == Mesher::Stuffing || (any && !reaches(best, fit_dihedral_deg())))
    take_better(best, by_stuffing(surface, surface_mm3, options, attempts), "isosurface stuffing", attempts);
  if (best) {
    if (options.max_volume_mm3)
      if (std::optional<std::string> large = too_large(*best, *options.max_volume_mm3))
        best->findings.push_back(*std::move(large));
    if (best->method != "isosurface stuffing")
      if (std::optional<std::string> coarse = coarse_place(*best, options.finer))
        best->findings.push_back(*std::move(coarse));
    best->findings.insert(best->findings.begin(), attempts.findings.begin(), attempts.findings.end());
    return *std::move(best);
  }
  std::string message = "tetrahedralise: no mesher filled the surface of " +
                        std::to_string(surface.triangles.size()) + " triangles in " +
                        std::to_string(parts.size()) + " parts";
  for (const std::string& finding : attempts.findings) message += "; " + finding;
  throw voxel::Error(attempts.code, message);
}

}  // namespace octotomy::convert
