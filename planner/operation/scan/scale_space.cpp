// SPDX-License-Identifier: AGPL-3.0-or-later
// A label map of the regions that belong to one maximum of a blurred scan.
#include "voxel/filter/scale_space.h"

#include <algorithm>

#include "planner/operation/table/json.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct ScaleSpaceStep {
  ScanName scan;
  double sigma_mm = 4.0;
  SampleWindow window;
  std::string objects = "bright";
};

MadeScan made(const ScaleSpaceStep& step, const ScanBench& bench) {
  const voxel::Scene& scene = bench.samples(step.scan.name);
  need_hounsfield(step.window, scene);
  voxel::ScaleSpaceOptions options;
  options.sigma_mm = step.sigma_mm;
  options.low = step.window.low;
  options.high = step.window.high_or_infinity();
  options.is_dark = step.objects == "dark";
  options.progress = bench.progress;
  voxel::ScaleSpace space = voxel::scale_space(scene, options);
  Json stack = Json::array();
  for (std::size_t level = 0; level < space.sigmas_mm.size(); ++level)
    stack.push_back({{"sigma_mm", space.sigmas_mm[level]}, {"maxima", space.maxima[level]}});
  // The answer lists only the largest regions, because a scan may have thousands of small ones.
  constexpr std::size_t most_listed = 20;
  Json largest = Json::array();
  for (std::size_t i = 0; i < std::min(most_listed, space.samples.size()); ++i)
    largest.push_back({{"label", i + 1}, {"samples", space.samples[i]}});
  return {std::move(space.labels),
          {{"sigma_mm", step.sigma_mm},
           {"window", {step.window.low, step.window.high ? Json(*step.window.high) : Json(nullptr)}},
           {"objects", step.objects},
           {"stack", std::move(stack)},
           {"regions", space.samples.size()},
           {"largest", std::move(largest)}}};
}

}  // namespace

Operation scale_space_operation() {
  return Describe<ScaleSpaceStep>("scale_space",
                                  "Makes a label map that separates touching objects. Each region belongs to "
                                  "one maximum of the blurred scan, which is followed from coarse to fine.",
                                  Makes::Scan)
      .takes(field("scan", &ScaleSpaceStep::scan, "The scan.").required())
      .takes(
          field("sigma_mm", &ScaleSpaceStep::sigma_mm,
                "Standard deviation of the coarsest blur: about half the width of the objects to separate.")
              .required()
              .greater_than(0.0))
      .takes(field("window", &ScaleSpaceStep::window,
                   "The samples that belong to regions: 'LOW:HIGH' or 'LOW:' in the scan's unit, or a "
                   "tissue's name.")
                 .required()
                 .for_example("\"300:\""))
      .takes(field("objects", &ScaleSpaceStep::objects,
                   "Whether the objects are brighter or darker than their surroundings.")
                 .one_of({"bright", "dark"}))
      .example(R"({"id": "teeth", "do": "scale_space", "scan": "ct", "sigma_mm": 2.5, "window": "1200:"})")
      .on_files("scale_space=SIGMA,WINDOW,OBJECTS (mm; bright or dark)")
      .scan(made);
}

}  // namespace octotomy::planner
