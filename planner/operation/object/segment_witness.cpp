// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/segment_witness.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include "verify/witness/class_witness.h"
#include "verify/witness/grown_witness.h"
#include "verify/witness/witness.h"

namespace octotomy::planner {
namespace {

/// The largest rounding of a sample in a grey octree of this step; 0 if all samples are whole multiples of
/// the step.
double rounding_of(const voxel::Scene& scene, double step) {
  const auto* const samples = std::get_if<voxel::FloatSamples>(&scene.samples);
  if (samples == nullptr) return 0.0;
  const bool is_rounded = std::any_of(samples->begin(), samples->end(), [&](float sample) {
    const double steps = static_cast<double>(sample) / step;
    return std::isfinite(steps) && steps != std::floor(steps);
  });
  return is_rounded ? step : 0.0;
}

verify::Witness witness_of_seeds(const Segment& segment, const LoadedScan& scan) {
  verify::GrownFrom from{.seeds_mm = segment.seeds_mm, .tolerance = segment.tolerance};
  if (segment.running_mean) from.mean_of_steps = scan.grey.step();
  if (segment.window) {
    from.low = segment.window->low;
    from.high = segment.window->high_or_infinity();
  }
  from.neighbours = segment.neighbours;
  // The flood runs only when the witness is first read, because an evaluation without certificates does not
  // need it.
  struct Flood {
    std::once_flag once;
    verify::Witness witness;
  };
  return [samples = scan.shared, step = scan.grey.step(), from, flood = std::make_shared<Flood>()](
             const glm::dvec3& p_mm, double slack_mm) {
    std::call_once(flood->once, [&] {
      verify::GrownFrom exact = from;
      exact.rounding = rounding_of(*samples, step);
      flood->witness = verify::witness_of_grown(*samples, exact);
    });
    return flood->witness(p_mm, slack_mm);
  };
}

verify::Witness witness_of_cluster(const Segment& segment, const LoadedScan& scan) {
  verify::ClassedBy by;
  for (const voxel::FeatureCentre& centre : segment.classes.centres)
    by.centres.emplace_back(centre.density, centre.gradient);
  by.scale = {segment.classes.density_scale, segment.classes.gradient_scale};
  by.meant = static_cast<std::size_t>(segment.otsu_class.value_or(*segment.clusters)) - 1;
  return verify::witness_of_class(scan.shared, by);
}

}  // namespace

verify::Witness witness_of_samples(const Segment& segment, const LoadedScan& scan, bool voxels_are_samples) {
  const bool chooses_parts = segment.largest || segment.components || segment.at_least_mm3;
  if (segment.label || segment.named || !segment.regions.empty() || segment.open_mm || segment.close_mm)
    return {};
  verify::Witness made;
  if (segment.clusters && segment.seeds_mm.empty())
    made = chooses_parts ? verify::witness_of_parts(witness_of_cluster(segment, scan))
                         : witness_of_cluster(segment, scan);
  else if (!segment.clusters && !segment.seeds_mm.empty() && voxels_are_samples && !chooses_parts)
    made = witness_of_seeds(segment, scan);
  return segment.fill && made ? verify::witness_of_filled(std::move(made)) : std::move(made);
}

}  // namespace octotomy::planner
