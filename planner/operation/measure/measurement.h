// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>

#include "planner/operation/measure/measured_size.h"

// The measurements of a plan: records below `measurements` in a result. Operations print them; tables and
// pages read them. `key` is the JSON key by which a kind of measurement is recognised, because no other kind
// has it.
namespace octotomy::planner {

/// The gap between two objects. Its numbers are missing if one of them is empty.
struct MeasuredGap {
  std::string object, to;
  std::optional<double> gap_mm, gap_mesh_mm, gap_half_width_mm, overlap_mm3;
  std::optional<std::string> finding, gap_estimator;
  std::optional<std::vector<Doubt>> gap_half_width_terms;
  std::optional<glm::dvec3> from_mm, to_mm;

  static constexpr const char* key = "gap_mm";
};
constexpr auto members_of(const MeasuredGap&) {
  using G = MeasuredGap;
  return std::tuple(member("object", &G::object), member("to", &G::to), member("gap_mm", &G::gap_mm),
                    member("gap_mesh_mm", &G::gap_mesh_mm),
                    member("gap_half_width_mm", &G::gap_half_width_mm),
                    member("overlap_mm3", &G::overlap_mm3), member_if_any("finding", &G::finding),
                    member_if_any("gap_estimator", &G::gap_estimator),
                    member_if_any("gap_half_width_terms", &G::gap_half_width_terms),
                    member_if_any("from_mm", &G::from_mm), member_if_any("to_mm", &G::to_mm));
}

/// The distance between two points.
struct MeasuredDistance {
  std::vector<glm::dvec3> points_mm;
  double distance_mm = 0.0;
  std::optional<double> distance_half_width_mm;
  std::optional<std::vector<Doubt>> distance_half_width_terms;

  static constexpr const char* key = "distance_mm";
};
constexpr auto members_of(const MeasuredDistance&) {
  using D = MeasuredDistance;
  return std::tuple(member("points_mm", &D::points_mm), member("distance_mm", &D::distance_mm),
                    member("distance_half_width_mm", &D::distance_half_width_mm),
                    member("distance_half_width_terms", &D::distance_half_width_terms));
}

/// The angle at the second of three points.
struct MeasuredAngle {
  std::vector<glm::dvec3> points_mm;
  double angle_deg = 0.0;
  std::optional<double> angle_half_width_deg;
  std::optional<std::vector<Doubt>> angle_half_width_terms;

  static constexpr const char* key = "angle_deg";
};
constexpr auto members_of(const MeasuredAngle&) {
  using A = MeasuredAngle;
  return std::tuple(member("points_mm", &A::points_mm), member("angle_deg", &A::angle_deg),
                    member("angle_half_width_deg", &A::angle_half_width_deg),
                    member("angle_half_width_terms", &A::angle_half_width_terms));
}

/// A place at which one object touches another.
struct MeasuredContact {
  glm::dvec3 at_mm{0.0}, normal{0.0, 0.0, 1.0};
  double nearest_mm = 0.0;  ///< negative if they overlap
  std::optional<double> voxel_nearest_mm;
  double depth_mm = 0.0;
  std::optional<double> area_mm2;
  double half_width_mm = 0.0;
};
constexpr auto members_of(const MeasuredContact&) {
  using C = MeasuredContact;
  return std::tuple(member("at_mm", &C::at_mm), member("normal", &C::normal),
                    member("nearest_mm", &C::nearest_mm), member("voxel_nearest_mm", &C::voxel_nearest_mm),
                    member("depth_mm", &C::depth_mm), member("area_mm2", &C::area_mm2),
                    member("half_width_mm", &C::half_width_mm));
}
/// The contacts of two objects. Their numbers are missing if one of them is empty.
struct MeasuredContacts {
  std::string object, against;
  double within_mm = 0.0;
  std::vector<MeasuredContact> contacts;
  std::optional<int> certain_count;
  std::optional<double> area_mm2, nearest_mm;
  std::vector<std::string> findings;
  std::optional<glm::dvec3> nearest_at_mm;
  std::optional<double> voxel_nearest_mm, overlap_mm3;
  std::optional<std::string> estimator;

  static constexpr const char* key = "contacts";
};
constexpr auto members_of(const MeasuredContacts&) {
  using C = MeasuredContacts;
  return std::tuple(member("object", &C::object), member("against", &C::against),
                    member("within_mm", &C::within_mm), member("contacts", &C::contacts),
                    member("certain_count", &C::certain_count), member("area_mm2", &C::area_mm2),
                    member("nearest_mm", &C::nearest_mm), member("findings", &C::findings),
                    member_if_any("nearest_at_mm", &C::nearest_at_mm),
                    member_if_any("voxel_nearest_mm", &C::voxel_nearest_mm),
                    member_if_any("overlap_mm3", &C::overlap_mm3), member_if_any("estimator", &C::estimator));
}

/// A section of an airway, perpendicular to its centre line.
struct MeasuredSection {
  double along_mm = 0.0;  ///< along the centre line, from its beginning
  glm::dvec3 at_mm{0.0}, direction{0.0, 0.0, 1.0};
  double area_mm2 = 0.0, half_width_mm2 = 0.0;
  double voxel_mm2 = 0.0;
  std::optional<double> mesh_mm2;
  std::optional<std::vector<Doubt>> half_width_terms;  ///< only for the narrowest section
};
constexpr auto members_of(const MeasuredSection&) {
  using S = MeasuredSection;
  return std::tuple(member("along_mm", &S::along_mm), member("at_mm", &S::at_mm),
                    member("direction", &S::direction), member("area_mm2", &S::area_mm2),
                    member("half_width_mm2", &S::half_width_mm2), member("voxel_mm2", &S::voxel_mm2),
                    member("mesh_mm2", &S::mesh_mm2),
                    member_if_any("half_width_terms", &S::half_width_terms));
}
struct AirwaySize {
  double volume_mm3 = 0.0, volume_half_width_mm3 = 0.0;
  std::optional<double> volume_mesh_mm3;
  double length_mm = 0.0;
  MeasuredSection narrowest;
  std::vector<MeasuredSection> sections;
};
constexpr auto members_of(const AirwaySize&) {
  using A = AirwaySize;
  return std::tuple(member("volume_mm3", &A::volume_mm3),
                    member("volume_half_width_mm3", &A::volume_half_width_mm3),
                    member("volume_mesh_mm3", &A::volume_mesh_mm3), member("length_mm", &A::length_mm),
                    member("narrowest", &A::narrowest), member("sections", &A::sections));
}
struct MeasuredAirway {
  std::string object;
  AirwaySize airway;
  std::vector<std::string> findings;

  static constexpr const char* key = "airway";
};
constexpr auto members_of(const MeasuredAirway&) {
  using A = MeasuredAirway;
  return std::tuple(member("object", &A::object), member("airway", &A::airway),
                    member("findings", &A::findings));
}

}  // namespace octotomy::planner
