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

/// Whether two images have equal pixels in size and spacing: nowhere do their pixels part by more than half.
bool same_grid(const DicomSlice& a, const DicomSlice& b);
/// By how many of its pixels the farthest corner of an image moves if its rows and columns take other
/// directions.
double turned_px(const DicomSlice& slice, const glm::dvec3& along_row, const glm::dvec3& along_column);
/// Whether two images lie in parallel planes with parallel rows, but for what turns no pixel by more than
/// half.
bool same_orientation(const DicomSlice& a, const DicomSlice& b);

/// Puts each image into the first group whose first image it is like, or into a new one; in the order of the
/// images. Cost: images by groups.
std::vector<std::vector<DicomSlice>> grouped(
    std::vector<DicomSlice> slices, const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike);

/// Parts the images of one series by size, orientation and identity, and images at one place by the attribute
/// that parts most of them: a kernel, an acquisition, a phase; else by their order in time or by their
/// numbers, if several lie at nearly each place. Most images first. Images at one place that nothing tells
/// apart stay together. `join` puts images of several studies and frames of reference together. Scout views
/// stay out unless there is nothing else.
std::vector<DicomSubseries> subseries_of(const std::vector<DicomSlice>& series, bool join = false);

/// Parts images at one place, of one size and orientation, as subseries_of() does.
std::vector<DicomSubseries> parted_at_one_place(std::vector<DicomSlice> slices);

}  // namespace octotomy::voxel
