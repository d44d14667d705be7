// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "voxel/space/scene.h"

// A window's size by counting a scan's own samples, and its dependence on their thickness.
namespace octotomy::planner {

/// The number of samples in a window low..high, padding left out. Parallel; one pass.
std::size_t count_in(const voxel::Scene& scan, double low, double high);

/// The area in mm2 between samples in a window and neighbours out of it, which overstates a boundary of all
/// directions by 3/2. Parallel; same bits on any thread count; one pass.
double faces_mm2(const voxel::Scene& scan, double low, double high);

/// The volume of one sample's cell.
double sample_mm3(const voxel::Scene& scan);

/// The bound that the error of a counted volume keeps in 99 of 100 cases. Each sample counts if its own
/// position is inside. Systematic sampling by the planes across each axis (Matheron 1971; Gundersen, Jensen
/// 1987, The efficiency of systematic sampling in stereology) has a variance of (3 C0 - 4 C1 + C2) / 12, Ck
/// the sum of products of sections k apart. Adds the error of a boundary that is unrelated to the lattice.
/// Cost: two passes.
double counting_doubt_mm3(const voxel::Scene& scan, double low, double high);

/// Ones for samples in a window, zeros elsewhere, for surfaces of labels half way between samples.
voxel::Scene indicator_of(const voxel::Scene& scan, double low, double high);

/// Averages pairs of samples along each axis whose spacing is at least three quarters of the coarsest; with
/// an odd number, the last sample is unchanged. If one sample of a pair is padding, the mean is the other
/// one. Precondition: the scene is not empty. Parallel; memory of half the scan at most.
voxel::Scene averaged_by_two(const voxel::Scene& scan);

/// The area in which a window's samples meet the scan's border. Cost: one pass over the outermost samples.
double cut_mm2(const voxel::Scene& scan, double low, double high);
/// The finding on an object that the scan's border cuts off over such an area; none if it is less than a
/// thousandth of the object's area.
std::optional<std::string> cut_finding(double cut_mm2, double area_mm2);

/// The uncertainty of a window's size due to the thickness of the scan's samples.
struct Thickness {
  /// The changes in a scan of samples twice as thick along its coarsest axes: of the counted volume, and of
  /// the area as a share of itself.
  double volume_change_mm3 = 0.0, area_change_share = 0.0;
  /// The volume of half a sample beyond the scan's border, where the object meets it.
  double border_mm3 = 0.0;
  double faces_mm2 = 0.0;  ///< faces in the original scan
};
/// None if no sample is inside. Cost: five passes over the samples.
std::optional<Thickness> thickness_of(const voxel::Scene& scan, double low, double high);

}  // namespace octotomy::planner
