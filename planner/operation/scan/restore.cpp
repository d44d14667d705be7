// SPDX-License-Identifier: AGPL-3.0-or-later
// What remove_headrest took out, put back.
#include "planner/operation/table/operation.h"
#include "voxel/filter/headrest.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {
namespace {

struct Restore {
  ScanName scan;
  std::filesystem::path path;
};

MadeScan made(const Restore& step, const ScanBench& bench) {
  const std::filesystem::path path = bench.folder / step.path;
  const voxel::OctreeFile file = voxel::read_octree(path);
  const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree);
  if (grey == nullptr)
    throw std::runtime_error(path.string() +
                             ": contains no samples: name the file that remove_headrest wrote");
  MadeScan made{bench.samples(step.scan.name)};
  made.details = {{"samples_restored", voxel::restore(made.scene, *grey)}, {"path", step.path.string()}};
  return made;
}

}  // namespace

Operation restore_operation() {
  return Describe<Restore>("restore", "Restores the samples that remove_headrest stored in a file.",
                           Makes::Scan)
      .takes(field("scan", &Restore::scan, "The scan.").required())
      .takes(
          field("path", &Restore::path, "The .octree file of removed samples, relative to the plan's folder.")
              .required())
      .example(R"({"id": "whole", "do": "restore", "scan": "ct", "path": "table.octree"})")
      .on_files("restore=FILE.octree")
      .scan(made);
}

}  // namespace octotomy::planner
