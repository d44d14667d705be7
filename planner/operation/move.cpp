// SPDX-License-Identifier: AGPL-3.0-or-later
// A rigid motion: a rotation, then a translation.
#include "planner/operation/move.h"

#include "brep/mesh/move.h"
#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

struct Move {
  struct Rotation {
    double degrees = 0.0;
    glm::dvec3 axis{0, 0, 1};
    glm::dvec3 about_mm{0.0};
  };
  ObjectName object;
  std::optional<glm::dvec3> translate_mm;
  std::optional<Rotation> rotate;
};

glm::dmat4 motion_of(const Move& move) {
  voxel::Motion motion;
  motion.translate_mm = move.translate_mm.value_or(glm::dvec3(0.0));
  if (move.rotate) {
    motion.degrees = move.rotate->degrees;
    motion.axis = move.rotate->axis;
    motion.about_mm = move.rotate->about_mm;
  }
  return voxel::moved_from_still(motion);
}

void check(const Move& move, const Place& place) {
  if (!move.translate_mm && !move.rotate) place.refuse("moves nothing: add 'translate_mm', 'rotate' or both");
  try {
    motion_of(move);
  } catch (const std::invalid_argument& error) {
    place.refuse(error.what());
  }
}

std::string definition(const Move& move, const Objects&) {
  const glm::dvec3 by_mm = move.translate_mm.value_or(glm::dvec3(0.0));
  std::string text = move.object.name + " moved by (" + plain(by_mm.x) + ", " + plain(by_mm.y) + ", " +
                     plain(by_mm.z) + ") mm";
  if (move.rotate) text += ", turned by " + plain(move.rotate->degrees) + "\u00b0";
  return text;
}

void voxels(const Move& move, const VoxelBench& bench, VoxelSide& made) {
  move_voxels(move.object.name, motion_of(move), bench, made);
}

void triangles(const Move& move, const MeshBench& bench, MeshSide& made) {
  move_triangles(move.object.name, motion_of(move), bench, made);
}

void bound(const Move& move, const BoundBench& bench, Object& made) {
  carry(bench.objects.at(move.object.name), motion_of(move), bench.universe, made);
}

}  // namespace

void move_voxels(const std::string& object, const glm::dmat4& moved_from_still, const VoxelBench& bench,
                 VoxelSide& made) {
  made.symbol = moved(*bench.object(object).symbol, moved_from_still);
  made.octree = bench.combined(*made.symbol);
  made.lineage = "the object's own definition under a rigid motion, windows on interpolated samples";
}

void move_triangles(const std::string& object, const glm::dmat4& moved_from_still, const MeshBench& bench,
                    MeshSide& made) {
  const Stopwatch watch(bench.timings, "boolean_mesh");
  made.whole = brep::moved(bench.object(object), moved_from_still);
  made.lineage = "vertices of a mesh under a rigid motion";
}

Operation move_operation() {
  using Rotation = Move::Rotation;
  return Describe<Move>("move", "Moves an object: rotates it, then translates it.", Makes::Object)
      .takes(field("object", &Move::object, "The object.").required())
      .takes(field("translate_mm", &Move::translate_mm, "The translation [x, y, z], LPS."))
      .takes(
          record("rotate", &Move::rotate, "The rotation, which is done first.",
                 {field("degrees", &Rotation::degrees, "The angle, right-handed about the axis.").required(),
                  field("axis", &Rotation::axis, "The direction of the axis, LPS.").required().direction(),
                  field("about_mm", &Rotation::about_mm, "A point on the axis, LPS.")}))
      .example(R"({"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 2],
        "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]}})")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
