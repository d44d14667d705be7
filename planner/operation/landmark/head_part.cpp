// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 The largest components of the bone, by voxel faces, are numbered in cells of about 2 mm.
// 2 Six sweeps along the axes count from how many sides each cell sees each part: the skull surrounds most.
// 3 Parts that soft tissue does not cover, or that lie beside or behind the skull, are not the patient's.
#include "planner/operation/landmark/head_part.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "brep/mesh/triangles.h"
#include "voxel/filter/components.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/interpolate.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::planner {
namespace {

constexpr double cell_mm = 2.0;
constexpr std::size_t most_parts = 8;       ///< a bit each
constexpr double least_part_mm3 = 300.0;    ///< about a tooth; smaller parts contain no landmark
constexpr double least_cavity_mm3 = 2.0e5;  ///< least space of a brain case, or of its part in the scan
constexpr double tissue_hu = -300.0;        ///< between air and soft tissue
constexpr double least_cover = 0.7;         ///< least share of a part's surface that tissue covers
constexpr double least_skull_cover = 0.6;   ///< if tissue covers less of the skull, the skull is dry
constexpr double least_within = 0.6;        ///< least share of a part's cells in the skull's surroundings
constexpr double aside_mm = 12.0, before_mm = 25.0, behind_mm = 3.0;  ///< the surroundings

class Cells {
 public:
  Cells(const voxel::DrawnObject& bone, std::vector<voxel::Octree> parts)
      : bone_(bone), parts_(std::move(parts)), universe_(bone.octree.universe()) {
    const glm::dvec3 spacing = universe_.lattice().spacing_mm();
    step_ = glm::max(glm::ivec3(glm::round(cell_mm / spacing)), glm::ivec3(1));
    dims_ = (glm::ivec3(universe_.side()) + step_ - 1) / step_;
    size_mm_ = spacing * glm::dvec3(step_);
    fill();
  }

  const glm::ivec3& dims() const { return dims_; }
  const glm::ivec3& step() const { return step_; }
  double cell_mm3() const { return size_mm_.x * size_mm_.y * size_mm_.z; }

  /// For each part, the number and the centre of the cells that it surrounds.
  struct Surrounded {
    double cells = 0.0;
    glm::dvec3 sum_voxel{0.0};
  };
  std::vector<Surrounded> surrounded() const {
    std::array<std::vector<std::uint8_t>, 6> seen;
    for (int way = 0; way < 6; ++way) seen[static_cast<std::size_t>(way)] = swept(way / 2, way % 2 == 1);
    std::vector<Surrounded> all(parts_.size());
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if (of_[i] != 0) continue;
      for (std::size_t part = 0; part < parts_.size(); ++part) {
        int ways = 0;
        for (const auto& one : seen) ways += one[i] >> part & 1;
        if (ways < 5) continue;
        all[part].cells += 1.0;
        all[part].sum_voxel += voxel_of(place(i));
      }
    }
    return all;
  }

  /// The share of a part's surface next to which samples are tissue; none if there are no samples.
  std::optional<double> cover(std::size_t part) const {
    if (!bone_.grey) return std::nullopt;
    const std::optional<glm::dmat4> still = bone_.still_from_voxel();
    double outside = 0.0, covered = 0.0;
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if ((of_[i] >> part & 1) == 0) continue;
      const glm::ivec3 at = place(i);
      for (int way = 0; way < 6; ++way) {
        glm::ivec3 off(0);
        off[way / 2] = way % 2 == 0 ? -1 : 1;
        if (at_cell(at + off) != 0 || at_cell(at + 2 * off) != 0) continue;
        const glm::dvec3 voxel = voxel_of(at + 2 * off);
        const glm::dvec3 sample = still ? glm::dvec3(*still * glm::dvec4(voxel, 1.0)) : voxel;
        // Where the scan ends, the part has no surface.
        if (!bone_.grey->scan().contains(glm::ivec3(glm::round(sample)))) continue;
        outside += 1.0;
        if (bone_.grey->step() * voxel::interpolate(*bone_.grey, sample, voxel::Interpolation::Nearest) >=
            tissue_hu)
          covered += 1.0;
      }
    }
    return outside > 0.0 ? covered / outside : 1.0;
  }

  /// The share of a part's cells that lie in the skull's surroundings or below the skull.
  double within_surroundings(std::size_t part, std::size_t skull) const {
    // The skull's extent. On each side the outermost thousandth of its cells is ignored.
    std::array<std::vector<double>, 3> along;
    for (std::size_t i = 0; i < of_.size(); ++i)
      if (of_[i] >> skull & 1)
        for (int axis = 0; axis < 3; ++axis)
          along[static_cast<std::size_t>(axis)].push_back(lps_of(place(i))[axis]);
    glm::dvec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      auto& values = along[static_cast<std::size_t>(axis)];
      const auto few = static_cast<std::ptrdiff_t>(values.size() / 1000);
      std::nth_element(values.begin(), values.begin() + few, values.end());
      low[axis] = values[static_cast<std::size_t>(few)];
      std::nth_element(values.begin(), values.end() - 1 - few, values.end());
      high[axis] = values[values.size() - 1 - static_cast<std::size_t>(few)];
    }
    double all = 0.0, within = 0.0;
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if ((of_[i] >> part & 1) == 0) continue;
      const glm::dvec3 p = lps_of(place(i));
      all += 1.0;
      if (p.x > low.x - aside_mm && p.x < high.x + aside_mm && p.y > low.y - before_mm &&
          p.y < high.y + behind_mm && p.z < high.z + behind_mm)
        within += 1.0;
    }
    return all > 0.0 ? within / all : 0.0;
  }

  /// Cells that contain voxels of one of the parts, and their neighbours.
  std::vector<bool> near(std::uint8_t kept) const {
    std::vector<bool> is_near(of_.size(), false);
    for (std::size_t i = 0; i < of_.size(); ++i) {
      if ((of_[i] & kept) == 0) continue;
      const glm::ivec3 at = place(i);
      for (int z = std::max(at.z - 1, 0); z <= std::min(at.z + 1, dims_.z - 1); ++z)
        for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, dims_.y - 1); ++y)
          for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, dims_.x - 1); ++x)
            is_near[index({x, y, z})] = true;
    }
    return is_near;
  }

 private:
  std::size_t index(const glm::ivec3& c) const {
    return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(dims_.y) +
            static_cast<std::size_t>(c.y)) *
               static_cast<std::size_t>(dims_.x) +
           static_cast<std::size_t>(c.x);
  }
  glm::ivec3 place(std::size_t i) const {
    const auto x = static_cast<std::size_t>(dims_.x), y = static_cast<std::size_t>(dims_.y);
    return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))};
  }
  std::uint8_t at_cell(const glm::ivec3& c) const {
    if (glm::any(glm::lessThan(c, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(c, dims_))) return 0;
    return of_[index(c)];
  }
  glm::dvec3 voxel_of(const glm::ivec3& cell) const {
    return glm::dvec3(cell * step_) + 0.5 * glm::dvec3(step_ - 1);
  }
  glm::dvec3 lps_of(const glm::ivec3& cell) const { return universe_.lattice().lps_mm(voxel_of(cell)); }

  void fill() {
    of_.assign(static_cast<std::size_t>(dims_.x) * static_cast<std::size_t>(dims_.y) *
                   static_cast<std::size_t>(dims_.z),
               0);
    for (std::size_t part = 0; part < parts_.size(); ++part)
      voxel::for_each_slice(parts_[part], [&](int z, const voxel::SliceBits& slice) {
        for (int y = 0; y < slice.side; ++y)
          for (int first = 0, last = -1; last + 1 < slice.side && next_run(slice, y, last + 1, first, last);)
            for (int x = first / step_.x; x <= last / step_.x; ++x) {
              std::uint8_t& of = of_[index({x, y / step_.y, z / step_.z})];
              of = static_cast<std::uint8_t>(of | 1U << part);
            }
      });
  }

  /// For each cell, the parts met along an axis from its low or its high end up to the cell.
  std::vector<std::uint8_t> swept(int axis, bool from_high) const {
    std::vector<std::uint8_t> met(of_.size(), 0);
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    glm::ivec3 at;
    for (at[a] = 0; at[a] < dims_[a]; ++at[a])
      for (at[b] = 0; at[b] < dims_[b]; ++at[b]) {
        std::uint8_t so_far = 0;
        for (int k = 0; k < dims_[axis]; ++k) {
          at[axis] = from_high ? dims_[axis] - 1 - k : k;
          so_far = static_cast<std::uint8_t>(so_far | of_[index(at)]);
          met[index(at)] = so_far;
        }
      }
    return met;
  }

  const voxel::DrawnObject& bone_;
  std::vector<voxel::Octree> parts_;
  voxel::Universe universe_;
  glm::ivec3 step_{1}, dims_{0};
  glm::dvec3 size_mm_{1.0};
  std::vector<std::uint8_t> of_;  ///< for each cell, one bit for each part in it
};

/// The largest components, and the number of the other components.
std::vector<voxel::Octree> largest_parts(const voxel::Octree& bone, const voxel::Progress& progress) {
  const double voxel_mm3 = bone.universe().lattice().voxel_mm3();
  voxel::Octree rest =
      voxel::components_of_at_least(bone, static_cast<std::uint64_t>(std::ceil(least_part_mm3 / voxel_mm3)));
  std::vector<voxel::Octree> parts;
  while (parts.size() < most_parts && !rest.is_empty()) {
    progress.at(0.5 * static_cast<double>(parts.size()) / most_parts);
    parts.push_back(voxel::components(rest).largest);
    rest = voxel::combine(rest.universe(), voxel::Expression(rest) - voxel::Expression(parts.back()));
  }
  return parts;
}

}  // namespace

brep::Mesh HeadPart::surface_of(const brep::Mesh& surface) const {
  brep::Triangles triangles = brep::triangles_of(surface);
  const voxel::Lattice lattice = bone.universe().lattice();
  std::erase_if(triangles.faces, [&](const auto& face) {
    const glm::dvec3 middle =
        (triangles.points_mm[face[0]] + triangles.points_mm[face[1]] + triangles.points_mm[face[2]]) / 3.0;
    const glm::ivec3 cell = glm::ivec3(glm::floor((lattice.voxel(middle) + 0.5) / glm::dvec3(cell_voxels)));
    if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(cell, cells)))
      return true;
    return !is_near[(static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(cells.y) +
                     static_cast<std::size_t>(cell.y)) *
                        static_cast<std::size_t>(cells.x) +
                    static_cast<std::size_t>(cell.x)];
  });
  return brep::mesh_of(triangles);
}

HeadPart head_part(const voxel::DrawnObject& bone, const voxel::Progress& progress) {
  const std::vector<voxel::Octree> parts = largest_parts(bone.octree, progress);
  if (parts.empty()) return {bone.octree, std::nullopt, 0, 0.0, {}, glm::ivec3(1), {}};
  const Cells cells(bone, parts);
  const std::vector<Cells::Surrounded> surrounded = cells.surrounded();
  const auto most = std::max_element(surrounded.begin(), surrounded.end(),
                                     [](const auto& a, const auto& b) { return a.cells < b.cells; });
  const bool has_cavity = most->cells * cells.cell_mm3() >= least_cavity_mm3;
  const auto skull = has_cavity ? static_cast<std::size_t>(most - surrounded.begin()) : 0;
  const std::optional<double> skull_cover = cells.cover(skull);
  const bool is_covered = skull_cover && *skull_cover >= least_skull_cover;
  HeadPart head{parts[skull], std::nullopt, 0, 0.0, cells.dims(), cells.step(), {}};
  if (has_cavity) head.cavity_mm = bone.octree.universe().lattice().lps_mm(most->sum_voxel / most->cells);
  std::uint8_t kept = static_cast<std::uint8_t>(1U << skull);
  voxel::Expression all(parts[skull]);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (part == skull) continue;
    const bool is_large = parts[part].voxel_count() * 20 >= parts[skull].voxel_count();
    const bool is_bone = is_covered ? *cells.cover(part) >= least_cover : is_large;
    if (is_bone && cells.within_surroundings(part, skull) >= least_within) {
      kept = static_cast<std::uint8_t>(kept | 1U << part);
      all = all | voxel::Expression(parts[part]);
    } else {
      ++head.removed_count;
      head.removed_mm3 +=
          static_cast<double>(parts[part].voxel_count()) * bone.octree.universe().lattice().voxel_mm3();
    }
  }
  head.bone = voxel::combine(bone.octree.universe(), all);
  head.is_near = cells.near(kept);
  return head;
}

}  // namespace octotomy::planner
