// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/read_raw.h"

#include <fstream>
#include <limits>

#include "voxel/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

std::string bytes_of_part(const fs::path& path, std::uint64_t offset, std::uint64_t count) {
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  if (!in) refuse(path, "cannot be read");
  return bytes;
}

}  // namespace

Lattice lattice_without_frame(const fs::path& path, const glm::ivec3& dims, const ReadOptions& options) {
  if (!options.spacing_mm)
    refuse(path, "does not say how far its samples lie apart: give --spacing X,Y,Z in mm");
  const glm::dvec3 spacing_mm = *options.spacing_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (!(spacing_mm[axis] >= 1e-4 && spacing_mm[axis] <= 1e3))
      refuse(path, "a spacing of " + std::to_string(spacing_mm[axis]) + " mm is none; give 0.0001 to 1000");
  return axis_aligned_lattice(dims, spacing_mm, -0.5 * glm::dvec3(dims - 1) * spacing_mm);
}

Finding no_frame_finding() {
  return {"orientation", Verdict::Warn,
          "the file names no patient frame: columns are taken to go to the patient's left, rows to the back, "
          "slices to the head, so that the patient may be mirrored"};
}

Scene read_raw(const fs::path& path, const ReadOptions& options) {
  const RawLayout& layout = options.raw.value();
  constexpr int most_a_side = 1 << 20;
  std::uint64_t bytes = bytes_of(layout.type);
  for (int axis = 0; axis < 3; ++axis) {
    if (layout.dims[axis] < 1 || layout.dims[axis] > most_a_side)
      refuse(path, "raw dims of " + std::to_string(layout.dims[axis]) + " are unusable");
    if (bytes > std::numeric_limits<std::uint64_t>::max() / static_cast<std::uint64_t>(layout.dims[axis]))
      refuse(path, "raw dims are more than any file holds");
    bytes *= static_cast<std::uint64_t>(layout.dims[axis]);
  }
  if (!fs::is_regular_file(path)) refuse(path, "is no file of raw samples");
  const std::uint64_t held = fs::file_size(path);
  if (held < layout.offset || held - layout.offset != bytes)
    refuse(path, "holds " + std::to_string(held) + " bytes where the raw layout takes " +
                     std::to_string(layout.offset) + " + " + std::to_string(bytes) +
                     ": check dims, type and offset");
  Scene scene;
  scene.source = path.string();
  scene.lattice = lattice_without_frame(path, layout.dims, options);
  scene.audit.push_back(no_frame_finding());
  take_bytes(bytes_of_part(path, layout.offset, bytes), {layout.type, layout.big_endian}, scene);
  return scene;
}

}  // namespace octotomy::voxel
