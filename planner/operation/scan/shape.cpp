// SPDX-License-Identifier: AGPL-3.0-or-later
// Binary slices between those of a window, by their shape.
#include "planner/operation/table/json.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/resample_slices.h"

namespace octotomy::planner {
namespace {

struct Shape {
  ScanName scan;
  double spacing_mm = 1.0;
  SampleWindow window;
};

MadeScan made(const Shape& step, const ScanBench& bench) {
  const voxel::Scene& scene = bench.samples(step.scan.name);
  need_hounsfield(step.window, scene);
  voxel::ShapeOptions options;
  options.spacing_mm = step.spacing_mm;
  options.low = step.window.low;
  options.high = step.window.high_or_infinity();
  options.progress = bench.progress;
  return {voxel::interpolate_shape(scene, options),
          {{"spacing_mm", step.spacing_mm},
           {"window", {step.window.low, step.window.high ? Json(*step.window.high) : Json(nullptr)}}}};
}

}  // namespace

Operation shape_operation() {
  return Describe<Shape>("shape", "Interpolates new slices of a window from the shapes in its slices.",
                         Makes::Scan)
      .takes(field("scan", &Shape::scan, "The scan.").required())
      .takes(field("spacing_mm", &Shape::spacing_mm, "Distance between the new slices.")
                 .required()
                 .greater_than(0.0))
      .takes(field("window", &Shape::window,
                   "The samples of the object: LOW:HIGH or LOW: in the scan's unit, or a tissue.")
                 .required()
                 .for_example("\"300:3000\""))
      .example(R"({"id": "shaped", "do": "shape", "scan": "ct", "spacing_mm": 1, "window": "bone"})")
      .on_files("shape=MM,WINDOW (binary slices by shape)")
      .scan(made);
}

}  // namespace octotomy::planner
