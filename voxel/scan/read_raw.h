// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <span>

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads a file of samples without a header in the options' layout and spacing. Its axes point along the
/// options' frame or are assumed to point to the patient's left, back and head, centred on the origin; the
/// audit reports this. Throws Error (Input) if the layout is unusable, no spacing is given, or the file is
/// not a regular file of the size that the layout states.
Scene read_raw(const std::filesystem::path& path, const ReadOptions& options);

/// A spacing in mm, and the words with which the audit states the unit's source.
struct KnownSpacing {
  glm::dvec3 mm{1.0};
  std::string unit_says;
};
inline constexpr const char* given_spacing = "mm (--spacing)";

/// Throws Error (Input): the file at `path` states no spacing, and neither do the options.
[[noreturn]] void refuse_without_spacing(const std::filesystem::path& path);

/// Sets the lattice of a scene whose file states no patient frame: axes along the options' frame or else LPS,
/// centred on the origin. The audit reports this. Throws Error (Input) with the path if the options state a
/// unit, or if no scanner has this spacing.
void place_without_frame(const std::filesystem::path& path, const glm::ivec3& dims,
                         const KnownSpacing& spacing, const ReadOptions& options, Scene& scene);

/// Converts stored samples as take_stored() does, for a file that states no modality. Their meaning is
/// derived from the air in them (air_level.h) and reported in the audit. Precondition: the bytes are the
/// samples of the scene's lattice. Throws as take_stored() does.
void take_bytes(std::span<const char> bytes, const StoredSamples& stored, Scene& scene);

}  // namespace octotomy::voxel
