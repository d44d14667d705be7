// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/print_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "brep/measure/free_space.h"
#include "brep/measure/local_thickness.h"
#include "brep/measure/overhang.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/components.h"
#include "voxel/measure/local_thickness.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr const char* passes = "PASS";
constexpr const char* warns = "WARN";
constexpr const char* fails = "FAIL";

std::string place_in_words(const glm::dvec3& p_mm) {
  const auto rounded = [](double value) { return plain(std::round(10.0 * value) / 10.0 + 0.0); };
  return "(" + rounded(p_mm.x) + ", " + rounded(p_mm.y) + ", " + rounded(p_mm.z) + ") mm";
}

glm::dvec3 middle_of(const brep::Triangles& triangles, std::size_t face) {
  const auto& [a, b, c] = triangles.faces[face];
  return (triangles.points_mm[a] + triangles.points_mm[b] + triangles.points_mm[c]) / 3.0;
}

/// One triangle at an edge: the edge's two points by index, the triangle, and whether it passes the edge from
/// the lower index to the higher.
struct EdgeUse {
  std::uint32_t low = 0, high = 0, face = 0;
  bool is_upward = false;
};

/// The centre of the first triangle with an edge for which `is_bad` is true. Its arguments are the numbers of
/// triangles that pass the edge upward and downward in index.
template <typename IsBad>
std::optional<glm::dvec3> first_bad_edge(const brep::Triangles& triangles, const IsBad& is_bad) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.faces.size());
  for (std::uint32_t face = 0; face < triangles.faces.size(); ++face)
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t from = triangles.faces[face][side], to = triangles.faces[face][(side + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), face, from < to});
    }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.low, a.high, a.face) < std::tie(b.low, b.high, b.face);
  });
  std::optional<std::uint32_t> first;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    std::array<int, 2> count{0, 0};
    for (end = begin;
         end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high; ++end)
      ++count[uses[end].is_upward ? 0 : 1];
    if (is_bad(count[0], count[1])) first = std::min(first.value_or(uses[begin].face), uses[begin].face);
  }
  if (!first) return std::nullopt;
  return middle_of(triangles, *first);
}

/// Text such as " (first at (1, 2, 3) mm)"; empty without a place.
std::string first_at(const std::optional<glm::dvec3>& at_mm) {
  return at_mm ? " (first at " + place_in_words(*at_mm) + ")" : "";
}

PrintCheck closed_check(const brep::Triangles& triangles, const brep::Health& health) {
  PrintCheck made{"closed", passes, "every edge has two triangles", {}, {}};
  made.numbers = {{"open_edges", health.boundary_edges}, {"edges_of_many", health.nonmanifold_edges}};
  if (health.faces == 0) {
    made.verdict = fails;
    made.says = "there are no triangles";
  } else if (health.boundary_edges > 0 || health.nonmanifold_edges > 0) {
    made.verdict = fails;
    made.at_mm = first_bad_edge(triangles, [](int up, int down) { return up + down != 2; });
    made.says = std::to_string(health.boundary_edges) + " edges have one triangle and " +
                std::to_string(health.nonmanifold_edges) + " have more than two" + first_at(made.at_mm) +
                ": mend them by octotomy repair --solid";
  } else if (health.nonmanifold_vertices > 0 || health.degenerate_faces > 0 || health.duplicate_faces > 0) {
    made.verdict = warns;
    made.says = health.findings.front();
  }
  return made;
}

PrintCheck crossing_check(const brep::Triangles& triangles, const brep::Health& health) {
  PrintCheck made{"self_crossing", passes, "no two triangles intersect", {}, {}};
  made.numbers = {{"pairs", health.self_intersections}};
  if (health.self_intersections == 0) return made;
  made.verdict = fails;
  if (!health.crossing.empty())
    made.at_mm = middle_of(triangles, static_cast<std::size_t>(health.crossing.front().second));
  made.says = std::to_string(health.self_intersections) + " pairs of triangles intersect" +
              first_at(made.at_mm) + ": mend them by octotomy repair --solid";
  return made;
}

PrintCheck outward_check(const brep::Triangles& triangles, const brep::Health& health) {
  PrintCheck made{"outward", passes, "all triangles face outward", {}, {}};
  made.numbers = {{"edges_wound_against", health.misoriented_edges},
                  {"misplaced_shells", health.misplaced_shells}};
  if (health.misoriented_edges > 0) {
    made.verdict = fails;
    made.at_mm = first_bad_edge(triangles, [](int up, int down) { return up == 2 || down == 2; });
    made.says = std::to_string(health.misoriented_edges) + " edges have triangles that face opposite ways" +
                first_at(made.at_mm) + ": turn them by octotomy repair --solid";
  } else if (!health.closed) {
    made.verdict.reset();
    made.says = "not measured, because an open surface has no outside";
  } else if (!health.oriented) {
    made.verdict = fails;
    const bool is_inside_out = std::any_of(health.findings.begin(), health.findings.end(),
                                           [](const std::string& f) { return f.find("inward") != f.npos; });
    if (is_inside_out) made.at_mm = middle_of(triangles, 0);
    made.says = is_inside_out ? "the surface faces inward" + first_at(made.at_mm) +
                                    ": turn it outward by octotomy repair --solid"
                              : health.findings.front() + ": join the shells by octotomy repair --solid";
  }
  return made;
}

/// The bounding box of a part that stands on the bed, after the rotation about the vertical for which its
/// share of the bed's width or depth is smallest.
struct Footprint {
  glm::dvec3 size_mm{0.0};  ///< size along the bed's width and depth, and upward
  double turned_deg = 0.0;
  double share = std::numeric_limits<double>::infinity();  ///< the larger of its shares of the bed's width
                                                           ///< and depth
};

Footprint footprint_of(const brep::Triangles& triangles, const PrintLimits& limits) {
  const glm::dvec3 beside = std::abs(limits.up.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 v = glm::normalize(glm::cross(limits.up, beside)), u = glm::cross(v, limits.up);
  Footprint best;
  // With steps of half a degree, a side is overestimated by at most 0.5 % of the other side.
  for (int step = 0; step < 360; ++step) {
    const double turn = glm::radians(0.5 * step);
    const glm::dvec3 across = std::cos(turn) * u + std::sin(turn) * v,
                     along = std::cos(turn) * v - std::sin(turn) * u;
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::dvec3& p_mm : triangles.points_mm) {
      const glm::dvec3 q(glm::dot(across, p_mm), glm::dot(along, p_mm), glm::dot(limits.up, p_mm));
      low = glm::min(low, q);
      high = glm::max(high, q);
    }
    const glm::dvec3 size_mm = high - low;
    const double share = std::max(size_mm.x / limits.bed_mm.x, size_mm.y / limits.bed_mm.y);
    // If shares are equal except for rounding, the smaller rotation is used.
    if (share < best.share * (1.0 - 1e-9)) best = {size_mm, 0.5 * step, share};
  }
  return best;
}

std::string size_in_words(const glm::dvec3& size_mm) {
  const auto rounded = [](double value) { return plain(std::round(10.0 * value) / 10.0); };
  return rounded(size_mm.x) + " x " + rounded(size_mm.y) + " x " + rounded(size_mm.z) + " mm";
}

PrintCheck bed_check(const brep::Triangles& triangles, const PrintLimits& limits) {
  const Footprint found = footprint_of(triangles, limits);
  const bool is_too_wide = found.share > 1.0, is_too_high = found.size_mm.z > limits.bed_mm.z;
  PrintCheck made{"bed", is_too_wide || is_too_high ? fails : passes, "", {}, {}};
  made.numbers = {{"size_mm", to_json(found.size_mm)},
                  {"limit_mm", to_json(limits.bed_mm)},
                  {"turned_deg", found.turned_deg}};
  made.says = size_in_words(found.size_mm) + " turned by " + plain(found.turned_deg) +
              " degrees, on a bed of " + size_in_words(limits.bed_mm);
  if (is_too_wide || is_too_high) {
    // The position to report: the highest point, or if the part is too wide the point farthest from its
    // middle.
    const auto height = [&](const glm::dvec3& p_mm) { return glm::dot(limits.up, p_mm); };
    glm::dvec3 low = triangles.points_mm.front(), high = low;
    for (const glm::dvec3& p_mm : triangles.points_mm) {
      low = glm::min(low, p_mm);
      high = glm::max(high, p_mm);
    }
    const auto aside = [&](const glm::dvec3& p_mm) {
      const glm::dvec3 from = p_mm - 0.5 * (low + high);
      return glm::length(from - glm::dot(limits.up, from) * limits.up);
    };
    made.at_mm = *std::max_element(triangles.points_mm.begin(), triangles.points_mm.end(),
                                   [&](const glm::dvec3& a, const glm::dvec3& b) {
                                     return is_too_high ? height(a) < height(b) : aside(a) < aside(b);
                                   });
    made.says += is_too_high ? ", which is too high: choose another build direction or printer"
                             : ", which is too wide: choose another build direction or printer";
  }
  return made;
}

PrintCheck overhang_check(const brep::Linked& surface, const PrintLimits& limits) {
  PrintCheck made{"overhang", passes, "no downward face needs support", {}, {}};
  double all_mm2 = 0.0, least_mm2 = limits.least_wall_mm * limits.least_wall_mm;
  std::size_t patches = 0;
  const std::vector<brep::Overhang> found =
      brep::overhangs(surface, {limits.up, limits.overhang_deg, brep::OverhangOptions().resting_mm});
  for (const brep::Overhang& patch : found) {
    // Patches smaller than the square of the least wall need no support, because the layer below carries
    // them.
    if (patch.area_mm2 < least_mm2) break;
    all_mm2 += patch.area_mm2;
    ++patches;
  }
  made.numbers = {{"area_mm2", all_mm2},
                  {"patches", patches},
                  {"limit_deg", limits.overhang_deg},
                  {"largest_mm2", patches > 0 ? Json(found.front().area_mm2) : Json(nullptr)}};
  if (patches == 0) return made;
  made.verdict = warns;
  made.at_mm = found.front().at_mm;
  made.says = grouped(all_mm2, 1) + " mm\u00b2 in " + std::to_string(patches) +
              " downward patches need support, the largest at " + place_in_words(*made.at_mm);
  return made;
}

/// A position on a shell: the centre of its first face, which is the same in every run.
glm::dvec3 place_of(const brep::Triangles& triangles, const brep::Component& piece) {
  return middle_of(triangles, piece.faces.front());
}

/// The centre of the first triangle of the first shell with a negative volume; none if there is none.
std::optional<glm::dvec3> first_cavity(const brep::Solid& solid) {
  const brep::Linked& linked = solid.linked();
  std::vector<char> is_seen(linked.triangles.faces.size(), 0);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t first = 0; first < is_seen.size(); ++first) {
    if (is_seen[first]) continue;
    double volume = 0.0;
    waiting.assign(1, first);
    is_seen[first] = 1;
    while (!waiting.empty()) {
      const std::uint32_t face = waiting.back();
      waiting.pop_back();
      const auto& [a, b, c] = linked.triangles.faces[face];
      const glm::dvec3& origin = linked.triangles.points_mm[linked.triangles.faces[first][0]];
      const std::vector<glm::dvec3>& p_mm = linked.triangles.points_mm;
      volume += glm::dot(p_mm[a] - origin, glm::cross(p_mm[b] - origin, p_mm[c] - origin));
      for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side)
        if (linked.opposite[side] != brep::Linked::none && !is_seen[linked.opposite[side] / 3]) {
          is_seen[linked.opposite[side] / 3] = 1;
          waiting.push_back(linked.opposite[side] / 3);
        }
    }
    if (volume < 0.0) return middle_of(linked.triangles, first);
  }
  return std::nullopt;
}

/// The free space around an object's voxels within a box, and the reason if it could not be computed
/// completely.
struct FreeVoxels {
  std::optional<voxel::Octree> octree;
  std::string lacks;
};

FreeVoxels free_voxels(const voxel::Octree& octree, double margin_mm) {
  const voxel::Box extent = *voxel::extents_of(octree), world = voxel::bounds(octree.universe().lattice());
  const voxel::Box box{extent.low_mm - margin_mm, extent.high_mm + margin_mm};
  if (glm::any(glm::lessThan(box.low_mm, world.low_mm)) ||
      glm::any(glm::greaterThan(box.high_mm, world.high_mm)))
    return {std::nullopt, "the universe ends within " + three_figures(margin_mm) +
                              " mm of the object, so voxels do not show its gaps"};
  return {voxel::combine(octree.universe(), voxel::Expression(box) - voxel::Expression(octree)), ""};
}

PrintCheck pieces_check(const brep::Solid& solid, const voxel::Octree* voxels) {
  const std::vector<brep::Component>& pieces = solid.components();
  PrintCheck made{"pieces", passes, "one piece", {}, {}};
  made.numbers = {{"count", pieces.size()}, {"voxel_count", nullptr}};
  if (pieces.size() > 1) {
    made.verdict = fails;
    made.at_mm = place_of(solid.triangles(), pieces[1]);
    made.says = std::to_string(pieces.size()) + " pieces, the second of " + grouped(pieces[1].volume_mm3, 2) +
                " mm\u00b3 at " + place_in_words(*made.at_mm) +
                ": make one of them an object by the operation 'separate'";
  }
  if (voxels == nullptr || voxels->is_empty()) return made;
  const std::size_t count = voxel::component_count(*voxels);
  made.numbers["voxel_count"] = count;
  if (made.verdict == passes && count > 1) {
    made.verdict = warns;
    made.says += ", but " + std::to_string(count) +
                 " of voxels, because bridges are thinner than a voxel or the kernels disagree";
  }
  return made;
}

PrintCheck cavity_check(const brep::Solid& solid, const voxel::Octree* voxels, double margin_mm) {
  std::size_t cavities = 0;
  for (const brep::Component& piece : solid.components()) cavities += piece.cavities;
  PrintCheck made{"cavities", passes, "no closed cavity", {}, {}};
  made.numbers = {{"count", cavities}, {"voxel_count", nullptr}};
  if (cavities > 0) {
    made.verdict = fails;
    made.at_mm = first_cavity(solid);
    made.says = std::to_string(cavities) + " closed cavities would contain resin or powder" +
                first_at(made.at_mm) + ": close them by the operation 'fill', or make a drain hole for each";
  }
  if (voxels == nullptr || voxels->is_empty()) return made;
  if (const FreeVoxels free = free_voxels(*voxels, margin_mm); free.octree)
    made.numbers["voxel_count"] = voxel::component_count(*free.octree, voxel::Neighbours::Corners) - 1;
  return made;
}

/// The least thickness below `up_to_mm`, measured by each kernel.
struct Thinnest {
  std::optional<double> mesh_mm, voxel_mm;
  std::optional<glm::dvec3> at_mm;
  double reach_mm = 0.0;
};

Thinnest thinnest_of(const brep::Solid& solid, const voxel::Octree* voxels, double up_to_mm,
                     const voxel::Progress& progress) {
  Thinnest found;
  brep::LocalThicknessOptions options;
  options.progress = progress.report;
  options.stop = progress.stop;
  const brep::ThinnestWall by_mesh = brep::thinnest_wall(solid, options);
  found.reach_mm = by_mesh.reach_mm;
  if (by_mesh.at && by_mesh.at->thickness_mm < up_to_mm) {
    found.mesh_mm = by_mesh.at->thickness_mm;
    found.at_mm = by_mesh.at->point.p_mm;
  }
  if (voxels == nullptr || voxels->is_empty()) return found;
  voxel::LocalThicknessOptions by_octree;
  by_octree.progress = progress;
  const std::optional<voxel::ThicknessAtVoxel> by_voxels = voxel::thinnest_wall(*voxels, by_octree);
  if (by_voxels && by_voxels->thickness_mm < up_to_mm) found.voxel_mm = by_voxels->thickness_mm;
  return found;
}

/// The check of the least wall or gap. `thin` is the verdict if it is below the limit; `what` is "wall" or
/// "gap".
PrintCheck thinnest_check(const Thinnest& found, const std::string& what, double limit_mm, const char* thin,
                          const std::string& remedy, const voxel::Octree* voxels) {
  PrintCheck made{what, passes, "", found.at_mm, {}};
  const auto json = [](const std::optional<double>& mm) { return mm ? Json(*mm) : Json(nullptr); };
  made.numbers = {{"least_mm", json(found.mesh_mm)},
                  {"voxel_least_mm", json(found.voxel_mm)},
                  {"limit_mm", limit_mm},
                  {"voxel_error_mm", nullptr},
                  {"sample_reach_mm", found.reach_mm}};
  if (found.mesh_mm) {
    made.says = "the smallest " + what + " is " + three_figures(*found.mesh_mm) + " mm at " +
                place_in_words(*found.at_mm) + ", " + three_figures(limit_mm) + " mm is the least";
    if (*found.mesh_mm < limit_mm) {
      made.verdict = thin;
      made.says += ": " + remedy;
    }
  } else {
    made.says = "there is no " + what + " with two sides that are nearly parallel";
  }
  if (voxels == nullptr || voxels->is_empty()) return made;
  // Each of the two digitised sides may be displaced by half a voxel's diagonal.
  const double error_mm = glm::length(voxels->universe().lattice().spacing_mm());
  made.numbers["voxel_error_mm"] = error_mm;
  if (made.verdict == passes && found.voxel_mm && *found.voxel_mm + error_mm < limit_mm) {
    made.verdict = warns;
    made.says += "; in voxels the least is " + three_figures(*found.voxel_mm) + " mm";
  } else if (made.verdict == passes && found.mesh_mm && found.voxel_mm &&
             std::abs(*found.mesh_mm - *found.voxel_mm) > error_mm && *found.voxel_mm < *found.mesh_mm) {
    made.verdict = warns;
    made.says +=
        "; the kernels disagree, because in voxels the least is " + three_figures(*found.voxel_mm) + " mm";
  }
  return made;
}

}  // namespace

std::vector<PrintCheck> health_checks(const brep::Triangles& triangles, const brep::Health& health) {
  return {closed_check(triangles, health), crossing_check(triangles, health),
          outward_check(triangles, health)};
}

std::vector<PrintCheck> build_checks(const brep::Linked& surface, const PrintLimits& limits) {
  return {overhang_check(surface, limits), bed_check(surface.triangles, limits)};
}

std::vector<PrintCheck> solid_checks(const brep::Solid& solid, const voxel::Octree* voxels,
                                     const PrintLimits& limits, const voxel::Progress& progress) {
  // The box extends beyond the part by more than the widest gap that is reported.
  const double margin_mm = std::max(4.0 * limits.least_gap_mm, 2.0), up_to_mm = 0.9 * margin_mm;
  std::vector<PrintCheck> made{pieces_check(solid, voxels), cavity_check(solid, voxels, margin_mm)};
  made.push_back(thinnest_check(thinnest_of(solid, voxels, std::numeric_limits<double>::infinity(), progress),
                                "wall", limits.least_wall_mm, fails, "thicken it or cut it off", voxels));
  FreeVoxels free;
  if (voxels != nullptr && !voxels->is_empty()) free = free_voxels(*voxels, margin_mm);
  const voxel::Octree* free_octree = free.octree ? &*free.octree : nullptr;
  made.push_back(
      thinnest_check(thinnest_of(brep::free_space(solid, margin_mm), free_octree, up_to_mm, progress), "gap",
                     limits.least_gap_mm, warns, "it may close in print: widen or fill it", free_octree));
  made.back().numbers["looked_up_to_mm"] = up_to_mm;
  if (!free.lacks.empty()) made.back().says += "; " + free.lacks;
  return made;
}

std::vector<PrintCheck> missing_solid_checks(const std::string& why) {
  std::vector<PrintCheck> made;
  for (const char* check : {"pieces", "cavities", "wall", "gap"})
    made.push_back({check, std::nullopt, "not measured: " + why, {}, Json::object()});
  return made;
}

std::string worst_verdict(const std::vector<PrintCheck>& checks) {
  for (const char* verdict : {fails, warns})
    if (std::any_of(checks.begin(), checks.end(),
                    [&](const PrintCheck& check) { return check.verdict == verdict; }))
      return verdict;
  return passes;
}

Json to_json(const std::vector<PrintCheck>& checks) {
  Json list = Json::array();
  for (const PrintCheck& check : checks) {
    Json json{{"check", check.check},
              {"verdict", check.verdict ? Json(*check.verdict) : Json(nullptr)},
              {"says", check.says},
              {"at_mm", to_json(check.at_mm)}};
    json.update(check.numbers);
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace octotomy::planner
