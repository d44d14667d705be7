// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Faults injected into one kernel's answer: certificates must show them.
namespace octotomy::verify {

/// A fault of the library. The name says its size if it has one.
struct Fault {
  std::string name;
  std::string what;  ///< a sentence: what it does, and to which kernel
  /// Must be caught from resolved_size on. The other, smaller faults measure the detection limit.
  bool must_be_caught = true;
};
const std::vector<Fault>& faults();

/// A certificate of a spoiled answer; of a clean one if `fault` is empty.
struct FaultTrial {
  std::string fault;
  std::string kernel;   ///< the spoiled one: "voxel" or "mesh"
  std::string subject;  ///< "ellipsoid", "ring", "head", "voxel sets"
  int voxels = 0;       ///< a side of the universe
  bool must_be_caught = false;
  Certificate certificate;

  /// Only FAIL counts.
  bool caught() const { return certificate.verdict == Verdict::Fail; }
};

struct FaultOptions {
  std::vector<int> sizes{16, 32, 64, 128};  ///< voxels a side, powers of two from 8 on
  voxel::Progress progress{};
};

/// The size, in voxels a side, from which every fault must be caught.
inline constexpr int resolved_size = 64;

/// Asks both kernels one question for each subject and size: a window on a scan, minus a box, turned and
/// moved; and for sets of voxels the exact tier's a - b, up to 64 a side. Then spoils one of the answers by
/// each fault and certifies the pair again. The head phantom joins from resolved_size on; below, all its bone
/// is thinner than a voxel. Same trials, in the same order, on any thread count. Throws std::invalid_argument
/// if a size is not a power of two from 8 on; voxel::Stopped. Cost: about a minute of processor time.
std::vector<FaultTrial> try_faults(const FaultOptions& options = {});

/// Trials of one fault at one size.
struct DetectionPower {
  std::string fault;  ///< "clean" for the twins
  int voxels = 0;
  int trials = 0;
  int caught = 0;   ///< FAIL; of clean twins these are false alarms
  int doubted = 0;  ///< WARN
};
/// By fault in the library's order, clean first, then by size.
std::vector<DetectionPower> detection_power(const std::vector<FaultTrial>& trials);

/// Every clean trial passes, and from resolved_size on its object is resolved and every fault that must be
/// caught is.
bool detection_holds(const std::vector<FaultTrial>& trials);

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
