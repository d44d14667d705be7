// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/measure/counted_window.h"
#include "planner/operation/measure/half_width.h"
#include "planner/operation/measure/result_json.h"
#include "verify/interval/size_interval.h"
#include "verify/interval/two_phase.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"

// The recommended volume and area of an object, each one number with one interval.
namespace octotomy::planner {

/// {"value", "unit", "half_width", "coverage", "sources"}.
Json to_json(const verify::Interval& interval, const std::string& unit);

/// Where an object's surface was sampled.
struct SurfaceSamples {
  glm::dmat4 lps_from_scan{1.0};               ///< the scan's lattice, unmoved
  glm::dmat4 moved_from_still{1.0};            ///< LPS to LPS, of all motions since
  std::optional<voxel::GreyOctree> grey = {};  ///< of that scan; none and no samples: no blur is looked for
  std::shared_ptr<const voxel::Scene> samples = {};  ///< the scan's own, which are taken before the octree's
  bool voxels_are_samples = false;                   ///< of the grey octree
  std::optional<double> window_shift_mm = {};
  std::optional<glm::dvec3> along_lps_mm = {};  ///< as verify::SampledFrom's
  /// The samples at which the surface lies; several sources are told apart by them.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool has_upper() const { return high < std::numeric_limits<double>::infinity(); }
};
/// How far a window's surface moves where its lower bound is off: by ten sample units of a scan in HU, of
/// others by a hundredth of their range and at most ten. From the scan's own samples, whatever their unit.
/// None where nothing is inside. Cost: four passes over the samples.
std::optional<double> window_shift_mm(const voxel::Scene& scan, double low, double high);

/// The numbers of a solid of one density, of which the scan shows the whole: those of the sum of its samples.
/// Where that is ambiguous, the surface's, widened to what could be there.
verify::SizeIntervals intervals_of_phases(const verify::TwoPhase& phases, verify::SizeIntervals by_surface);
/// Labels are counted: the number of samples, and what a boundary between them may be off.
verify::SizeIntervals intervals_of_labels(const voxel::Scene& scan, double low, double high,
                                          verify::SizeIntervals by_surface);
/// Adds what counting samples may be off, counting_doubt_mm3(); to the area that share of it.
void add_counting(double doubt_mm3, verify::SizeIntervals& found);
/// Adds what voxels of the plan or the verb, by which the other kernel checks the numbers, may be off.
void add_voxels(const glm::dvec3& voxel_mm, double area_mm2, verify::SizeIntervals& found);

/// Adds what samples as thick as the scan's may hide: what a window's size changes by in samples twice as
/// thick, which is about what it lost by the last halving, and half a sample where the object meets the
/// scan's border. `share` is the object's of the window's surface. Precondition: 0 <= share <= 1.
void add_thickness(const Thickness& thickness, double share, verify::SizeIntervals& found);

/// What people must be told of recommended numbers: a volume that leaves both kernels' answers, with the
/// reason, an area that leaves them by over a tenth, and an interval wider than its value. The answers are
/// the voxels' and the mesh's; one may be missing.
std::vector<std::string> findings_of(const verify::SizeIntervals& found, bool is_of_phases, bool has_core,
                                     const std::array<std::optional<double>, 2>& kernels_mm3,
                                     const std::array<std::optional<double>, 2>& kernels_mm2);

/// By the mesh kernel, whose surface samples place to a part of their spacing. An object of several scans or
/// motions has the interval of each for the share of its surface that the source shows; a cut has none.
/// Precondition: at least one source.
verify::SizeIntervals intervals_of_surface(const brep::Solid& solid,
                                           const std::vector<SurfaceSamples>& sources);

/// By counting, where there are voxels alone: volume_half_width(); the area by Crofton's formula with flat
/// parts along the lattice as they are, its half-width what the formula may lose of oblique planes. Both are
/// widened to what is seen.
verify::SizeIntervals intervals_of_count(const voxel::Measures& measures, const Digitised& digitised,
                                         const voxel::Lattice& lattice,
                                         const std::optional<SeenSize>& seen = {});

}  // namespace octotomy::planner
