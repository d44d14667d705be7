// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The lattice's axes nearest to the patient's: along the table, to the back, and to a side.
struct PatientAxes {
  int along = 2, back = 1, side = 0;
};
PatientAxes patient_axes(const Lattice& lattice);

/// The level of air in HU, accurate to 2.5 HU. Computes the means of blocks of six millimetres, which noise
/// hardly changes, and returns the most frequent mean from -1100 to -850; -1000 if no mean is in this range.
/// Blocks of a single value of -1024 or less are padding.
double air_level(const Scene& scene, const Int16Samples& samples);

struct ExtrusionOptions {
  double threshold = -300.0;  ///< samples of at least this value are solid
  double air = -1000.0;       ///< samples up to 50 above this value are air
  /// The largest thickness of a support, above 0. A part belongs to the body if its cross-section contains a
  /// disc of solid samples wider than this. A slab may be twice as thick if air borders four fifths of its
  /// outline.
  double thick_mm = 40.0;
  Progress progress{};
};

/// Parts whose cross-section repeats along the table: boards, couches, cradles, rails, with their foam.
struct Extrusion {
  std::vector<std::uint8_t> marks;  ///< 1 for each sample of an extruded part, in the scene's order
  glm::dvec2 slope{0.0};   ///< shift of the parts per millimetre along the table: to the side, to the back
  int parts = 0;           ///< number of cross-sections found
  double solid_mm3 = 0.0;  ///< volume of marked samples at or above the threshold
};

/// Finds parts whose samples have nearly constant values over at least 60 mm, or a third of the scan, along
/// the lattice's axis nearest to the table's. The parts may be inclined to that axis by up to 24 degrees. A
/// part is at least 40 mm wide, at most thick_mm thick where it is solid, and borders air along two fifths of
/// its outline, unlike the core of a body. A part thicker than 20 mm must also be 2.5 times as long as thick,
/// unlike a head, a neck or a limb. A part that the patient's tissue covers ends where its samples change.
/// Throws std::invalid_argument if samples are not int16; Stopped. Same bits on any thread count. Cost:
/// linear; memory: one byte per sample.
Extrusion extrusion_of(const Scene& scene, const ExtrusionOptions& options);

}  // namespace octotomy::voxel
