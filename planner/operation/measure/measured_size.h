// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/measure/half_width.h"
#include "planner/operation/table/record.h"

// The measured size of an object: records below `measurements` in a result. Keys end in their unit.
namespace octotomy::planner {

constexpr auto members_of(const Doubt&) {
  return std::tuple(member("name", &Doubt::name), member("formula", &Doubt::formula),
                    member("half_width", &Doubt::half_width));
}

/// A recommended number with its half-width, and the sources of the half-width.
struct MeasuredInterval {
  double value = 0.0;
  std::string unit;
  std::optional<double> half_width;
  double coverage = 0.0;  ///< share of cases in which the interval contains the true value
  std::vector<Doubt> sources;
};
constexpr auto members_of(const MeasuredInterval&) {
  using M = MeasuredInterval;
  return std::tuple(member("value", &M::value), member("unit", &M::unit),
                    member("half_width", &M::half_width), member("coverage", &M::coverage),
                    member("sources", &M::sources));
}

/// The voxel kernel's measures of an object.
struct VoxelSize {
  double volume_mm3 = 0.0;
  std::string volume_estimator;
  std::uint64_t voxels = 0;
  std::optional<double> area_mm2;
  std::string area_estimator;
  std::optional<double> area_lindblad_mm2;
  std::optional<glm::dvec3> centroid_mm;
  std::optional<std::vector<glm::dvec3>> inertia_mm5;  ///< its three rows
  std::optional<std::vector<glm::dvec3>> extents_mm;   ///< lowest and highest corner
};
constexpr auto members_of(const VoxelSize&) {
  using S = VoxelSize;
  return std::tuple(member("volume_mm3", &S::volume_mm3), member("volume_estimator", &S::volume_estimator),
                    member("voxels", &S::voxels), member("area_mm2", &S::area_mm2),
                    member("area_estimator", &S::area_estimator),
                    member("area_lindblad_mm2", &S::area_lindblad_mm2),
                    member("centroid_mm", &S::centroid_mm), member("inertia_mm5", &S::inertia_mm5),
                    member("extents_mm", &S::extents_mm));
}

/// The mesh kernel's measures of an object.
struct MeshSize {
  double volume_mm3 = 0.0;
  std::string volume_estimator;
  double area_mm2 = 0.0;
  std::string area_estimator;
  std::optional<glm::dvec3> centroid_mm;
  std::optional<std::vector<glm::dvec3>> inertia_mm5;
  std::vector<glm::dvec3> extents_mm;
};
constexpr auto members_of(const MeshSize&) {
  using S = MeshSize;
  return std::tuple(member("volume_mm3", &S::volume_mm3), member("volume_estimator", &S::volume_estimator),
                    member("area_mm2", &S::area_mm2), member("area_estimator", &S::area_estimator),
                    member("centroid_mm", &S::centroid_mm), member("inertia_mm5", &S::inertia_mm5),
                    member("extents_mm", &S::extents_mm));
}

/// An object's size by each kernel, and the recommended size.
struct MeasuredSize {
  std::string object;
  double volume_mm3 = 0.0;
  std::string volume_estimator;
  std::optional<double> area_mm2;
  std::string area_estimator;
  std::optional<glm::dvec3> centroid_mm;
  VoxelSize voxel;
  std::optional<MeshSize> mesh;
  std::optional<double> difference_mm3, difference_percent;  ///< voxel minus mesh
  std::optional<MeasuredInterval> volume, area;              ///< the recommended ones
  double volume_half_width_mm3 = 0.0;
  std::vector<Doubt> volume_half_width_terms;
  std::optional<std::string> finding;
  std::optional<double> area_half_width_mm2;

  static constexpr const char* key = "volume_mm3";  ///< only sizes have it
};
constexpr auto members_of(const MeasuredSize&) {
  using S = MeasuredSize;
  return std::tuple(
      member("object", &S::object), member("volume_mm3", &S::volume_mm3),
      member("volume_estimator", &S::volume_estimator), member("area_mm2", &S::area_mm2),
      member("area_estimator", &S::area_estimator), member("centroid_mm", &S::centroid_mm),
      member("voxel", &S::voxel), member("mesh", &S::mesh), member("difference_mm3", &S::difference_mm3),
      member("difference_percent", &S::difference_percent), member_if_any("volume", &S::volume),
      member_if_any("area", &S::area), member("volume_half_width_mm3", &S::volume_half_width_mm3),
      member("volume_half_width_terms", &S::volume_half_width_terms), member_if_any("finding", &S::finding),
      member("area_half_width_mm2", &S::area_half_width_mm2));
}

}  // namespace octotomy::planner
