// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/offset.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/sample_surface.h"
#include "brep/shape/level_surface.h"

namespace octotomy::brep {
namespace {

/// Signed distance to the offset surface, negative within.
LevelField field_of(const SurfaceTree& tree, bool has_inside, double by_mm) {
  return [&tree, has_inside, by_mm](const std::vector<glm::dvec3>& points_mm,
                                    std::vector<std::uint32_t>& nearest) {
    std::vector<double> values =
        has_inside ? tree.signed_distances_mm(points_mm, nearest) : tree.distances_mm(points_mm);
    for (double& value : values) value -= by_mm;
    return values;
  };
}

void check(const Triangles& surface, const OffsetOptions& options) {
  if (surface.faces.empty()) throw InvalidInput("a surface without triangles has no offset");
  if (!std::isfinite(options.by_mm)) throw InvalidInput("an offset's length must be finite");
  if (!std::isfinite(options.cell_mm) || options.cell_mm <= 0.0)
    throw InvalidInput("the edge of an offset's cells must be above 0 mm");
}

}  // namespace

double offset_tolerance_mm(const OffsetOptions& options) {
  const double by = std::abs(options.by_mm), cell = options.cell_mm;
  return std::min(cell / 16.0, cell * cell / (4.0 * std::max(by, 0.25 * cell)));
}

Solid offset(const Solid& solid, const OffsetOptions& options) {
  check(solid.triangles(), options);
  return level_surface(field_of(solid.tree(), true, options.by_mm), solid.size(), options);
}

Solid thickened(const Triangles& surface, const OffsetOptions& options) {
  check(surface, options);
  if (!(options.by_mm > 0.0)) throw InvalidInput("the thickness of a wall must be above 0 mm");
  const SurfaceTree tree(surface);
  return level_surface(field_of(tree, false, options.by_mm), size_of(surface), options);
}

MissedWalls missed_walls(const Solid& solid, const Solid& moved, const OffsetOptions& options) {
  const bool inward = options.by_mm < 0.0;
  if (moved.empty()) return {inward ? 0.0 : 1.0, solid.triangles().points_mm.front()};
  constexpr double samples_wanted = 20000.0;
  const double spacing_mm = std::max(options.cell_mm, std::sqrt(solid.measures().area_mm2 / samples_wanted));
  const SurfaceSamples samples = sample_surface(
      solid.triangles(), widened_spacing_mm(solid.triangles(), spacing_mm, 64.0 * samples_wanted));
  const std::vector<std::uint8_t> inside = moved.tree().inside(samples.points_mm);
  std::vector<glm::dvec3> wrong_mm;
  std::vector<double> areas_mm2;
  for (std::size_t i = 0; i < inside.size(); ++i)
    if ((inside[i] != 0) == inward) {
      wrong_mm.push_back(samples.points_mm[i]);
      areas_mm2.push_back(samples.areas_mm2[i]);
    }
  const std::vector<double> distances_mm = moved.tree().distances_mm(wrong_mm);
  MissedWalls missed;
  double missed_mm2 = 0.0;
  for (std::size_t i = wrong_mm.size(); i-- > 0;)
    if (distances_mm[i] > options.cell_mm) {
      missed_mm2 += areas_mm2[i];
      missed.at_mm = wrong_mm[i];
    }
  missed.area_share = missed_mm2 / solid.measures().area_mm2;
  return missed;
}

}  // namespace octotomy::brep
