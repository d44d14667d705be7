// SPDX-License-Identifier: AGPL-3.0-or-later
// An object with all that lies behind it along an insertion direction: its undercuts blocked out. A part from
// which this is subtracted can be slid on along the direction. Each kernel works on its own version of the
// object; the direction and the end plane are determined first, so that both kernels use the same.
//
// With a tolerated undercut, only the object's points deeper than the tolerance cast the shadow, and the
// object is united with it. On its way a part then meets only points of the object that are at most that
// deep.
#include "brep/shape/shadow.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "brep/boolean/boolean.h"
#include "brep/shape/offset.h"
#include "brep/shape/prism.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/part/insertion.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "voxel/filter/offset.h"
#include "voxel/filter/shadow.h"

namespace octotomy::planner {
namespace {

struct Shadow {
  ObjectName object;
  Insertion insertion;
  double beyond_mm = 0.0;
  std::optional<double> tolerance_mm;
  glm::dvec3 along{0.0, 1.0, 0.0};  ///< computed by settle(): unit, LPS
  double end_mm = 0.0;              ///< computed by settle(): position along `along` of the plane at which
                                    ///< the shadow ends
};

void check(const Shadow& shadow, const FieldLocation& place) {
  check(shadow.insertion, place);
}

/// The part of the object within the universe, of which both kernels compute the shadow. Precondition: the
/// object has a mesh.
const brep::Solid& solid_within(const Object& object) {
  return object.mesh.within ? *object.mesh.within : *object.mesh.whole;
}

/// The position of the object's far end along the direction: from its mesh, whose tips are exact, or from its
/// voxels if it has no mesh.
std::optional<double> far_end_mm(const Object& object, const glm::dvec3& along) {
  if (object.mesh.whole) {
    const brep::Solid& solid = solid_within(object);
    if (solid.empty()) return std::nullopt;
    return brep::far_end_mm(solid, along);
  }
  if (object.voxel.octree.is_empty()) return std::nullopt;
  return voxel::far_end_mm(object.voxel.octree, *object.voxel.symbol, along);
}

Shadow settle(const Shadow& asked, const SettleBench& bench) {
  Shadow settled = asked;
  settled.along = direction_of(asked.insertion, bench.objects.lps_from_head);
  if (const auto far_mm = far_end_mm(bench.objects.at(asked.object.name), settled.along))
    settled.end_mm = *far_mm + asked.beyond_mm;
  bench.details = {{"direction", to_json(settled.along)}, {"end_mm", settled.end_mm}};
  return settled;
}

std::string definition(const Shadow& shadow, const Objects&) {
  return "shadow of " + shadow.object.name + " along " + in_words(shadow.insertion);
}

/// The edge of the cells with which the mesh kernel searches for points as deep as the tolerance: a quarter
/// of the tolerance, but at least about 1/200 of the solid's extent.
double cell_mm(const brep::Solid& solid, double tolerance_mm) {
  const glm::dvec3 extent = solid.size().high_mm - solid.size().low_mm;
  return std::max(0.25 * tolerance_mm, std::max({extent.x, extent.y, extent.z}) / 200.0);
}

/// The part of a shadow within the universe, because the voxels' shadow also ends there. The end plane of an
/// oblique shadow extends beyond the universe; that part is cut off without a finding. A verb that works on
/// meshes only has no universe.
brep::BooleanResult cut_at_universe(const brep::Solid& shadow, bool has_voxels, const MeshBench& bench) {
  const glm::dvec3 &low = bench.low_mm, &high = bench.high_mm;
  if (!has_voxels || shadow.empty() ||
      (glm::all(glm::greaterThanEqual(shadow.size().low_mm, low)) &&
       glm::all(glm::lessThanEqual(shadow.size().high_mm, high))))
    return {shadow, {}, 0.0, {}};
  brep::Prism world;
  world.polygons_mm = {{{low.x, low.z}, {high.x, low.z}, {high.x, high.z}, {low.x, high.z}}};
  world.from_mm = low.y;
  world.to_mm = high.y;
  return brep::boolean(shadow, brep::Operation::Intersection, brep::solid_of(world), bench.progress.stop);
}

void voxels(const Shadow& shadow, const VoxelBench& bench, VoxelSide& made) {
  made.lineage = "columns of the octree, filled from the point at which they first cross its surface";
  const VoxelSide& object = bench.object(shadow.object.name);
  if (object.octree.is_empty()) {
    made.symbol = voxel::Expression(made.octree);
    return;
  }
  voxel::Octree octree = object.octree;
  voxel::Expression solid = bench.within_universe(*object.symbol);
  if (shadow.tolerance_mm) {
    const Stopwatch watch(bench.timings, "offset_voxel");
    solid = voxel::Expression(voxel::offset(octree, solid, -*shadow.tolerance_mm, bench.progress));
    octree = bench.combined(solid);
  }
  if (octree.is_empty()) {
    made.octree = object.octree;
    made.symbol = object.symbol;
    made.findings.push_back(
        "no point of the object is deeper than the tolerated undercut, so nothing is blocked out: choose a "
        "smaller undercut");
    return;
  }
  const voxel::Shadow found = [&] {
    const Stopwatch watch(bench.timings, "shadow_voxel");
    return voxel::shadow(octree, solid, {shadow.along, shadow.end_mm, bench.progress});
  }();
  // The end comes from the mesh. The end of the voxels may differ by less than a voxel's diagonal.
  const double apart_mm =
      std::abs(found.far_end_mm + shadow.tolerance_mm.value_or(0.0) + shadow.beyond_mm - shadow.end_mm);
  if (apart_mm > glm::length(bench.universe.lattice().spacing_mm()))
    made.findings.push_back("the object's far end lies " + three_figures(apart_mm) +
                            " mm apart in voxels and in the mesh, because a thin tip has no voxels: choose "
                            "smaller voxels or cut off the tip");
  const voxel::Expression window(found.window);
  made.octree = bench.combined(shadow.tolerance_mm ? window | voxel::Expression(object.octree) : window);
  made.symbol = bench.within_universe(shadow.tolerance_mm ? window | *object.symbol : window);
}

void triangles(const Shadow& shadow, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "shadow");
  const Object& object = bench.objects.at(shadow.object.name);
  const brep::Solid& solid = solid_within(object);
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  brep::Solid deep = solid;
  if (shadow.tolerance_mm && !solid.empty()) {
    const brep::OffsetOptions options{-*shadow.tolerance_mm, cell_mm(solid, *shadow.tolerance_mm), progress};
    deep = brep::offset(solid, options);
    const brep::MissedWalls missed = brep::missed_walls(solid, deep, options);
    if (missed.area_share > 0.0)
      made.findings.push_back("walls thinner than " + three_figures(options.cell_mm) + " mm, " +
                              three_figures(100.0 * missed.area_share) +
                              " % of the surface, cast no shadow because an undercut is tolerated");
    made.details["cell_mm"] = options.cell_mm;
  }
  const brep::Shadow found = brep::shadow(deep, {shadow.along, shadow.end_mm, progress});
  brep::BooleanResult whole = cut_at_universe(found.solid, object.voxel.symbol.has_value(), bench);
  made.shift_mm = whole.shift_mm;
  made.findings.insert(made.findings.end(), whole.findings.begin(), whole.findings.end());
  if (shadow.tolerance_mm) {
    whole = brep::boolean(solid, brep::Operation::Union, whole.solid, bench.progress.stop);
    made.shift_mm += whole.shift_mm;
    made.findings.insert(made.findings.end(), whole.findings.begin(), whole.findings.end());
  }
  made.whole = whole.solid;
  made.details["triangles_seen"] = found.seen;
  made.details["filled_mm3"] = brep::volume_mm3(*made.whole) - brep::volume_mm3(solid);
  made.lineage = "the triangles that are visible along the direction, with walls below their outline";
}

void bound(const Shadow& shadow, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(shadow.object.name);
  inherit(object, made);
  if (shadow.tolerance_mm && made.mesh.whole && object.mesh.whole && !made.mesh.whole->empty()) {
    made.bound.measured_apart_mm += verify::offset_allowance_mm(
        {object.witness, object.voxel.octree, *object.mesh.whole, is_whole_voxels(object.voxel)},
        {-*shadow.tolerance_mm, cell_mm(solid_within(object), *shadow.tolerance_mm)},
        made.mesh.whole->measures().area_mm2);
    made.bound.reshaped = {shadow.object.name};
  }
  // The outline of whole voxels is too wide by up to half a voxel's edge.
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  if (is_whole_voxels(object.voxel))
    made.bound.measured_apart_mm += 0.5 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  // If the end plane is parallel to faces of voxels, the whole plane is rounded in the same direction.
  constexpr double rounding = 1e-9;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(shadow.along[axis]) > 1.0 - rounding)
      made.bound.planes.push_back({axis, shadow.along, shadow.end_mm, 1.0});
  made.ends_with_universe = true;
}

}  // namespace

Operation shadow_operation() {
  return Describe<Shadow>("shadow",
                          "Blocks out an object's undercuts: fills everything behind it along an "
                          "insertion direction.",
                          Makes::Object)
      .takes(field("object", &Shadow::object, "The object.").required().positional("solid"))
      .takes(insertion_direction(&Shadow::insertion))
      .takes(insertion_view(&Shadow::insertion))
      .takes(
          field(
              "beyond_mm", &Shadow::beyond_mm,
              "The distance to which the shadow continues behind the object's far end, at most to the "
              "universe's border. Default: it ends at the far end, like models that are blocked out by hand.")
              .from(0.0)
              .to(500.0))
      .takes(field("tolerance_mm", &Shadow::tolerance_mm,
                   "The tolerated undercut: points less deep than this below the object's surface cast no "
                   "shadow, so that a part can snap on, for example 0.12. Default: no undercut is tolerated.")
                 .greater_than(0.0)
                 .to(2.0))
      .example(R"({"id": "blocked", "do": "shadow", "object": "maxilla", "direction": [0, 0, 1]})")
      .on_files(
          "octotomy shadow teeth.stl --direction 0,0,1 -o blocked.stl\n"
          "  octotomy shadow skull.stl --seen-from anterior --beyond 5 -o blocked.ply --json")
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
