// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/read_scene.h"

namespace octotomy::voxel {

/// Reads a file of samples without a header, as the options' layout and spacing say. It names no patient
/// frame: its axes are taken as the patient's left, back and head, about the origin, which the audit says.
/// Throws std::runtime_error where the layout is unusable, no spacing is given, or the file has not the bytes
/// that the layout takes.
Scene read_raw(const std::filesystem::path& path, const ReadOptions& options);

/// A lattice of the spacing about the origin, axes along LPS: what files without a frame are given. Throws
/// std::runtime_error naming the path where the options have no spacing or one that is not positive.
Lattice lattice_without_frame(const std::filesystem::path& path, const glm::ivec3& dims,
                              const ReadOptions& options);
/// The audit's line on that.
Finding no_frame_finding();

}  // namespace octotomy::voxel
