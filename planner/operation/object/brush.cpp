// SPDX-License-Identifier: AGPL-3.0-or-later
// A brush that removes material from an object along strokes, or adds material.
#include "brep/shape/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "brep/boolean/boolean.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/brush_witness.h"
#include "verify/witness/witness.h"
#include "voxel/solid/brush.h"

namespace octotomy::planner {
namespace {

struct Stroke {
  std::vector<glm::dvec3> points_mm;
  double radius_mm = 3.0;
  std::string shape = "ball";
  std::optional<glm::dvec3> normal;    ///< normal of a slab, of any length
  std::optional<double> thickness_mm;  ///< of a slab

  bool is_slab() const { return shape == "slab"; }
};

struct Brush {
  ObjectName object;
  std::vector<Stroke> strokes;
  std::string mode = "erase";
  Stroke drawn;  ///< the verb's stroke

  bool paints() const { return mode == "paint"; }
  std::vector<Stroke> all() const { return strokes.empty() ? std::vector{drawn} : strokes; }
};

/// The frame of a slab. Its first corner may lie in any direction, so both kernels read it from here.
struct SlabFrame {
  glm::dvec3 normal, across;
};
SlabFrame frame_of(const Stroke& stroke) {
  const glm::dvec3 normal = glm::normalize(*stroke.normal);
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) < std::abs(normal[least])) least = axis;
  glm::dvec3 across(0.0);
  across[least] = 1.0;
  return {normal, glm::normalize(across - normal * normal[least])};
}

/// The strokes in the types of one kernel or of the witness. `slab` is the member there for a slab's frame
/// and thickness.
template <typename Made, typename Slab>
std::vector<Made> strokes_of(const Brush& brush, std::optional<Slab> Made::*slab) {
  std::vector<Made> made;
  for (const Stroke& stroke : brush.all()) {
    made.push_back({stroke.points_mm, stroke.radius_mm});
    if (!stroke.is_slab()) continue;
    const SlabFrame frame = frame_of(stroke);
    made.back().*slab = Slab{frame.normal, frame.across, *stroke.thickness_mm};
  }
  return made;
}

std::string changes_no(const std::string& part, const Brush& brush) {
  return "the brush changes no " + part + " of '" + brush.object.name +
         "': check the positions of its strokes, and draw them again";
}

/// If two different points are nearer to each other than this, the faces of their hull are thinner than
/// rounding.
constexpr double least_way_mm = 1e-3;
/// Farther from the origin than this, rounding would displace the faces of a small brush.
constexpr double most_mm = 1e6;

void check_stroke(const Stroke& stroke, const FieldLocation& place) {
  if (stroke.is_slab()) {
    if (!stroke.normal) place.at("normal").refuse("is missing: a slab needs it");
    if (!stroke.thickness_mm) place.at("thickness_mm").refuse("is missing: a slab needs it");
  } else {
    if (stroke.normal)
      place.at("normal").refuse("applies only to a slab: set 'shape' to \"slab\", or leave it out");
    if (stroke.thickness_mm)
      place.at("thickness_mm").refuse("applies only to a slab: set 'shape' to \"slab\", or leave it out");
  }
  for (std::size_t i = 0; i < stroke.points_mm.size(); ++i)
    if (!(glm::length(stroke.points_mm[i]) <= most_mm))
      place.at("points_mm")
          .refuse("point " + std::to_string(i) +
                  " lies more than 1000 m from the origin: state LPS coordinates in mm");
  for (std::size_t i = 1; i < stroke.points_mm.size(); ++i) {
    const double way_mm = glm::distance(stroke.points_mm[i - 1], stroke.points_mm[i]);
    if (way_mm > 0.0 && way_mm < least_way_mm)
      place.at("points_mm")
          .refuse("points " + std::to_string(i - 1) + " and " + std::to_string(i) +
                  " are less than 0.001 mm apart: leave out one of them");
  }
}

void check(const Brush& brush, const FieldLocation& place) {
  if (place.scope == nullptr && brush.strokes.empty()) return check_stroke(brush.drawn, place);
  if (brush.strokes.empty()) place.refuse("'strokes' is missing: add at least one stroke");
  for (std::size_t i = 0; i < brush.strokes.size(); ++i)
    check_stroke(brush.strokes[i], place.at("strokes[" + std::to_string(i) + "]"));
}

std::string definition(const Brush& brush, const Objects&) {
  const std::size_t count = brush.all().size();
  const std::string strokes = std::to_string(count) + (count == 1 ? " stroke" : " strokes") + " of a brush";
  return brush.object.name + (brush.paints() ? " and " : " less ") + strokes;
}

constexpr const char* not_measured = "; no scan measured the painted material";

void voxels(const Brush& brush, const VoxelBench& bench, VoxelSide& made) {
  const voxel::Expression touched = voxel::brush(strokes_of(brush, &voxel::BrushStroke::slab));
  const VoxelSide& object = bench.object(brush.object.name);
  const voxel::Expression octree(object.octree);
  made.octree = bench.combined(brush.paints() ? octree | touched : octree - touched);
  made.symbol = bench.within_universe(brush.paints() ? *object.symbol | touched : *object.symbol - touched);
  made.lineage = brush.paints()
                     ? std::string("the object's voxels and voxel centres in the brush") + not_measured
                     : "voxel centres outside of the brush";
}

void triangles(const Brush& brush, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "boolean_mesh");
  const brep::Solid& solid = bench.object(brush.object.name);
  const brep::BooleanResult touched =
      brep::brush_solid(strokes_of(brush, &brep::BrushTrace::disc), bench.progress.stop);
  brep::BooleanResult result =
      brep::boolean(solid, brush.paints() ? brep::Operation::Union : brep::Operation::Difference,
                    touched.solid, bench.progress.stop);
  made.shift_mm = touched.shift_mm + result.shift_mm;
  made.findings = touched.findings;
  made.findings.insert(made.findings.end(), result.findings.begin(), result.findings.end());
  const std::optional<double> residual =
      result.residual ? std::max(*result.residual, touched.residual.value_or(0.0)) : touched.residual;
  made.details["residuals"] = {{"volume_relative", residual ? nlohmann::ordered_json(*residual) : nullptr}};
  made.details["brush_mm3"] = brep::volume_mm3(touched.solid);
  const double changed_mm3 = std::abs(brep::volume_mm3(result.solid) - brep::volume_mm3(solid));
  made.details[brush.paints() ? "painted_mm3" : "erased_mm3"] = changed_mm3;
  if (changed_mm3 == 0.0) made.findings.push_back(changes_no("part of the surface", brush));
  made.whole = result.solid;
  made.lineage =
      std::string("corefinement with the hulls of the brush") + (brush.paints() ? not_measured : "");
}

/// The distance from a dab's centre to the plane that is normal to an axis and touches the dab.
double reach_mm(const Stroke& stroke, int axis) {
  // The outermost edges of a ball's polyhedron along an axis lie between two hexagons.
  if (!stroke.is_slab())
    return 0.9675583399663303 * std::numbers::sqrt3 / std::numbers::phi * stroke.radius_mm;
  const SlabFrame frame = frame_of(stroke);
  const glm::dvec3 third = glm::cross(frame.normal, frame.across);
  constexpr double turn = std::numbers::pi / 8.0;
  double most = 0.0;
  for (int corner = 0; corner < 16; ++corner)
    most =
        std::max(most, std::cos(corner * turn) * frame.across[axis] + std::sin(corner * turn) * third[axis]);
  return 0.993537015401427 / std::cos(0.5 * turn) * stroke.radius_mm * most +
         0.5 * *stroke.thickness_mm * std::abs(frame.normal[axis]);
}

/// The planes of the brush's walls that are normal to an axis. A piece of a stroke that is perpendicular to
/// the axis has such a wall on either side. A slab whose normal is the axis has two at each of its points.
std::vector<CutPlane> walls_of(const std::vector<Stroke>& strokes) {
  constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  std::array<std::set<double>, 3> offsets_mm;
  for (const Stroke& stroke : strokes)
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_flat = stroke.is_slab() && std::abs(frame_of(stroke).normal[axis]) >= 1.0 - rounding;
      const double reach = reach_mm(stroke, axis);
      for (std::size_t i = 0; i < stroke.points_mm.size(); ++i) {
        const double at_mm = stroke.points_mm[i][axis];
        const auto is_level = [&](std::size_t other) {
          return std::abs(stroke.points_mm[other][axis] - at_mm) <= rounding * (1.0 + std::abs(at_mm));
        };
        if (is_flat || (i > 0 && is_level(i - 1)) || (i + 1 < stroke.points_mm.size() && is_level(i + 1)))
          offsets_mm[static_cast<std::size_t>(axis)].insert({at_mm - reach, at_mm + reach});
      }
    }
  std::vector<CutPlane> planes;
  for (int axis = 0; axis < 3; ++axis)
    for (const double offset_mm : offsets_mm[static_cast<std::size_t>(axis)]) {
      glm::dvec3 normal(0.0);
      normal[axis] = 1.0;
      planes.push_back({axis, normal, offset_mm});
    }
  return planes;
}

void bound(const Brush& brush, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(brush.object.name);
  inherit(object, made);
  made.shown = object.shown;
  const verify::Witness touched = verify::witness_of_brush(strokes_of(brush, &verify::DrawnBrush::disc));
  if (!brush.paints())
    made.witness = verify::without(object.witness, touched);
  else if (object.witness)
    made.witness = verify::witness_of_expression("object | brush", [&](const std::string& name) {
      return name == "brush" ? touched : object.witness;
    });
  made.ends_with_universe = true;
  const std::vector<CutPlane> walls = walls_of(brush.all());
  made.bound.planes.insert(made.bound.planes.end(), walls.begin(), walls.end());
  const double before = static_cast<double>(object.voxel.octree.voxel_count());
  const double changed = std::abs(static_cast<double>(made.voxel.octree.voxel_count()) - before);
  if (changed == 0.0) {
    // If the mesh kernel found no change, either, one finding is enough.
    std::erase(made.findings, changes_no("part of the surface", brush));
    made.findings.push_back(changes_no("voxel", brush));
  }
  if (changed > 0.0 && brush.paints())
    made.findings.push_back("painted: " + three_figures(changed * bench.universe.lattice().voxel_mm3()) +
                            " mm\u00b3 were drawn by hand; no scan measured them");
}

std::vector<Field> stroke_fields() {
  std::vector<Field> fields;
  fields.push_back(field("points_mm", &Stroke::points_mm, "One or more points of the stroke, LPS.")
                       .required()
                       .from(1)
                       .to(2000));
  fields.push_back(
      field("radius_mm", &Stroke::radius_mm,
            "The radius of the brush. A ball is a polyhedron with 32 faces and the ball's volume; its "
            "surface lies between 3.2 % of the radius inside and 4.9 % outside of the ball's surface. A slab "
            "is a disc with 16 sides, from 0.6 % inside to 1.3 % outside.")
          .from(0.1)
          .to(100.0));
  fields.push_back(field("shape", &Stroke::shape, "The shape of the brush.").one_of({"ball", "slab"}));
  fields.push_back(field("normal", &Stroke::normal, "The slab's normal, LPS.").direction());
  fields.push_back(field("thickness_mm", &Stroke::thickness_mm,
                         "The thickness of a slab; half of it lies on either side of the points.")
                       .from(0.1)
                       .to(200.0));
  return fields;
}

}  // namespace

Operation brush_operation() {
  return Describe<Brush>("brush",
                         "Removes material from an object along the strokes of a brush, or adds material.",
                         Makes::Object)
      .takes(field("object", &Brush::object, "The object.").required().positional("solid"))
      .takes(records("strokes", &Brush::strokes,
                     "The strokes. Between two points a stroke is the convex hull of the brush at both.",
                     stroke_fields())
                 .from(1)
                 .to(500)
                 .in_plans_only())
      .takes(field("mode", &Brush::mode,
                   "Whether the strokes remove or add material. No scan measures added material.")
                 .one_of({"erase", "paint"}))
      .verb_takes(&Brush::drawn, stroke_fields())
      .example(
          R"({"id": "clean", "do": "brush", "object": "skull", "strokes": [
        {"points_mm": [[-15, -84, 45], [15, -84, 45]], "radius_mm": 4, "shape": "ball"}]})")
      .on_files("octotomy brush skull.stl --points -15,-84,45 15,-84,45 --radius 4 -o clean.stl")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
