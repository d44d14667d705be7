// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 send a ray inward from each point; 2 start with the ball that touches at the point and has the ray's
// length as diameter; 3 shrink it until no other sheet lies in it.
#include "brep/measure/thickness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/measure/inscribed_balls.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {

std::vector<Thickness> thickness(const Solid& solid, const std::vector<SurfacePoint>& points,
                                 const ThicknessOptions& options) {
  if (solid.empty()) throw InvalidInput("thickness: the solid has no triangles");
  if (!(options.least_angle_deg >= 1.0 && options.least_angle_deg <= 120.0))
    throw InvalidInput("thickness: the least angle must be from 1 to 120 degrees");
  const InscribedBalls inscribed(solid.triangles());
  const double least_cosine = std::cos(options.least_angle_deg * std::numbers::pi / 180.0);
  std::vector<Thickness> thickness(points.size());
  // Points are processed in parts, and this thread reports progress after each part.
  constexpr std::size_t part = 8192;
  for (std::size_t from = 0; from < points.size(); from += part) {
    if (options.stop.stop_requested()) throw Stopped("thickness: stopped");
    if (options.progress) options.progress(static_cast<double>(from) / static_cast<double>(points.size()));
    const std::size_t to = std::min(from + part, points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(from, to, 64), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const auto& [p_mm, normal] = points[i];
        const double ray_mm = inscribed.ray_mm(p_mm, normal);
        thickness[i] = {ray_mm, ray_mm};
        if (std::isfinite(ray_mm))
          thickness[i].ball_mm = 2.0 * inscribed.touching(p_mm, normal, ray_mm, least_cosine).radius_mm;
      }
    });
    for (std::size_t i = from; i < to; ++i)
      if (!std::isfinite(thickness[i].ray_mm))
        throw InvalidInput("thickness: the ray from point " + std::to_string(i) +
                           " leaves without meeting the surface; it is not closed, or the normal "
                           "does not point out of it");
  }
  return thickness;
}

}  // namespace octotomy::brep
