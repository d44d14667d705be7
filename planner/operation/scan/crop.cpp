// SPDX-License-Identifier: AGPL-3.0-or-later
// The samples within a box.
#include "voxel/filter/crop.h"

#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Crop {
  ScanName scan;
  glm::dvec3 low_mm{0.0}, high_mm{0.0};
};

MadeScan made(const Crop& step, const ScanBench& bench) {
  const voxel::Scene& scene = bench.samples(step.scan.name);
  const voxel::Box box{glm::min(step.low_mm, step.high_mm), glm::max(step.low_mm, step.high_mm)};
  const voxel::VoxelRange range = voxel::range_within(scene.lattice, box);
  if (range.is_empty())
    throw std::runtime_error(scene.source +
                             ": no sample lies in the box of crop, which must overlap the scan");
  return {voxel::crop(scene, range), {{"first_sample", {range.low.x, range.low.y, range.low.z}}}};
}

}  // namespace

Operation crop_operation() {
  return Describe<Crop>("crop", "Keeps the samples of a scan within a box.", Makes::Scan)
      .takes(field("scan", &Crop::scan, "The scan.").required())
      .takes(field("low_mm", &Crop::low_mm, "A corner of the box, LPS mm.").required())
      .takes(field("high_mm", &Crop::high_mm, "The opposite corner, LPS.").required())
      .example(
          R"({"id": "face", "do": "crop", "scan": "ct", "low_mm": [-90, -120, -80],
        "high_mm": [90, 110, 90]})")
      .on_files("crop=X0,Y0,Z0,X1,Y1,Z1 (mm)")
      .scan(made);
}

}  // namespace octotomy::planner
