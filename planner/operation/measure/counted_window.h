// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "voxel/space/scene.h"

// A window's size by counting a scan's own samples, and how far it depends on how thick they are.
namespace octotomy::planner {

/// The number of samples in a window low..high, padding left out. Parallel; one pass.
std::size_t count_in(const voxel::Scene& scan, double low, double high);

/// The area in mm2 between samples in a window and neighbours out of it, which overstates a boundary of all
/// directions by 3/2. Parallel; same bits on any thread count; one pass.
double faces_mm2(const voxel::Scene& scan, double low, double high);

/// The volume of one sample's cell.
double sample_mm3(const voxel::Scene& scan);

/// What counting samples may be off of the volume of an object of which each sample says whether its own
/// place lies within, 99 of 100 times. Systematic sampling by the planes across each axis (Matheron 1971;
/// Gundersen, Jensen 1987, The efficiency of systematic sampling in stereology): a variance of (3 C0 - 4 C1 +
/// C2) / 12, Ck the sum of products of sections k apart; and what a boundary in no relation to the lattice
/// leaves. Two passes.
double counting_doubt_mm3(const voxel::Scene& scan, double low, double high);

/// Ones where a window holds a sample, zeros elsewhere, for surfaces of labels half-way between samples.
voxel::Scene indicator_of(const voxel::Scene& scan, double low, double high);

/// The mean of every two samples along each axis whose spacing is at least three quarters of the coarsest;
/// the last of an odd number stays alone. A mean holds no padding: of a pair with one padded sample it is the
/// other. Precondition: the scene is not empty. Parallel; memory of half the scan at most.
voxel::Scene averaged_by_two(const voxel::Scene& scan);

/// The area over which a window's samples meet the scan's border; one pass over the outermost samples.
double cut_mm2(const voxel::Scene& scan, double low, double high);
/// What is reported of an object that the scan's border cuts off over such an area; none where that is less
/// than a thousandth of its own.
std::optional<std::string> cut_finding(double cut_mm2, double area_mm2);

/// What nobody knows of a window's size because the scan's samples are as thick as they are.
struct Thickness {
  /// By how much the count changes in a scan of samples twice as thick along its coarsest axes; the area as a
  /// share of itself.
  double volume_change_mm3 = 0.0, area_change_share = 0.0;
  /// Where the object meets the scan's border: half a sample beyond it.
  double border_mm3 = 0.0;
  double faces_mm2 = 0.0;  ///< of the scan as it is
};
/// None where nothing is inside. Cost: five passes over the samples.
std::optional<Thickness> thickness_of(const voxel::Scene& scan, double low, double high);

}  // namespace octotomy::planner
