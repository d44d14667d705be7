// SPDX-License-Identifier: AGPL-3.0-or-later
// An MR scan without the slow change of brightness that an inhomogeneous magnetic field causes.
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/bias_field.h"

namespace octotomy::planner {
namespace {

struct BiasField {
  ScanName scan;
  std::optional<double> threshold;
  double knots_mm = voxel::BiasFieldOptions{}.knots_mm;
  int levels = voxel::BiasFieldOptions{}.levels;
  int iterations = voxel::BiasFieldOptions{}.iterations;
};

MadeScan made(const BiasField& step, const ScanBench& bench) {
  voxel::BiasFieldOptions options;
  options.threshold = step.threshold;
  options.knots_mm = step.knots_mm;
  options.levels = step.levels;
  options.iterations = step.iterations;
  options.progress = bench.progress;
  voxel::BiasCorrection corrected = voxel::correct_bias_field(bench.samples(step.scan.name), options);
  MadeScan made{std::move(corrected.scene),
                {{"threshold", corrected.threshold},
                 {"knots_mm", step.knots_mm},
                 {"levels", step.levels},
                 {"iterations", step.iterations},
                 {"fitted_samples", corrected.fitted},
                 {"field", {corrected.field_low, corrected.field_high}}}};
  if (!step.threshold)
    made.findings.push_back("the field is fitted to samples above " + plain(corrected.threshold) +
                            ", a threshold that Otsu's method guessed from the histogram: if these are not "
                            "the patient's tissue, state 'threshold'");
  return made;
}

}  // namespace

Operation n4_bias_field_operation() {
  return Describe<BiasField>("n4_bias_field",
                             "Corrects the brightness of an MR scan: divides it by the slowly changing field "
                             "that N4 estimates.",
                             Makes::Scan)
      .takes(field("scan", &BiasField::scan, "The MR scan.").required())
      .takes(
          field("threshold", &BiasField::threshold,
                "Samples above this value determine the field. Default: Otsu's threshold, which is a guess.")
              .from(0.0)
              .to(1e9))
      .takes(field("knots_mm", &BiasField::knots_mm,
                   "Largest distance between the spline's knots at the first level.")
                 .from(1.0)
                 .to(10000.0))
      .takes(field("levels", &BiasField::levels,
                   "Number of levels of the fit. Each level halves the distance between knots.")
                 .from(1)
                 .to(6))
      .takes(field("iterations", &BiasField::iterations, "Largest number of iterations at each level.")
                 .from(1)
                 .to(1000))
      .example(R"({"id": "even", "do": "n4_bias_field", "scan": "ct", "threshold": 20})")
      .on_files("n4_bias_field=THRESHOLD,KNOTS,LEVELS,ITERATIONS (samples, mm)")
      .scan(made);
}

}  // namespace octotomy::planner
