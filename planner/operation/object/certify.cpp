// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/certify.h"

#include <algorithm>
#include <chrono>

#include "planner/operation/object/provenance.h"
#include "verify/certificate/certify_alone.h"
#include "verify/certificate/certify_bounded.h"
#include "verify/certificate/surface_reach.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/witness.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::planner {
namespace {

/// The witness of an object, cut at the universe's border, as both results are, and loosened by the distance
/// by which Booleans may have moved surfaces.
verify::Witness within_universe(const Object& made) {
  const voxel::Box world = voxel::bounds(made.voxel.octree.universe().lattice());
  const verify::Witness within = verify::both(made.witness, verify::witness_of_box(world));
  return made.bound.shift_mm > 0.0 ? verify::loosened(within, made.bound.shift_mm) : within;
}

void judge_reshaped(Object& made, const voxel::Progress& progress) {
  const voxel::Lattice lattice = made.voxel.octree.universe().lattice();
  const glm::dvec3 voxel_mm = lattice.spacing_mm();
  verify::judge_reach(*made.certificate, made.mesh.within->triangles(),
                      verify::expected_surface(made.witness),
                      {.world_mm = voxel::bounds(lattice),
                       .shift_mm = made.bound.shift_mm,
                       .spacing_mm = std::min({voxel_mm.x, voxel_mm.y, voxel_mm.z})},
                      progress);
}

/// Missing tissue lowers the verdict only if it exceeds this share of the object; otherwise a finding states
/// it. The share is a choice: for comparison, the volume's interval of the head phantom's maxilla is 9 % wide
/// on each side.
constexpr double negligible_share = 0.001;

void lower_by_caveats(Object& made) {
  for (const Caveat& caveat : made.caveats)
    if (!caveat.missing_mm3 || *caveat.missing_mm3 > negligible_share * made.certificate->larger_mm3())
      verify::lower(*made.certificate, caveat.verdict, caveat.reason);
}

/// Computes the certificate; the caller measures the time.
void judge(Object& made, const std::string& title, const voxel::Progress& progress) {
  if (!made.mesh.within) {
    made.certificate = verify::certify_alone(
        made.voxel.octree, {title, made.voxel.lineage, made.voxel.makers, within_universe(made)}, progress);
    made.certificate->shared_values = made.shared_values;
    return lower_by_caveats(made);
  }
  verify::BoundInputs inputs;
  inputs.operation = title;
  inputs.voxel_lineage = made.voxel.lineage;
  inputs.mesh_lineage = made.mesh.lineage;
  // Objects that verbs make from files have no measures yet.
  if (made.voxel.measures.voxel_count > 0 &&
      made.voxel.measures.voxel_count == made.voxel.octree.voxel_count())
    inputs.voxel_measures = made.voxel.measures;
  inputs.scan_spacing_mm = made.bound.spacing_mm;
  inputs.flat_cut_mm2 = area_on_planes(made.mesh.within->triangles(), made.bound.planes);
  inputs.scan_box_mm = made.bound.scan_box_mm;
  inputs.measured_apart_mm = made.bound.measured_apart_mm;
  inputs.voxels_are_samples = made.bound.voxels_are_samples;
  inputs.is_surely_empty = made.is_surely_empty;
  inputs.witness = within_universe(made);
  const bool reshaped = verify::is_reshaped(made.witness);
  made.certificate = verify::certify_bounded(made.voxel.octree, *made.mesh.within, inputs,
                                             voxel::part_of(progress, 0.0, reshaped ? 0.6 : 1.0));
  made.certificate->voxel.makers = made.voxel.makers;
  made.certificate->mesh.makers = made.mesh.makers;
  made.certificate->shared_values = made.shared_values;
  if (reshaped) judge_reshaped(made, voxel::part_of(progress, 0.6, 1.0));
  verify::judge_independence(*made.certificate);
  lower_by_caveats(made);
}

}  // namespace

void certify(Object& made, const std::string& title, const voxel::Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  judge(made, title, progress);
  made.certificate->milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace octotomy::planner
