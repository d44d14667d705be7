// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "verify/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Errors drawn by chance in one kernel's answer or in both: none that is over a certificate's limit may pass.
namespace octotomy::verify {

/// An answer altered by chance in kind, place and size, and the verdict on it.
struct Alteration {
  std::string kind;     ///< "box lost by both kernels"; `unaltered` of a twin
  std::string subject;  ///< and its voxels a side
  double altered_mm3 = 0.0;
  bool is_over_limit = false;  ///< larger than the clean certificate's detection limit
  Verdict verdict = Verdict::Pass;
  Verdict clean_verdict = Verdict::Pass;  ///< of the right answers
  /// Over the limit and passed: there must be none.
  bool is_missed() const { return is_over_limit && verdict == Verdict::Pass; }
};
inline constexpr const char* unaltered = "nothing altered";

/// A scan to draw objects from: those of the window from `low` on.
struct ScanToAlter {
  std::string name;
  std::shared_ptr<const voxel::Scene> scan;
  double low = 0.0;
};

struct AlterationOptions {
  std::uint64_t seed = 1;
  int count = 60;                  ///< shared out among the subjects
  int voxels = 64;                 ///< a side; a power of two from 32 on
  std::vector<ScanToAlter> scans;  ///< none: the phantoms
  int objects_of_scan = 8;         ///< blocks of each scan, drawn by chance, at one to two samples a voxel
  voxel::Progress progress{};
};

/// Alters the clean answers of the ellipsoid, the ring and the head, or those of objects of scans: boxes lost
/// and added by either kernel or both, ends clipped, a part lost, pieces of the mesh that are there several
/// times, shifts of the mesh, empty answers, nothing at all. A block of a scan that has no object is drawn
/// again. Same alterations for a seed. Throws std::invalid_argument where no block of a scan has an object;
/// voxel::Stopped. Cost: about a second of processor time each at 64 voxels a side.
std::vector<Alteration> try_alterations(const AlterationOptions& options = {});

}  // namespace octotomy::verify
