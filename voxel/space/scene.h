// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxel/space/large_allocator.h"
#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// The meaning of the sample values: Hounsfield units, numbers without a known unit, or labels of objects.
enum class Meaning { Hounsfield, Raw, Label };

/// The verdict of a check. Verdicts are ordered by severity, so that the maximum of several is the gravest.
enum class Verdict { Pass, Warn, Fail };

/// One line of a scan's audit: the check, its verdict, and in `detail` what was found and how it was treated.
struct Finding {
  std::string check;
  Verdict verdict = Verdict::Pass;
  std::string detail;
  std::vector<std::string> files = {};  ///< the files concerned, relative to the scan's folder
};

/// A slab between two neighbouring images that are further apart than the others. No image was measured
/// inside the slab, so samples there are interpolated. The slab's position remains valid if a scene is
/// cropped or resampled.
struct Hole {
  glm::dvec3 normal{0, 0, 1};  ///< normal of the images, a unit vector in LPS
  double low_mm = 0.0;         ///< position of the image below: p . normal for its points p
  double high_mm = 0.0;        ///< position of the image above

  double length_mm() const { return high_mm - low_mm; }
};

template <typename Sample>
using Samples = std::vector<Sample, LargeAllocator<Sample>>;
using Int16Samples = Samples<std::int16_t>;
using FloatSamples = Samples<float>;

/// Patient, study and frame of reference as DICOM states them, in UTF-8 without padding; empty if not stated.
/// A scan has one study and one frame of reference; for a structure set, all to which it refers are listed.
struct Identity {
  std::string patient_id, patient_name;
  std::vector<std::string> study_uids, frame_uids;
  std::string id_issuer = {};   ///< issuer of patient_id, which is unique only among this issuer's numbers
  std::string birth_date = {};  ///< YYYYMMDD
  std::string sex = {};         ///< M, F or O
  std::string series_uid = {};  ///< series from which a scan was read; empty for other files
  /// For a structure set, the series on which it was drawn.
  std::vector<std::string> referred_series_uids = {};
  std::string study_date = {};  ///< YYYYMMDD
};

/// Samples on a lattice, x fastest.
struct Scene {
  Lattice lattice;
  std::variant<Int16Samples, FloatSamples> samples;
  Meaning meaning = Meaning::Raw;
  std::string modality;  ///< DICOM's two letters ("CT", "MR"), empty if the file does not say
  std::string source;    ///< its origin, for people
  std::vector<Finding> audit;
  std::vector<Hole> holes = {};  ///< from the lowest on
  Identity identity = {};
  /// For a label map with overlapping labels: maps each number that represents several labels to these
  /// labels, in ascending order.
  std::map<int, std::vector<int>> overlaps = {};
  /// The sample value where the scanner measured nothing; below every measured sample. Interpolation must not
  /// mix it with measurements. None: every sample was measured.
  std::optional<double> padding = {};
  /// The samples' unit as a DICOM file declares it: "HU", "US" (unspecified), "OD", "BQML", "GY". Empty if no
  /// unit is declared, which for a CT means HU (PS3.3, C.8.2.1).
  std::string declared_unit = {};
};

/// A window's lower bound, raised above the padding, so that no window contains unmeasured samples.
double above_padding(const Scene& scene, double low);

/// A range of slices of a lattice, both ends included.
struct SliceRange {
  int first = 0;
  int last = 0;
};
/// The slices of a lattice whose centres lie inside a hole. None if there are no such slices, or if the
/// lattice's slices are not parallel to the hole's images.
std::optional<SliceRange> slices_inside(const Lattice& lattice, const Hole& hole);

/// The smallest and the largest measured sample; both are the padding if no sample was measured.
/// Precondition: the scene is not empty.
struct Range {
  double low = 0.0;
  double high = 0.0;
};
Range range(const Scene& scene);

/// The unit to print after a sample value: "HU" or "1".
std::string unit(const Scene& scene);

/// Throws std::invalid_argument if the number of samples does not match the lattice, or if the lattice is
/// empty, singular or not finite.
void check(const Scene& scene);

/// The sample at a position in index space by trilinear interpolation. Positions outside get the value at the
/// nearest position of the border. Returns the padding if any sample involved is padding. Precondition: the
/// scene passes check().
double interpolate(const Scene& scene, const glm::dvec3& p_voxel);

}  // namespace octotomy::voxel
