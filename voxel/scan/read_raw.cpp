// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_raw.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string_view>

#include "voxel/scan/air_level.h"
#include "voxel/space/file_text.h"
#include "voxel/space/memory_need.h"
#include "voxel/volume/stated_geometry.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

Samples<char> bytes_of_part(const fs::path& path, std::uint64_t offset, std::uint64_t count) {
  std::ifstream in = opened(path);
  in.seekg(static_cast<std::streamoff>(offset));
  Samples<char> bytes(count);
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  if (!in) refuse(path, "cannot be read");
  return bytes;
}

/// The mean difference between neighbours along x, divided by the samples' mean deviation from their mean. It
/// is small for a scan and about 1.4 for random numbers. Reads at most a million samples, in whole rows.
/// Precondition: two bytes a sample.
double roughness(std::string_view bytes, const glm::ivec3& dims, const StoredSamples& stored) {
  const auto value = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[2 * i]),
               second = static_cast<unsigned char>(bytes[2 * i + 1]);
    const int bits = stored.big_endian ? first << 8 | second : second << 8 | first;
    return static_cast<double>(stored.type == SampleType::Int16 ? static_cast<std::int16_t>(bits) : bits);
  };
  const auto width = static_cast<std::size_t>(dims.x), rows = bytes.size() / 2 / width;
  const std::size_t stride = 1 + bytes.size() / 2 / (std::size_t{1} << 20);
  double sum = 0.0, count = 0.0, apart = 0.0, steps = 0.0;
  for (std::size_t row = 0; row < rows; row += stride, count += static_cast<double>(width))
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) sum += value(i);
  for (std::size_t row = 0; row < rows; row += stride)
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      apart += std::abs(value(i) - sum / count);
      if (i > row * width) steps += std::abs(value(i) - value(i - 1));
    }
  return apart > 0.0 ? steps / apart : 0.0;
}

/// Whether the samples are much smoother in the other byte order.
bool is_smoother_swapped(std::string_view bytes, const glm::ivec3& dims, const StoredSamples& stored) {
  if (bytes_of(stored.type) != 2 || dims.x < 8) return false;
  const double rough = roughness(bytes, dims, stored);
  return rough > 0.3 && roughness(bytes, dims, {stored.type, !stored.big_endian}) < 0.4 * rough;
}

}  // namespace

void refuse_without_spacing(const fs::path& path) {
  refuse(path, "does not state its spacing: give --spacing X,Y,Z in mm");
}

void place_without_frame(const fs::path& path, const glm::ivec3& dims, const KnownSpacing& spacing,
                         const ReadOptions& options, Scene& scene) {
  if (options.unit) refuse(path, "its spacing is in " + spacing.unit_says + ": leave --unit out");
  for (int axis = 0; axis < 3; ++axis)
    if (!(spacing.mm[axis] >= 1e-4 && spacing.mm[axis] <= 1e3))
      refuse(path, "a spacing of " + std::to_string(spacing.mm[axis]) +
                       " mm is out of range; give 0.0001 to 1000 by --spacing");
  StatedGeometry geometry;
  geometry.dims = dims;
  for (int axis = 0; axis < 3; ++axis) geometry.file_from_voxel[axis][axis] = spacing.mm[axis];
  geometry.file_from_voxel[3] = glm::dvec4(-0.5 * glm::dvec3(dims - 1) * spacing.mm, 1.0);
  geometry.unit_says = spacing.unit_says;
  scene.lattice = placed(geometry, options.frame, {}, scene.audit);
  scene.audit.push_back(
      {"origin", Verdict::Warn, "the file states no origin: the volume's centre is taken as the origin"});
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
    refuse(path, "is not a regular file; choose a file of raw samples");
  const std::uint64_t held = fs::file_size(path);
  if (held < layout.offset || held - layout.offset != bytes)
    refuse(path, "holds " + std::to_string(held) + " bytes, but the raw layout takes " +
                     std::to_string(layout.offset) + " + " + std::to_string(bytes) +
                     ": check dims, type and offset");
  need_room(path, bytes / bytes_of(layout.type), 2 * bytes_of(layout.type));
  Scene scene;
  scene.source = path.string();
  if (!options.spacing_mm) refuse_without_spacing(path);
  place_without_frame(path, layout.dims, {*options.spacing_mm, given_spacing}, options, scene);
  const StoredSamples stored{layout.type, layout.big_endian};
  const Samples<char> samples = bytes_of_part(path, layout.offset, bytes);
  take_bytes(samples, stored, scene);
  if (is_smoother_swapped({samples.data(), samples.size()}, layout.dims, stored))
    scene.audit.push_back({"byte_order", Verdict::Warn,
                           std::string("read as ") + (stored.big_endian ? "big" : "little") +
                               "-endian, neighbouring samples differ as much as random numbers, and much "
                               "less in the other byte order, which is probably right"});
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
