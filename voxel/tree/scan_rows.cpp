// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/scan_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>

#include "voxel/space/error.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {
namespace {

// Interpolates between four rows of samples, at (y, z) = (0, 0), (1, 0), (0, 1), (1, 1). Voxel i of the row
// lies between samples low[i] and high[i]; share[i] is the weight of the latter. Values are rounded to 16
// bits if the samples have 16 bits.
OCTOTOMY_VECTOR_CLONES void interpolate_row(const std::int16_t* const (&rows)[4], const std::int32_t* low,
                                            const std::int32_t* high, const double* share,
                                            const glm::dvec2& yz_share, std::int16_t* row) {
  constexpr std::size_t length = ScanRows::length;
  double along_x[4][length];
  for (std::size_t r = 0; r < 4; ++r) {
    std::int32_t first[length], second[length];
    for (std::size_t i = 0; i < length; ++i) {
      first[i] = rows[r][low[i]];
      second[i] = rows[r][high[i]];
    }
    for (std::size_t i = 0; i < length; ++i)
      along_x[r][i] =
          static_cast<double>(first[i]) * (1.0 - share[i]) + static_cast<double>(second[i]) * share[i];
  }
  const double y = yz_share.x, z = yz_share.y;
  double value[length];
  for (std::size_t i = 0; i < length; ++i) {
    const double below = along_x[0][i] * (1.0 - y) + along_x[1][i] * y;
    const double above = along_x[2][i] * (1.0 - y) + along_x[3][i] * y;
    value[i] = std::floor(below * (1.0 - z) + above * z + 0.5);
  }
  for (std::size_t i = 0; i < length; ++i)
    row[i] = static_cast<std::int16_t>(static_cast<std::int32_t>(value[i]));
}

}  // namespace

ScanRows::ScanRows(const Universe& universe, const Scene& scene, std::int16_t background, double step)
    : scene_(scene),
      dims_(scene.lattice.dims),
      background_(background),
      step_(step),
      scan_from_universe_(glm::inverse(scene.lattice.lps_from_voxel) * universe.lps_from_voxel),
      offset_(whole_voxel_offset(scan_from_universe_)) {
  if (offset_ || !is_diagonal()) return;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < std::max(universe.side(), length); ++i) {
      glm::dvec3 voxel(0.0);
      voxel[axis] = i;
      along_[static_cast<std::size_t>(axis)].push_back(place(axis, position(voxel)[axis]));
    }
  for (const AxisPosition& x : along_[0]) {
    in_row_.low.push_back(x.low);
    in_row_.high.push_back(x.high);
    in_row_.share.push_back(x.share);
  }
}

bool ScanRows::is_diagonal() const {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (column != row && scan_from_universe_[column][row] != 0.0) return false;
  return true;
}

glm::dvec3 ScanRows::position(const glm::dvec3& voxel) const {
  return glm::dvec3(scan_from_universe_ * glm::dvec4(voxel, 1.0));
}

ScanRows::AxisPosition ScanRows::place(int axis, double p) const {
  AxisPosition result;
  result.inside = p >= -0.5 && p <= dims_[axis] - 0.5;
  if (!result.inside) return result;
  const double clamped = std::clamp(p, 0.0, dims_[axis] - 1.0);
  result.low = static_cast<int>(clamped);
  result.high = std::min(result.low + 1, dims_[axis] - 1);
  result.share = clamped - result.low;
  return result;
}

std::array<ScanRows::AxisPosition, 3> ScanRows::places(const glm::ivec3& voxel) const {
  const auto known = [&](int axis) {
    return along_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(voxel[axis])];
  };
  if (!along_[0].empty()) return {known(0), known(1), known(2)};
  const glm::dvec3 p = position(glm::dvec3(voxel));
  return {place(0, p.x), place(1, p.y), place(2, p.z)};
}

std::size_t ScanRows::index(int y, int z) const {
  const auto row =
      static_cast<std::size_t>(z) * static_cast<std::size_t>(dims_.y) + static_cast<std::size_t>(y);
  return row * static_cast<std::size_t>(dims_.x);
}

std::int16_t ScanRows::rounded(double value) const {
  const double nearest = std::floor(value / step_ + 0.5);
  if (!(nearest >= std::numeric_limits<std::int16_t>::min() &&
        nearest <= std::numeric_limits<std::int16_t>::max()))
    throw InvalidInput(scene_.source + ": the sample " + std::to_string(value) +
                       " does not fit into 16 bits: rescale the scan first");
  return static_cast<std::int16_t>(nearest);
}

template <typename Sample>
std::uint16_t ScanRows::copy(const Sample* samples, const glm::ivec3& first, std::int16_t* row) const {
  std::fill_n(row, length, background_);
  if (first.y < 0 || first.z < 0 || first.y >= dims_.y || first.z >= dims_.z) return 0;
  const Sample* source = samples + index(first.y, first.z) + first.x;
  const int begin = std::max(0, -first.x);
  const int end = std::min(length, dims_.x - first.x);
  if (begin >= end) return 0;
  for (int i = begin; i < end; ++i) {
    if constexpr (std::is_same_v<Sample, std::int16_t>)
      row[i] = source[i];
    else if (!scene_.padding || static_cast<double>(source[i]) != *scene_.padding)
      row[i] = rounded(source[i]);
  }
  unsigned inside = (0xffffU >> (length - end)) & (0xffffU << begin);
  if (scene_.padding)
    for (int i = begin; i < end; ++i)
      if (static_cast<double>(source[i]) == *scene_.padding) {
        row[i] = background_;
        inside &= ~(1U << i);
      }
  return static_cast<std::uint16_t>(inside);
}

template <typename Sample>
bool ScanRows::is_mixed(const Sample* samples, const std::array<AxisPosition, 3>& at) const {
  const auto& [x, y, z] = at;
  for (int corner = 0; corner < 8; ++corner) {
    const bool right = (corner & 1) != 0, back = (corner & 2) != 0, up = (corner & 4) != 0;
    const double share =
        (right ? x.share : 1.0 - x.share) * (back ? y.share : 1.0 - y.share) * (up ? z.share : 1.0 - z.share);
    const Sample* own = samples + index(back ? y.high : y.low, up ? z.high : z.low);
    if (share > 0.0 && static_cast<double>(own[right ? x.high : x.low]) == *scene_.padding) return true;
  }
  return false;
}

template <typename Sample>
std::uint16_t ScanRows::interpolate(const Sample* samples, const glm::ivec3& first, std::int16_t* row) const {
  unsigned inside = 0;
  for (int i = 0; i < length; ++i) {
    row[i] = background_;
    const auto [x, y, z] = places(first + glm::ivec3(i, 0, 0));
    if (!x.inside || !y.inside || !z.inside) continue;
    if (scene_.padding && is_mixed(samples, {x, y, z})) continue;
    inside |= 1U << i;
    const auto along_x = [&, &x = x](int j, int k) {
      const Sample* own = samples + index(j, k);
      return static_cast<double>(own[x.low]) * (1.0 - x.share) + static_cast<double>(own[x.high]) * x.share;
    };
    const double below = along_x(y.low, z.low) * (1.0 - y.share) + along_x(y.high, z.low) * y.share;
    const double above = along_x(y.low, z.high) * (1.0 - y.share) + along_x(y.high, z.high) * y.share;
    row[i] = rounded(below * (1.0 - z.share) + above * z.share);
  }
  return static_cast<std::uint16_t>(inside);
}

// Computes a whole row at a time, with the same bits as interpolate().
std::uint16_t ScanRows::interpolate_along(const std::int16_t* samples, const glm::ivec3& first,
                                          std::int16_t* row) const {
  const AxisPosition& y = along_[1][static_cast<std::size_t>(first.y)];
  const AxisPosition& z = along_[2][static_cast<std::size_t>(first.z)];
  if (!y.inside || !z.inside) {
    std::fill_n(row, length, background_);
    return 0;
  }
  const auto x = static_cast<std::size_t>(first.x);
  const std::int16_t* const rows[4] = {samples + index(y.low, z.low), samples + index(y.high, z.low),
                                       samples + index(y.low, z.high), samples + index(y.high, z.high)};
  interpolate_row(rows, &in_row_.low[x], &in_row_.high[x], &in_row_.share[x], {y.share, z.share}, row);
  unsigned inside = 0;
  for (std::size_t i = 0; i < length; ++i) {
    if (along_[0][x + i].inside)
      inside |= 1U << i;
    else
      row[i] = background_;
  }
  return static_cast<std::uint16_t>(inside);
}

int ScanRows::slices_read(int first, int last) const {
  if (offset_) return std::clamp(last + offset_->z + 1, 0, dims_.z);
  const std::vector<AxisPosition>& along_z = along_[2];
  if (along_z.empty()) return dims_.z;
  int count = 0;
  for (int z = first; z <= last; ++z)
    if (const AxisPosition& place = along_z[static_cast<std::size_t>(z)]; place.inside)
      count = std::max(count, place.high + 1);
  return count;
}

const std::int16_t* ScanRows::own_samples(const glm::ivec3& origin) const {
  const auto* shorts = std::get_if<Int16Samples>(&scene_.samples);
  if (shorts == nullptr || !offset_ || scene_.padding) return nullptr;
  const glm::ivec3 first = origin + *offset_;
  if (glm::any(glm::lessThan(first, glm::ivec3(0))) || glm::any(glm::greaterThan(first + length, dims_)))
    return nullptr;
  return shorts->data() + index(first.y, first.z) + first.x;
}

RowSteps ScanRows::steps() const {
  return {index(1, 0), index(0, 1)};
}

std::uint16_t ScanRows::read(const glm::ivec3& first, std::int16_t* row) const {
  return std::visit(
      [&](const auto& samples) {
        if (offset_) return copy(samples.data(), first + *offset_, row);
        if constexpr (std::is_same_v<std::decay_t<decltype(samples)>, Int16Samples>)
          if (!along_[0].empty() && !scene_.padding) return interpolate_along(samples.data(), first, row);
        return interpolate(samples.data(), first, row);
      },
      scene_.samples);
}

}  // namespace octotomy::voxel
