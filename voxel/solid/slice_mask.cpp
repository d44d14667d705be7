// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/slice_mask.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "voxel/solid/region_mask.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr double outside_mm = std::numeric_limits<double>::infinity();

}  // namespace

void check(const SliceMask& mask) {
  if (mask.slices.size() < 2) throw InvalidInput("a mask from slices needs regions on at least two of them");
  bool drawn = false;
  for (std::size_t i = 0; i < mask.slices.size(); ++i) {
    const SliceMask::Slice& slice = mask.slices[i];
    const std::string where = "slice " + std::to_string(i + 1) + " of the mask";
    if (!std::isfinite(slice.position_mm))
      throw InvalidInput(where + ": its position is not a finite number");
    if (i > 0 && !(slice.position_mm > mask.slices[i - 1].position_mm))
      throw InvalidInput(where + " does not lie beyond the one before it: sort them by position");
    if (slice.polygons_mm.empty()) continue;
    drawn = true;
    try {
      check(RegionMask{{{mask.view, slice.polygons_mm}}});
    } catch (const InvalidInput& error) {
      throw InvalidInput(where + ": " + error.what());
    }
  }
  if (!drawn) throw InvalidInput("no slice of the mask has a polygon");
  // Two slices may lie closer than this where a part ends. If all slices of a stack do, their positions are
  // probably not in mm.
  constexpr double least_span_mm = 0.01;
  if (mask.slices.back().position_mm - mask.slices.front().position_mm < least_span_mm)
    throw InvalidInput("slice 1 to slice " + std::to_string(mask.slices.size()) +
                       " lie within 0.01 mm of each other: state their positions in mm");
}

SliceDistance::SliceDistance(const SliceMask& mask) : mask_(&mask) {
  edges_.reserve(mask.slices.size());
  for (const SliceMask::Slice& slice : mask.slices) edges_.emplace_back(slice.polygons_mm);
}

double SliceDistance::distance_mm(std::size_t slice, const glm::dvec2& p_mm) const {
  const double distance = std::sqrt(edges_[slice].square_to(p_mm));
  return edges_[slice].contains(p_mm) ? -distance : distance;
}

// Bounds of the interpolated distance at one point of the plane, over a stretch of the gap after slice
// `below`. `at_a` and `at_b` are the point's distances to the outlines of the two slices.
SliceDistance::Bounds SliceDistance::in_gap(std::size_t below, double at_a, double at_b,
                                            const Stretch& stretch) const {
  const auto [from_mm, to_mm] = stretch;
  assert(from_mm <= to_mm);
  const SliceMask::Slice& a = mask_->slices[below];
  const SliceMask::Slice& b = mask_->slices[below + 1];
  const bool blend =
      mask_->between == SliceMask::Between::ShapeBased && !a.polygons_mm.empty() && !b.polygons_mm.empty();
  if (blend) {
    const auto at = [&](double position_mm) {
      const double t = (position_mm - a.position_mm) / (b.position_mm - a.position_mm);
      return at_a + t * (at_b - at_a);
    };
    const double from = at(from_mm);
    const double to = at(to_mm);
    return {std::min(from, to), std::max(from, to)};
  }
  // The middle of a gap belongs to the slice before the gap.
  const double middle = 0.5 * (a.position_mm + b.position_mm);
  Bounds bounds{outside_mm, -outside_mm};
  const auto take = [&](double distance) {
    bounds = {std::min(bounds.low, distance), std::max(bounds.high, distance)};
  };
  if (from_mm <= middle) take(at_a);
  if (to_mm > middle) take(at_b);
  return bounds;
}

SliceDistance::Bounds SliceDistance::operator()(const glm::dvec2& p_mm, double position_mm,
                                                double in_plane_mm, double across_mm) const {
  assert(mask_->slices.size() >= 2 && in_plane_mm >= 0.0 && across_mm >= 0.0);
  const std::vector<SliceMask::Slice>& slices = mask_->slices;
  const std::size_t last = slices.size() - 1;
  const double first_mm = slices[0].position_mm;
  const double last_mm = slices[last].position_mm;
  const double lowest_mm = first_mm - 0.5 * (slices[1].position_mm - first_mm);
  const double highest_mm = last_mm + 0.5 * (last_mm - slices[last - 1].position_mm);
  const double from_mm = position_mm - across_mm;
  const double to_mm = position_mm + across_mm;
  if (to_mm < lowest_mm || from_mm > highest_mm) return {outside_mm, outside_mm};

  Bounds bounds{outside_mm, -outside_mm};
  const auto take = [&](const Bounds& part) {
    bounds = {std::min(bounds.low, part.low), std::max(bounds.high, part.high)};
  };
  // Visits the slices from the last one before the stretch, if there is one, to the first one behind it.
  std::size_t below = static_cast<std::size_t>(
      std::lower_bound(slices.begin(), slices.end(), from_mm,
                       [](const SliceMask::Slice& slice, double mm) { return slice.position_mm < mm; }) -
      slices.begin());
  if (below > 0) --below;
  double at_below = distance_mm(below, p_mm);
  if (from_mm < first_mm) take({at_below, at_below});
  for (; below < last && slices[below].position_mm <= to_mm; ++below) {
    const double at_above = distance_mm(below + 1, p_mm);
    take(in_gap(
        below, at_below, at_above,
        {std::max(from_mm, slices[below].position_mm), std::min(to_mm, slices[below + 1].position_mm)}));
    at_below = at_above;
  }
  if (to_mm > last_mm) take({at_below, at_below});
  // If the point moves within the plane, its distance changes by at most the length of the movement.
  bounds.low -= in_plane_mm;
  bounds.high += in_plane_mm;
  if (from_mm < lowest_mm || to_mm > highest_mm) bounds.high = outside_mm;
  return bounds;
}

}  // namespace octotomy::voxel
