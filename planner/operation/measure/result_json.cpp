// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/result_json.h"

#include <cmath>

#include "planner/operation/measure/certificate_record.h"

namespace octotomy::planner {
namespace {

/// Infinity and NaN become null, because JSON has neither.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

KernelAnswer answer_of(const verify::Answer& side) {
  return {side.lineage, side.volume_mm3, side.area_mm2, side.centroid_mm, side.makers};
}

Json third_json(const std::optional<verify::LineCount>& third) {
  if (!third) return nullptr;
  return {
      {"volume_mm3", finite(third->volume_mm3)},
      {"deviation_mm3", finite(third->deviation_mm3)},
      {"area_mm2", finite(third->area_mm2)},
      {"lines", third->lines},
      {"crossings", third->crossings},
      {"estimator", "Cauchy-Crofton: lines in twelve directions through the plan's expression on the scan"}};
}

ComparedQuantity compared(const verify::Comparison& comparison) {
  ComparedQuantity made{comparison.quantity,   comparison.unit,      comparison.voxel,   comparison.mesh,
                        comparison.difference, comparison.tolerance, comparison.formula, {}};
  if (comparison.tolerance) made.verdict = verify::to_string(comparison.verdict);
  return made;
}

}  // namespace

Json answer(const Timings& timings) {
  Json json{{"octotomy", OCTOTOMY_VERSION}, {"timings_ms", Json::object()}};
  for (const auto& [stage, milliseconds] : timings) json["timings_ms"][stage] = milliseconds;
  return json;
}

Json to_json(const glm::dvec3& value) {
  return Json::array({finite(value.x), finite(value.y), finite(value.z)});
}

Json to_json(const std::optional<glm::dvec3>& value) {
  return value ? to_json(*value) : Json(nullptr);
}

Json to_json(const glm::dmat4& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({matrix[0][row], matrix[1][row], matrix[2][row], matrix[3][row]});
  return rows;
}

Json to_json(const glm::dmat3& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row)
    rows.push_back({finite(matrix[0][row]), finite(matrix[1][row]), finite(matrix[2][row])});
  return rows;
}

Json to_json(const std::vector<voxel::Finding>& audit) {
  Json lines = Json::array();
  for (const voxel::Finding& finding : audit) {
    lines.push_back(
        {{"check", finding.check}, {"verdict", to_string(finding.verdict)}, {"detail", finding.detail}});
    if (!finding.files.empty()) lines.back()["files"] = finding.files;
  }
  return lines;
}

Json to_json(const std::vector<voxel::Hole>& holes, const voxel::Lattice& lattice) {
  Json list = Json::array();
  for (const voxel::Hole& hole : holes) {
    const std::optional<voxel::SliceRange> slices = voxel::slices_inside(lattice, hole);
    list.push_back({{"normal", to_json(hole.normal)},
                    {"low_mm", hole.low_mm},
                    {"high_mm", hole.high_mm},
                    {"length_mm", hole.length_mm()},
                    {"slices", slices ? Json({slices->first, slices->last}) : Json(nullptr)}});
  }
  return list;
}

namespace {

std::vector<glm::dvec3> rows_of(const glm::dmat3& matrix) {
  const glm::dmat3 rows = glm::transpose(matrix);
  return {rows[0], rows[1], rows[2]};
}

}  // namespace

VoxelSize size_of(const voxel::Measures& measures) {
  VoxelSize size;
  size.volume_mm3 = measures.volume_mm3;
  size.volume_estimator = "voxels counted";
  size.voxels = measures.voxel_count;
  size.area_mm2 = measures.area_crofton13_mm2;
  size.area_estimator = voxel_area_estimator;
  size.area_lindblad_mm2 = measures.area_lindblad_mm2;
  size.centroid_mm = measures.centroid_mm;
  if (measures.inertia_mm5) size.inertia_mm5 = rows_of(*measures.inertia_mm5);
  if (measures.extents) size.extents_mm = {measures.extents->low_mm, measures.extents->high_mm};
  return size;
}

MeshSize size_of(const brep::Measures& measures) {
  MeshSize size;
  size.volume_mm3 = measures.volume_mm3;
  size.volume_estimator = "divergence theorem over the mesh";
  size.area_mm2 = measures.area_mm2;
  size.area_estimator = mesh_area_estimator;
  size.centroid_mm = measures.centroid_mm;
  if (measures.inertia_mm5) size.inertia_mm5 = rows_of(*measures.inertia_mm5);
  size.extents_mm = {measures.low_mm, measures.high_mm};
  return size;
}

Json to_json(const voxel::Measures& measures) {
  return print_record(size_of(measures));
}

Json to_json(const brep::Measures& measures) {
  return print_record(size_of(measures));
}

Json to_json(const brep::Health& health) {
  return {{"vertices", health.vertices},
          {"faces", health.faces},
          {"closed", health.closed},
          {"manifold", health.manifold},
          {"oriented", health.oriented},
          {"self_intersections", health.self_intersections},
          {"components", health.components},
          {"euler", health.euler},
          {"open_edges", health.boundary_edges},
          {"open_edges_closed_by_welding", health.unwelded_edges},
          {"edges_of_three_and_more", health.nonmanifold_edges},
          {"coincident_points", health.coincident_points},
          {"findings", health.findings}};
}

CertificateRecord record_of_certificate(const verify::Certificate& certificate) {
  Json terms = Json::array();
  for (const verify::ToleranceTerm& term : certificate.terms)
    terms.push_back({{"name", term.name},
                     {"cause", term.cause},
                     {"formula", term.formula},
                     {"value_mm3", finite(term.value_mm3)}});
  Json worst = nullptr;
  if (certificate.worst)
    worst = {{"at_mm", to_json(certificate.worst->at_mm)},
             {"size_mm", finite(certificate.worst->size_mm)},
             {"what", certificate.worst->what}};
  Json limit = nullptr;
  if (certificate.limit)
    limit = {
        {"volume_mm3", finite(certificate.limit->volume_mm3)},
        {"shift_mm", certificate.limit->shift_mm ? finite(*certificate.limit->shift_mm) : Json(nullptr)}};
  Json bridges = Json::array();
  for (const verify::WorstPlace& bridge : certificate.bridges)
    bridges.push_back(
        {{"at_mm", to_json(bridge.at_mm)}, {"volume_mm3", finite(bridge.volume_mm3)}, {"what", bridge.what}});
  CertificateRecord made;
  made.operation = certificate.operation;
  made.tier = verify::to_string(certificate.tier);
  made.verdict = verify::to_string(certificate.verdict);
  made.resolved = certificate.resolved();
  if (certificate.unresolved) {
    made.smallest_extent_voxels = certificate.unresolved->extent_voxels;
    made.not_resolved_because = certificate.unresolved->reason;
  }
  made.reasons = certificate.reasons;
  made.lineage = {certificate.voxel.lineage, certificate.mesh.lineage};
  made.independent = certificate.independent();
  made.shared_makers = verify::shared_makers(certificate.voxel, certificate.mesh);
  made.shared_values = certificate.shared_values;
  made.voxel = answer_of(certificate.voxel);
  made.mesh = answer_of(certificate.mesh);
  made.difference_mm3 = certificate.difference_mm3;
  made.tolerance_mm3 = certificate.tolerance_mm3;
  made.terms = std::move(terms);
  made.symmetric_difference_mm3 = certificate.symmetric_difference_mm3;
  made.symmetric_difference_tolerance_mm3 = certificate.symmetric_difference_tolerance_mm3;
  made.centroid_distance_mm = certificate.centroid_distance_mm;
  made.centroid_tolerance_mm = certificate.centroid_tolerance_mm;
  made.hausdorff_mm = certificate.hausdorff_mm;
  made.hausdorff95_mm = certificate.hausdorff95_mm;
  made.worst = std::move(worst);
  made.detection_limit = std::move(limit);
  made.bridges = std::move(bridges);
  made.third_reading = third_json(certificate.third);
  for (const verify::Comparison& comparison : certificate.comparisons)
    made.comparisons.push_back(compared(comparison));
  made.timings_ms.certify = certificate.milliseconds;
  return made;
}

Json to_json(const verify::Certificate& certificate) {
  return print_record(record_of_certificate(certificate));
}

Json to_json(const HalfWidth& width) {
  return print_value(width.terms);
}

Json to_json(const ScanRecord& scan) {
  Json json{{"name", scan.name},
            {"path", scan.path.generic_string()},
            {"sha256", scan.sha256},
            {"dims", {scan.lattice.dims.x, scan.lattice.dims.y, scan.lattice.dims.z}},
            {"spacing_mm", to_json(scan.lattice.spacing_mm())},
            {"lps_from_voxel", to_json(scan.lattice.lps_from_voxel)},
            {"range", {finite(scan.range.low), finite(scan.range.high)}},
            {"modality", scan.modality},
            {"unit", scan.unit},
            {"audit", to_json(scan.audit)}};
  if (!scan.holes.empty()) json["interpolated"] = to_json(scan.holes, scan.lattice);
  if (!scan.made_by.empty()) json["made_by"] = scan.made_by;
  if (!scan.details.empty()) json["details"] = scan.details;
  return json;
}

Json to_json(const Object& object) {
  Json json{
      {"id", object.id},
      {"kind", object.kind},
      {"definition", object.definition},
      {"voxel", to_json(object.voxel.measures)},
      {"mesh", object.mesh.within ? to_json(object.mesh.within->measures()) : Json(nullptr)},
      {"mesh_faces", object.mesh.within ? Json(object.mesh.within->triangles().faces.size()) : Json(nullptr)},
      {"verdict", object.certificate ? Json(verify::to_string(object.certificate->verdict)) : Json(nullptr)},
      {"resolved", object.certificate ? Json(object.certificate->resolved()) : Json(nullptr)},
      {"findings", object.findings}};
  if (!object.mesh.details.empty()) json["details"] = object.mesh.details;
  return json;
}

namespace {

/// The identity in DICOM's terms; null for values that the file does not state.
Json identity_json(const voxel::Identity& identity) {
  const auto or_null = [](const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); };
  const auto first = [](const std::vector<std::string>& uids) {
    return uids.empty() ? Json(nullptr) : Json(uids.front());
  };
  return {{"patient_id", or_null(identity.patient_id)},
          {"study_uid", first(identity.study_uids)},
          {"frame_of_reference_uid", first(identity.frame_uids)}};
}

}  // namespace

Json scan_answer(const voxel::Scene& scene, const Timings& timings) {
  Json json = answer(timings);
  const voxel::Range range = voxel::range(scene);
  json.update({{"kind", "scan"},
               {"source", scene.source},
               {"dims", {scene.lattice.dims.x, scene.lattice.dims.y, scene.lattice.dims.z}},
               {"spacing_mm", to_json(scene.lattice.spacing_mm())},
               {"lps_from_voxel", to_json(scene.lattice.lps_from_voxel)},
               {"range", {finite(range.low), finite(range.high)}},
               {"padding", print_value(scene.padding)},
               {"modality", scene.modality},
               {"unit", voxel::unit(scene)},
               {"identity", identity_json(scene.identity)},
               {"audit", to_json(scene.audit)}});
  if (!scene.holes.empty()) json["interpolated"] = to_json(scene.holes, scene.lattice);
  return json;
}

}  // namespace octotomy::planner
