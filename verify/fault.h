// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "verify/certificate.h"

// Faults put into one kernel's answer on purpose, to see that certificates show them.
namespace octotomy::verify {

/// A fault of the library. Where it is one of degree, its size stands in its name.
struct Fault {
  std::string name;
  std::string what;  ///< is done, and to which kernel
  /// A bug of this kind must be caught from 64 voxels a side on; the others, smaller, show what still is.
  bool must_be_caught = true;
};
const std::vector<Fault>& faults();

/// A certificate of a spoiled answer; of a clean one where `fault` is empty.
struct FaultTrial {
  std::string fault;
  std::string kernel;   ///< that was spoiled: "voxel" or "mesh"
  std::string subject;  ///< "ellipsoid", "ring", "head", "voxel sets"
  int voxels = 0;       ///< a side of the universe
  bool must_be_caught = false;
  Certificate certificate;

  /// FAIL; a WARN is no catch.
  bool caught() const { return certificate.agreement == Agreement::Fail; }
};

struct FaultOptions {
  std::vector<int> sizes{16, 32, 64, 128};  ///< voxels a side, powers of two
  std::stop_token stop{};
  std::function<void(const std::string& doing, double share)> progress{};
};

/// From here on every fault must be caught, in voxels a side.
inline constexpr int resolved_size = 64;

/// Asks both kernels one question a subject and size, each from the same scan: a window on it, less a box,
/// turned and moved; and for sets of voxels the exact tier's a - b, up to 64 a side. Then spoils one of the
/// answers by each fault and certifies the pair again. The head phantom is asked from resolved_size on: it
/// has no bone that is thicker than voxels below. Same trials, in the same order, on any thread count. Throws
/// voxel::Stopped. Cost: about a minute of processor time.
std::vector<FaultTrial> try_faults(const FaultOptions& options = {});

/// How many trials of a fault at a size there were, and how many were caught; of clean ones, how many did not
/// pass.
struct DetectionPower {
  std::string fault;  ///< "clean" for the twins
  int voxels = 0;
  int trials = 0;
  int caught = 0;
  int doubted = 0;  ///< WARN
};
/// By fault in the library's order, clean first, then by size.
std::vector<DetectionPower> detection_power(const std::vector<FaultTrial>& trials);

/// No clean trial fails or warns, and every fault that must be caught is at resolved_size and up.
bool detection_holds(const std::vector<FaultTrial>& trials);

}  // namespace octotomy::verify
