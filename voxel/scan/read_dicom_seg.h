// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Whether a file is a DICOM segmentation, by its storage class. Returns false also for files that cannot be
/// read.
bool is_dicom_seg(const std::filesystem::path& path);

/// Reads a DICOM segmentation as a label map: a sample is the number of its segment, or 0 for none. The
/// lattice is that of the frames, unshifted; planes without a frame are empty. The distance between planes is
/// the stated one if all positions deviate from it by at most a fifth; otherwise it is computed from the
/// positions. Where segments overlap, a further number represents all of them (Scene::overlaps). A fractional
/// segment becomes the pixels whose fraction is at least half of the maximum. In the audit, "segments" lists
/// numbers and labels, "overlaps" the segments that overlap. "slice_spacing", "fractions" and "undescribed"
/// report uneven positions, fractional segments that were cut at one half, and segments without a
/// description. Deflated files are inflated. Throws Error (Input) with path and reason, also if frames are
/// turned against each other or off one lattice, or cannot be decompressed. Memory: the file, its
/// decompressed frames, and two bytes per sample of at most four planes per frame.
Scene read_dicom_seg(const std::filesystem::path& path);

/// Reads the fractions of one segment, by its label or number, as samples from 0 to 1 on the same lattice;
/// for a BINARY segment or a label map the samples are only 0 and 1. The audit's "fractions" counts the
/// partial samples; it is a WARN if the file does not state OCCUPANCY. Throws as read_dicom_seg() does, also
/// if there is no such segment.
Scene read_dicom_fractions(const std::filesystem::path& path, const std::string& segment);

}  // namespace octotomy::voxel
