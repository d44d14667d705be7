// SPDX-License-Identifier: AGPL-3.0-or-later
// A motion that another program determined, from its file: 3D Slicer's linear transforms, ITK's, registrations.
#include "planner/operation/file/itk_transform.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/field_file.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Transform {
  ObjectName object;
  std::filesystem::path file;
};

/// The motion in a transform's file. Throws std::runtime_error that names the path if the motion is not
/// rigid.
TransformFile motion_in(const std::filesystem::path& path) {
  TransformFile read = read_itk_transform(path);
  if (!is_rigid(read.moved_from_still))
    throw std::runtime_error(
        path.string() +
        ": scales, shears or mirrors: save a rigid transform, or use 'affine' to scale and shear");
  return read;
}

void check(const Transform& transform, const FieldLocation& place) {
  check_field_file(place.at("file"), transform.file, motion_in);
}

std::string definition(const Transform& transform, const Objects&) {
  return transform.object.name + " moved by " + transform.file.filename().string();
}

void voxels(const Transform& transform, const VoxelBench& bench, VoxelSide& made) {
  const TransformFile read = motion_in(bench.folder / transform.file);
  move_voxels(transform.object.name, read.moved_from_still, bench, made);
  made.findings.insert(made.findings.end(), read.findings.begin(), read.findings.end());
}

void triangles(const Transform& transform, const MeshBench& bench, MeshSide& made) {
  move_triangles(transform.object.name, motion_in(bench.folder / transform.file).moved_from_still, bench,
                 made);
}

void bound(const Transform& transform, const BoundBench& bench, Object& made) {
  carry(transform.object.name, motion_in(bench.folder / transform.file).moved_from_still, bench, made);
  made.shared_values.push_back("the motion in " + transform.file.filename().string());
}

}  // namespace

Operation transform_operation() {
  return Describe<Transform>("transform",
                             "Moves an object by the rigid transform in a file of 3D Slicer or ITK.",
                             Makes::Object)
      .takes(field("object", &Transform::object, "The object.").required().positional("solid"))
      .takes(field("file", &Transform::file,
                   "A file of a rigid transform, .tfm or .h5, in LPS and mm. As both programs write it, it "
                   "maps positions after the motion to positions before it.")
                 .required()
                 .a_file())
      .example(R"({"id": "moved", "do": "transform", "object": "maxilla", "file": "advanced_motion.tfm"})")
      .on_files("octotomy transform maxilla.stl --file advanced_motion.tfm -o moved.stl")
      .motion()
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
