// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Offsets and meanings in the header of 540 bytes are from nifti2.h by R. Cox and others, NIfTI-2 2011.
// Numbers are in the file's own byte order.
#include "voxel/scan/read_nifti2.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include "voxel/scan/audit.h"
#include "voxel/scan/sample_stream.h"
#include "voxel/scan/stored_samples.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t header_bytes = 540;

template <typename Number>
Number swapped(Number value) {
  std::array<char, sizeof(Number)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(Number));
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), sizeof(Number));
  return value;
}

class Header {
 public:
  Header(const fs::path& path, std::string_view bytes) : path_(path), bytes_(bytes) {
    if (bytes.size() < header_bytes) refuse(path, "is cut short within its NIfTI-2 header");
    swap_ = raw<std::int32_t>(0) != static_cast<std::int32_t>(header_bytes);
  }

  template <typename Number>
  Number number(std::size_t at) const {
    const Number value = raw<Number>(at);
    return swap_ ? swapped(value) : value;
  }
  bool big_endian() const { return swap_ == (std::endian::native == std::endian::little); }

  glm::ivec3 dims() const {
    const auto axes = number<std::int64_t>(16);
    if (axes < 2 || axes > 7) refuse(path_, "its NIfTI-2 header is damaged: number of axes");
    glm::ivec3 dims(1);
    for (int axis = 0; axis < static_cast<int>(axes); ++axis) {
      const auto length = number<std::int64_t>(24 + 8 * static_cast<std::size_t>(axis));
      if (length < 1 || length > std::numeric_limits<std::int32_t>::max())
        refuse(path_, "its NIfTI-2 header is damaged: dims");
      if (axis >= 3 && length > 1) refuse(path_, "has more than three axes; extract one volume from it");
      if (axis < 3) dims[axis] = static_cast<int>(length);
    }
    return dims;
  }

  SampleType type() const {
    static const std::map<int, SampleType> types{{2, SampleType::UInt8},    {4, SampleType::Int16},
                                                 {8, SampleType::Int32},    {16, SampleType::Float},
                                                 {64, SampleType::Double},  {256, SampleType::Int8},
                                                 {512, SampleType::UInt16}, {768, SampleType::UInt32},
                                                 {1024, SampleType::Int64}, {1280, SampleType::UInt64}};
    const auto found = types.find(number<std::int16_t>(12));
    if (found == types.end()) refuse(path_, "its samples are not single numbers");
    return found->second;
  }

  /// RAS from voxel: the sform, else the qform, else none.
  std::optional<glm::dmat4> affine() const {
    glm::dmat4 ras(1.0);
    if (number<std::int32_t>(348) > 0) {
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
          ras[column][row] =
              number<double>(400 + 32 * static_cast<std::size_t>(row) + 8 * static_cast<std::size_t>(column));
      return ras;
    }
    if (number<std::int32_t>(344) <= 0) return std::nullopt;
    const glm::dvec3 quaternion(number<double>(352), number<double>(360), number<double>(368));
    const double a = std::sqrt(std::max(0.0, 1.0 - glm::dot(quaternion, quaternion)));
    const double sign = number<double>(104) < 0.0 ? -1.0 : 1.0;
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(a, quaternion.x, quaternion.y, quaternion.z));
    for (int axis = 0; axis < 3; ++axis)
      ras[axis] = glm::dvec4(turn[axis] * spacing_mm()[axis] * (axis == 2 ? sign : 1.0), 0.0);
    ras[3] = glm::dvec4(number<double>(376), number<double>(384), number<double>(392), 1.0);
    return ras;
  }

  glm::dvec3 spacing_mm() const { return {number<double>(112), number<double>(120), number<double>(128)}; }

 private:
  template <typename Number>
  Number raw(std::size_t at) const {
    Number value;
    std::memcpy(&value, bytes_.data() + at, sizeof(Number));
    return value;
  }

  const fs::path& path_;
  std::string_view bytes_;
  bool swap_ = false;
};

std::string content_of(const fs::path& path) {
  SampleStream in(path, 0, is_gzip(path));
  std::string bytes, part(std::size_t{1} << 18, '\0');
  while (const std::size_t count = in.read(part.data(), part.size())) bytes.append(part, 0, count);
  return bytes;
}

void place(const Header& header, const glm::ivec3& dims, Scene& scene) {
  scene.lattice.dims = dims;
  const std::optional<glm::dmat4> ras = header.affine();
  scene.lattice.lps_from_voxel = ras.value_or(glm::dmat4(1.0));
  if (ras) {
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 2; ++row)
        scene.lattice.lps_from_voxel[column][row] = -scene.lattice.lps_from_voxel[column][row] + 0.0;
  } else {
    for (int axis = 0; axis < 3; ++axis) scene.lattice.lps_from_voxel[axis][axis] = header.spacing_mm()[axis];
  }
  scene.audit.push_back(frame_finding(ras.has_value()));
}

}  // namespace

bool is_nifti2(const fs::path& path) {
  std::int32_t size = 0;
  try {
    if (SampleStream(path, 0, is_gzip(path)).read(reinterpret_cast<char*>(&size), sizeof size) < sizeof size)
      return false;
  } catch (const Error&) {
    return false;
  }
  constexpr auto wanted = static_cast<std::int32_t>(header_bytes);
  return size == wanted || swapped(size) == wanted;
}

Scene read_nifti2(const fs::path& path) {
  const std::string bytes = content_of(path);
  const Header header(path, bytes);
  const glm::ivec3 dims = header.dims();
  const SampleType type = header.type();
  const auto offset = header.number<std::int64_t>(168);
  // Products of three positive ints below 2^31 and 8 stay below 2^96: compare by division.
  const auto held = static_cast<std::uint64_t>(bytes.size());
  const bool inside =
      offset >= static_cast<std::int64_t>(header_bytes) && static_cast<std::uint64_t>(offset) <= held;
  std::uint64_t left = inside ? (held - static_cast<std::uint64_t>(offset)) / bytes_of(type) : 0;
  for (int axis = 0; axis < 3; ++axis) left /= static_cast<std::uint64_t>(dims[axis]);
  if (!inside || left == 0)
    refuse(path, "its header claims more samples than the file holds; it is cut short or damaged");
  Scene scene;
  scene.source = path.string();
  place(header, dims, scene);
  StoredSamples stored{type, header.big_endian()};
  const auto slope = header.number<double>(176);
  const auto intercept = header.number<double>(184);
  if (std::isfinite(slope) && slope != 0.0 && std::isfinite(intercept)) {
    stored.slope = slope;
    stored.intercept = intercept;
  }
  take_bytes(std::span(bytes).subspan(static_cast<std::size_t>(offset),
                                      scene.lattice.sample_count() * bytes_of(type)),
             stored, scene);
  return scene;
}

}  // namespace octotomy::voxel
