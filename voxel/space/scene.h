// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxel/space/large_allocator.h"
#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// What a sample's value means.
enum class Meaning { Hounsfield, Raw, Label };

/// Ordered from harmless to grave, so that the gravest of several is their maximum.
enum class Verdict { Pass, Warn, Fail };

/// One line of a scan's audit: the check, its verdict, what was found and done about it.
struct Finding {
  std::string check;
  Verdict verdict = Verdict::Pass;
  std::string detail;
};

template <typename Sample>
using Samples = std::vector<Sample, LargeAllocator<Sample>>;
using Int16Samples = Samples<std::int16_t>;
using FloatSamples = Samples<float>;

/// Samples on a lattice, x fastest.
struct Scene {
  Lattice lattice;
  std::variant<Int16Samples, FloatSamples> samples;
  Meaning meaning = Meaning::Raw;
  std::string modality;  ///< DICOM's two letters ("CT", "MR"), empty if the file does not say
  std::string source;    ///< its origin, for people
  std::vector<Finding> audit;
};

/// Smallest and largest sample. Precondition: the scene is not empty.
struct Range {
  double low = 0.0;
  double high = 0.0;
};
Range range(const Scene& scene);

/// The unit people read beside a value: "HU" or "1".
std::string unit(const Scene& scene);

/// Throws std::invalid_argument if the number of samples is not the lattice's, the lattice is empty,
/// singular or not finite.
void check(const Scene& scene);

/// The sample at a position in index space by trilinear interpolation; positions outside take the nearest
/// border sample. Precondition: the scene passes check().
double interpolate(const Scene& scene, const glm::dvec3& p_voxel);

}  // namespace octotomy::voxel
