// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"

// Injects faults into a kernel's answer or into both. The certificates must detect them.
namespace octotomy::verify {

/// A kind of fault that is injected. The name includes the fault's size if it has one.
struct Fault {
  std::string name;
  std::string what;  ///< a clause: the fault's effect, and the kernel that has it
  /// Whether the fault must be detected from resolved_size on. Faults without this flag measure the detection
  /// limit.
  bool must_be_caught = true;
};
const std::vector<Fault>& faults();

/// The certificate of a pair of answers with a fault; of the clean answers if `fault` is empty.
struct FaultTrial {
  std::string fault;
  std::string kernel;   ///< the spoiled one: "voxel" or "mesh"
  std::string subject;  ///< "ellipsoid", "ring", "head", "voxel sets"
  int voxels = 0;       ///< voxels a side of the universe
  bool must_be_caught = false;
  Certificate certificate;

  /// Whether the fault was detected. Only FAIL counts.
  bool caught() const { return certificate.verdict == Verdict::Fail; }
};

struct FaultOptions {
  std::vector<int> sizes{16, 32, 64, 128};  ///< voxels a side of the universes; powers of two from 8 on
  voxel::Progress progress{};
};

/// The size of a universe, in voxels a side, from which on every fault with `must_be_caught` must be
/// detected.
inline constexpr int resolved_size = 64;

/// Evaluates one question in both kernels for each subject and size: a window on a scan, minus a box, turned
/// and moved. For sets of voxels the question is a - b in tier Exact, up to 64 voxels a side. Then applies
/// each fault to one of the answers, or to both, and certifies the pair again. The head phantom is used from
/// resolved_size on; below that size all its bone is thinner than a voxel. The trials and their order are the
/// same on any thread count. Throws std::invalid_argument if a size is not a power of two from 8 on;
/// voxel::Stopped. Cost: about a minute of processor time.
std::vector<FaultTrial> try_faults(const FaultOptions& options = {});

/// How often one fault was detected at one size.
struct DetectionPower {
  std::string fault;  ///< "clean" for the twins
  int voxels = 0;
  int trials = 0;
  int caught = 0;   ///< number of FAILs; of clean answers these are false alarms
  int doubted = 0;  ///< number of WARNs
};
/// Counts the trials of each fault at each size. The result is sorted by fault in the order of faults(),
/// clean trials first, then by size.
std::vector<DetectionPower> detection_power(const std::vector<FaultTrial>& trials);

/// Whether every clean trial passes, and from resolved_size on every clean object is resolved and every fault
/// with `must_be_caught` is detected.
bool detection_holds(const std::vector<FaultTrial>& trials);

}  // namespace octotomy::verify
