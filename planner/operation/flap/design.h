// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace octotomy::planner {

/// The plan of a free flap. All points are LPS millimetres: those of the curve and its stumps in the
/// patient's scan, those of the donor in the donor's scan.
struct FlapPlan {
  std::vector<glm::dvec3> curve_mm;  ///< corners of the new bone's axis, one more than there are segments
  /// Points on the remaining bone, beyond the first and the last corner; none: the end cuts are square to the
  /// flap.
  std::vector<glm::dvec3> stumps_mm;
  glm::dvec3 donor_from_mm{0.0}, donor_to_mm{0, 0, 100};  ///< on the donor bone's axis; the flap begins near
                                                          ///< the first
  glm::dvec3 donor_face_mm{1, 0, 0};                      ///< a point off the axis, on the bone's face
  glm::dvec3 facing{0, 0, -1};  ///< LPS direction of the donor's face in the first segment; any length except
                                ///< zero
  double roll_deg = 0.0;        ///< an additional rotation of all segments about their axes
  double start_mm = 0.0;        ///< from donor_from_mm to the first cut, along the axis
  double kerf_mm = 1.0;         ///< the width of one saw cut, outside of the segments
  double reach_mm = 12.0;       ///< the donor bone lies within this distance from its axis
};

/// A plane of the points p with dot(normal, p - point_mm) = 0.
struct FlapPlane {
  glm::dvec3 point_mm{0.0};
  glm::dvec3 normal{0, 0, 1};  ///< unit, along the curve
};

/// One segment. Segments are in their order along the curve, which is also the order along the donor.
struct FlapSegment {
  FlapPlane start, end;                             ///< its cuts at its place in the patient
  glm::dvec3 along{0.0};                            ///< unit, along the segment's axis from start to end
  glm::dvec3 across{0.0};                           ///< unit, perpendicular to `along`: the direction of the
                                                    ///< donor's face
  double length_mm = 0.0;                           ///< along its axis
  double shortest_mm = 0.0, longest_mm = 0.0;       ///< length of the bone's shortest and longest side, at
                                                    ///< `reach_mm` from the axis
  double start_tilt_deg = 0.0, end_tilt_deg = 0.0;  ///< angles of its cuts from a square cut
  double turn_deg = 0.0;                            ///< angle to the previous segment; 0 for the first
  double donor_start_mm = 0.0, donor_end_mm = 0.0;  ///< positions of its cuts on the donor's axis, from
                                                    ///< donor_from_mm
  FlapPlane donor_start, donor_end;                 ///< its cuts in the donor's scan, with normals along the
                                                    ///< axis
  glm::dmat4 placed_from_donor{1.0};                ///< LPS to LPS, rigid
};

/// The distance of the corners of a prism with eight sides from its axis, if its sides are `reach_mm` from
/// the axis.
double flap_corner_mm(double reach_mm);

/// Computes the segments. Neighbours meet in the plane that bisects their angle, and no segment is twisted
/// relative to the previous one, so that equal cross-sections of the donor meet edge to edge. On the donor, a
/// wedge of bone remains between segments; where it is narrowest within `reach_mm`, it is as wide as the saw
/// cuts. Throws std::invalid_argument that names the corner or segment if corners coincide, the curve turns
/// by 120 degrees or more, a segment's cuts cross within the bone, the donor's points define no axis or face,
/// `facing` is along the first segment, a length is negative, or the donor is too short; then the message
/// states the missing length.
std::vector<FlapSegment> flap_segments(const FlapPlan& plan);

}  // namespace octotomy::planner
