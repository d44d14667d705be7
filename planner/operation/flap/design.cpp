// SPDX-License-Identifier: AGPL-3.0-or-later
// Mitred segments of a straight bone along a curve.
//   1 A plane at every corner: the bisector of the two directions that meet there.
//   2 Frames along the curve, each the previous one rotated by the smallest rotation between the two
//     directions. A line along one segment then meets the bisector where the same line along the next does.
//   3 Positions on the donor: one after another, each as near to the previous one as saw and wedge allow.
// A cut is described by its slope: at an offset o from the axis it lies dot(slope, o) further along.
#include "planner/operation/flap/design.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

std::string said(double mm) {
  return std::to_string(static_cast<long>(std::lround(mm)));
}

/// The slope of a cut along the axes of its segment's frame: along `across`, and along the third axis.
glm::dvec2 slope_of(const FlapPlane& cut, const FlapSegment& segment) {
  const glm::dvec3 third = glm::cross(segment.along, segment.across);
  const double along = glm::dot(cut.normal, segment.along);
  return -glm::dvec2(glm::dot(cut.normal, segment.across), glm::dot(cut.normal, third)) / along;
}

double tilt_deg(const glm::dvec2& slope) {
  return glm::degrees(std::atan(glm::length(slope)));
}

/// The component of a vector perpendicular to a unit vector, normalised.
glm::dvec3 square_to(const glm::dvec3& unit, const glm::dvec3& vector, const std::string& refusal) {
  const glm::dvec3 rest = vector - unit * glm::dot(unit, vector);
  if (!(glm::length(rest) > 1e-3 * glm::length(vector))) throw voxel::InvalidInput(refusal);
  return glm::normalize(rest);
}

/// Rotates a vector by the smallest rotation that maps one unit vector onto another. Precondition: the two
/// are not opposite.
glm::dvec3 carried(const glm::dvec3& vector, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 sum = from + to;
  return vector - sum * (glm::dot(vector, to) + glm::dot(vector, from)) / (1.0 + glm::dot(from, to)) +
         2.0 * to * glm::dot(vector, from);
}

void check(const FlapPlan& plan) {
  if (plan.curve_mm.size() < 2) throw voxel::InvalidInput("the curve needs at least two corners: add one");
  if (!plan.stumps_mm.empty() && plan.stumps_mm.size() != 2)
    throw voxel::InvalidInput(
        "'stumps' needs two points, one beyond the first corner and one beyond the last");
  for (std::size_t i = 0; i + 1 < plan.curve_mm.size(); ++i)
    if (!(glm::distance(plan.curve_mm[i], plan.curve_mm[i + 1]) > 1e-3))
      throw voxel::InvalidInput("corners " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                                " of the curve coincide: move one of them");
  if (!(plan.kerf_mm >= 0.0 && plan.reach_mm > 0.0 && plan.start_mm >= 0.0))
    throw voxel::InvalidInput("kerf and start must be at least 0, and the reach must be above 0");
}

std::vector<glm::dvec3> directions_of(const FlapPlan& plan) {
  std::vector<glm::dvec3> along;
  for (std::size_t i = 0; i + 1 < plan.curve_mm.size(); ++i)
    along.push_back(glm::normalize(plan.curve_mm[i + 1] - plan.curve_mm[i]));
  return along;
}

/// The planes of the cuts at the corners of the curve, one more than there are segments.
std::vector<FlapPlane> cuts_of(const FlapPlan& plan, const std::vector<glm::dvec3>& along) {
  const std::size_t last = along.size();
  std::vector<FlapPlane> cuts;
  for (std::size_t k = 0; k <= last; ++k) {
    glm::dvec3 before = along[k == 0 ? 0 : k - 1], after = along[std::min(k, last - 1)];
    if (!plan.stumps_mm.empty() && (k == 0 || k == last)) {
      const glm::dvec3 stump =
          k == 0 ? plan.curve_mm[0] - plan.stumps_mm[0] : plan.stumps_mm[1] - plan.curve_mm[last];
      if (!(glm::length(stump) > 1e-3))
        throw voxel::InvalidInput("a point of 'stumps' coincides with the corner: choose one beyond it");
      (k == 0 ? before : after) = glm::normalize(stump);
    }
    if (!(glm::dot(before, after) > -0.5))
      throw voxel::InvalidInput("the curve turns by 120° or more at corner " + std::to_string(k + 1) +
                                ": check the order of its corners");
    cuts.push_back({plan.curve_mm[k], glm::normalize(before + after)});
  }
  return cuts;
}

/// The parts of a segment that do not depend on its position on the donor.
FlapSegment segment_between(const FlapPlane& start, const FlapPlane& end, const glm::dvec3& along,
                            const glm::dvec3& across, double corner_mm, std::size_t number) {
  FlapSegment made;
  made.start = start;
  made.end = end;
  made.along = along;
  made.across = across;
  made.length_mm = glm::distance(start.point_mm, end.point_mm);
  const glm::dvec2 start_slope = slope_of(start, made), end_slope = slope_of(end, made);
  const double spread_mm = corner_mm * glm::length(end_slope - start_slope);
  made.shortest_mm = made.length_mm - spread_mm;
  made.longest_mm = made.length_mm + spread_mm;
  made.start_tilt_deg = tilt_deg(start_slope);
  made.end_tilt_deg = tilt_deg(end_slope);
  if (!(made.shortest_mm > 0.0))
    throw voxel::InvalidInput("segment " + std::to_string(number) + " is " + said(made.length_mm) +
                              " mm long, so its cuts cross within the bone: place corners farther apart, or "
                              "state fewer segments or a smaller 'reach_mm'");
  return made;
}

}  // namespace

double flap_corner_mm(double reach_mm) {
  return reach_mm / std::cos(glm::pi<double>() / 8.0);
}

std::vector<FlapSegment> flap_segments(const FlapPlan& plan) {
  check(plan);
  const double corner_mm = flap_corner_mm(plan.reach_mm);
  const glm::dvec3 axis_mm = plan.donor_to_mm - plan.donor_from_mm;
  if (!(glm::length(axis_mm) > 1e-3))
    throw voxel::InvalidInput("the donor's two points coincide: choose two along the bone's axis");
  const glm::dvec3 axis = glm::normalize(axis_mm);
  const glm::dvec3 face =
      square_to(axis, plan.donor_face_mm - plan.donor_from_mm,
                "the point on the donor's face lies on the donor's axis: choose a point beside it");
  const std::vector<glm::dvec3> along = directions_of(plan);
  const std::vector<FlapPlane> cuts = cuts_of(plan, along);

  glm::dvec3 across = square_to(along[0], plan.facing,
                                "'facing' is along the first segment: state a direction across the segment");
  across = glm::dvec3(glm::rotate(glm::dmat4(1.0), glm::radians(plan.roll_deg), along[0]) *
                      glm::dvec4(across, 0.0));
  std::vector<FlapSegment> segments;
  double next_mm = plan.start_mm;
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (i > 0) across = glm::normalize(carried(across, along[i - 1], along[i]));
    FlapSegment segment = segment_between(cuts[i], cuts[i + 1], along[i], across, corner_mm, i + 1);
    if (i > 0) {
      FlapSegment& before = segments.back();
      segment.turn_deg = glm::degrees(std::acos(std::clamp(glm::dot(along[i - 1], along[i]), -1.0, 1.0)));
      const glm::dvec2 start = slope_of(segment.start, segment), end = slope_of(before.end, before);
      const double saw_mm =
          plan.kerf_mm * std::sqrt(1.0 + std::max(glm::dot(start, start), glm::dot(end, end)));
      next_mm = before.donor_end_mm + saw_mm + corner_mm * glm::length(start - end);
    }
    segment.donor_start_mm = next_mm;
    segment.donor_end_mm = next_mm + segment.length_mm;
    const glm::dmat3 placed(segment.along, across, glm::cross(segment.along, across));
    const glm::dmat3 donor(axis, face, glm::cross(axis, face));
    const glm::dmat3 turn = placed * glm::transpose(donor);
    const glm::dvec3 from_mm = plan.donor_from_mm + axis * segment.donor_start_mm;
    segment.placed_from_donor = glm::dmat4(turn);
    segment.placed_from_donor[3] = glm::dvec4(segment.start.point_mm - turn * from_mm, 1.0);
    segment.donor_start = {from_mm, glm::transpose(turn) * segment.start.normal};
    segment.donor_end = {from_mm + axis * segment.length_mm, glm::transpose(turn) * segment.end.normal};
    segments.push_back(segment);
  }
  const double missing_mm = segments.back().donor_end_mm - glm::length(axis_mm);
  if (missing_mm > 0.0)
    throw voxel::InvalidInput(
        "the donor is " + said(glm::length(axis_mm)) + " mm long, and the flap needs " + said(missing_mm) +
        " mm more: start nearer to its first point, or choose donor points farther apart");
  return segments;
}

}  // namespace octotomy::planner
