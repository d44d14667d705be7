// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/anatomy/measured_movement.h"
#include "planner/operation/measure/certificate_record.h"
#include "planner/procedure/cephalometry/cephalometry_table.h"
#include "planner/result/report/measurement.h"

// Those parts of result.json that tables, credibility and cohorts read.
namespace octotomy::planner {

/// A line of a scan's audit.
struct AuditLine {
  std::string check, verdict, detail;
};
constexpr auto members_of(const AuditLine&) {
  using A = AuditLine;
  return std::tuple(member("check", &A::check), member("verdict", &A::verdict), member("detail", &A::detail));
}

struct ScanOfResult {
  std::string name;
  std::optional<std::string> modality, sha256;
  std::optional<glm::dvec3> spacing_mm;
  std::vector<AuditLine> audit;
};
constexpr auto members_of(const ScanOfResult&) {
  using S = ScanOfResult;
  return std::tuple(member("name", &S::name), member("modality", &S::modality), member("sha256", &S::sha256),
                    member("spacing_mm", &S::spacing_mm), member("audit", &S::audit));
}

struct SignatureOfResult {
  std::optional<std::string> by;
  std::vector<std::string> changed_since;
};
constexpr auto members_of(const SignatureOfResult&) {
  return std::tuple(member("by", &SignatureOfResult::by),
                    member("changed_since", &SignatureOfResult::changed_since));
}

struct PlanOfResult {
  std::optional<std::string> name;
};
constexpr auto members_of(const PlanOfResult&) {
  return std::tuple(member("name", &PlanOfResult::name));
}

struct UniverseOfResult {
  glm::dvec3 voxel_mm{0.0};
};
constexpr auto members_of(const UniverseOfResult&) {
  return std::tuple(member("voxel_mm", &UniverseOfResult::voxel_mm));
}

/// Read by record_of<ResultRecord>(result).
struct ResultRecord {
  std::string octotomy;  ///< version of the program
  PlanOfResult plan;
  UniverseOfResult universe;
  std::vector<ScanOfResult> scans;
  std::vector<ObjectMovement> movements;
  std::vector<SignatureOfResult> signatures;
  std::optional<CephalometryTable> cephalometry;
  std::vector<Measurement> measurements;
  std::vector<CertificateRecord> certificates;
  Json counts;  ///< certificates by verdict
};
constexpr auto members_of(const ResultRecord&) {
  using R = ResultRecord;
  return std::tuple(member("octotomy", &R::octotomy), member("plan", &R::plan),
                    member("universe", &R::universe), member("scans", &R::scans),
                    member("movements", &R::movements), member("signatures", &R::signatures),
                    member("cephalometry", &R::cephalometry), member("measurements", &R::measurements),
                    member("certificates", &R::certificates), member("counts", &R::counts));
}

}  // namespace octotomy::planner
