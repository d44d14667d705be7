// SPDX-License-Identifier: AGPL-3.0-or-later
// A plate on a bone as it is planned, with its holes where the plan's motions bring its screws.
//
// 1 The band about the curve through the points, the side from which the plate is put on (guide_site.h), and
//   the screws' axes.
// 2 The bone near the band and all that lies behind it along the way in which the plate is put on; grown by
//   the bending radius and the clearance, then shrunk by the radius: its surface has no hollow narrower than
//   the radius, so that the plate bridges gaps. It still contains all that lies behind it, so that the plate
//   slides on.
// 3 The plate: 2 grown by the thickness minus the rounding, within a band that is narrower by the
//   rounding on each side; all of this grown by the rounding, so that all outer edges are round. Minus 2,
//   minus the holes.
// 4 Only the part that is covered by balls within it as wide as the least wall: where the bone falls away
//   beside the plate, a flange would get ever thinner. The largest piece, with points that files for printers
//   can hold.
//
// The mesh kernel does 3 and 4 without Booleans, on distances to the surfaces (brep/shape/level_body.h). The
// voxel kernel combines windows of distances.
// 1 is settled once and is a shared value of both kernels.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/segment.h"
#include "brep/shape/level_body.h"
#include "brep/shape/offset.h"
#include "brep/shape/shadow.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/part/guide_site.h"
#include "planner/operation/part/printed_part.h"
#include "planner/operation/part/screw.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "voxel/filter/offset.h"
#include "voxel/filter/shadow.h"
#include "voxel/filter/surface_crossings.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

struct Plate {
  ObjectName object;
  std::string side;
  std::optional<glm::dvec3> direction;
  std::vector<Mark> points;
  double width_mm = 7.0, thickness_mm = 2.5, bend_radius_mm = 10.0, clearance_mm = 0.2, rounding_mm = 0.8,
         reach_mm = 25.0;
  std::vector<ObjectName> screws;
  double play_mm = 0.2, hole_wall_mm = 1.0;
  std::vector<ObjectName> away_from;
  double least_mm = 1.0;
  double least_wall_mm = 0.8;
  // The following members are computed by settle().
  GuideSite site;
  Slab ridge;  ///< the band, narrower than the plate by the rounding on either side
  std::vector<ScrewAxis> axes;

  double hole_radius_mm(const ScrewAxis& axis) const { return 0.5 * (axis.diameter_mm + play_mm); }
  double flat_mm() const { return thickness_mm - rounding_mm; }  ///< thickness below the rounded edge
};

constexpr double plate_room_mm = 1.0;
/// The largest allowed angle between a screw and the plate's insertion direction.
constexpr double steepest_screw_deg = 45.0;
/// A screw's point may lie this far off the bone, because it was placed by hand.
constexpr double screw_off_bone_mm = 3.0;
/// Cell size of the mesh's offsets. Triangles lie within a 16th of a cell from the surface, and within a
/// third of that on average. The number of triangles determines the running time, because a ball of the
/// bending radius touches all triangles of the patch on which it rests.
constexpr double plate_outer_cell_mm = 0.6;
double grown_cell_mm(const Plate& plate) {
  return plate.bend_radius_mm / 5.0;
}
/// A triangle faces the bone if the cosine between its normal and the insertion direction exceeds this, that
/// is within 60 degrees.
constexpr double faces_bone = 0.5;

void check(const Plate& plate, const FieldLocation& place) {
  try {
    voxel::parse_view(plate.side);
  } catch (const voxel::InvalidInput& error) {
    place.at("side").refuse(error.what());
  }
  if (std::max(plate.points.size(), plate.points.empty() ? plate.screws.size() : 0) < 2)
    place.at("points").refuse(
        "has fewer than two points: add points on the bone, or 'screws', whose heads are points");
  if (plate.rounding_mm > 0.45 * plate.thickness_mm)
    place.at("rounding_mm")
        .refuse("is more than 0.45 of 'thickness_mm', so nothing of the sides would remain: make it smaller");
  if (plate.rounding_mm > 0.3 * plate.width_mm)
    place.at("rounding_mm")
        .refuse("is more than 0.3 of 'width_mm', so nothing of the outer face would remain: make it smaller");
  if (!(plate.bend_radius_mm >= 2.0 * plate.thickness_mm))
    place.at("bend_radius_mm")
        .refuse(
            "is less than twice 'thickness_mm', but a plate that is bent so sharply breaks, and its outer "
            "side would cross itself: make it larger");
  check_least_wall(plate.least_wall_mm, plate.thickness_mm, "thickness_mm", place);
  if (plate.least_wall_mm > plate.hole_wall_mm)
    place.at("least_wall_mm")
        .refuse("is more than 'hole_wall_mm', so walls beside holes would be cut off: make it smaller");
}

/// The distance in mm of a point from the border of an outline; negative if it lies outside.
double within_mm(const std::vector<glm::dvec2>& outline_mm, const glm::dvec2& p_mm) {
  double least_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline_mm.size(); ++i) {
    const glm::dvec2 &a = outline_mm[i], &b = outline_mm[(i + 1) % outline_mm.size()];
    least_mm = std::min(least_mm, glm::distance(p_mm, glm::mix(a, b, brep::share_along(p_mm, a, b))));
  }
  return voxel::contains({outline_mm}, p_mm) ? least_mm : -least_mm;
}

/// The axes of the screws. Throws std::runtime_error unless each screw starts at the planned bone, lies
/// within the band and leaves enough wall to the plate's side and to other holes.
std::vector<ScrewAxis> axes_of(const Plate& plate, const SettleBench& bench) {
  std::vector<ScrewAxis> axes;
  const brep::Solid& bone = bench.object(plate.object.name);
  for (const ObjectName& name : plate.screws) {
    const ScrewAxis axis = screw_axis(name.name, bench);
    std::uint32_t start = 0;
    if (const double off_mm = bone.tree().distance_mm(axis.head_mm, start); off_mm > screw_off_bone_mm)
      throw std::runtime_error(
          "the screw '" + name.name + "' lies " + three_figures(off_mm) + " mm off the surface of '" +
          plate.object.name +
          "': if the screw moves with a piece, name the object of the step that moved the screw");
    if (glm::dot(axis.along, plate.site.along) < std::cos(glm::radians(steepest_screw_deg)))
      throw std::runtime_error("the screw '" + name.name +
                               "' points more than 45 degrees off the direction in which the plate is put "
                               "on: turn the screw, or choose another 'side'");
    // The point at which the axis crosses the middle of the plate's thickness.
    const glm::dvec3 middle_mm = axis.head_mm - (plate.clearance_mm + 0.5 * plate.thickness_mm) * axis.along;
    const double wall_mm = within_mm(plate.site.base.outline_mm, plate.site.base.frame.project(middle_mm)) -
                           plate.hole_radius_mm(axis);
    if (wall_mm < plate.hole_wall_mm)
      throw std::runtime_error(
          "the hole of '" + name.name + "' leaves " +
          (wall_mm > 0.0 ? three_figures(wall_mm) + " mm of the plate beside it, less than the " +
                               three_figures(plate.hole_wall_mm) + " mm of 'hole_wall_mm'"
                         : std::string("no plate beside it")) +
          ": put 'points' at the screws, make the plate wider, or leave the screw out of 'screws'");
    for (const ScrewAxis& other : axes) {
      const glm::dvec3 apart_mm = axis.head_mm - other.head_mm;
      const glm::dvec3 across_mm = apart_mm - glm::dot(apart_mm, plate.site.along) * plate.site.along;
      const double between_mm =
          glm::length(across_mm) - plate.hole_radius_mm(axis) - plate.hole_radius_mm(other);
      if (between_mm < plate.hole_wall_mm)
        throw std::runtime_error("the holes of '" + other.screw + "' and '" + name.name + "' are " +
                                 three_figures(std::max(0.0, between_mm)) + " mm apart, less than the " +
                                 three_figures(plate.hole_wall_mm) +
                                 " mm of 'hole_wall_mm': move one of the screws");
    }
    axes.push_back(axis);
  }
  return axes;
}

/// Reports for each screw its planned axis, and its distances from objects that it must not touch: before its
/// motion, from its own step, and in its planned position.
void report_screws(const Plate& plate, const SettleBench& bench) {
  bench.details["screws"] = nlohmann::ordered_json::array();
  for (const ScrewAxis& axis : plate.axes) {
    const Object& screw = bench.objects.at(axis.screw);
    const Object& still = still_of(bench.objects, screw);
    nlohmann::ordered_json line{{"screw", axis.screw},
                                {"placed_by", still.id},
                                {"is_carried", still.id != axis.screw},
                                {"at_mm", to_json(axis.head_mm)},
                                {"along", to_json(axis.along)},
                                {"hole_mm", 2.0 * plate.hole_radius_mm(axis)},
                                {"clearances", nlohmann::ordered_json::array()}};
    if (const auto before = still.mesh.details.find("clearances"); before != still.mesh.details.end())
      for (nlohmann::ordered_json clear : *before) {
        clear["is_planned_place"] = false;
        line["clearances"].push_back(std::move(clear));
      }
    for (const ScrewClear& clear : clear_of_objects(axis, plate.away_from, bench)) {
      line["clearances"].push_back(to_json(clear));
      line["clearances"].back()["is_planned_place"] = true;
      if (std::string text = too_near("'" + axis.screw + "'", clear, plate.least_mm); !text.empty())
        bench.findings.push_back(std::move(text));
    }
    bench.details["screws"].push_back(std::move(line));
  }
  if (plate.axes.empty())
    bench.findings.push_back("the plate has no holes: name screws of the plan as 'screws'");
}

Plate settle(const Plate& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "plate_settle");
  Plate made = asked;
  SiteAsked site;
  site.bone = asked.object.name;
  site.side = asked.side;
  site.direction = asked.direction;
  for (const Mark& mark : asked.points) site.points_mm.push_back(mark_mm(mark, bench.objects));
  if (asked.points.empty())
    for (const ObjectName& name : asked.screws)
      site.points_mm.push_back(screw_axis(name.name, bench).head_mm);
  site.radius_mm = 0.5 * asked.width_mm;
  site.reach_mm = asked.reach_mm;
  site.before_mm = asked.thickness_mm + asked.clearance_mm + plate_room_mm;
  site.margin_mm = asked.bend_radius_mm + asked.thickness_mm + plate_room_mm;
  site.part = "plate";
  site.is_on_several = true;
  made.site = guide_site(site, bench);
  // The plate ends in half discs around the first and last point.
  Slab& base = made.site.base;
  const std::vector<glm::dvec2>& points_mm = base.frame.points_mm;
  base.outline_mm = round_band_outline(points_mm, asked.width_mm);
  made.ridge = base;
  made.ridge.outline_mm = round_band_outline(points_mm, asked.width_mm - 2.0 * asked.rounding_mm);
  try {
    static_cast<void>(base.solid());
    static_cast<void>(made.ridge.solid());
  } catch (const std::invalid_argument&) {
    throw std::runtime_error(
        "the plate along the points crosses itself: make it narrower, or choose points in their order along "
        "a line that bends less");
  }
  made.axes = axes_of(made, bench);
  bench.details = {{"direction", to_json(made.site.along)}, {"length_mm", curve_length_mm(points_mm)}};
  report_screws(made, bench);
  return made;
}

std::string definition(const Plate& plate, const Objects&) {
  return "plate of " + plain(plate.width_mm) + " x " + plain(plate.thickness_mm) + " mm on " +
         plate.object.name + " from " + plate.side + ", " + std::to_string(plate.axes.size()) + " holes";
}

/// The length of a screw's hole on either side of the screw's head. The hole passes through the plate even if
/// the plate bridges a gap there.
double through_mm(const Plate& plate) {
  return plate.clearance_mm + plate.thickness_mm + plate.bend_radius_mm + plate_room_mm;
}

/// The space behind the bone, grown by the bending radius and the clearance, and then shrunk by the radius.
/// It is correct only where it is used, within the plate's thickness around its band. Shrinking needs the
/// grown body only within the radius around that region. All points farther away count as grown, so distances
/// are only computed to the surface before the band.
voxel::Expression closed_about(const Plate& plate, const voxel::Expression& behind, const VoxelBench& bench) {
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  const double voxel_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const auto about_band = [&](double by_mm) {
    Slab about = plate.site.base;
    about.outline_mm = band_outline(longer_by(about.frame.points_mm, 0.5 * plate.width_mm + by_mm),
                                    plate.width_mm + 2.0 * by_mm);
    about.low_mm -= by_mm;
    about.high_mm += by_mm;
    return about.expression();
  };
  // Two more voxels, because distances next to a region's border are interpolated.
  const double wanted_mm = plate.thickness_mm + 2.0 * voxel_mm, reach_mm = wanted_mm + plate.bend_radius_mm;
  const voxel::Octree wanted = bench.combined(about_band(wanted_mm + 2.0 * voxel_mm)),
                      reached = bench.combined(about_band(reach_mm + 2.0 * voxel_mm));
  const voxel::Octree behind_voxels = bench.combined(behind);
  if (behind_voxels.is_empty()) return voxel::Expression(behind_voxels);
  const voxel::Expression big(voxel::offset_near(behind_voxels, bench.within_universe(behind),
                                                 plate.bend_radius_mm + plate.clearance_mm, reached,
                                                 bench.progress));
  const voxel::Expression all = big | ~about_band(reach_mm);
  return about_band(wanted_mm) &
         voxel::Expression(
             voxel::offset_near(bench.combined(all), all, -plate.bend_radius_mm, wanted, bench.progress));
}

void voxels(const Plate& plate, const VoxelBench& bench, VoxelSide& made) {
  made.lineage = "distances to the columns of the bone's octree";
  const VoxelSide& object = bench.object(plate.object.name);
  const voxel::Expression near = plate.site.near.expression();
  const voxel::Octree bone = bench.combined(voxel::Expression(object.octree) & near);
  const auto has_none = [&] {
    made.findings.push_back("no voxel lies within the plate: choose smaller voxels");
    made.octree = voxel::Octree::empty(bench.universe);
    made.symbol = voxel::Expression(made.octree);
  };
  if (bone.is_empty()) return has_none();
  const Stopwatch watch(bench.timings, "plate_voxel");
  const auto grown = [&](const voxel::Expression& solid, double by_mm) {
    const voxel::Octree octree = bench.combined(solid);
    if (octree.is_empty()) return voxel::Expression(octree);
    return voxel::Expression(voxel::offset(octree, bench.within_universe(solid), by_mm, bench.progress));
  };
  const voxel::Expression behind(voxel::shadow(bone, bench.within_universe(*object.symbol & near),
                                               {plate.site.along, plate.site.end_mm, bench.progress})
                                     .window);
  const voxel::Expression closed = closed_about(plate, behind, bench);
  const voxel::Expression ridge = grown(closed, plate.flat_mm()) & plate.ridge.expression();
  voxel::Expression whole = grown(ridge, plate.rounding_mm) - closed;
  for (const ScrewAxis& axis : plate.axes) {
    const glm::dvec3 by_mm = through_mm(plate) * axis.along;
    whole = whole - voxel::Expression(voxel::Cylinder{axis.head_mm - by_mm, axis.head_mm + by_mm,
                                                      plate.hole_radius_mm(axis)});
  }
  keep_largest(thick_part(whole, plate.least_wall_mm, bench), bench, made);
  if (made.octree.is_empty()) has_none();
}

/// The gap between a plate and the bone, over the part of the plate's surface that faces the bone.
struct FitGap {
  double mean_mm = 0.0, largest_mm = 0.0;
  glm::dvec3 largest_at_mm{0.0};
};

std::optional<FitGap> mesh_gap(const brep::Solid& plate, const glm::dvec3& along, const brep::Solid& bone) {
  const brep::Triangles& surface = plate.triangles();
  std::vector<glm::dvec3> places_mm;
  std::vector<double> area_mm2;
  for (const auto& face : surface.faces) {
    const glm::dvec3 &a = surface.points_mm[face[0]], &b = surface.points_mm[face[1]],
                     &c = surface.points_mm[face[2]];
    const glm::dvec3 doubled = glm::cross(b - a, c - a);
    if (!(glm::dot(doubled, along) > faces_bone * glm::length(doubled))) continue;
    places_mm.push_back((a + b + c) / 3.0);
    area_mm2.push_back(0.5 * glm::length(doubled));
  }
  if (places_mm.empty()) return std::nullopt;
  const std::vector<double> gaps_mm = bone.tree().distances_mm(places_mm);
  FitGap gap;
  double all_mm2 = 0.0;
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    gap.mean_mm += gaps_mm[i] * area_mm2[i];
    all_mm2 += area_mm2[i];
    if (gaps_mm[i] > gap.largest_mm) {
      gap.largest_mm = gaps_mm[i];
      gap.largest_at_mm = places_mm[i];
    }
  }
  gap.mean_mm /= all_mm2;
  return gap;
}

/// The gap computed from points at which the surfaces of both objects cross the lattice's lines.
std::optional<FitGap> voxel_gap(const VoxelSide& plate, const glm::dvec3& along, const VoxelSide& bone,
                                const voxel::Expression& near, const voxel::Universe& universe) {
  const voxel::Expression world(voxel::bounds(universe.lattice()));
  const auto crossings_of = [&](const voxel::Octree& octree, const voxel::Expression& solid) {
    std::vector<glm::dvec3> found = voxel::SurfaceCrossings(octree, solid & world).points();
    for (glm::dvec3& p : found) p = glm::dvec3(universe.lps_from_voxel * glm::dvec4(p, 1.0));
    return found;
  };
  const glm::dmat4 voxel_from_lps = glm::inverse(universe.lps_from_voxel);
  const double beyond_mm = std::max({universe.lattice().spacing_mm().x, universe.lattice().spacing_mm().y,
                                     universe.lattice().spacing_mm().z});
  const auto is_plate = [&](const glm::dvec3& p_mm) {
    const glm::ivec3 voxel(glm::round(glm::dvec3(voxel_from_lps * glm::dvec4(p_mm, 1.0))));
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, glm::ivec3(universe.side()))) && plate.octree.contains(voxel);
  };
  std::vector<glm::dvec3> facing;
  for (const glm::dvec3& p_mm : crossings_of(plate.octree, *plate.symbol))
    if (is_plate(p_mm - beyond_mm * along) && !is_plate(p_mm + beyond_mm * along)) facing.push_back(p_mm);
  const voxel::Octree beside = voxel::combine(universe, voxel::Expression(bone.octree) & near);
  if (facing.empty() || beside.is_empty()) return std::nullopt;
  const std::vector<glm::dvec3> surface = crossings_of(beside, *bone.symbol & near);
  constexpr std::size_t most = 2000;  // each point of the plate is compared with all crossings of the bone
  const std::size_t step = std::max<std::size_t>(1, facing.size() / most);
  std::vector<glm::dvec3> places_mm;
  for (std::size_t i = 0; i < facing.size(); i += step) places_mm.push_back(facing[i]);
  std::vector<double> least_mm2(places_mm.size(), std::numeric_limits<double>::infinity());
  tbb::parallel_for(std::size_t{0}, places_mm.size(), [&](std::size_t i) {
    for (const glm::dvec3& q_mm : surface) {
      const glm::dvec3 between = q_mm - places_mm[i];
      least_mm2[i] = std::min(least_mm2[i], glm::dot(between, between));
    }
  });
  FitGap gap;
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    const double mm = std::sqrt(least_mm2[i]);
    gap.mean_mm += mm / static_cast<double>(places_mm.size());
    if (mm > gap.largest_mm) {
      gap.largest_mm = mm;
      gap.largest_at_mm = places_mm[i];
    }
  }
  return gap;
}

void triangles(const Plate& plate, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "plate");
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  const auto grown = [&](const brep::Solid& solid, double by_mm, double cell_mm) {
    const Stopwatch part(bench.timings, "plate_offset");
    return brep::offset(solid, {by_mm, cell_mm, progress});
  };
  made.lineage = "level sets of the distance to the bone's exact shadow";
  const brep::Solid bone = noted(plate.site.bone, made);
  if (bone.empty())
    throw std::runtime_error("no bone of the mesh lies along the plate: move 'points' onto the bone");
  const brep::Solid behind = brep::shadow(bone, {plate.site.along, plate.site.end_mm, progress}).solid;
  const brep::Solid big = grown(behind, plate.bend_radius_mm + plate.clearance_mm, grown_cell_mm(plate));
  if (big.empty())
    throw std::runtime_error("no bone of the mesh lies along the plate: move 'points' onto the bone");
  // Shrinks `big` by the radius. Points of `big` that lie at most that deep are outside of the bone, and
  // their depth determines their distance from it.
  const brep::Level closed{big, -plate.bend_radius_mm};
  // The ridge ends below the bone's surface, deeper than its rounding extends.
  const brep::LevelBody ridge_body{
      {{{big, plate.flat_mm() - plate.bend_radius_mm}, {plate.ridge.solid(), 0.0}}},
      {{big, -plate.bend_radius_mm - plate.rounding_mm - plate_room_mm}}};
  const brep::Solid ridge = [&] {
    const Stopwatch part(bench.timings, "plate_offset");
    return brep::core_of(ridge_body, {0.0, plate_outer_cell_mm, progress});
  }();
  if (ridge.empty())
    throw std::runtime_error("no bone of the mesh lies along the plate: move 'points' onto the bone");
  brep::LevelBody body{{{{ridge, plate.rounding_mm}}}, {closed}};
  for (const ScrewAxis& axis : plate.axes) {
    const glm::dvec3 by_mm = through_mm(plate) * axis.along;
    body.without.push_back(
        {rod(axis.head_mm - by_mm, axis.head_mm + by_mm, plate.hole_radius_mm(axis)), 0.0});
  }
  made.whole = thick_part(body, {plate.least_wall_mm}, "plate", bench, made);
  if (made.whole->empty()) throw std::runtime_error("nothing of the plate remains: make it thicker");
  made.details["holes"] = nlohmann::ordered_json::array();
  constexpr double goal_mm = 0.01;
  for (const ScrewAxis& axis : plate.axes) {
    const std::optional<double> off_mm = hole_off_mm(*made.whole, axis, plate.hole_radius_mm(axis));
    made.details["holes"].push_back({{"screw", axis.screw}, {"off_axis_mm", nullptr}, {"goal_mm", goal_mm}});
    if (off_mm) made.details["holes"].back()["off_axis_mm"] = *off_mm;
    if (!off_mm)
      made.findings.push_back(
          "the plate has no hole for '" + axis.screw +
          "', because the hole lies in a separate piece that was left out: put 'points' on bone");
    else if (*off_mm > goal_mm)
      made.findings.push_back("the hole of '" + axis.screw + "' lies " + three_figures(*off_mm) +
                              " mm off its axis, more than 0.01 mm");
  }
  if (const std::optional<FitGap> gap = mesh_gap(*made.whole, plate.site.along, bone))
    made.details["gap"] = {{"mean_mm", gap->mean_mm},
                           {"mean_half_width_mm", nullptr},
                           {"largest_mm", gap->largest_mm},
                           {"largest_half_width_mm", nullptr},
                           {"voxel_mean_mm", nullptr},
                           {"voxel_largest_mm", nullptr},
                           {"largest_at_mm", to_json(gap->largest_at_mm)}};
}

/// Computes the half-widths of the gaps: the difference between both kernels, plus the noise of digitised
/// surfaces, which is a tenth of a voxel.
void bound_gap(const Plate& plate, const BoundBench& bench, const Object& bone, Object& made) {
  const auto json = made.mesh.details.find("gap");
  if (json == made.mesh.details.end() || !made.voxel.symbol || made.voxel.octree.is_empty() ||
      !bone.voxel.symbol)
    return;
  const std::optional<FitGap> gap =
      voxel_gap(made.voxel, plate.site.along, bone.voxel, plate.site.near.expression(), bench.universe);
  if (!gap) return;
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  const double noise_mm = 0.1 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  nlohmann::ordered_json& details = *json;
  details["voxel_mean_mm"] = gap->mean_mm;
  details["voxel_largest_mm"] = gap->largest_mm;
  details["mean_half_width_mm"] = noise_mm + std::abs(gap->mean_mm - details["mean_mm"].get<double>());
  details["largest_half_width_mm"] =
      noise_mm + std::abs(gap->largest_mm - details["largest_mm"].get<double>());
}

void bound(const Plate& plate, const BoundBench& bench, Object& made) {
  const Object& bone = bench.objects.at(plate.object.name);
  inherit(bone, made);
  if (bone.mesh.whole && made.mesh.whole && !made.mesh.whole->empty()) {
    const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
    // Bone that is hidden behind other bone has no effect, because the shadow is grown, not the bone.
    // Shrinking it again by the radius moves no point of the surface by more than the error of the grown
    // surface.
    const voxel::Octree near =
        voxel::combine(bench.universe, voxel::Expression(bone.voxel.octree) & plate.site.near.expression());
    const voxel::Octree behind =
        near.is_empty()
            ? near
            : voxel::combine(bench.universe,
                             voxel::Expression(voxel::shadow(near, voxel::Expression(near),
                                                             {plate.site.along, plate.site.end_mm, {}})
                                                   .window));
    const brep::Solid mesh_behind =
        brep::shadow(plate.site.bone.solid, {plate.site.along, plate.site.end_mm, {}}).solid;
    double apart_mm =
        verify::offset_allowance_mm({bone.witness, behind, mesh_behind, is_whole_voxels(bone.voxel)},
                                    {plate.bend_radius_mm + plate.clearance_mm, grown_cell_mm(plate)},
                                    made.mesh.whole->measures().area_mm2);
    // Later offsets start from smooth surfaces, whose triangles deviate by a third of the tolerance on
    // average.
    apart_mm += brep::offset_tolerance_mm({plate.rounding_mm, plate_outer_cell_mm, {}}) / 3.0 +
                thick_part_allowance_mm({plate.least_wall_mm});
    if (is_whole_voxels(bone.voxel)) apart_mm += 0.5 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    made.bound.measured_apart_mm += apart_mm;
    made.bound.reshaped.push_back(bone.id);
    bound_gap(plate, bench, bone, made);
  }
  const std::vector<CutPlane> sides = planes_of(plate.site.base.sides());
  made.bound.planes.insert(made.bound.planes.end(), sides.begin(), sides.end());
  made.shared_values.push_back("the band, the insertion direction and the screws' axes");
  made.ends_with_universe = true;
}

}  // namespace

Operation plate_operation() {
  return Describe<Plate>("plate",
                         "Makes a plate along a curve on the planned bone, with holes for its screws.",
                         Makes::Object)
      .takes(field("object", &Plate::object, "The planned bone, with its pieces in their planned positions.")
                 .required()
                 .positional("bone"))
      .takes(field("side", &Plate::side,
                   "The side from which the surgeon puts the plate on, relative to the head's position: "
                   "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees.")
                 .required())
      .takes(field("direction", &Plate::direction,
                   "The direction in which the plate is put on, LPS. Default: straight from the side.")
                 .direction())
      .takes(field("points", &Plate::points,
                   "Two or more points on the bone, in their order along the plate: [x, y, z] or landmarks. "
                   "The plate ends in half discs around the first and the last. Default: the heads of the "
                   "screws, in their order."))
      .takes(field("width_mm", &Plate::width_mm, "The plate's width.").from(3.0).to(20.0))
      .takes(field("thickness_mm", &Plate::thickness_mm,
                   "The plate's thickness; 2.5 is usual for plates that carry the jaw's load.")
                 .from(0.8)
                 .to(6.0))
      .takes(
          field(
              "bend_radius_mm", &Plate::bend_radius_mm,
              "The smallest radius of hollows that the plate follows. It bridges narrower hollows and gaps. "
              "The radius must be at least twice the thickness; 10 is four times the usual thickness.")
              .from(2.0)
              .to(60.0))
      .takes(field("clearance_mm", &Plate::clearance_mm,
                   "The gap between plate and bone where the plate follows the bone; 0.2 exceeds a printer's "
                   "error of 0.16.")
                 .from(0.05)
                 .to(2.0))
      .takes(field("rounding_mm", &Plate::rounding_mm,
                   "The radius of the rounded outer edges; 0.8 is a third of the usual thickness.")
                 .from(0.2)
                 .to(2.5))
      .takes(field("reach_mm", &Plate::reach_mm,
                   "The distance to which the plate extends behind the foremost bone, along its insertion "
                   "direction; 25 extends from the piriform rim to the buttress.")
                 .from(2.0)
                 .to(150.0))
      .takes(field("screws", &Plate::screws,
                   "Screws of this plan in their planned positions, moved with their pieces. The plate has a "
                   "hole for each.")
                 .in_plans_only())
      .takes(field("play_mm", &Plate::play_mm,
                   "The play of a screw: its hole is wider than the screw by this much; 0.2 exceeds a "
                   "printer's error of 0.16.")
                 .from(0.0)
                 .to(1.0))
      .takes(field("hole_wall_mm", &Plate::hole_wall_mm,
                   "The least wall between a hole and the plate's side or another hole; 1 exceeds the "
                   "default of 'least_wall_mm'.")
                 .from(0.5)
                 .to(5.0))
      .takes(field("away_from", &Plate::away_from,
                   "Objects in their planned positions that the screws must not touch, such as roots or the "
                   "nerve's canal.")
                 .in_plans_only())
      .takes(field("least_mm", &Plate::least_mm,
                   "The least distance from the screws to 'away_from'; a smaller distance is a finding. 1 is "
                   "published for screws between roots.")
                 .from(0.0)
                 .to(20.0))
      .takes(least_wall(&Plate::least_wall_mm))
      .example(R"({"id": "left_plate", "do": "plate", "object": "advanced", "side": "anterior",
        "points": [[18, -82, -36], [18, -82, -20]], "screws": ["left_1"]})")
      .on_files("octotomy plate bone.stl --side anterior --points 18,-82,-36 18,-82,-20 -o plate.stl")
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
