// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Alters the answers of both kernels at random, to test the certificates. No certificate may pass an
// alteration above its detection limit.
namespace octotomy::verify {

/// An alteration of the clean answers, random in kind, place and size, and the verdict on the altered
/// answers.
struct Alteration {
  std::string kind;     ///< "box lost by both kernels"; `unaltered` for an answer without alteration
  std::string subject;  ///< the subject's name and its voxels a side
  double altered_mm3 = 0.0;
  bool is_over_limit = false;  ///< larger than the detection limit of the clean certificate
  Verdict verdict = Verdict::Pass;
  Verdict clean_verdict = Verdict::Pass;  ///< verdict on the answers before the alteration
  /// Whether the altered answers passed although the alteration is over the limit. This must not happen.
  bool is_missed() const { return is_over_limit && verdict == Verdict::Pass; }
};
inline constexpr const char* unaltered = "nothing altered";

/// A scan from which random objects are taken: its samples from `low` on.
struct ScanToAlter {
  std::string name;
  std::shared_ptr<const voxel::Scene> scan;
  double low = 0.0;
};

struct AlterationOptions {
  std::uint64_t seed = 1;
  int count = 60;                  ///< number of alterations, shared out equally to the subjects
  int voxels = 64;                 ///< voxels a side of the universe; a power of two from 32 on
  std::vector<ScanToAlter> scans;  ///< none: the phantoms are altered instead
  int objects_of_scan = 8;         ///< random blocks of each scan, at one to two samples a voxel
  voxel::Progress progress{};
};

/// Alters the clean answers for three phantoms (ellipsoid, ring and head), or those for objects of scans. The
/// alterations are boxes lost and added by one kernel or both, clipped ends, a lost part, repeated pieces of
/// the mesh, shifts of the mesh, empty answers, and none. If a block of a scan has no object, another block
/// is drawn. The same seed yields the same alterations. Throws std::invalid_argument if no block of a scan
/// has an object; voxel::Stopped. Cost: about a second of processor time for each alteration at 64 voxels a
/// side.
std::vector<Alteration> try_alterations(const AlterationOptions& options = {});

}  // namespace octotomy::verify
