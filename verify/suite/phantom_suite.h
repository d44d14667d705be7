// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"

// Tests both kernels on solids of known volume and area: whether the bounds of the certificates hold, and
// whether they are tight.
namespace octotomy::verify {

struct PhantomSuiteOptions {
  int poses = 6;  ///< poses of a solid at each spacing and sampling, 1..1000; as many for calibration
  std::uint64_t seed = 1;
  std::optional<std::string> solid = {};  ///< only this kind: "sphere", "box, turned", ...
  voxel::Progress progress = {};
};

/// One solid in one pose. `bounded` compares the kernels with each other, `closed_form` both with the truth.
struct PhantomCase {
  std::string solid, spacing, sampling;
  std::uint64_t seed = 0;  ///< replays pose and noise
  Certificate bounded, closed_form;
};

/// How tight the bounded tolerances are at one spacing and sampling: the observed differences as shares of
/// the tolerances.
struct Tightness {
  std::string spacing, sampling;
  int cases = 0;             ///< resolved objects only: at least six voxels across
  double worst_share = 0.0;  ///< the largest |difference| / tolerance; above 1 no PASS
  double p99_share = 0.0;    ///< 99th percentile of |difference| / tolerance
};

/// A constant of the tolerances, and the value that would suffice in the calibration poses. These have other
/// seeds than the cases.
struct Calibration {
  std::string constant;
  double in_use = 0.0;
  double p99 = 0.0;  ///< the value that covers 99 of 100 calibration poses
  int poses = 0;
};

/// Errors at several radii, in per cent of the truth (root mean square over the poses), and the order of a
/// fit: error ~ radius^-order.
struct Convergence {
  std::string quantity;
  std::vector<double> radii_voxels, errors_percent;
  double order = 0.0;
  double least_order = 0.0;  ///< required order: that of theory, less the scatter of a fit over few poses
};

/// A requirement of the suite, and whether it is met.
struct SuiteCheck {
  std::string statement;
  double found = 0.0, allowed = 0.0;
  bool held = false;
};

struct PhantomSuite {
  std::vector<PhantomCase> cases;
  std::vector<Tightness> tightness;
  std::vector<Calibration> calibrations;
  std::vector<Convergence> convergences;
  std::vector<SuiteCheck> checks;
  std::optional<Contested> worst;  ///< the case with the worst bounded certificate
  /// The largest error of area, in per cent, of solids with edges at a radius of six voxels. It is reported
  /// without a check, because the isosurface chamfers edges.
  double area_with_edges_percent = 0.0;
};

/// Runs the suite: spheres, ellipsoids, tori, boxes along the lattice and turned, cylinders, plates of one to
/// three voxels, lenses, cut spheres and shells in random poses, at spacings 1:1:1, 2:1:1 and 5:1:1. Voxels
/// come from centres, from filled shares, and from a window on a blurred scan with noise. The mesh is the
/// isosurface of the shares, or of that scan. Throws std::invalid_argument if an option is out of its range;
/// voxel::Stopped. Same answer on any thread count. Cost: about 50 ms a case.
PhantomSuite phantom_suite(const PhantomSuiteOptions& options = {});

}  // namespace octotomy::verify
