// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"

// Injects faults into one kernel's answer. The certificates must detect them.
namespace octotomy::verify {

/// A fault of the library. The name includes its size if it has one.
struct Fault {
  std::string name;
  std::string what;  ///< a sentence: its effect, and the kernel
  /// Must be detected from resolved_size on. The other, smaller faults measure the detection limit.
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

  /// Whether the fault was detected. Only FAIL counts.
  bool caught() const { return certificate.verdict == Verdict::Fail; }
};

struct FaultOptions {
  std::vector<int> sizes{16, 32, 64, 128};  ///< voxels a side, powers of two from 8 on
  voxel::Progress progress{};
};

/// The size, in voxels a side, from which every fault with `must_be_caught` must be detected.
inline constexpr int resolved_size = 64;

/// Evaluates one question in both kernels for each subject and size: a window on a scan, minus a box, turned
/// and moved; and for sets of voxels a - b in tier Exact, up to 64 voxels a side. Then applies each fault to
/// one of the answers and certifies the pair again. The head phantom is used from resolved_size on; below
/// that size all its bone is thinner than a voxel. The trials and their order are the same on any thread
/// count. Throws std::invalid_argument if a size is not a power of two from 8 on; voxel::Stopped. Cost: about
/// a minute of processor time.
std::vector<FaultTrial> try_faults(const FaultOptions& options = {});

/// Trials of one fault at one size.
struct DetectionPower {
  std::string fault;  ///< "clean" for the twins
  int voxels = 0;
  int trials = 0;
  int caught = 0;   ///< FAIL; of clean twins these are false alarms
  int doubted = 0;  ///< WARN
};
/// The trials of each fault at each size, sorted by fault in the order of faults(), clean trials first, then
/// by size.
std::vector<DetectionPower> detection_power(const std::vector<FaultTrial>& trials);

/// Whether every clean trial passes, and from resolved_size on every clean object is resolved and every fault
/// with `must_be_caught` is detected.
bool detection_holds(const std::vector<FaultTrial>& trials);

}  // namespace octotomy::verify
