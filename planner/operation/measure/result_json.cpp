// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/result_json.h"

#include <cmath>

namespace octotomy::planner {
namespace {

/// JSON has no infinity and no NaN; these become null.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json finite(const std::optional<double>& value) {
  return value ? finite(*value) : Json(nullptr);
}

Json answer_of(const verify::Answer& side) {
  return {{"lineage", side.lineage},
          {"volume_mm3", finite(side.volume_mm3)},
          {"area_mm2", finite(side.area_mm2)},
          {"centroid_mm", to_json(side.centroid_mm)},
          {"makers", side.makers}};
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

Json comparison_json(const verify::Comparison& comparison) {
  return {{"quantity", comparison.quantity},
          {"unit", comparison.unit},
          {"voxel", finite(comparison.voxel)},
          {"mesh", finite(comparison.mesh)},
          {"difference", finite(comparison.difference)},
          {"tolerance", finite(comparison.tolerance)},
          {"formula", comparison.formula},
          {"verdict", comparison.tolerance ? Json(verify::to_string(comparison.verdict)) : Json(nullptr)}};
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

Json to_json(const voxel::Measures& measures) {
  Json json{{"volume_mm3", measures.volume_mm3},
            {"volume_estimator", "voxels counted"},
            {"voxels", measures.voxel_count},
            {"area_mm2", measures.area_crofton13_mm2},
            {"area_estimator", voxel_area_estimator},
            {"area_lindblad_mm2", nullptr},
            {"centroid_mm", to_json(measures.centroid_mm)},
            {"inertia_mm5", nullptr},
            {"extents_mm", nullptr}};
  if (measures.area_lindblad_mm2) json["area_lindblad_mm2"] = *measures.area_lindblad_mm2;
  if (measures.inertia_mm5) json["inertia_mm5"] = to_json(*measures.inertia_mm5);
  if (measures.extents)
    json["extents_mm"] = Json::array({to_json(measures.extents->low_mm), to_json(measures.extents->high_mm)});
  return json;
}

Json to_json(const brep::Measures& measures) {
  return {{"volume_mm3", measures.volume_mm3},
          {"volume_estimator", "divergence theorem over the mesh"},
          {"area_mm2", measures.area_mm2},
          {"area_estimator", mesh_area_estimator},
          {"centroid_mm", to_json(measures.centroid_mm)},
          {"inertia_mm5", measures.inertia_mm5 ? to_json(*measures.inertia_mm5) : Json(nullptr)},
          {"extents_mm", Json::array({to_json(measures.low_mm), to_json(measures.high_mm)})}};
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

Json to_json(const verify::Certificate& certificate) {
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
  Json comparisons = Json::array();
  for (const verify::Comparison& comparison : certificate.comparisons)
    comparisons.push_back(comparison_json(comparison));
  return {
      {"operation", certificate.operation},
      {"tier", verify::to_string(certificate.tier)},
      {"verdict", verify::to_string(certificate.verdict)},
      {"resolved", certificate.resolved()},
      {"smallest_extent_voxels",
       certificate.unresolved ? finite(certificate.unresolved->extent_voxels) : Json(nullptr)},
      {"not_resolved_because", certificate.unresolved ? Json(certificate.unresolved->reason) : Json(nullptr)},
      {"reasons", certificate.reasons},
      {"lineage", {{"voxel", certificate.voxel.lineage}, {"mesh", certificate.mesh.lineage}}},
      {"independent", certificate.independent()},
      {"shared_makers", verify::shared_makers(certificate.voxel, certificate.mesh)},
      {"shared_values", certificate.shared_values},
      {"voxel", answer_of(certificate.voxel)},
      {"mesh", answer_of(certificate.mesh)},
      {"difference_mm3", finite(certificate.difference_mm3)},
      {"tolerance_mm3", finite(certificate.tolerance_mm3)},
      {"terms", terms},
      {"symmetric_difference_mm3", finite(certificate.symmetric_difference_mm3)},
      {"symmetric_difference_tolerance_mm3", finite(certificate.symmetric_difference_tolerance_mm3)},
      {"centroid_distance_mm", finite(certificate.centroid_distance_mm)},
      {"centroid_tolerance_mm", finite(certificate.centroid_tolerance_mm)},
      {"hausdorff_mm", finite(certificate.hausdorff_mm)},
      {"hausdorff95_mm", finite(certificate.hausdorff95_mm)},
      {"worst", worst},
      {"detection_limit", limit},
      {"bridges", bridges},
      {"third_reading", third_json(certificate.third)},
      {"comparisons", comparisons},
      {"timings_ms", {{"certify", certificate.milliseconds}}}};
}

Json to_json(const HalfWidth& width) {
  Json terms = Json::array();
  for (const Doubt& doubt : width.terms)
    terms.push_back(
        {{"name", doubt.name}, {"formula", doubt.formula}, {"half_width", finite(doubt.half_width)}});
  return terms;
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
  return {
      {"id", object.id},
      {"kind", object.kind},
      {"definition", object.definition},
      {"voxel", to_json(object.voxel.measures)},
      {"mesh", object.mesh.within ? to_json(object.mesh.within->measures()) : Json(nullptr)},
      {"mesh_faces", object.mesh.within ? Json(object.mesh.within->triangles().faces.size()) : Json(nullptr)},
      {"verdict", object.certificate ? Json(verify::to_string(object.certificate->verdict)) : Json(nullptr)},
      {"resolved", object.certificate ? Json(object.certificate->resolved()) : Json(nullptr)},
      {"findings", object.findings}};
}

namespace {

/// The identity as in DICOM; null for values that the file does not state.
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
  json["kind"] = "scan";
  json["source"] = scene.source;
  json["dims"] = {scene.lattice.dims.x, scene.lattice.dims.y, scene.lattice.dims.z};
  json["spacing_mm"] = to_json(scene.lattice.spacing_mm());
  json["lps_from_voxel"] = to_json(scene.lattice.lps_from_voxel);
  json["range"] = {finite(range.low), finite(range.high)};
  json["padding"] = scene.padding ? Json(*scene.padding) : Json(nullptr);
  json["modality"] = scene.modality;
  json["unit"] = voxel::unit(scene);
  json["identity"] = identity_json(scene.identity);
  json["audit"] = to_json(scene.audit);
  if (!scene.holes.empty()) json["interpolated"] = to_json(scene.holes, scene.lattice);
  return json;
}

}  // namespace octotomy::planner
