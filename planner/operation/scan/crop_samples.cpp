// SPDX-License-Identifier: AGPL-3.0-or-later
// The samples from one index to another.
#include "planner/operation/table/operation.h"
#include "voxel/filter/crop.h"

namespace octotomy::planner {
namespace {

struct CropSamples {
  ScanName scan;
  glm::dvec3 first{0.0}, last{0.0};
};

void check(const CropSamples& step, const FieldLocation& place) {
  for (const glm::dvec3& index : {step.first, step.last})
    if (index != glm::floor(index) || glm::any(glm::greaterThan(glm::abs(index), glm::dvec3(1e6))))
      place.refuse("indices must be whole numbers from 0; both samples are included");
}

MadeScan made(const CropSamples& step, const ScanBench& bench) {
  return {voxel::crop(bench.samples(step.scan.name), {glm::ivec3(step.first), glm::ivec3(step.last)})};
}

}  // namespace

Operation crop_samples_operation() {
  return Describe<CropSamples>("crop_samples", "Keeps the samples of a scan between two indices.",
                               Makes::Scan)
      .takes(field("scan", &CropSamples::scan, "The scan.").required())
      .takes(
          field("first", &CropSamples::first, "Indices [i, j, k] of the first sample that is kept, from 0.")
              .required())
      .takes(
          field("last", &CropSamples::last, "Indices [i, j, k] of the last sample that is kept.").required())
      .example(
          R"({"id": "part", "do": "crop_samples", "scan": "ct", "first": [0, 0, 10],
        "last": [255, 255, 90]})")
      .on_files("crop_samples=I0,J0,K0,I1,J1,K1")
      .check(check)
      .scan(made);
}

}  // namespace octotomy::planner
