// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/tiled_slices.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "brep/contour/sections_between.h"
#include "brep/mesh/error.h"
#include "planner/operation/file/contour_findings.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "verify/witness/slice_witness.h"
#include "voxel/solid/polygon_overlaps.h"

namespace octotomy::planner {
namespace {

bool is_interpolated(const voxel::SliceMask& mask) {
  return mask.between == voxel::SliceMask::Between::ShapeBased;
}

std::vector<brep::Section> sections_of(const voxel::SliceMask& mask) {
  std::vector<brep::Section> sections;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    sections.push_back({slice.position_mm, {}});
    for (const auto& polygon : slice.polygons_mm) {
      // Removes repeated neighbouring points, which would make sides without length.
      brep::Contour contour;
      for (const glm::dvec2& p : polygon)
        if (contour.points_mm.empty() || contour.points_mm.back() != p) contour.points_mm.push_back(p);
      while (contour.points_mm.size() > 1 && contour.points_mm.front() == contour.points_mm.back())
        contour.points_mm.pop_back();
      if (contour.points_mm.size() > 2) sections.back().contours.push_back(std::move(contour));
    }
  }
  return sections;
}

/// Throws if contours of a slice cross. This check precedes that of tiling, whose message would state the
/// position of an interpolated section that nobody drew.
void need_uncrossed_slices(const voxel::SliceMask& mask) {
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    const voxel::CrossingPolygons crossing = voxel::crossing_polygons(slice.polygons_mm, off_plane_mm());
    if (crossing.all.empty()) continue;
    const auto& first = crossing.all.front();
    throw brep::Error(brep::ErrorCode::Geometry, "the slice at " + plain(slice.position_mm) +
                                                     " mm: polygon " + std::to_string(first.polygon + 1) +
                                                     " crosses itself or another one near [" +
                                                     plain(first.at_mm.x) + ", " + plain(first.at_mm.y) +
                                                     "] mm: draw one outline around both parts");
  }
}

/// The limit is ten metres of drawn slices, because longer stacks are in another unit.
void need_few_sections(const voxel::SliceMask& mask) {
  if (!is_interpolated(mask)) return;
  constexpr double most_mm = 10'000.0;
  double joined_mm = 0.0;
  for (std::size_t s = 0; s + 1 < mask.slices.size(); ++s)
    if (!mask.slices[s].polygons_mm.empty() && !mask.slices[s + 1].polygons_mm.empty())
      joined_mm += mask.slices[s + 1].position_mm - mask.slices[s].position_mm;
  if (joined_mm > most_mm)
    throw brep::Error(brep::ErrorCode::Geometry,
                      "the joined slices span " + plain(joined_mm) + " mm, but at most " + plain(most_mm) +
                          " mm can be tiled, with a section every " + plain(tile_step_mm()) +
                          " mm: check that positions are in mm");
}

}  // namespace

TiledSlices tiled_slices(const voxel::SliceMask& mask, std::optional<brep::TileCost> cost,
                         std::stop_token stop) {
  need_few_sections(mask);
  need_uncrossed_slices(mask);
  brep::SectionsBetweenOptions between;
  between.between = is_interpolated(mask) ? brep::Between::shape_based : brep::Between::nearest;
  between.step_mm = tile_step_mm();
  between.stop = std::move(stop);
  brep::TiledBetween tiled = brep::tile_between(sections_of(mask), between, cost);
  for (glm::dvec3& p : tiled.surface.points_mm)
    p = p.x * mask.view.right + p.y * mask.view.up + p.z * mask.view.look;
  // Triangles are reversed, because (right, up, look) is left-handed: right = look x up.
  for (auto& face : tiled.surface.faces) std::swap(face[1], face[2]);
  const brep::Proof proof = tiled.is_apart ? brep::Proof::Health : brep::Proof::Rounded;
  return {brep::trusted_solid(std::move(tiled.surface), proof), tiled.sections};
}

verify::Witness witness_of(const voxel::SliceMask& mask) {
  verify::DrawnStack stack{mask.view.look,        mask.view.up,  mask.view.right, {},
                           is_interpolated(mask), tile_step_mm()};
  for (const voxel::SliceMask::Slice& slice : mask.slices)
    stack.slices.push_back({slice.position_mm, slice.polygons_mm});
  return verify::witness_of_slices(stack);
}

double tiles_apart_mm(const voxel::SliceMask& mask) {
  if (!is_interpolated(mask)) return 0.0;
  double area_mm2 = 0.0, length_mm = 0.0;
  for (const brep::Section& section : sections_of(mask))
    for (const brep::Contour& contour : section.contours) {
      area_mm2 += std::abs(brep::signed_area_mm2(contour));
      length_mm += brep::perimeter_mm(contour);
    }
  if (!(area_mm2 > 0.0)) return 0.0;
  const double step_mm = tile_step_mm(), radius_mm = 2.0 * area_mm2 / length_mm;
  return std::min(0.5 * step_mm, 1.25 * step_mm * step_mm / (8.0 * radius_mm));
}

std::vector<CutPlane> planes_of(const voxel::SliceMask& mask) {
  constexpr double least_side_mm = 5.0;
  std::vector<CutPlane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(mask.view.look[axis]) < 1.0) continue;
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    std::set<double> offsets_mm;
    const auto& slices = mask.slices;
    const std::size_t last = slices.size() - 1;
    const auto add = [&](double position_mm) { offsets_mm.insert(mask.view.look[axis] * position_mm); };
    for (std::size_t s = 0; s < last; ++s)
      if (!is_interpolated(mask) || slices[s].polygons_mm.empty() != slices[s + 1].polygons_mm.empty())
        add(0.5 * (slices[s].position_mm + slices[s + 1].position_mm));
    add(1.5 * slices[0].position_mm - 0.5 * slices[1].position_mm);
    add(1.5 * slices[last].position_mm - 0.5 * slices[last - 1].position_mm);
    for (const double offset_mm : offsets_mm) planes.push_back({axis, normal, offset_mm});
  }
  voxel::RegionMask sides;
  for (const voxel::SliceMask::Slice& slice : mask.slices)
    for (const auto& polygon : slice.polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if (glm::distance(a, b) >= least_side_mm) sides.regions.push_back({mask.view, {{a, b}}});
      }
  for (const CutPlane& plane : planes_of(sides))
    if (std::none_of(planes.begin(), planes.end(), [&](const CutPlane& known) {
          return known.axis == plane.axis && known.offset_mm == plane.offset_mm;
        }))
      planes.push_back(plane);
  return planes;
}

}  // namespace octotomy::planner
