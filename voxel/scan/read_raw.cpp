// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_raw.h"

#include <algorithm>
#include <cassert>
#include <fstream>
#include <limits>

#include "voxel/scan/air_level.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/volume/stated_geometry.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

std::string bytes_of_part(const fs::path& path, std::uint64_t offset, std::uint64_t count) {
  std::ifstream in = opened(path);
  in.seekg(static_cast<std::streamoff>(offset));
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  if (!in) refuse(path, "cannot be read");
  return bytes;
}

}  // namespace

void place_without_frame(const fs::path& path, const glm::ivec3& dims, const ReadOptions& options,
                         Scene& scene) {
  if (options.unit) refuse(path, "its spacing is --spacing, in mm: leave --unit out");
  if (!options.spacing_mm) refuse(path, "does not state its spacing: give --spacing X,Y,Z in mm");
  const glm::dvec3 spacing_mm = *options.spacing_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (!(spacing_mm[axis] >= 1e-4 && spacing_mm[axis] <= 1e3))
      refuse(path,
             "a spacing of " + std::to_string(spacing_mm[axis]) + " mm is out of range; give 0.0001 to 1000");
  StatedGeometry geometry;
  geometry.dims = dims;
  for (int axis = 0; axis < 3; ++axis) geometry.file_from_voxel[axis][axis] = spacing_mm[axis];
  geometry.file_from_voxel[3] = glm::dvec4(-0.5 * glm::dvec3(dims - 1) * spacing_mm, 1.0);
  geometry.unit_says = "mm (--spacing)";
  scene.lattice = placed(geometry, options.frame, {}, scene.audit);
}

Scene read_raw(const fs::path& path, const ReadOptions& options) {
  const RawLayout& layout = options.raw.value();
  constexpr int most_a_side = 1 << 20;
  std::uint64_t bytes = bytes_of(layout.type);
  for (int axis = 0; axis < 3; ++axis) {
    if (layout.dims[axis] < 1 || layout.dims[axis] > most_a_side)
      refuse(path, "raw dims of " + std::to_string(layout.dims[axis]) + " are out of range; give 1 to " +
                       std::to_string(most_a_side));
    if (bytes > std::numeric_limits<std::uint64_t>::max() / static_cast<std::uint64_t>(layout.dims[axis]))
      refuse(path, "raw dims are larger than any file; check them");
    bytes *= static_cast<std::uint64_t>(layout.dims[axis]);
  }
  if (std::error_code ignored; !fs::is_regular_file(path, ignored))
    refuse(path, "is no regular file; give a file of raw samples");
  const std::uint64_t held = fs::file_size(path);
  if (held < layout.offset || held - layout.offset != bytes)
    refuse(path, "holds " + std::to_string(held) + " bytes, but the raw layout takes " +
                     std::to_string(layout.offset) + " + " + std::to_string(bytes) +
                     ": check dims, type and offset");
  need_memory(path, bytes / bytes_of(layout.type), 2 * bytes_of(layout.type));
  Scene scene;
  scene.source = path.string();
  place_without_frame(path, layout.dims, options, scene);
  take_bytes(bytes_of_part(path, layout.offset, bytes), {layout.type, layout.big_endian}, scene);
  return scene;
}

void take_bytes(std::span<const char> bytes, const StoredSamples& stored, Scene& scene) {
  assert(bytes.size() == scene.lattice.sample_count() * bytes_of(stored.type));
  take_stored(stored, scene,
              [&](char* memory, std::size_t count) { std::copy_n(bytes.data(), count, memory); });
  const AirLevel air = air_level_of_unnamed(scene);
  scene.meaning = air.meaning;
  scene.audit.push_back(air.finding);
  if (scene.meaning == Meaning::Hounsfield) take_unstated_padding(scene);
}

}  // namespace octotomy::voxel
