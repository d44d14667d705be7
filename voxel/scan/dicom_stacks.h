// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "voxel/scan/dicom_slice.h"

namespace octotomy::voxel {

/// Images of one series that can lie in one volume.
struct DicomSubseries {
  std::vector<DicomSlice> slices;
  std::string words;  ///< what tells them from the series' others: "kernel H60s, acquisition 2"
};

/// Whether two images have equal pixels in size and spacing.
bool same_grid(const DicomSlice& a, const DicomSlice& b);
/// Whether two images lie in parallel planes with parallel rows.
bool same_orientation(const DicomSlice& a, const DicomSlice& b);

/// Puts each image into the first group whose first image it is like, or into a new one; in the order of the
/// images. Cost: images by groups.
std::vector<std::vector<DicomSlice>> grouped(
    std::vector<DicomSlice> slices, const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike);

/// Parts the images of one series by size, orientation and identity, and images at one place by the attribute
/// that parts most of them: a kernel, an acquisition, a phase. Most images first. Images at one place that no
/// attribute tells apart stay together. Scout views stay out unless there is nothing else.
std::vector<DicomSubseries> subseries_of(const std::vector<DicomSlice>& series);

/// Parts images at one place, of one size and orientation, as subseries_of() does.
std::vector<DicomSubseries> parted_at_one_place(std::vector<DicomSlice> slices);

}  // namespace octotomy::voxel
