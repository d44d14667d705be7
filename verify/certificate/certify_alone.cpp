// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/certify_alone.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "voxel/measure/measure.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

/// Numbers of voxels, by the witness's readings at their centres.
struct CentreCount {
  /// voxels that the octree has although the witness excludes them; that it lacks although the witness
  /// requires them
  std::uint64_t surplus = 0, lacking = 0;
  std::uint64_t on_surface = 0, unknown = 0;
  /// voxels inside by the witness; where the witness allows both sides, the voxels that the octree has
  std::uint64_t by_witness = 0;
  std::optional<glm::ivec3> first_surplus, first_lacking;

  void add(const CentreCount& other) {
    surplus += other.surplus;
    lacking += other.lacking;
    on_surface += other.on_surface;
    unknown += other.unknown;
    by_witness += other.by_witness;
    if (!first_surplus) first_surplus = other.first_surplus;
    if (!first_lacking) first_lacking = other.first_lacking;
  }
  void add(const glm::ivec3& voxel, bool is_inside, const AllowedSides& allowed) {
    if (allowed.in && allowed.out) {
      ++(allowed.near ? on_surface : unknown);
      by_witness += is_inside ? 1 : 0;
      return;
    }
    by_witness += allowed.in ? 1 : 0;
    if (allowed.allows(is_inside)) return;
    ++(is_inside ? surplus : lacking);
    std::optional<glm::ivec3>& first = is_inside ? first_surplus : first_lacking;
    if (!first) first = voxel;
  }
};

CentreCount counted(const voxel::Octree& octree, const Witness& witness, const voxel::Progress& progress) {
  const voxel::Lattice lattice = octree.universe().lattice();
  const int side = octree.universe().side();
  std::vector<CentreCount> layers(static_cast<std::size_t>(side));
  voxel::SharedProgress done(progress, layers.size());
  tbb::parallel_for(0, side, [&](int z) {
    CentreCount& layer = layers[static_cast<std::size_t>(z)];
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::ivec3 voxel(x, y, z);
        layer.add(voxel, octree.contains(voxel),
                  witness.allowed_sides(lattice.lps_mm(glm::dvec3(voxel))).voxel);
      }
    done.one_more();
  });
  CentreCount all;
  for (const CentreCount& layer : layers) all.add(layer);
  return all;
}

}  // namespace

Certificate certify_alone(const voxel::Octree& octree, const AloneInputs& inputs,
                          const voxel::Progress& progress) {
  const CentreCount count = counted(octree, inputs.witness, voxel::part_of(progress, 0.0, 0.9));
  const voxel::Lattice lattice = octree.universe().lattice();
  const double voxel_mm3 = lattice.voxel_mm3();
  const auto mm3 = [&](std::uint64_t voxels) { return static_cast<double>(voxels) * voxel_mm3; };
  const voxel::Measures measures = voxel::measure(octree);
  Certificate certificate;
  certificate.operation = inputs.operation;
  certificate.voxel = {inputs.lineage, measures.volume_mm3, measures.area_crofton13_mm2, measures.centroid_mm,
                       inputs.makers};
  certificate.mesh = {"no mesh: the witness's own reading at the centre of every voxel",
                      mm3(count.by_witness), 0.0, std::nullopt, inputs.makers};
  certificate.difference_mm3 = certificate.voxel.volume_mm3 - certificate.mesh.volume_mm3;
  certificate.symmetric_difference_mm3 = mm3(count.surplus + count.lacking);
  add_comparison(certificate,
                 {.quantity = "voxel centres on a side that the witness excludes",
                  .unit = "",
                  .difference = static_cast<double>(count.surplus + count.lacking),
                  .tolerance = 0.0,
                  .formula = "0: the witness reads every centre",
                  .statement = "The centres of % voxels are on a side that the witness excludes"});
  if (count.surplus + count.lacking > 0) {
    const bool is_lack = count.lacking > count.surplus;
    const double volume_mm3 = mm3(is_lack ? count.lacking : count.surplus);
    certificate.worst = {lattice.lps_mm(glm::dvec3(is_lack ? *count.first_lacking : *count.first_surplus)),
                         std::cbrt(volume_mm3),
                         is_lack ? "the voxels lack a part there that the witness has"
                                 : "the voxels have a part there that the witness lacks",
                         volume_mm3};
    certificate.reasons.push_back(text_of(*certificate.worst));
  }
  // At voxels where the witness allows both sides, any answer passes.
  certificate.limit = DetectionLimit{voxel_mm3 + mm3(count.on_surface + count.unknown), std::nullopt};
  const std::string alone = "Not independent: the voxel kernel alone made this object";
  lower(certificate, Verdict::Warn,
        count.unknown > 0 ? alone + ", and its witness cannot decide the side of " +
                                voxel::rounded(mm3(count.unknown)) + " mm3 of voxels."
                          : alone + "; its witness judged the centre of every voxel.");
  judge_evidence(certificate);
  judge_emptiness(certificate, certificate.unseen_mm3());
  progress.at(1.0);
  return certificate;
}

}  // namespace octotomy::verify
