// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's mirror image about a plane.
#include "brep/align/mirror.h"

#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "voxel/solid/expression.h"

namespace octotomy::planner {
namespace {

struct Mirror {
  ObjectName object;
  glm::dvec3 point_mm{0.0};
  glm::dvec3 normal{1, 0, 0};
};

/// The reflection in the plane: Householder's matrix about the plane's point.
glm::dmat4 reflection_of(const Mirror& mirror) {
  const glm::dvec3 n = glm::normalize(mirror.normal);
  glm::dmat4 mirrored(glm::dmat3(1.0) - 2.0 * glm::outerProduct(n, n));
  mirrored[3] = glm::dvec4(2.0 * glm::dot(n, mirror.point_mm) * n, 1.0);
  return mirrored;
}

std::string definition(const Mirror& mirror, const Objects&) {
  return mirror.object.name + " mirrored about the plane through (" + plain(mirror.point_mm.x) + ", " +
         plain(mirror.point_mm.y) + ", " + plain(mirror.point_mm.z) + ") mm";
}

void voxels(const Mirror& mirror, const VoxelBench& bench, VoxelSide& made) {
  made.symbol = reflected(*bench.object(mirror.object.name).symbol, reflection_of(mirror));
  made.octree = bench.combined(*made.symbol);
  made.lineage = "the object's own definition under a reflection, windows on interpolated samples";
}

void triangles(const Mirror& mirror, const MeshBench& bench, MeshSide& made) {
  made.whole =
      brep::mirrored(bench.object(mirror.object.name), {mirror.point_mm, glm::normalize(mirror.normal)});
  made.lineage = "vertices of a mesh under a reflection";
}

void bound(const Mirror& mirror, const BoundBench& bench, Object& made) {
  carry(bench.objects.at(mirror.object.name), reflection_of(mirror), bench.universe, made);
  // A mirror image has not moved: nothing in a deck takes it along, and no picture shows it as the same
  // piece.
  made.moved.reset();
  made.shown.reset();
}

}  // namespace

Operation mirror_operation() {
  return Describe<Mirror>("mirror", "Makes an object's mirror image about a plane.", Makes::Object)
      .takes(field("object", &Mirror::object, "The object.").required())
      .takes(field("point_mm", &Mirror::point_mm, "A point of the plane, LPS."))
      .takes(field("normal", &Mirror::normal, "The plane's normal, LPS. Default: the patient's left.")
                 .direction())
      .example(
          R"({"id": "twin", "do": "mirror", "object": "maxilla", "point_mm": [0, 0, 0], "normal": [1, 0, 0]})")
      .definition(definition)
      .voxel(voxels)
      .mesh(triangles)
      .bound(bound);
}

}  // namespace octotomy::planner
