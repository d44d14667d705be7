// SPDX-License-Identifier: AGPL-3.0-or-later
// A splint between two jaws: a slab along the arch, without the space that the teeth take up.
//
// 1 The arch's plane and a band about the curve through its points; the slab reaches `depth_mm` over the tips
//   of both rows of teeth. Only the jaws near the band are used.
// 2 The insertion directions, typed or found: of a grid of directions, the one with the least undercut.
// 3 From the slab are taken the teeth grown by the offset, and the shadow of the teeth grown by the offset
//   less the tolerated undercut. That shadow lies within the grown teeth where there is no undercut, so there
//   the grown teeth's surface is the fitting surface.
// 4 Walls thinner than the least wall are cut off: only the part that is covered by balls of that diameter
//   within the splint stays.
// 5 The largest piece, with points that files for printers can hold.
//
// The mesh kernel does 3 and 4 without Booleans, on distances to the surfaces (brep/shape/level_body.h). The
// voxel kernel combines windows of distances. 1 and 2 are settled once, by mesh and voxels, and are shared
// values of both kernels.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/shape/level_body.h"
#include "brep/shape/offset.h"
#include "brep/shape/shadow.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/part/arch_band.h"
#include "planner/operation/part/insertion.h"
#include "planner/operation/part/printed_part.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "voxel/filter/offset.h"
#include "voxel/filter/shadow.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

/// The values of one jaw that settle() computes.
struct SplintJaw {
  Slab near;                  ///< the space of the jaw that is used
  glm::dvec3 along{0, 0, 1};  ///< unit, LPS: the direction in which the splint moves onto this jaw
  double end_mm = 0.0;        ///< position along `along` of a plane behind `near` and the slab
  double tip_mm = 0.0;        ///< position p . look of the teeth's tips
};

struct Splint {
  ObjectName upper, lower;
  std::vector<Mark> arch;
  double offset_mm = 0.1, depth_mm = 2.0, thickness_mm = 1.5, width_mm = 14.0, tolerance_mm = 0.12;
  std::optional<glm::dvec3> upper_direction, lower_direction;
  // Settled.
  Slab slab;
  SplintJaw jaws[2];  ///< upper, lower
};

/// A jaw is used within these distances around the band: beside it, and above and below it.
constexpr double margin_mm = 3.0, reach_mm = 12.0;
/// Directions that are searched are tilted from the arch's normal by at most this angle, in these steps.
constexpr double search_deg = 20.0, search_step_deg = 10.0;
/// A direction with a larger angle to the arch's normal runs along the teeth's sides and is refused.
constexpr double steepest_deg = 60.0;
/// Cell size of the mesh's offsets of teeth. Flat parts lie within a 16th of a cell.
constexpr double fit_cell_mm = 0.5;

const ObjectName& name_of(const Splint& splint, int jaw) {
  return jaw == 0 ? splint.upper : splint.lower;
}

void check(const Splint& splint, const FieldLocation& place) {
  if (splint.upper.name == splint.lower.name)
    place.at("lower").refuse("is the upper jaw itself: name the object with the lower teeth");
}

/// Throws std::runtime_error if the points do not all lie on the same jaw.
void need_one_jaw(const std::vector<glm::dvec3>& points_mm, const Splint& splint, const SettleBench& bench) {
  constexpr double on_mm = 3.0;  // points may lie this far off, because landmarks are placed by hand
  std::vector<double> to[2];
  double sum[2] = {0.0, 0.0};
  for (int jaw = 0; jaw < 2; ++jaw) {
    const brep::Solid& solid = bench.object(name_of(splint, jaw).name);
    if (solid.empty())
      throw std::runtime_error("'" + name_of(splint, jaw).name + "' is empty, so it has no teeth");
    for (const brep::Foot& foot : solid.tree().feet(points_mm)) to[jaw].push_back(foot.distance_mm);
    for (const double mm : to[jaw]) sum[jaw] += mm;
  }
  const int on = sum[0] <= sum[1] ? 0 : 1;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    if (to[on][i] <= on_mm) continue;
    const std::string point = "point " + std::to_string(i + 1) + " of the arch lies ";
    if (to[1 - on][i] < to[on][i])
      throw std::runtime_error(point + "on '" + name_of(splint, 1 - on).name + "', the others on '" +
                               name_of(splint, on).name + "': choose points on the teeth of one jaw");
    throw std::runtime_error(point + three_figures(to[on][i]) + " mm off '" + name_of(splint, on).name +
                             "': choose points on the biting surfaces of its teeth");
  }
}

/// The position p . look of a jaw's tips of teeth in the band: the smallest of the upper jaw, the largest of
/// the lower jaw. `column` is the band, extended up and down as far as jaws are used.
double tip_of(const brep::Solid& jaw, const Slab& column, double sign, const std::string& name,
              const SettleBench& bench) {
  const brep::Solid teeth =
      brep::boolean(jaw, brep::Operation::Intersection, column.solid(), bench.progress.stop).solid;
  double tip_mm = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p_mm : teeth.triangles().points_mm)
    tip_mm = std::min(tip_mm, sign * glm::dot(p_mm, column.frame.look));
  // If the jaw continues beyond the column, there are no tips in the column.
  constexpr double cut_mm = 1e-3;
  if (!(std::abs(sign * tip_mm - column.frame.height_mm) < reach_mm - cut_mm))
    throw std::runtime_error("'" + name + "' has no tips of teeth within " + three_figures(reach_mm) +
                             " mm above or below the arch's points: choose points on its biting surfaces, "
                             "and check that the object contains only this jaw");
  return sign * tip_mm;
}

/// The direction along which the teeth within the slab have the least undercut, LPS.
glm::dvec3 found_direction(const Object& object, const Slab& slab, double sign, const SettleBench& bench,
                           nlohmann::ordered_json& details) {
  const glm::dvec3 first = sign * slab.frame.look;
  if (!object.voxel.symbol || object.voxel.octree.is_empty()) return first;
  const voxel::Universe universe = object.voxel.octree.universe();
  const voxel::Expression solid =
      *object.voxel.symbol & slab.expression() & voxel::Expression(voxel::bounds(universe.lattice()));
  const voxel::Octree teeth =
      voxel::combine(universe, voxel::Expression(object.voxel.octree) & slab.expression());
  if (teeth.is_empty()) return first;
  const std::vector<glm::dvec3> directions = directions_about(first, search_deg, search_step_deg);
  const std::vector<double> filled = voxel::filled_mm3(teeth, solid, directions, bench.progress);
  const auto best = static_cast<std::size_t>(std::min_element(filled.begin(), filled.end()) - filled.begin());
  details["filled_mm3"] = filled[best];
  details["filled_along_normal_mm3"] = filled[0];
  return directions[best];
}

Splint settle(const Splint& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "splint_settle");
  Splint made = asked;
  std::vector<glm::dvec3> points_mm;
  for (const Mark& mark : asked.arch) points_mm.push_back(mark_mm(mark, bench.objects));
  Slab& slab = made.slab;
  slab.frame = arch_frame(points_mm, bench.objects.lps_from_head[2]);
  need_one_jaw(points_mm, asked, bench);
  slab.outline_mm = band_outline(slab.frame.points_mm, asked.width_mm);
  const double middle_mm = slab.frame.height_mm;
  slab.low_mm = middle_mm - reach_mm;
  slab.high_mm = middle_mm + reach_mm;
  try {
    static_cast<void>(slab.solid());
  } catch (const brep::InvalidInput&) {
    throw std::runtime_error("a band of " + three_figures(asked.width_mm) +
                             " mm along the arch's points crosses itself: choose a smaller 'width_mm', or "
                             "state the points in their order along the arch");
  }
  bench.details = {{"arch_normal", to_json(slab.frame.look)}, {"jaws", nlohmann::ordered_json::array()}};
  for (int jaw = 0; jaw < 2; ++jaw) {
    SplintJaw& of = made.jaws[jaw];
    of.near = {slab.frame,
               band_outline(longer_by(slab.frame.points_mm, margin_mm), asked.width_mm + 2.0 * margin_mm),
               middle_mm - reach_mm, middle_mm + reach_mm};
    const std::string& name = name_of(asked, jaw).name;
    of.tip_mm = tip_of(bench.object(name), {slab.frame, slab.outline_mm, of.near.low_mm, of.near.high_mm},
                       jaw == 0 ? 1.0 : -1.0, name, bench);
  }
  slab.high_mm = made.jaws[0].tip_mm + asked.depth_mm;
  slab.low_mm = made.jaws[1].tip_mm - asked.depth_mm;
  if (!(slab.high_mm - slab.low_mm >= asked.thickness_mm))
    throw std::runtime_error("the rows of teeth overlap by " +
                             three_figures(made.jaws[1].tip_mm - made.jaws[0].tip_mm) + " mm, so that " +
                             three_figures(slab.high_mm - slab.low_mm) + " mm remain for a splint of " +
                             three_figures(asked.thickness_mm) + " mm: open the bite, or raise 'depth_mm'");
  for (int jaw = 0; jaw < 2; ++jaw) {
    SplintJaw& of = made.jaws[jaw];
    const double sign = jaw == 0 ? 1.0 : -1.0;
    nlohmann::ordered_json details{{"object", name_of(asked, jaw).name}};
    const std::optional<glm::dvec3>& typed = jaw == 0 ? asked.upper_direction : asked.lower_direction;
    if (typed) {
      of.along = glm::normalize(*typed);
      const double off_deg =
          glm::degrees(std::acos(std::clamp(sign * glm::dot(of.along, slab.frame.look), -1.0, 1.0)));
      if (off_deg > steepest_deg)
        throw std::runtime_error(std::string(jaw == 0 ? "'upper_direction'" : "'lower_direction'") +
                                 " lies " + three_figures(off_deg) +
                                 " degrees off the arch's normal, so it runs along the teeth's sides: point "
                                 "it from the splint to the teeth");
    } else {
      of.along = found_direction(bench.objects.at(name_of(asked, jaw).name), slab, sign, bench, details);
    }
    // The jaw is used slightly beyond the slab, so that the plane at which it is cut does not touch the
    // splint.
    (jaw == 0 ? of.near.high_mm : of.near.low_mm) =
        jaw == 0 ? slab.high_mm + margin_mm : slab.low_mm - margin_mm;
    of.end_mm = std::max(of.near.far_end_mm(of.along), slab.far_end_mm(of.along)) + margin_mm;
    details["direction"] = to_json(of.along);
    details["is_found"] = !typed;
    details["tip_mm"] = of.tip_mm;
    bench.details["jaws"].push_back(details);
  }
  bench.details["bite_mm"] = made.jaws[0].tip_mm - made.jaws[1].tip_mm;
  bench.details["height_mm"] = slab.high_mm - slab.low_mm;
  if (slab.frame.off_plane_mm > asked.depth_mm)
    bench.findings.push_back("points of the arch lie up to " + three_figures(slab.frame.off_plane_mm) +
                             " mm off their plane, so teeth there are covered less or more by this distance");
  return made;
}

std::string definition(const Splint& splint, const Objects&) {
  return "splint between " + splint.upper.name + " and " + splint.lower.name + ", " +
         plain(splint.offset_mm) + " mm off the teeth";
}

/// The distance between the teeth and the surface that casts the shadow. If it is below the accuracy of the
/// mesh's offsets on flat parts, the teeth themselves cast the shadow.
double shadow_by_mm(const Splint& splint) {
  const double by_mm = splint.offset_mm - splint.tolerance_mm;
  return std::abs(by_mm) < fit_cell_mm / 16.0 ? 0.0 : by_mm;
}

/// The voxels that the splint must not occupy because of one jaw.
voxel::Expression taken_by(const Splint& splint, int jaw, const VoxelBench& bench) {
  const VoxelSide& object = bench.object(name_of(splint, jaw).name);
  const voxel::Expression near = splint.jaws[jaw].near.expression();
  const voxel::Octree octree = bench.combined(voxel::Expression(object.octree) & near);
  if (octree.is_empty()) return voxel::Expression(octree);
  const voxel::Expression solid = bench.within_universe(*object.symbol & near);
  const voxel::Expression grown(voxel::offset(octree, solid, splint.offset_mm, bench.progress));
  voxel::Expression casts = solid;
  if (shadow_by_mm(splint) != 0.0)
    casts = voxel::Expression(voxel::offset(octree, solid, shadow_by_mm(splint), bench.progress));
  const voxel::Octree casting = bench.combined(casts);
  if (casting.is_empty()) return grown;
  const voxel::Shadow shadow =
      voxel::shadow(casting, casts, {splint.jaws[jaw].along, splint.jaws[jaw].end_mm, bench.progress});
  return grown | voxel::Expression(shadow.window);
}

void voxels(const Splint& splint, const VoxelBench& bench, VoxelSide& made) {
  made.lineage = "the slab less the columns of the teeth's octrees and the points near them";
  const voxel::Expression slab = splint.slab.expression();
  const voxel::Expression taken = [&] {
    const Stopwatch watch(bench.timings, "splint_voxel");
    return taken_by(splint, 0, bench) | taken_by(splint, 1, bench);
  }();
  const voxel::Expression whole = slab - taken;
  const voxel::Octree octree = bench.combined(whole);
  if (octree.is_empty()) {
    made.octree = octree;
    made.symbol = voxel::Expression(octree);
    return;
  }
  const Stopwatch watch(bench.timings, "splint_voxel");
  keep_largest(thick_part(whole, splint.thickness_mm, bench), bench, made);
}

/// The levels of the mesh kernel that the splint must not occupy because of one jaw.
std::vector<brep::Level> taken_by(const Splint& splint, int jaw, const MeshBench& bench, MeshSide& made) {
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  const brep::BooleanResult near =
      brep::boolean(bench.object(name_of(splint, jaw).name), brep::Operation::Intersection,
                    splint.jaws[jaw].near.solid(), bench.progress.stop);
  made.shift_mm += near.shift_mm;
  if (near.solid.empty()) return {};
  const auto shadow_of = [&](const brep::Solid& casts) {
    return brep::shadow(casts, {splint.jaws[jaw].along, splint.jaws[jaw].end_mm, progress}).solid;
  };
  std::vector<brep::Level> taken{{near.solid, splint.offset_mm}};
  // For teeth that are grown, the shadow of the grown teeth equals the grown shadow of the teeth. For teeth
  // that are shrunk this does not hold.
  if (const double by_mm = shadow_by_mm(splint); by_mm >= 0.0) {
    taken.push_back({shadow_of(near.solid), by_mm});
  } else if (const brep::Solid casts = brep::offset(near.solid, {by_mm, fit_cell_mm, progress});
             !casts.empty()) {
    taken.push_back({shadow_of(casts), 0.0});
  }
  return taken;
}

void triangles(const Splint& splint, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "splint");
  made.lineage = "level sets of the distances to the slab, the teeth and their exact shadows";
  brep::LevelBody body{{{{splint.slab.solid(), 0.0}}}, {}};
  for (int jaw = 0; jaw < 2; ++jaw) {
    const std::vector<brep::Level> taken = taken_by(splint, jaw, bench, made);
    body.without.insert(body.without.end(), taken.begin(), taken.end());
  }
  made.whole = thick_part(body, {splint.thickness_mm, fit_cell_mm}, "splint", bench, made);
  if (made.whole->empty())
    made.findings.push_back("no part of the splint is " + three_figures(splint.thickness_mm) +
                            " mm thick: open the bite, or raise 'depth_mm' or 'width_mm'");
}

void bound(const Splint& splint, const BoundBench& bench, Object& made) {
  double apart_mm = 0.0;
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  for (int jaw = 0; jaw < 2; ++jaw) {
    const Object& object = bench.objects.at(name_of(splint, jaw).name);
    inherit(object, made);
    if (!object.mesh.whole || !made.mesh.whole || made.mesh.whole->empty()) continue;
    // The mesh kernel uses exact distances up to the last surface, except for the shadow of shrunk teeth.
    const double cell_mm = shadow_by_mm(splint) < 0.0 ? fit_cell_mm : 0.0;
    double of_mm =
        verify::offset_allowance_mm(
            {object.witness, object.voxel.octree, *object.mesh.whole, is_whole_voxels(object.voxel)},
            {splint.offset_mm, cell_mm}, made.mesh.whole->measures().area_mm2) +
        thick_part_allowance_mm({splint.thickness_mm, fit_cell_mm});
    if (is_whole_voxels(object.voxel)) of_mm += 0.5 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    apart_mm = std::max(apart_mm, of_mm);
    made.bound.reshaped.push_back(object.id);
  }
  made.bound.measured_apart_mm += apart_mm;
  const std::vector<CutPlane> sides = planes_of(splint.slab.sides());
  made.bound.planes.insert(made.bound.planes.end(), sides.begin(), sides.end());
  constexpr double rounding = 1e-9;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(splint.slab.frame.look[axis]) > 1.0 - rounding)
      for (const double height_mm : {splint.slab.low_mm, splint.slab.high_mm})
        made.bound.planes.push_back({axis, splint.slab.frame.look, height_mm, 1.0});
  made.shared_values.push_back("the slab's place and the insertion directions");
  made.ends_with_universe = true;
}

}  // namespace

Operation splint_operation() {
  return Describe<Splint>("splint", "Makes a splint that can be put onto the teeth of both jaws.",
                          Makes::Object)
      .takes(field("upper", &Splint::upper, "The upper jaw in its planned position.")
                 .required()
                 .positional("upper"))
      .takes(field("lower", &Splint::lower, "The lower jaw in its position with the planned bite.")
                 .required()
                 .positional("lower"))
      .takes(field("arch", &Splint::arch,
                   "Three or more points on the biting surfaces of one jaw, from one end of the arch to the "
                   "other: [x, y, z] or landmarks.")
                 .required()
                 .from(3))
      .takes(field("offset_mm", &Splint::offset_mm,
                   "The gap between splint and teeth; 0.05 to 0.2 are published.")
                 .from(0.05)
                 .to(0.5))
      .takes(field("depth_mm", &Splint::depth_mm,
                   "The distance to which the splint extends over the tips of both rows of teeth; published "
                   "splints with 5 fit badly.")
                 .from(0.5)
                 .to(6.0))
      .takes(field("thickness_mm", &Splint::thickness_mm,
                   "Thinner walls are cut off; 0.6 is the least thickness published for splints.")
                 .from(0.6)
                 .to(5.0))
      .takes(field("width_mm", &Splint::width_mm,
                   "The splint's width across the arch; molars are about 10 wide.")
                 .from(4.0)
                 .to(40.0))
      .takes(field("tolerance_mm", &Splint::tolerance_mm,
                   "The depth to which the splint may extend into undercuts of the teeth, including the gap, "
                   "so that it snaps on. The default is published for splints.")
                 .from(0.0)
                 .to(0.5))
      .takes(field("upper_direction", &Splint::upper_direction,
                   "The direction in which the splint moves onto the upper teeth, LPS. Default: the "
                   "direction of least undercut within 20 degrees of the arch's normal.")
                 .direction())
      .takes(field("lower_direction", &Splint::lower_direction,
                   "The direction in which the splint moves onto the lower teeth, LPS. Default: the "
                   "direction of least undercut within 20 degrees of the arch's normal.")
                 .direction())
      .example(R"({"id": "wafer", "do": "splint", "upper": "advanced", "lower": "rest",
        "arch": [[-24, -52, -56], [0, -86, -56], [24, -52, -56]]})")
      .on_files("octotomy splint upper.stl lower.stl --arch -24,-52,-56 0,-86,-56 24,-52,-56 -o splint.stl")
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
