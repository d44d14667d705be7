// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "voxel/space/scene.h"

// The size of a window, counted in a scan's own samples, and the dependence of this size on the samples'
// thickness.
namespace octotomy::planner {

/// The number of samples in the window low..high. Padding does not count. Parallel; one pass.
std::size_t count_in(const voxel::Scene& scan, double low, double high);

/// The area in mm2 of the faces between samples in the window and neighbours outside of it. It is 3/2 of the
/// area of a boundary with all directions. Parallel; same bits on any thread count; one pass.
double faces_mm2(const voxel::Scene& scan, double low, double high);

/// The volume of one sample's cell in mm3.
double sample_mm3(const voxel::Scene& scan);

/// A bound in mm3 that the error of a counted volume keeps in 99 of 100 cases. A sample counts if its centre
/// lies inside the object. For each axis, sampling by planes (Matheron 1971; Gundersen, Jensen 1987, The
/// efficiency of systematic sampling in stereology) has the variance (3 C0 - 4 C1 + C2) / 12, where Ck is the
/// sum of the products of sections k planes apart. The error of a boundary that is unrelated to the lattice
/// is added. Cost: two passes.
double counting_doubt_mm3(const voxel::Scene& scan, double low, double high);

/// A scene with 1 for samples in the window and 0 elsewhere. Its surface at 0.5 lies half-way between
/// samples.
voxel::Scene indicator_of(const voxel::Scene& scan, double low, double high);

/// Averages pairs of samples along each axis whose spacing is at least three quarters of the coarsest
/// spacing. If their number is odd, the last sample stays unchanged. If one sample of a pair is padding, the
/// other one is the mean. Precondition: the scene is not empty. Parallel; needs at most half the scan's
/// memory.
voxel::Scene averaged_by_two(const voxel::Scene& scan);

/// The area in mm2 in which samples of the window lie at the scan's border. Cost: one pass over the outermost
/// samples.
double cut_mm2(const voxel::Scene& scan, double low, double high);
/// A finding that the scan's border cuts off the object over this area; none if the area is less than a
/// thousandth of the object's area.
std::optional<std::string> cut_finding(double cut_mm2, double area_mm2);

/// Numbers from which the uncertainty of a window's size by the thickness of the samples follows.
struct Thickness {
  /// The changes when samples become twice as thick along the coarsest axes: of the counted volume, and of
  /// the area relative to the area.
  double volume_change_mm3 = 0.0, area_change_share = 0.0;
  /// The volume of half a sample's thickness over the area in which the object meets the scan's border.
  double border_mm3 = 0.0;
  double faces_mm2 = 0.0;  ///< area of the faces in the original scan, by faces_mm2()
};
/// None if no sample lies in the window. Cost: five passes over the samples.
std::optional<Thickness> thickness_of(const voxel::Scene& scan, double low, double high);

}  // namespace octotomy::planner
