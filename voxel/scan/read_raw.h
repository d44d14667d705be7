// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <span>

#include "voxel/scan/read_scene.h"

namespace octotomy::voxel {

/// Reads a file of samples without a header in the options' layout and spacing. Its axes point along the
/// options' frame or are assumed to point to the patient's left, back and head, centred on the origin; the
/// audit reports this. Throws Error (Input) if the layout is unusable, no spacing is given, or the file's
/// size does not match the layout.
Scene read_raw(const std::filesystem::path& path, const ReadOptions& options);

/// A spacing, and the audit's text on the origin of its unit.
struct KnownSpacing {
  glm::dvec3 mm{1.0};
  std::string unit_says;
};
inline constexpr const char* given_spacing = "mm (--spacing)";

/// Throws Error (Input) naming the path.
[[noreturn]] void refuse_without_spacing(const std::filesystem::path& path);

/// Places a scene whose file has no patient frame: axes along the options' frame or else LPS, centred on the
/// origin; the audit reports this. Throws Error (Input) naming the path, if the options have a unit or no
/// scanner has this spacing.
void place_without_frame(const std::filesystem::path& path, const glm::ivec3& dims,
                         const KnownSpacing& spacing, const ReadOptions& options, Scene& scene);

/// Converts the samples of a file that does not state its modality, as take_stored() does. Their meaning is
/// decided from their air (air_level.h) and reported in the audit. Precondition: the bytes are the samples of
/// the scene's lattice. Throws as take_stored() does.
void take_bytes(std::span<const char> bytes, const StoredSamples& stored, Scene& scene);

}  // namespace octotomy::voxel
