// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"

namespace octotomy::voxel {

/// Images of one series that can lie in one volume.
struct DicomSubseries {
  std::vector<DicomSlice> slices;
  std::string words;  ///< how they differ from the other images of the series: "kernel H60s, acquisition 2"
};

/// Whether two images have the same size, and spacings whose difference shifts no pixel by more than half a
/// pixel.
bool same_grid(const DicomSlice& a, const DicomSlice& b);
/// The distance in pixels by which the farthest corner of an image moves if its rows and columns are turned
/// to the given directions.
double turned_px(const DicomSlice& slice, const glm::dvec3& along_row, const glm::dvec3& along_column);
/// Whether two images lie in parallel planes with parallel rows, up to a rotation that moves no pixel by more
/// than half a pixel.
bool same_orientation(const DicomSlice& a, const DicomSlice& b);

/// Adds each image, in order, to the first group whose first image satisfies `alike` with it, or to a new
/// group. Cost: number of images times number of groups.
std::vector<std::vector<DicomSlice>> grouped(
    std::vector<DicomSlice> slices, const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike);

/// Splits the images of one series by size, orientation and identity. Splits images at one position by the
/// attribute in which most of these images differ (kernel, acquisition, phase); otherwise, if nearly every
/// position has several images, by time or number. Groups with most images come first. Images at one position
/// that differ in no attribute stay together. With `join`, images of several studies and frames of reference
/// stay together. Scout views are left out unless there are no other images.
std::vector<DicomSubseries> subseries_of(const std::vector<DicomSlice>& series, bool join = false);

/// Splits images that have one size, orientation and position, by the same attributes as subseries_of().
std::vector<DicomSubseries> parted_at_one_place(std::vector<DicomSlice> slices);

}  // namespace octotomy::voxel
