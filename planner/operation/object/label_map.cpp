// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's voxels as a label map of the universe.
#include "voxel/filter/label_map.h"

#include "planner/operation/file/label_table.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

struct LabelMap {
  ObjectName object;
  std::filesystem::path path;
};

void check(const LabelMap& map, const FieldLocation& place) {
  check_output_path(map.path, {".nrrd", ".nii.gz", ".mha"}, place.at("path"));
}

void write(const LabelMap& wanted, const AnswerBench& bench, Exported& made) {
  const Object& object = bench.objects.at(wanted.object.name);
  made.object = object.id;
  made.path = output_path(wanted.path).generic_string();
  const voxel::Octree& octree = object.voxel.octree;
  if (octree.is_empty()) return made.findings.push_back("not written: '" + object.id + "' is empty");
  const Stopwatch watch(bench.timings, "write");
  voxel::LabelMap map =
      voxel::label_map(octree.universe().lattice(), {&octree, 1}, bench.progress("labelling " + object.id));
  map.scene.source = object.id;
  const std::filesystem::path file = output_file(bench.folder, made.path);
  voxel::write_scene(map.scene, file);
  // An existing file with the name of the table of labels is not overwritten: it may belong to another label
  // map.
  const std::map<int, std::string> names{{1, object.id}};
  const std::filesystem::path table = label_table_path(file);
  if (!std::filesystem::exists(table))
    voxel::write_whole(table, label_table_text(names));
  else if (!holds_names(table, names))
    made.findings.push_back("the name of its label is not written, as " + table.filename().string() +
                            " is there and does not have it: choose another name for one of them");
  made.written = true;
  made.content = grouped(static_cast<double>(octree.voxel_count()), 0) + " voxels labelled 1";
  made.details = {{"voxels", octree.voxel_count()}, {"volume_mm3", object.voxel.measures.volume_mm3}};
}

}  // namespace

Operation label_map_operation() {
  return Describe<LabelMap>("label_map", "Writes an object's voxels as a label map.", Makes::File)
      .takes(field("object", &LabelMap::object, "The object, which gets label 1.").required())
      .takes(field("path", &LabelMap::path, "The file within the result's folder: .nrrd, .nii.gz or .mha.")
                 .required())
      .example(R"({"id": "labels", "do": "label_map", "object": "advanced", "path": "advanced.nrrd"})")
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner
