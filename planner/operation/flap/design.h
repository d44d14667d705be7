// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace octotomy::planner {

/// The plan of a free flap. All points are LPS millimetres: those of the curve and its stumps in the
/// patient's scan, those of the donor in the donor's scan.
struct FlapPlan {
  std::vector<glm::dvec3> curve_mm;  ///< corners of the new bone, one more than it has segments
  /// Points on the remaining bone, behind the first and the last corner; none: the end cuts are square.
  std::vector<glm::dvec3> stumps_mm;
  glm::dvec3 donor_from_mm{0.0}, donor_to_mm{0, 0, 100};  ///< on the donor bone's axis, in order of use
  glm::dvec3 donor_face_mm{1, 0, 0};                      ///< a point off the axis, on the bone's face
  glm::dvec3 facing{0, 0, -1};  ///< LPS: the direction that this face has in the first segment; any length
                                ///< except zero
  double roll_deg = 0.0;        ///< an additional rotation of all segments about their axes
  double start_mm = 0.0;        ///< from donor_from_mm to the first cut, along the axis
  double kerf_mm = 1.0;         ///< the width of one saw cut, outside of the segments
  double reach_mm = 12.0;       ///< the donor bone lies within this distance from its axis
};

/// The points p of a plane: dot(normal, p - point_mm) = 0.
struct FlapPlane {
  glm::dvec3 point_mm{0.0};
  glm::dvec3 normal{0, 0, 1};  ///< unit, along the curve
};

/// One segment, in order along the curve and along the donor.
struct FlapSegment {
  FlapPlane start, end;                             ///< its cuts at its place in the patient
  glm::dvec3 along{0.0};                            ///< unit, from start to end
  glm::dvec3 across{0.0};                           ///< unit, perpendicular to `along`: the direction of the
                                                    ///< donor's face
  double length_mm = 0.0;                           ///< along its axis
  double shortest_mm = 0.0, longest_mm = 0.0;       ///< along the sides of the bone, at the greatest distance
                                                    ///< from its axis
  double start_tilt_deg = 0.0, end_tilt_deg = 0.0;  ///< angles of its cuts from a square cut
  double turn_deg = 0.0;                            ///< angle to the previous segment; 0 for the first
  double donor_start_mm = 0.0, donor_end_mm = 0.0;  ///< positions of its cuts on the donor's axis, from the
                                                    ///< axis's start
  FlapPlane donor_start, donor_end;                 ///< its cuts in the donor's scan, normals along the axis
  glm::dmat4 placed_from_donor{1.0};                ///< LPS to LPS, rigid
};

/// Half the corner-to-corner distance of the eight-sided prism whose sides are `reach_mm` from its axis.
double flap_corner_mm(double reach_mm);

/// Computes the segments. Neighbours meet in the plane that bisects their angle, and no segment is twisted
/// relative to the previous one, so that equal cross-sections of the donor meet edge to edge. On the donor a
/// wedge remains between segments; at its narrowest point within the bone's reach it is as wide as the saw
/// cuts. Throws std::invalid_argument, which names the corner or segment, for: corners that coincide; a curve
/// that turns by 120 degrees or more; a segment so short that its cuts cross within the bone; a donor without
/// axis or face; a facing along the first segment; a negative length; a donor that is too short, with the
/// missing length.
std::vector<FlapSegment> flap_segments(const FlapPlan& plan);

}  // namespace octotomy::planner
