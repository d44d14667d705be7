// SPDX-License-Identifier: AGPL-3.0-or-later
// A guide for saw and drill on the surface of a bone.
//
// 1 The region, about points or drawn, and the way in which the guide is put on, from the side that the
//   surgeon reaches (guide_site.h). The slots follow from the plan's cuts (guide_slots.h), sleeves from its
//   screws.
// 2 The bone near the region, grown by the clearance, and all that lies behind it along that way: no part of
//   the guide may lie there. Where there is no undercut, the fitting surface is that of the grown bone.
// 3 The region's bone grown by clearance and thickness, so that the guide's rim is round. Walls about each
//   slot extend as far before the bone as the slot is deep: they lie within the shadow of 2 after it is moved
//   back along the saw. A rod for each sleeve. Edges of the walls are rounded.
// 4 3 minus 2, minus slots and holes. Only the part that is covered by balls within it as wide as the least
//   wall: slots and holes leave slivers at the edges of the bone, which no printer makes.
// 5 The largest piece, with points that files for printers can hold.
//
// The mesh kernel does 3 and 4 without Booleans, on distances to the surfaces (brep/shape/level_body.h). The
// voxel kernel combines windows of distances.
// 1 is settled once and is a shared value of both kernels.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <stdexcept>

#include "brep/measure/gap.h"
#include "brep/shape/level_body.h"
#include "brep/shape/shadow.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/part/guide_site.h"
#include "planner/operation/part/guide_slots.h"
#include "planner/operation/part/printed_part.h"
#include "planner/operation/part/screw.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "voxel/filter/offset.h"
#include "voxel/filter/shadow.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

/// A sleeve around the axis of a screw. The drill passes through it.
struct Sleeve {
  ScrewAxis axis;
  glm::dvec3 outer_mm{0.0};  ///< centre of its outer end

  glm::dvec3 through_mm(double by_mm) const { return axis.head_mm + by_mm * axis.along; }
};

struct Guide {
  ObjectName object;
  std::string side;
  std::optional<glm::dvec3> direction;
  std::vector<Mark> points;
  double radius_mm = 10.0;
  std::optional<double> ends_mm;
  std::optional<DrawnSite> region;
  double reach_mm = 25.0;
  double clearance_mm = 0.25, thickness_mm = 3.0;
  std::vector<ObjectName> cuts;
  double kerf_mm = 1.0, play_mm = 0.2, slot_depth_mm = 15.0, slot_wall_mm = 2.0, slot_end_mm = 4.0,
         rounding_mm = 1.0;
  std::string slot_form = "closed";
  std::vector<ObjectName> screws;
  double drill_mm = 1.5, sleeve_wall_mm = 1.5, sleeve_height_mm = 6.0;
  double least_wall_mm = 0.8;
  // Settled.
  GuideSite site;
  std::vector<SawSlot> slots;
  std::vector<Sleeve> sleeves;

  double slot_width_mm(const SawSlot& slot) const { return slot.kerf_mm + play_mm; }
  double walls_width_mm(const SawSlot& slot) const { return slot_width_mm(slot) + 2.0 * slot_wall_mm; }
  double hole_radius_mm() const { return 0.5 * (drill_mm + play_mm); }
  double sleeve_radius_mm() const { return hole_radius_mm() + sleeve_wall_mm; }
};

/// Cell size of the mesh's level sets. The centres of the balls and the final surface each lie within a 16th
/// of a cell. Together they deviate by at most an eighth of a millimetre, which is less than a printer's
/// error of 0.16 mm; the mean deviation is a third of that.
constexpr double guide_cell_mm = 1.0;
/// Bone within this distance beside the region is used, in addition to what the guide needs.
constexpr double room_mm = 1.0;
/// Rods and holes extend this far below the bone's surface, because a screw's point may lie slightly off the
/// surface.
constexpr double below_mm = 5.0;

void check(const Guide& guide, const FieldLocation& place) {
  if (!guide.points.empty() && guide.region)
    place.refuse("states its region twice, as 'points' and 'region': keep one of them");
  if (guide.points.empty() && !guide.region && guide.screws.empty())
    place.refuse(
        "the region is missing: add 'points' on the bone, 'region', drawn in a view, or 'screws', whose "
        "heads are points");
  if (guide.region && guide.region->polygons_mm.size() != 1)
    place.at("region").refuse("must have exactly one polygon, because a guide is one piece");
  const auto check_view = [&](const std::string& view, const FieldLocation& at) {
    try {
      voxel::parse_view(view);
    } catch (const voxel::InvalidInput& error) {
      at.refuse(error.what());
    }
  };
  check_view(guide.side, place.at("side"));
  if (guide.region) check_view(guide.region->view, place.at("region").at("view"));
  if (guide.rounding_mm > 0.9 * guide.slot_wall_mm)
    place.at("rounding_mm")
        .refuse("is more than 0.9 of 'slot_wall_mm', so rounding would cut off the walls: make it smaller");
  check_least_wall(guide.least_wall_mm, guide.thickness_mm, "thickness_mm", place);
  check_least_wall(guide.least_wall_mm, guide.slot_wall_mm, "slot_wall_mm", place);
  check_least_wall(guide.least_wall_mm, guide.sleeve_wall_mm, "sleeve_wall_mm", place);
  if (place.scope == nullptr) return;
  for (std::size_t i = 0; i < guide.cuts.size(); ++i) {
    const std::string& maker = place.scope->maker_of(guide.cuts[i].name).name;
    if (maker != "saw" && maker != "mask" && maker != "flap_space")
      place.at("cuts[" + std::to_string(i) + "]")
          .refuse("'" + guide.cuts[i].name + "' was made by '" + maker +
                  "': name a saw step, a mask whose walls are cuts or a flap's space");
  }
}

/// Computes the sleeves. Throws std::runtime_error unless each lies within the region and beside all slots.
std::vector<Sleeve> sleeves_of(const Guide& guide, const SettleBench& bench) {
  std::vector<Sleeve> sleeves;
  for (const ObjectName& name : guide.screws) {
    Sleeve sleeve{screw_axis(name.name, bench), {}};
    sleeve.outer_mm = sleeve.through_mm(-guide.sleeve_height_mm);
    const std::string says = "the sleeve of '" + name.name + "' ";
    if (!voxel::contains({guide.site.base.outline_mm}, guide.site.base.frame.project(sleeve.axis.head_mm)))
      throw std::runtime_error(says +
                               "lies beside the guide's region: make the region larger, or leave it "
                               "out of 'screws'");
    if (glm::dot(sleeve.axis.along, guide.site.along) < 0.5)
      throw std::runtime_error(says +
                               "points more than 60 degrees off the guide's insertion direction: turn the "
                               "screw, or choose another 'side'");
    const brep::Solid body = rod(sleeve.outer_mm, sleeve.axis.head_mm, guide.sleeve_radius_mm());
    for (const SawSlot& slot : guide.slots) {
      const brep::Solid opening = slot.opening.solid(guide.slot_width_mm(slot));
      if (opening.tree().is_inside(sleeve.axis.head_mm) ||
          brep::gap(body.triangles(), opening.triangles()).distance_mm <= 0.0)
        throw std::runtime_error(
            says + "runs through the slot of '" + slot.cut + "': move the screw at least " +
            three_figures(guide.sleeve_radius_mm() + 0.5 * guide.slot_width_mm(slot)) + " mm off the cut");
    }
    sleeves.push_back(std::move(sleeve));
  }
  return sleeves;
}

Guide settle(const Guide& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "guide_settle");
  Guide made = asked;
  std::vector<glm::dvec3> points_mm;
  for (const Mark& mark : asked.points) points_mm.push_back(mark_mm(mark, bench.objects));
  if (points_mm.empty() && !asked.region)
    for (const ObjectName& name : asked.screws) points_mm.push_back(screw_axis(name.name, bench).head_mm);
  const double shell_mm = asked.clearance_mm + asked.thickness_mm;
  const double before_mm =
      shell_mm + room_mm +
      std::max(asked.cuts.empty() ? 0.0 : asked.slot_depth_mm,
               asked.screws.empty() ? 0.0 : asked.sleeve_height_mm + asked.sleeve_wall_mm);
  made.site = guide_site({asked.object.name, asked.side, asked.direction, points_mm, asked.radius_mm,
                          asked.ends_mm, asked.region, asked.reach_mm, before_mm, shell_mm + room_mm},
                         bench);
  const GuideSite& site = made.site;
  const SlotsAsked slots{site.base,
                         site.along,
                         [&site](const glm::dvec2& p_mm) { return site.bone_at(p_mm); },
                         asked.kerf_mm,
                         asked.slot_end_mm,
                         asked.slot_form == "three_sided",
                         asked.slot_depth_mm + shell_mm + room_mm};
  for (const ObjectName& cut : asked.cuts)
    for (SawSlot& slot : slots_of(cut.name, slots, bench)) made.slots.push_back(std::move(slot));
  made.sleeves = sleeves_of(made, bench);
  bench.details = {{"direction", to_json(site.along)},
                   {"slots", nlohmann::ordered_json::array()},
                   {"sleeves", nlohmann::ordered_json::array()}};
  for (const SawSlot& slot : made.slots)
    bench.details["slots"].push_back({{"cut", slot.cut},
                                      {"width_mm", made.slot_width_mm(slot)},
                                      {"length_mm", slot.length_mm},
                                      {"depth_mm", asked.slot_depth_mm},
                                      {"goes_in", to_json(slot.goes_in)}});
  for (const Sleeve& sleeve : made.sleeves)
    bench.details["sleeves"].push_back({{"screw", sleeve.axis.screw},
                                        {"hole_mm", 2.0 * made.hole_radius_mm()},
                                        {"at_mm", to_json(sleeve.axis.head_mm)},
                                        {"along", to_json(sleeve.axis.along)}});
  return made;
}

std::string definition(const Guide& guide, const Objects&) {
  return "guide on " + guide.object.name + " from " + guide.side + ", " + std::to_string(guide.slots.size()) +
         " slots, " + std::to_string(guide.sleeves.size()) + " sleeves";
}

/// The position along the insertion direction at which the bone's shadow ends. Moved back by the depth of a
/// slot, the shadow bounds the slot's walls. It must then still end behind the region, so that the walls meet
/// the base everywhere.
double shadow_end_mm(const Guide& guide) {
  return guide.site.end_mm + (guide.slots.empty() ? 0.0 : guide.slot_depth_mm);
}

/// The motion along the saw's direction by which the space behind the bone becomes the space behind a slot's
/// outer rim.
glm::dmat4 to_rim(const Guide& guide, const SawSlot& slot) {
  return glm::translate(glm::dmat4(1.0), -guide.slot_depth_mm * slot.goes_in);
}

voxel::Expression rod_of(const glm::dvec3& from_mm, const glm::dvec3& to_mm, double radius_mm) {
  return voxel::Expression(voxel::Cylinder{from_mm, to_mm, radius_mm});
}

/// The length by which a drill's hole extends beyond a sleeve's outer end and below the bone.
double beyond_mm(const Guide& guide) {
  return guide.clearance_mm + guide.thickness_mm + guide.sleeve_height_mm + room_mm;
}

void voxels(const Guide& guide, const VoxelBench& bench, VoxelSide& made) {
  made.lineage = "distances to the octree of the bone, and its columns";
  const VoxelSide& object = bench.object(guide.object.name);
  const voxel::Expression near = guide.site.near.expression();
  const voxel::Octree bone = bench.combined(voxel::Expression(object.octree) & near);
  const voxel::Expression nothing(voxel::Octree::empty(bench.universe));
  const auto has_none = [&] {
    made.findings.push_back("no voxel lies within the guide's walls: choose smaller voxels");
    made.octree = voxel::Octree::empty(bench.universe);
    made.symbol = nothing;
  };
  if (bone.is_empty()) return has_none();
  const Stopwatch watch(bench.timings, "guide_voxel");
  const voxel::Expression solid = bench.within_universe(*object.symbol & near);
  const voxel::Expression grown(voxel::offset(bone, solid, guide.clearance_mm, bench.progress));
  const voxel::Expression taken(
      voxel::shadow(bench.combined(grown), grown, {guide.site.along, shadow_end_mm(guide), bench.progress})
          .window);
  const voxel::Expression base = guide.site.base.expression();
  const voxel::Octree patch = bench.combined(voxel::Expression(bone) & base);
  if (patch.is_empty()) return has_none();
  voxel::Expression whole(
      voxel::offset(patch, solid & base, guide.clearance_mm + guide.thickness_mm, bench.progress));
  for (const SawSlot& slot : guide.slots)
    whole = whole | rounded(slot.walls.expression(guide.walls_width_mm(slot)) & base &
                                moved(taken, to_rim(guide, slot)),
                            guide.rounding_mm, bench);
  for (const Sleeve& sleeve : guide.sleeves)
    whole = whole | rod_of(sleeve.outer_mm, sleeve.through_mm(below_mm), guide.sleeve_radius_mm());
  whole = whole - (taken | grown);
  for (const SawSlot& slot : guide.slots) whole = whole - slot.opening.expression(guide.slot_width_mm(slot));
  for (const Sleeve& sleeve : guide.sleeves)
    whole = whole - rod_of(sleeve.through_mm(-beyond_mm(guide)), sleeve.through_mm(beyond_mm(guide)),
                           guide.hole_radius_mm());
  keep_largest(thick_part(whole, guide.least_wall_mm, bench), bench, made);
  if (made.octree.is_empty()) has_none();
}

void triangles(const Guide& guide, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "guide");
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  made.lineage = "level sets of the distance to the bone, less their exact shadow";
  const brep::Solid bone = noted(guide.site.bone, made);
  if (bone.empty()) throw std::runtime_error("the region contains no bone of the mesh: draw it on the bone");
  const auto timed = [&](const char* stage, const auto& work) {
    const Stopwatch part(bench.timings, stage);
    return work();
  };
  // The shadow is computed first and then grown, because it has fewer triangles than the bone and the result
  // is the same.
  const brep::Level taken{
      timed("guide_shadow",
            [&] {
              return brep::shadow(bone, {guide.site.along, shadow_end_mm(guide), progress}).solid;
            }),
      guide.clearance_mm};
  const brep::Solid base = guide.site.base.solid();
  const brep::Solid patch =
      noted(brep::boolean(bone, brep::Operation::Intersection, base, bench.progress.stop), made);
  if (patch.empty()) throw std::runtime_error("the region contains no bone of the mesh: draw it on the bone");
  brep::LevelBody body;
  body.without.push_back(taken);
  for (const SawSlot& slot : guide.slots) {
    const brep::LevelBody walls{{{{slot.walls.solid(guide.walls_width_mm(slot)), 0.0},
                                  {base, 0.0},
                                  {brep::moved(taken.solid, to_rim(guide, slot)), taken.by_mm}}},
                                {}};
    const brep::Solid core = timed("guide_rounding", [&] {
      return brep::core_of(walls, {-guide.rounding_mm, guide.rounding_mm, progress});
    });
    if (!core.empty()) body.parts.push_back({{core, guide.rounding_mm}});
    body.without.push_back({slot.opening.solid(guide.slot_width_mm(slot)), 0.0});
  }
  std::vector<brep::Level> holes;
  for (const Sleeve& sleeve : guide.sleeves) {
    body.parts.push_back(
        {{rod(sleeve.outer_mm, sleeve.through_mm(below_mm), guide.sleeve_radius_mm()), 0.0}});
    holes.push_back({rod(sleeve.through_mm(-beyond_mm(guide)), sleeve.through_mm(beyond_mm(guide)),
                         guide.hole_radius_mm()),
                     0.0});
  }
  body.without.insert(body.without.end(), holes.begin(), holes.end());
  body.parts.push_back({{patch, guide.clearance_mm + guide.thickness_mm}});
  made.whole = thick_part(body, {guide.least_wall_mm, guide_cell_mm, holes}, "guide", bench, made);
  if (made.whole->empty()) throw std::runtime_error("nothing of the guide remains: make the region larger");
  made.details["holes"] = nlohmann::ordered_json::array();
  for (const Sleeve& sleeve : guide.sleeves) {
    const std::optional<double> off_mm = hole_off_mm(*made.whole, sleeve.axis, guide.hole_radius_mm());
    made.details["holes"].push_back({{"screw", sleeve.axis.screw}, {"off_axis_mm", nullptr}});
    if (off_mm)
      made.details["holes"].back()["off_axis_mm"] = *off_mm;
    else
      made.findings.push_back(
          "the guide has no hole for '" + sleeve.axis.screw +
          "', because its sleeve is on a piece that was left out: make the region larger");
  }
}

void bound(const Guide& guide, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(guide.object.name);
  inherit(object, made);
  if (object.mesh.whole && made.mesh.whole && !made.mesh.whole->empty()) {
    const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
    // In the mesh kernel, distances are exact up to the last surface. Only thick_part(), which makes that
    // surface, adds an error.
    double apart_mm =
        verify::offset_allowance_mm({object.witness,
                                     voxel::combine(bench.universe, voxel::Expression(object.voxel.octree) &
                                                                        guide.site.near.expression()),
                                     guide.site.bone.solid, is_whole_voxels(object.voxel)},
                                    {guide.clearance_mm, 0.0}, made.mesh.whole->measures().area_mm2) +
        thick_part_allowance_mm({guide.least_wall_mm, guide_cell_mm});
    if (is_whole_voxels(object.voxel)) apart_mm += 0.5 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    made.bound.measured_apart_mm += apart_mm;
    made.bound.reshaped.push_back(object.id);
  }
  const auto add = [&](const voxel::RegionMask& sides) {
    const std::vector<CutPlane> planes = planes_of(sides);
    made.bound.planes.insert(made.bound.planes.end(), planes.begin(), planes.end());
  };
  add(guide.site.base.sides());
  for (const SawSlot& slot : guide.slots) {
    add(slot.opening.sides(guide.slot_width_mm(slot)));
    add(slot.walls.sides(guide.walls_width_mm(slot)));
  }
  made.shared_values.push_back("the region, the insertion direction, slots and sleeves");
  made.ends_with_universe = true;
}

}  // namespace

Operation guide_operation() {
  return Describe<Guide>("guide", "Makes a guide for saw and drill that fits onto a region of a bone.",
                         Makes::Object)
      .takes(field("object", &Guide::object, "The bone, before it is cut.").required().positional("bone"))
      .takes(field("side", &Guide::side,
                   "The side from which the surgeon reaches the bone, relative to the head's position: "
                   "anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees.")
                 .required())
      .takes(field("direction", &Guide::direction,
                   "The direction in which the guide is put on, LPS. Default: straight from the side.")
                 .direction())
      .takes(field("points", &Guide::points,
                   "Points on the bone, in their order along it: [x, y, z] or landmarks. The guide covers "
                   "the bone around them. Default, without a region: the heads of the screws."))
      .takes(field("radius_mm", &Guide::radius_mm,
                   "The distance to which the guide extends on either side of the line through the points.")
                 .from(3.0)
                 .to(60.0)
                 .read_if<Guide>([](const Guide& guide) { return !guide.region; },
                                 "applies only to 'points': leave it out"))
      .takes(field("ends_mm", &Guide::ends_mm,
                   "The distance to which the guide extends beyond the first and the last of several points. "
                   "Default: the radius.")
                 .from(0.0)
                 .to(60.0)
                 .read_if<Guide>(
                     [](const Guide& guide) {
                       return !guide.region &&
                              (guide.points.empty() ? guide.screws.size() : guide.points.size()) > 1;
                     },
                     "applies only to several points or screws: leave it out"))
      .takes(record("region", &Guide::region, "A region drawn in a view, instead of the points.",
                    {field("view", &DrawnSite::view, "The view in which the region is drawn.").required(),
                     field("polygons_mm", &DrawnSite::polygons_mm,
                           "One closed polygon of points [u, v] in the view's millimetres.")
                         .required()})
                 .in_plans_only())
      .takes(field("reach_mm", &Guide::reach_mm,
                   "The distance to which the guide extends behind the region's foremost bone; 25 extends "
                   "from the piriform rim to the buttress.")
                 .from(2.0)
                 .to(150.0))
      .takes(field("clearance_mm", &Guide::clearance_mm,
                   "The gap between guide and bone; 0.25 is usual for resin, 0.4 for filament.")
                 .from(0.05)
                 .to(2.0))
      .takes(field("thickness_mm", &Guide::thickness_mm,
                   "The thickness of the base; 3 is usual, and 1 is the least that is stiff enough to guide "
                   "a saw.")
                 .from(1.0)
                 .to(10.0))
      .takes(field("cuts", &Guide::cuts,
                   "Saw steps, masks and spaces of flaps in this plan whose cuts get slots. A mask gets "
                   "slots at its walls that cut bone in the region, a flap's segment at both of its cuts, "
                   "and a resection at its cuts in the region.")
                 .in_plans_only())
      .takes(field("kerf_mm", &Guide::kerf_mm,
                   "The width of the saw's cut for masks, which do not state one as saw steps do.")
                 .from(0.1)
                 .to(5.0))
      .takes(field("play_mm", &Guide::play_mm,
                   "The play: slots are wider than the kerf, and holes wider than the drill, by this much, "
                   "so that saw and drill run freely; 0.2 exceeds a printer's error of 0.16.")
                 .from(0.0)
                 .to(1.0))
      .takes(
          field("slot_depth_mm", &Guide::slot_depth_mm,
                "The length of a slot's walls along the saw, from the fitting surface to their rim. They "
                "guide the blade over this length, and the rim stops its shaft. 15 is published for guides.")
              .from(1.0)
              .to(40.0))
      .takes(field("slot_wall_mm", &Guide::slot_wall_mm,
                   "The thickness of the walls beside a slot; 2 is twice the least that is allowed.")
                 .from(1.0)
                 .to(10.0))
      .takes(
          field(
              "slot_end_mm", &Guide::slot_end_mm,
              "The length of the wall beyond a slot's closed ends; 4 is twice the default of 'slot_wall_mm'.")
              .from(1.0)
              .to(30.0))
      .takes(field("slot_form", &Guide::slot_form,
                   "closed: both ends of slots are closed; three_sided: the end at the last point of the "
                   "cut's line is open.")
                 .one_of({"closed", "three_sided"}))
      .takes(field("rounding_mm", &Guide::rounding_mm,
                   "The radius of the rounded edges of slots' walls; 1 is half the default of "
                   "'slot_wall_mm'. The base's rim is not rounded.")
                 .from(0.3)
                 .to(5.0))
      .takes(field("screws", &Guide::screws,
                   "Screws of this plan. The guide has a sleeve for the drill of each.")
                 .in_plans_only())
      .takes(field("drill_mm", &Guide::drill_mm, "The drill's diameter; 1.5 is usual for screws of 2 mm.")
                 .from(0.5)
                 .to(6.0))
      .takes(field("sleeve_wall_mm", &Guide::sleeve_wall_mm,
                   "The thickness of the wall of a drill's sleeve; 1.5 is the diameter of a usual drill.")
                 .from(1.0)
                 .to(5.0))
      .takes(field("sleeve_height_mm", &Guide::sleeve_height_mm,
                   "The height of a sleeve above the bone's surface, along its axis; over a length of 6 a "
                   "drill tilts by at most 2 degrees within its play.")
                 .from(1.0)
                 .to(40.0))
      .takes(least_wall(&Guide::least_wall_mm))
      .example(R"({"id": "saw_guide", "do": "guide", "object": "skull", "side": "anterior",
        "points": [[-24, -70, -30], [-14, -80, -34], [14, -80, -34], [24, -70, -30]], "radius_mm": 9,
        "cuts": ["sawn"], "screws": ["left_1"]})")
      .on_files(
          "octotomy guide bone.stl --side anterior --points -14,-80,-34 14,-80,-34 --radius 9 -o guide.stl")
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
