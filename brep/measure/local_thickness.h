// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <vector>

#include "brep/measure/thickness.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct LocalThicknessOptions {
  /// Approximate number of points that are measured on the surface, and again in the volume; at least 64.
  /// Errors of the average fall with the square root of this number on solids with edges.
  std::size_t samples = 20000;
  double least_angle_deg = 30.0;  ///< as of ThicknessOptions
  /// A point belongs to a wall if its ball touches the surface, within 2.5 % of its radius, at a second place
  /// that is at least this angle from the point, seen from the ball's centre; 91..179. The two sides of a
  /// wedge of angle a touch a ball at places 180 - a apart. So 150 excludes edges, sharp or blunt, but not
  /// walls whose sides converge by up to 30 degrees.
  double wall_angle_deg = 150.0;
  std::function<void(double)> progress = {};  ///< is called with 0..1, from the calling thread
  std::stop_token stop = {};
};

/// A point of the surface, its share of the area, and the local thickness there.
struct LocalThicknessAt {
  SurfacePoint point;
  double area_mm2 = 0.0;
  double ray_mm = 0.0;  ///< distance straight inward to the next point of the surface; infinity if there is
                        ///< none
  double thickness_mm = 0.0;
  bool is_wall = false;  ///< by the rule of LocalThicknessOptions::wall_angle_deg
};

/// Statistics over a solid's volume; each point is weighted by its part of the volume.
struct LocalThickness {
  /// Extrapolated to infinitely many balls, to first order: the mean over all balls, plus the increase from
  /// the mean over a fourth of them. At most largest_mm.
  double mean_mm = 0.0;
  double deviation_mm = 0.0, median_mm = 0.0, largest_mm = 0.0;  ///< over the balls, not extrapolated
  /// The mean is within this length of the true value for the given triangles, in 99 of 100 cases. The sum of
  /// three terms: twice the change when three balls of four are left out, 2.6 standard errors, estimated from
  /// the means of 16 groups of points, and 0.5 % for the searches.
  double mean_half_width_mm = 0.0;
  std::vector<LocalThicknessAt> surface;
  double reach_mm = 0.0;  ///< largest distance of any point of the surface from the nearest point in the list
                          ///< `surface`
  /// The thinnest point of a wall, as an index into `surface`; none if no point belongs to a wall.
  std::optional<std::size_t> thinnest_wall;
};

/// Local thickness: the diameter of the largest ball inside that holds the point. On a smooth part of the
/// surface this is the ball that touches at the point. Towards a sharp edge the thickness falls to 0, because
/// no ball reaches the edge. LPS millimetres. Throws std::invalid_argument if the solid is empty or an option
/// is out of its range; Stopped. The same bits on any number of threads. Cost: n log n for the tree, about
/// log n a sample; parallel. Source: Hildebrand and Ruegsegger, "A new method for the model-independent
/// assessment of thickness in three-dimensional images", Journal of Microscopy 185, 1997; balls after Ma, Bae
/// and Choi (see thickness.h). Departure: balls are those that touch at samples and at the feet of the
/// volume's points, not all of a distance ridge.
LocalThickness local_thickness(const Solid& solid, const LocalThicknessOptions& options = {});

struct ThinnestWall {
  std::optional<LocalThicknessAt> at;  ///< none if no sample belongs to a wall
  double reach_mm = 0.0;               ///< as of LocalThickness
};

/// The thinnest wall alone, from the same samples of the surface and their balls, but without the balls of
/// the volume's points. Because fewer balls are tried, no thickness exceeds that of local_thickness(). Throws
/// as local_thickness(). The same bits on any number of threads. Cost: less than half of local_thickness().
ThinnestWall thinnest_wall(const Solid& solid, const LocalThicknessOptions& options = {});

}  // namespace octotomy::brep
