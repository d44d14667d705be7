// SPDX-License-Identifier: AGPL-3.0-or-later
// A scan of the plan as a file for other programs.
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

struct ScanFile {
  ScanName scan;
  std::filesystem::path path;
};

void check(const ScanFile& file, const FieldLocation& place) {
  check_output_path(file.path, {".nrrd", ".nii", ".nii.gz", ".mha"}, place.at("path"));
}

void write(const ScanFile& wanted, const AnswerBench& bench, Exported& made) {
  const voxel::Scene& scene = bench.samples(wanted.scan.name);
  made.object = wanted.scan.name;
  made.path = output_path(wanted.path).generic_string();
  const Stopwatch watch(bench.timings, "write");
  voxel::write_scene(scene, output_file(bench.folder, made.path));
  made.written = true;
  const glm::ivec3 dims = scene.lattice.dims;
  made.content = std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " + std::to_string(dims.z) +
                 " samples of '" + wanted.scan.name + "'";
  made.details = {{"samples", {dims.x, dims.y, dims.z}}};
}

}  // namespace

Operation scan_file_operation() {
  return Describe<ScanFile>("scan_file",
                            "Writes a scan of the plan, such as the operated scan. To convert it to DICOM: "
                            "octotomy convert operated.nrrd -o folder --source CT-FOLDER.",
                            Makes::File)
      .takes(field("scan", &ScanFile::scan, "The scan: one of the plan's scans, or one that a step made.")
                 .required())
      .takes(field("path", &ScanFile::path,
                   "Path of the file within the result's folder: .nrrd, .nii, .nii.gz or .mha.")
                 .required())
      .example(R"({"id": "file", "do": "scan_file", "scan": "ct", "path": "operated.nrrd"})")
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner
