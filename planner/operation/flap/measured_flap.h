// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/record.h"

// Segments and osteotomies of a free flap: records below `measurements` in a result.
namespace octotomy::planner {

/// A cut on the donor: its position, its angle from a square cut, and its plane in the donor's scan.
struct DonorCut {
  double at_mm = 0.0;  ///< along the donor's axis, from the axis's first point
  double tilt_deg = 0.0;
  glm::dvec3 donor_point_mm{0.0}, donor_normal{0.0, 0.0, 1.0};
};
constexpr auto members_of(const DonorCut&) {
  using C = DonorCut;
  return std::tuple(member("at_mm", &C::at_mm), member("tilt_deg", &C::tilt_deg),
                    member("donor_point_mm", &C::donor_point_mm), member("donor_normal", &C::donor_normal));
}

struct MeasuredSegment {
  int number = 1;
  std::string object;
  double length_mm = 0.0, shortest_mm = 0.0, longest_mm = 0.0;
  std::optional<double> angle_to_last_deg;  ///< none for the first segment
  double volume_mm3 = 0.0;
  std::optional<std::string> verdict;
  DonorCut first_cut, second_cut;
};
constexpr auto members_of(const MeasuredSegment&) {
  using S = MeasuredSegment;
  return std::tuple(member("number", &S::number), member("object", &S::object),
                    member("length_mm", &S::length_mm), member("shortest_mm", &S::shortest_mm),
                    member("longest_mm", &S::longest_mm), member("angle_to_last_deg", &S::angle_to_last_deg),
                    member("volume_mm3", &S::volume_mm3), member("verdict", &S::verdict),
                    member("first_cut", &S::first_cut), member("second_cut", &S::second_cut));
}

/// The contact area of both bones at an osteotomy.
struct MeasuredOsteotomy {
  int number = 1;
  std::string object;
  std::vector<std::string> between;  ///< names of two segments; "bone" beyond the first and the last one
  double contact_voxels_mm2 = 0.0;
  std::optional<double> contact_mesh_mm2;
  double contact_mm2 = 0.0;  ///< the mesh kernel's area or, if it is missing, the voxel kernel's
  std::optional<double> tolerance_mm2;
  std::optional<std::string> verdict;
  std::optional<double> slab_lacks_at_most_mm2;
  std::optional<std::string> finding;
};
constexpr auto members_of(const MeasuredOsteotomy&) {
  using O = MeasuredOsteotomy;
  return std::tuple(member("number", &O::number), member("object", &O::object),
                    member("between", &O::between), member("contact_voxels_mm2", &O::contact_voxels_mm2),
                    member("contact_mesh_mm2", &O::contact_mesh_mm2), member("contact_mm2", &O::contact_mm2),
                    member("tolerance_mm2", &O::tolerance_mm2), member("verdict", &O::verdict),
                    member("slab_lacks_at_most_mm2", &O::slab_lacks_at_most_mm2),
                    member_if_any("finding", &O::finding));
}

struct MeasuredFlap {
  std::vector<MeasuredSegment> flap_segments;
  std::vector<MeasuredOsteotomy> osteotomies;
  double donor_used_mm = 0.0;
  std::string contact_estimator;

  static constexpr const char* key = "flap_segments";
};
constexpr auto members_of(const MeasuredFlap&) {
  using F = MeasuredFlap;
  return std::tuple(member("flap_segments", &F::flap_segments), member("osteotomies", &F::osteotomies),
                    member("donor_used_mm", &F::donor_used_mm),
                    member("contact_estimator", &F::contact_estimator));
}

}  // namespace octotomy::planner
