// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "planner/operation/table/record.h"
#include "verify/certificate/certificate.h"

// The records of certificates in results. They have no value where a certificate has an infinite number.
namespace octotomy::planner {

/// One kernel's answer.
struct KernelAnswer {
  std::string lineage;
  std::optional<double> volume_mm3, area_mm2;
  std::optional<glm::dvec3> centroid_mm;
  std::vector<std::string> makers;
};
constexpr auto members_of(const KernelAnswer&) {
  using A = KernelAnswer;
  return std::tuple(member("lineage", &A::lineage), member("volume_mm3", &A::volume_mm3),
                    member("area_mm2", &A::area_mm2), member("centroid_mm", &A::centroid_mm),
                    member("makers", &A::makers));
}

struct ComparedQuantity {
  std::string quantity, unit;
  std::optional<double> voxel, mesh, difference, tolerance;
  std::string formula;
  std::optional<std::string> verdict;  ///< none without a tolerance
};
constexpr auto members_of(const ComparedQuantity&) {
  using C = ComparedQuantity;
  return std::tuple(member("quantity", &C::quantity), member("unit", &C::unit), member("voxel", &C::voxel),
                    member("mesh", &C::mesh), member("difference", &C::difference),
                    member("tolerance", &C::tolerance), member("formula", &C::formula),
                    member("verdict", &C::verdict));
}

struct Lineages {
  std::string voxel, mesh;
};
constexpr auto members_of(const Lineages&) {
  return std::tuple(member("voxel", &Lineages::voxel), member("mesh", &Lineages::mesh));
}

struct CertificateTime {
  double certify = 0.0;
};
constexpr auto members_of(const CertificateTime&) {
  return std::tuple(member("certify", &CertificateTime::certify));
}

struct CertificateRecord {
  std::string object;  ///< the object's name; empty outside of a plan's result
  std::string operation, tier, verdict;
  bool resolved = true;
  std::optional<double> smallest_extent_voxels;
  std::optional<std::string> not_resolved_because;
  std::vector<std::string> reasons;
  Lineages lineage;
  bool independent = false;
  std::vector<std::string> shared_makers, shared_values;
  KernelAnswer voxel, mesh;
  std::optional<double> difference_mm3, tolerance_mm3;
  Json terms;
  std::optional<double> symmetric_difference_mm3, symmetric_difference_tolerance_mm3, centroid_distance_mm,
      centroid_tolerance_mm, hausdorff_mm, hausdorff95_mm;
  Json worst;
  Json detection_limit;  ///< null if no detection limit was determined
  Json bridges, third_reading;
  std::vector<ComparedQuantity> comparisons;
  CertificateTime timings_ms;
  std::vector<std::string> findings;  ///< of the object
};
constexpr auto members_of(const CertificateRecord&) {
  using C = CertificateRecord;
  return std::tuple(
      member_if_any("object", &C::object), member("operation", &C::operation), member("tier", &C::tier),
      member("verdict", &C::verdict), member("resolved", &C::resolved),
      member("smallest_extent_voxels", &C::smallest_extent_voxels),
      member("not_resolved_because", &C::not_resolved_because), member("reasons", &C::reasons),
      member("lineage", &C::lineage), member("independent", &C::independent),
      member("shared_makers", &C::shared_makers), member("shared_values", &C::shared_values),
      member("voxel", &C::voxel), member("mesh", &C::mesh), member("difference_mm3", &C::difference_mm3),
      member("tolerance_mm3", &C::tolerance_mm3), member("terms", &C::terms),
      member("symmetric_difference_mm3", &C::symmetric_difference_mm3),
      member("symmetric_difference_tolerance_mm3", &C::symmetric_difference_tolerance_mm3),
      member("centroid_distance_mm", &C::centroid_distance_mm),
      member("centroid_tolerance_mm", &C::centroid_tolerance_mm), member("hausdorff_mm", &C::hausdorff_mm),
      member("hausdorff95_mm", &C::hausdorff95_mm), member("worst", &C::worst),
      member("detection_limit", &C::detection_limit), member("bridges", &C::bridges),
      member("third_reading", &C::third_reading), member("comparisons", &C::comparisons),
      member("timings_ms", &C::timings_ms), member_if_any("findings", &C::findings));
}

/// The record of a certificate, without its object and findings.
CertificateRecord record_of_certificate(const verify::Certificate& certificate);

}  // namespace octotomy::planner
