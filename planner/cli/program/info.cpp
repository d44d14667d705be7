// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "brep/mesh/health.h"
#include "planner/cli/program/convert_source.h"
#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/mesh_options.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

int info_of_mesh(const Program& program, const std::filesystem::path& path) {
  Timings timings;
  brep::Triangles triangles;
  {
    const Stopwatch watch(timings, "read");
    triangles = read_mesh_in(path);
  }
  brep::Health health;
  {
    const Stopwatch watch(timings, "health");
    health = brep::health(triangles);
  }
  Json json = answer(timings);
  json["kind"] = "mesh";
  json["source"] = path.string();
  json.update(to_json(health));
  std::vector<brep::MeshFinding> audit;
  for (const MeshRecord& mesh : meshes_read()) audit = mesh.audit;
  json["audit"] = to_json(audit);
  std::string text =
      lines({{"mesh", path.string()},
             {"vertices", grouped(static_cast<double>(health.vertices), 0)},
             {"faces", grouped(static_cast<double>(health.faces), 0)},
             {"components", std::to_string(health.components)},
             {"euler", std::to_string(health.euler)},
             {"closed", health.closed ? "yes" : "no"},
             {"manifold", health.manifold ? "yes" : "no"},
             {"oriented", health.oriented ? "yes" : "no"},
             {"crossings", std::to_string(health.self_intersections)},
             {"open edges", grouped(static_cast<double>(health.boundary_edges), 0)},
             {"coincident", grouped(static_cast<double>(health.coincident_points), 0) + " points"}});
  for (const brep::MeshFinding& finding : audit)
    text += "  " + brep::to_string(finding.verdict) + "  " + finding.check + ": " + finding.detail + "\n";
  for (const std::string& finding : health.findings) text += "  " + finding + "\n";
  program.say(json, text);
  return done;
}

/// The series of a DICOM folder, with the numbers that --series accepts. Null for other inputs.
Json series_of(const std::filesystem::path& path, const voxel::Scene& scene) {
  if (!is_dicom(scene)) return nullptr;
  Json list = Json::array();
  for (const voxel::SeriesEntry& entry : voxel::list_series(path))
    list.push_back({{"series", list.size() + 1},
                    {"description", entry.description},
                    {"modality", entry.modality},
                    {"number", entry.number},
                    {"slices", entry.slices},
                    {"choice", entry.choice},
                    {"stack", entry.stack},
                    {"size_px", {entry.size_px.x, entry.size_px.y}},
                    {"uid", entry.uid}});
  return list;
}

int info_of_scan(const Program& program, const std::filesystem::path& path, const ScanIn& in) {
  Timings timings;
  const voxel::Scene scene = read_scan(program, path, in, timings);
  Json json = scan_answer(scene, timings);
  json["series"] = series_of(path, scene);
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const voxel::Range range = voxel::range(scene);
  std::string text = lines({{"scan", path.string()},
                            {"modality", scene.modality.empty() ? "not stated" : scene.modality},
                            {"samples", dims_text(scene.lattice.dims)},
                            {"spacing", grouped(spacing_mm.x, 4) + " x " + grouped(spacing_mm.y, 4) + " x " +
                                            grouped(spacing_mm.z, 4) + " mm"},
                            {"range", grouped(range.low, 0) + " to " + grouped(range.high, 0) +
                                          (voxel::unit(scene) == "1" ? "" : " HU")}});
  if (json["series"].size() > 1)
    for (const Json& series : json["series"])
      text += "  series " + series["choice"].get<std::string>() + ": '" +
              series["description"].get<std::string>() + "', " + series["modality"].get<std::string>() +
              (series["stack"] == "" ? "" : ", " + series["stack"].get<std::string>()) + ", " +
              std::to_string(series["slices"].get<int>()) + " slices\n";
  for (const voxel::Finding& finding : scene.audit)
    text += "  " + to_string(finding.verdict) + "  " + finding.check + ": " + finding.detail + "\n";
  program.say(json, text);
  return done;
}

}  // namespace

void add_info(Program& program) {
  const auto path = std::make_shared<std::filesystem::path>();
  const auto in = std::make_shared<ScanIn>();
  const auto self = std::make_shared<CLI::App*>(nullptr);
  CLI::App& verb = program.verb(
      "info",
      "Describes a file: a scan's geometry, range and audit; an octree's levels; a mesh's counts and health",
      "octotomy info head.nrrd --json", [&program, path, in, self] {
        choose_mesh_options(**self);
        need_options_fit(**self, {path->string()});
        if (is_octree(*path)) return info_of_octree(program, *path);
        if (is_mesh(*path)) return info_of_mesh(program, *path);
        if (const std::optional<int> status = info_of_archived(program, *path)) return *status;
        return info_of_scan(program, *path, *in);
      });
  verb.add_option("file", *path,
                  "A DICOM folder or file, NIfTI, NRRD, MetaImage; .octree; STL, PLY, OBJ, OFF, VTK, GLB, "
                  "3MF; a document or picture in DICOM")
      ->required()
      ->check(scan_path());
  add_scan_options(verb, *in);
  add_mesh_options(verb);
  *self = &verb;
}

}  // namespace octotomy::planner::cli
