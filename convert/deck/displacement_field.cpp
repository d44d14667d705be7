// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/displacement_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "convert/deck/scan_sampler.h"
#include "convert/tet/element_faces.h"
#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

const Tetrahedra& checked(const Tetrahedra& tetrahedra, std::size_t displacements) {
  if (tetrahedra.tets.empty()) throw voxel::InvalidInput("a displacement field needs elements");
  if (displacements != tetrahedra.nodes_mm.size())
    throw voxel::InvalidInput("a displacement field needs one displacement for each node, not " +
                              std::to_string(displacements) + " of " +
                              std::to_string(tetrahedra.nodes_mm.size()));
  return tetrahedra;
}

double largest_mm(const std::vector<glm::dvec3>& displacement_mm) {
  double largest = 0.0;
  for (const glm::dvec3& displacement : displacement_mm)
    largest = std::max(largest, glm::length(displacement));
  return largest;
}

double checked_fade(double fade_mm, const std::vector<glm::dvec3>& displacement_mm) {
  if (!(fade_mm > least_fade_mm(largest_mm(displacement_mm))))
    throw voxel::InvalidInput("a displacement of " + std::to_string(largest_mm(displacement_mm)) +
                              " mm that fades over " + std::to_string(fade_mm) + " mm folds space");
  return fade_mm;
}

/// In a lattice, many points are exactly as far from one face of the elements as from another one, which may
/// move differently. The nearest point is searched from a place this far beside the point, so that rounding
/// does not choose the face.
constexpr glm::dvec3 tie_break_mm(1e-6, 0.618e-6, 0.382e-6);

}  // namespace

double least_fade_mm(double largest_displacement_mm) {
  // The derivative -20 r (1-r)^3 of (1-r)^4 (4r+1) is steepest at r = 1/4: 20 / 4 * 27 / 64.
  constexpr double steepest = 135.0 / 64.0;
  return steepest * largest_displacement_mm;
}

glm::ivec3 DisplacementField::Bins::bin(const glm::dvec3& p_mm) const {
  return glm::clamp(glm::ivec3(glm::floor((p_mm - low_mm) / side_mm)), glm::ivec3(0), dims - 1);
}

std::size_t DisplacementField::Bins::number(const glm::ivec3& bin) const {
  return static_cast<std::size_t>(bin.x) +
         static_cast<std::size_t>(dims.x) *
             (static_cast<std::size_t>(bin.y) +
              static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(bin.z));
}

DisplacementField::Box DisplacementField::box_of(const Tetrahedra& tetrahedra) {
  Box box{tetrahedra.nodes_mm.front(), tetrahedra.nodes_mm.front()};
  for (const glm::dvec3& p_mm : tetrahedra.nodes_mm) {
    box.low_mm = glm::min(box.low_mm, p_mm);
    box.high_mm = glm::max(box.high_mm, p_mm);
  }
  return box;
}

DisplacementField::Bins DisplacementField::bins_of(const Tetrahedra& tetrahedra) {
  Bins bins;
  const Box box = box_of(tetrahedra);
  bins.low_mm = box.low_mm;
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  // About one bin for each element. The limit along an axis bounds memory for any shape.
  constexpr double most_a_side = 400.0;
  const double longest_mm = std::max({extent_mm.x, extent_mm.y, extent_mm.z});
  bins.side_mm = std::max(
      std::cbrt(extent_mm.x * extent_mm.y * extent_mm.z / static_cast<double>(tetrahedra.tets.size())),
      longest_mm / most_a_side);
  bins.dims = glm::ivec3(extent_mm / bins.side_mm) + 1;
  const auto for_each_bin = [&](std::size_t tet, const auto& visit) {
    const TetCorners p = corners_mm(tetrahedra, tet);
    const glm::ivec3 low = bins.bin(glm::min(glm::min(p[0], p[1]), glm::min(p[2], p[3])));
    const glm::ivec3 high = bins.bin(glm::max(glm::max(p[0], p[1]), glm::max(p[2], p[3])));
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) visit(bins.number({x, y, z}));
  };
  bins.first.assign(bins.number(bins.dims - 1) + 2, 0);
  for (std::size_t tet = 0; tet < tetrahedra.tets.size(); ++tet)
    for_each_bin(tet, [&](std::size_t bin) { ++bins.first[bin + 1]; });
  for (std::size_t bin = 1; bin < bins.first.size(); ++bin) bins.first[bin] += bins.first[bin - 1];
  bins.tets.resize(bins.first.back());
  std::vector<std::uint32_t> next = bins.first;
  for (std::size_t tet = 0; tet < tetrahedra.tets.size(); ++tet)
    for_each_bin(tet, [&](std::size_t bin) { bins.tets[next[bin]++] = static_cast<std::uint32_t>(tet); });
  return bins;
}

DisplacementField::DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm,
                                     double fade_mm)
    : DisplacementField(tetrahedra, displacement_mm, checked_fade(fade_mm, displacement_mm),
                        box_of(checked(tetrahedra, displacement_mm.size())), false) {}

DisplacementField::DisplacementField(Tetrahedra tetrahedra, std::vector<glm::dvec3> displacement_mm,
                                     double fade_mm, Box box, bool is_inverse)
    : tetrahedra_(std::move(tetrahedra)),
      displacement_mm_(std::move(displacement_mm)),
      bins_(bins_of(tetrahedra_)),
      surface_(surface_of(tetrahedra_)),
      surface_tree_(surface_),
      fade_mm_(fade_mm),
      box_(box),
      is_inverse_(is_inverse) {}

double DisplacementField::fading(const glm::dvec3& p_mm) const {
  const double r = std::min(1.0, glm::distance(p_mm, glm::clamp(p_mm, box_.low_mm, box_.high_mm)) / fade_mm_);
  const double square = (1.0 - r) * (1.0 - r);
  return square * square * (4.0 * r + 1.0);
}

glm::dvec3 DisplacementField::faded(const glm::dvec3& p_mm, const glm::dvec3& displacement_mm) const {
  if (!is_inverse_) return fading(p_mm) * displacement_mm;
  // Finds the share s of the displacement d that moves a displaced point p back to its origin: s = fading(p +
  // s d). The iteration converges, because `fade_mm` is above least_fade_mm(). After all rounds, the error is
  // under the tolerance if the displacement is at most 95 % of the largest that `fade_mm` allows.
  constexpr int most_rounds = 400;
  constexpr double tolerance = 1e-12;
  double share = fading(p_mm);
  for (int round = 0; round < most_rounds; ++round) {
    const double next = fading(p_mm + share * displacement_mm);
    if (std::abs(next - share) <= tolerance) return next * displacement_mm;
    share = next;
  }
  return share * displacement_mm;
}

std::optional<glm::dvec3> DisplacementField::within(const glm::dvec3& p_mm) const {
  // With this tolerance a point on a shared face is in one of the two elements in spite of rounding.
  constexpr double slack = 1e-9;
  const std::size_t bin = bins_.number(bins_.bin(p_mm));
  for (std::uint32_t i = bins_.first[bin]; i < bins_.first[bin + 1]; ++i) {
    const TetCorners c = corners_mm(tetrahedra_, bins_.tets[i]);
    const double whole = six_volumes(c);
    const std::array<double, 4> weights{
        six_volumes({p_mm, c[1], c[2], c[3]}) / whole, six_volumes({c[0], p_mm, c[2], c[3]}) / whole,
        six_volumes({c[0], c[1], p_mm, c[3]}) / whole, six_volumes({c[0], c[1], c[2], p_mm}) / whole};
    if (!std::all_of(weights.begin(), weights.end(), [](double weight) { return weight >= -slack; }))
      continue;
    glm::dvec3 displacement(0.0);
    for (std::size_t k = 0; k < 4; ++k)
      displacement += weights[k] * displacement_mm_[tetrahedra_.tets[bins_.tets[i]][k]];
    return displacement;
  }
  return std::nullopt;
}

std::vector<glm::dvec3> DisplacementField::at(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<glm::dvec3> displacements(points_mm.size());
  std::vector<std::uint8_t> found(points_mm.size(), 0);
  tbb::parallel_for(std::size_t{0}, points_mm.size(), [&](std::size_t i) {
    if (const auto displacement = within(points_mm[i])) {
      displacements[i] = *displacement;
      found[i] = 1;
    }
  });
  std::vector<std::size_t> outside;
  std::vector<glm::dvec3> outside_mm;
  for (std::size_t i = 0; i < points_mm.size(); ++i)
    if (found[i] == 0) {
      outside.push_back(i);
      outside_mm.push_back(points_mm[i]);
    }
  if (outside.empty()) return displacements;
  std::vector<glm::dvec3> from_mm = outside_mm;
  for (glm::dvec3& p_mm : from_mm) p_mm += tie_break_mm;
  const std::vector<brep::Foot> feet = surface_tree_.feet(from_mm);
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const auto& corners = surface_.faces[feet[i].face];
    glm::dvec3 of_foot(0.0);
    for (std::size_t k = 0; k < 3; ++k)
      of_foot += feet[i].weights[static_cast<int>(k)] * displacement_mm_[corners[k]];
    displacements[outside[i]] = faded(outside_mm[i], of_foot);
  }
  return displacements;
}

DisplacementField DisplacementField::inverse() const {
  Tetrahedra displaced = tetrahedra_;
  std::vector<glm::dvec3> back(displacement_mm_.size());
  for (std::size_t node = 0; node < back.size(); ++node) {
    displaced.nodes_mm[node] += displacement_mm_[node];
    back[node] = -displacement_mm_[node];
  }
  return {std::move(displaced), std::move(back), fade_mm_, box_, !is_inverse_};
}

std::vector<TurnedOver> DisplacementField::turned_over() const {
  std::vector<TurnedOver> found;
  for (std::size_t tet = 0; tet < tetrahedra_.tets.size(); ++tet) {
    const TetCorners before = corners_mm(tetrahedra_, tet);
    TetCorners after = before;
    for (std::size_t k = 0; k < 4; ++k) after[k] += displacement_mm_[tetrahedra_.tets[tet][k]];
    const double volume = six_volumes(before), displaced_volume = six_volumes(after);
    if (displaced_volume > 0.0) continue;
    found.push_back({(before[0] + before[1] + before[2] + before[3]) / 4.0,
                     volume > 0.0 ? displaced_volume / volume : 0.0});
  }
  return found;
}

brep::Mesh warped(const brep::Mesh& mesh, const DisplacementField& field) {
  brep::Mesh displaced = mesh;
  std::vector<glm::dvec3> points_mm;
  points_mm.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.vertices()) {
    const auto& p = mesh.point(vertex);
    points_mm.emplace_back(p[0], p[1], p[2]);
  }
  const std::vector<glm::dvec3> displacements = field.at(points_mm);
  std::size_t i = 0;
  for (const auto vertex : mesh.vertices()) {
    const glm::dvec3 p_mm = points_mm[i] + displacements[i];
    displaced.set_point(vertex, brep::Mesh::Point(p_mm.x, p_mm.y, p_mm.z));
    ++i;
  }
  return displaced;
}

voxel::Scene warped(const voxel::Scene& scan, const DisplacementField& field,
                    const voxel::Progress& progress) {
  const DisplacementField back = field.inverse();
  const ScanSampler sampler(scan);
  voxel::Scene result = scan;
  const glm::ivec3& dims = scan.lattice.dims;
  const std::size_t slice = static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
  std::vector<glm::dvec3> points_mm;
  points_mm.reserve(slice);
  for (int z = 0; z < dims.z; ++z) {
    progress.at(static_cast<double>(z) / dims.z);
    points_mm.clear();
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) points_mm.push_back(scan.lattice.lps_mm({x, y, z}));
    const std::vector<glm::dvec3> from = back.at(points_mm);
    std::visit(
        [&](auto& samples) {
          using Sample = typename std::decay_t<decltype(samples)>::value_type;
          tbb::parallel_for(std::size_t{0}, slice, [&](std::size_t i) {
            // Voxels that do not move keep their exact values.
            if (from[i] == glm::dvec3(0.0)) return;
            const double value = sampler.at(sampler.voxel(points_mm[i] + from[i]));
            samples[slice * static_cast<std::size_t>(z) + i] =
                static_cast<Sample>(std::is_integral_v<Sample> ? std::floor(value + 0.5) : value);
          });
        },
        result.samples);
  }
  return result;
}

}  // namespace octotomy::convert
