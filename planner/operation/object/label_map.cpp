// SPDX-License-Identifier: AGPL-3.0-or-later
// Objects' voxels as a label map of the universe.
#include "voxel/filter/label_map.h"

#include <set>

#include "planner/operation/file/label_table.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

struct LabelMap {
  ObjectName object;
  std::vector<ObjectName> also;
  std::filesystem::path path;
};

/// All objects of the step, in the order of their labels.
std::vector<std::string> labelled(const LabelMap& map) {
  std::vector<std::string> names{map.object.name};
  for (const ObjectName& also : map.also) names.push_back(also.name);
  return names;
}

void check(const LabelMap& map, const FieldLocation& place) {
  check_output_path(map.path, {".nrrd", ".nii.gz", ".mha"}, place.at("path"));
  std::set<std::string> seen;
  for (const std::string& name : labelled(map))
    if (!seen.insert(name).second)
      place.at("also").refuse("names '" + name +
                              "' twice, but an object can have only one label: delete one of them");
}

void write(const LabelMap& wanted, const AnswerBench& bench, Exported& made) {
  const Object& object = bench.objects.at(wanted.object.name);
  made.object = object.id;
  made.path = output_path(wanted.path).generic_string();
  std::vector<voxel::Octree> octrees;
  std::map<int, std::string> names;
  for (const std::string& name : labelled(wanted)) {
    octrees.push_back(bench.objects.at(name).voxel.octree);
    names[static_cast<int>(octrees.size())] = name;
    if (!octrees.back().is_empty()) continue;
    if (wanted.also.empty()) return made.findings.push_back("not written: '" + name + "' is empty");
    made.findings.push_back("'" + name + "' is empty, so no voxel has its label");
  }
  const voxel::Octree& octree = octrees.front();
  const Stopwatch watch(bench.timings, "write");
  voxel::LabelMap map =
      voxel::label_map(octree.universe().lattice(), octrees, bench.progress("labelling " + object.id));
  if (map.overlaps > 0)
    made.findings.push_back("WARN, labels: " + grouped(static_cast<double>(map.overlaps), 0) +
                            " voxels lie in several objects and have the label of the first: to keep all, "
                            "write a .seg.nrrd by octotomy scene");
  map.scene.source = object.id;
  const std::filesystem::path file = output_file(bench.folder, made.path);
  voxel::write_scene(map.scene, file);
  // If a file with the name of the label table exists, it is not overwritten, because it may belong to
  // another label map.
  const std::filesystem::path table = label_table_path(file);
  if (!std::filesystem::exists(table))
    voxel::write_whole(table, label_table_text(names));
  else if (!holds_names(table, names))
    made.findings.push_back("the names of the labels are not written, because " + table.filename().string() +
                            " exists and has other names: rename one of the two files");
  made.written = true;
  made.content = grouped(static_cast<double>(octree.voxel_count()), 0) + " voxels labelled 1";
  if (!wanted.also.empty()) made.content += ", " + std::to_string(octrees.size()) + " labels";
  made.details = {{"voxels", octree.voxel_count()}, {"volume_mm3", object.voxel.measures.volume_mm3}};
  if (wanted.also.empty()) return;
  made.details["labels"] = Json::array();
  for (const auto& [label, name] : names)
    made.details["labels"].push_back(
        {{"label", label},
         {"name", name},
         {"voxels", octrees[static_cast<std::size_t>(label - 1)].voxel_count()}});
}

}  // namespace

Operation label_map_operation() {
  return Describe<LabelMap>("label_map", "Writes objects' voxels as a label map.", Makes::File)
      .takes(field("object", &LabelMap::object, "The object, which gets label 1.").required())
      .takes(field("also", &LabelMap::also, "Further objects, which get the labels 2, 3, ... in this order."))
      .takes(field("path", &LabelMap::path,
                   "Path of the file within the result's folder: .nrrd, .nii.gz or .mha.")
                 .required())
      .example(R"({"id": "labels", "do": "label_map", "object": "advanced", "path": "advanced.nrrd"})")
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner
