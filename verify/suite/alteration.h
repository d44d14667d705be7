// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Alters answers of both kernels at random. No certificate may pass an alteration above its detection limit.
namespace octotomy::verify {

/// An alteration of an answer, random in kind, place and size, and the verdict on the altered answer.
struct Alteration {
  std::string kind;     ///< "box lost by both kernels"; `unaltered` for an answer without alteration
  std::string subject;  ///< name and voxels a side
  double altered_mm3 = 0.0;
  bool is_over_limit = false;  ///< larger than the clean certificate's detection limit
  Verdict verdict = Verdict::Pass;
  Verdict clean_verdict = Verdict::Pass;  ///< of the right answers
  /// Whether the alteration is over the limit and passed, which must not happen.
  bool is_missed() const { return is_over_limit && verdict == Verdict::Pass; }
};
inline constexpr const char* unaltered = "nothing altered";

/// A scan from which objects are cut: the window from `low` on.
struct ScanToAlter {
  std::string name;
  std::shared_ptr<const voxel::Scene> scan;
  double low = 0.0;
};

struct AlterationOptions {
  std::uint64_t seed = 1;
  int count = 60;                  ///< of alterations, divided among the subjects
  int voxels = 64;                 ///< a side; a power of two from 32 on
  std::vector<ScanToAlter> scans;  ///< none: the phantoms
  int objects_of_scan = 8;         ///< random blocks of each scan, at one to two samples a voxel
  voxel::Progress progress{};
};

/// Alters the clean answers for the ellipsoid, the ring and the head, or those for objects of scans. The
/// alterations are boxes lost and added by one kernel or both, clipped ends, a lost part, repeated pieces of
/// the mesh, shifts of the mesh, empty answers, and none. A block of a scan without an object is replaced by
/// another one. A seed always makes the same alterations. Throws std::invalid_argument if no block of a scan
/// has an object; voxel::Stopped. Cost: about a second of processor time for each alteration at 64 voxels a
/// side.
std::vector<Alteration> try_alterations(const AlterationOptions& options = {});

}  // namespace octotomy::verify
