// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/split_sides.h"

#include <algorithm>

namespace octotomy::convert {

namespace {

double least_angle_deg(const TetCorners& corners_mm) {
  Tetrahedra alone;
  alone.nodes_mm.assign(corners_mm.begin(), corners_mm.end());
  alone.tets = {{0, 1, 2, 3}};
  return quality(alone).min_dihedral_deg;
}

}  // namespace

bool is_fit(const TetCorners& corners_mm, double least_deg) {
  return six_volumes(corners_mm) > 0.0 && least_angle_deg(corners_mm) >= least_deg;
}

std::vector<std::vector<std::uint32_t>> elements_about(const Tetrahedra& tetrahedra) {
  std::vector<std::vector<std::uint32_t>> about(tetrahedra.nodes_mm.size());
  for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t v : tetrahedra.tets[t]) about[v].push_back(t);
  return about;
}

SideSplitter::SideSplitter(Tetrahedra& tetrahedra, double least_deg)
    : tetrahedra_(tetrahedra), least_deg_(least_deg), about_(elements_about(tetrahedra)) {}

bool SideSplitter::split(std::uint32_t a, std::uint32_t b, const glm::dvec3& at_mm) {
  auto& tets = tetrahedra_.tets;
  auto& regions = tetrahedra_.region_of_tet;
  std::vector<std::uint32_t> halved;
  for (const std::uint32_t t : about_[a])
    if (std::find(tets[t].begin(), tets[t].end(), b) != tets[t].end()) halved.push_back(t);
  if (halved.empty()) return false;
  double least_deg = least_deg_;
  for (const std::uint32_t t : halved)
    least_deg = std::min(least_deg, least_angle_deg(corners_mm(tetrahedra_, t)));
  for (const std::uint32_t t : halved)
    for (const std::uint32_t end : {a, b}) {
      TetCorners part_mm = corners_mm(tetrahedra_, t);
      for (std::size_t k = 0; k < 4; ++k)
        if (tets[t].at(k) == end) part_mm.at(k) = at_mm;
      if (!is_fit(part_mm, least_deg)) return false;
    }
  const auto middle = static_cast<std::uint32_t>(tetrahedra_.nodes_mm.size());
  tetrahedra_.nodes_mm.push_back(at_mm);
  about_.emplace_back();
  for (const std::uint32_t t : halved) {
    const auto other = static_cast<std::uint32_t>(tets.size());
    const std::array<std::uint32_t, 4> whole = tets[t];
    tets.push_back(whole);
    if (!regions.empty()) {
      const std::uint32_t region = regions[t];
      regions.push_back(region);
    }
    std::replace(tets[t].begin(), tets[t].end(), b, middle);
    std::replace(tets[other].begin(), tets[other].end(), a, middle);
    about_[middle].push_back(t);
    std::erase(about_[b], t);
    for (const std::uint32_t v : tets[other]) about_[v].push_back(other);
  }
  return true;
}

}  // namespace octotomy::convert
