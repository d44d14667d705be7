// SPDX-License-Identifier: AGPL-3.0-or-later
// A donor's scan at the position of one segment of a flap. Its samples do not change; only the lattice moves.
// Nothing is therefore interpolated twice, and both kernels read the placed bone like any scan.
#include <algorithm>

#include "planner/operation/flap/fields.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/crop.h"

namespace octotomy::planner {
namespace {

struct FlapScan : FlapFields {
  ScanName scan;
  int segment = 1;
  bool uncut = false;
};

/// The scan extends this far beyond a segment's cuts, so that the bone continues through its osteotomies.
constexpr double beyond_cuts_mm = 10.0;

void check(const FlapScan& step, const FieldLocation& place) {
  check_flap(step, place);
  const std::size_t count = step.curve.size() - 1;
  if (static_cast<std::size_t>(step.segment) > count)
    place.at("segment").refuse("must be a segment of the curve, which has " + std::to_string(count) +
                               " segments");
}

/// With 'uncut' the scan extends this far beyond the outer cuts, because a guide sits there.
constexpr double beyond_uncut_mm = 25.0;

/// The box in the donor's scan around the bone from segment `first` to segment `last`, with `beyond_mm` of
/// bone at either end.
voxel::Box box_of(const FlapPlan& plan, const FlapSegment& first, const FlapSegment& last, double beyond_mm) {
  const glm::dvec3 along = glm::normalize(plan.donor_to_mm - plan.donor_from_mm);
  const auto over_mm = [&](const FlapSegment& segment) {
    return 0.5 * (segment.longest_mm - segment.length_mm) + beyond_mm;
  };
  const glm::dvec3 a = first.donor_start.point_mm - along * over_mm(first),
                   b = last.donor_end.point_mm + along * over_mm(last);
  const glm::dvec3 aside(flap_corner_mm(plan.reach_mm) + beyond_cuts_mm);
  return {glm::min(a, b) - aside, glm::max(a, b) + aside};
}

MadeScan made(const FlapScan& step, const ScanBench& bench) {
  const FlapPlan plan = plan_of(step);
  const std::vector<FlapSegment> segments = flap_segments(plan);
  const FlapSegment& segment = segments[static_cast<std::size_t>(step.segment - 1)];
  const voxel::Scene& scene = bench.samples(step.scan.name);
  const voxel::VoxelRange range = voxel::range_within(
      scene.lattice, step.uncut ? box_of(plan, segments.front(), segments.back(), beyond_uncut_mm)
                                : box_of(plan, segment, segment, beyond_cuts_mm));
  if (range.is_empty())
    throw std::runtime_error("segment " + std::to_string(step.segment) +
                             " lies outside of the donor's scan: check the two points of the donor's axis");
  MadeScan placed{voxel::crop(scene, range), {{"segment", step.segment}}};
  const glm::dmat4& motion = segment.placed_from_donor;
  placed.scene.lattice.lps_from_voxel = motion * placed.scene.lattice.lps_from_voxel;
  for (voxel::Hole& hole : placed.scene.holes) {
    hole.normal = glm::dmat3(motion) * hole.normal;
    const double by_mm = glm::dot(hole.normal, glm::dvec3(motion[3]));
    hole.low_mm += by_mm;
    hole.high_mm += by_mm;
  }
  for (int row = 0; row < 4; ++row)
    placed.details["placed_from_donor"].push_back(
        {motion[0][row], motion[1][row], motion[2][row], motion[3][row]});
  return placed;
}

}  // namespace

Operation flap_scan_operation() {
  Describe<FlapScan> entry("flap_scan", "Moves a donor's scan to the place of one segment in a free flap.",
                           Makes::Scan);
  for (Field& each : flap_fields<FlapScan>()) std::move(entry).takes(std::move(each));
  return std::move(entry)
      .takes(field("scan", &FlapScan::scan, "The donor's scan.").required())
      .takes(field("segment", &FlapScan::segment, "The number of the segment, from 1.").from(1).to(8))
      .takes(field("uncut", &FlapScan::uncut,
                   "Includes the whole uncut bone of the flap, placed by this segment's motion, so that a "
                   "guide can be designed on it."))
      .example(R"({"id": "fibula_1", "do": "flap_scan", "scan": "ct", "segment": 1,
        "curve": [[-30, -60, -80], [0, -80, -85], [30, -60, -80]],
        "donor": [[30, 12, 90], [33, 15, -90]], "face": [45, 12, 90]})")
      .check(check)
      .scan(made);
}

}  // namespace octotomy::planner
