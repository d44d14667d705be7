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
#include "planner/operation/measure/measured_size.h"
#include "planner/operation/measure/result_json.h"
#include "verify/interval/size_interval.h"
#include "verify/interval/two_phase.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"

// The recommended volume and area of an object: one number each, with one interval.
namespace octotomy::planner {

/// The record of an interval in results.
MeasuredInterval measured(const verify::Interval& interval, const std::string& unit);

/// The samples from which an object's surface was made.
struct SurfaceSamples {
  glm::dmat4 lps_from_scan{1.0};               ///< the scan's lattice, unmoved
  glm::dmat4 moved_from_still{1.0};            ///< LPS to LPS, of all motions since the surface was made
  std::optional<voxel::GreyOctree> grey = {};  ///< octree of the scan; without it and without samples, no
                                               ///< blur is measured
  std::shared_ptr<const voxel::Scene> samples = {};  ///< the scan's own samples, preferred to those of the
                                                     ///< octree
  bool voxels_are_samples = false;                   ///< the voxels of the grey octree are the scan's samples
  std::optional<double> window_shift_mm = {};
  std::optional<glm::dvec3> along_lps_mm = {};  ///< see the member of this name in verify::SampledFrom
  /// The sample values at which the surface lies. They distinguish several sources.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool has_upper() const { return high < std::numeric_limits<double>::infinity(); }
};
/// The shift in mm of a window's surface if its lower bound changes: by ten units for a scan in HU, else by a
/// hundredth of the range, at most ten. It is computed from the scan's own samples. None if the window is
/// empty. Cost: four passes over the samples.
std::optional<double> window_shift_mm(const voxel::Scene& scan, double low, double high);

/// The sizes of a solid of one density that lies wholly in the scan, from the sum of its samples. If that sum
/// is ambiguous, the sizes of the surface, widened to contain its interval.
verify::SizeIntervals intervals_of_phases(const verify::TwoPhase& phases, verify::SizeIntervals by_surface);
/// The sizes of a label: its counted samples, with the error of a boundary between samples.
verify::SizeIntervals intervals_of_labels(const voxel::Scene& scan, double low, double high,
                                          verify::SizeIntervals by_surface);
/// Adds the error of counting samples, counting_doubt_mm3(), to the volume, and the same share to the area.
void add_counting(double doubt_mm3, verify::SizeIntervals& found);
/// Adds the error of counting in the voxels of the plan or verb.
void add_voxels(const glm::dvec3& voxel_mm, double area_mm2, verify::SizeIntervals& found);

/// Adds the error due to the samples' thickness. Its terms are the change of the window's size if samples
/// become twice as thick, which is about the loss by their present thickness, and half a sample where the
/// object meets the scan's border. `share` is the object's share of the window's surface. Precondition: 0 <=
/// share <= 1.
void add_thickness(const Thickness& thickness, double share, verify::SizeIntervals& found);

/// Findings on recommended numbers: a volume outside of both kernels' answers, with the reason; an area
/// outside of them by more than a tenth; an interval wider than its value. `kernels_mm3` and `kernels_mm2`
/// are the answers of voxels and mesh, of which either may be missing.
std::vector<std::string> findings_of(const verify::SizeIntervals& found, bool is_of_phases, bool has_core,
                                     const std::array<std::optional<double>, 2>& kernels_mm3,
                                     const std::array<std::optional<double>, 2>& kernels_mm2);

/// The sizes by the mesh kernel, whose surface is accurate to a fraction of the samples' spacing. If an
/// object has several sources, each source's error counts for its share of the surface; cuts have no error.
/// Precondition: at least one source.
verify::SizeIntervals intervals_of_surface(const brep::Solid& solid,
                                           const std::vector<SurfaceSamples>& sources);

/// The sizes by counting, if there are only voxels. The volume has volume_half_width(). The area is Crofton's
/// formula, with the exact area of flat parts along the lattice; its half-width is the formula's largest loss
/// on oblique planes. widen_to_seen() may widen both.
verify::SizeIntervals intervals_of_count(const voxel::Measures& measures, const Digitised& digitised,
                                         const voxel::Lattice& lattice,
                                         const std::optional<SeenSize>& seen = {});

}  // namespace octotomy::planner
