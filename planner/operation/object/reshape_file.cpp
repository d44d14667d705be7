// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/reshape_file.h"

#include <algorithm>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "convert/voxel/voxelise.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/certify.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

/// A surface that was read, and whether it is open and thus has no inside.
struct Read {
  brep::Mesh mesh;
  bool is_open = false;
};

/// The surface in a file that contains no solid. Throws unless its only fault is that it is open.
Read read_open(const std::filesystem::path& path, Timings& timings, std::vector<std::string>& findings) {
  brep::Mesh mesh = read_surface(path, timings, &findings);
  const brep::Health health = brep::health(mesh);
  if (health.closed || health.self_intersections > 0 || health.degenerate_faces > 0)
    return {brep::Mesh(), false};
  findings.push_back(path.filename().string() + " is open (" + health.findings.front() +
                     "): its borders do not move, and it has no volume");
  return {std::move(mesh), true};
}

Read read(const ReshapeFile& asked, const FileBench& bench, std::vector<std::string>& findings) {
  if (is_octree(asked.mesh))
    throw std::runtime_error(asked.mesh.string() +
                             ": is an octree: make a mesh of it first by octotomy mesh");
  if (asked.mend) {
    const voxel::Progress progress = bench.progress("repair");
    return {read_mended_solid(asked.mesh, bench.timings, findings, {progress.stop, progress.report}).mesh(),
            false};
  }
  try {
    return {read_solid(asked.mesh, bench.timings).mesh(), false};
  } catch (const brep::Error& error) {
    if (error.code() == brep::ErrorCode::Geometry) {
      Read open = read_open(asked.mesh, bench.timings, findings);
      if (open.is_open) return open;
    }
    throw brep::Error(error.code(), std::string(error.what()) + "; or take --mend");
  }
}

FileAnswer voxels_written(const ReshapeFile& asked, const FileBench& bench, const std::string& doing,
                          const brep::Mesh& mesh, const Json& details, std::vector<std::string> findings) {
  const brep::Linked solid = brep::linked(brep::triangles_of(mesh));
  const brep::Size size = brep::size_of(solid.triangles);
  const glm::dvec3 extent = size.high_mm - size.low_mm;
  const double voxel_mm = asked.voxel_mm.value_or(std::max({extent.x, extent.y, extent.z}) / 128.0);
  findings.emplace_back(mesh_alone);
  const auto inside = [&] {
    const Stopwatch watch(bench.timings, "voxelise");
    return convert::voxelise(voxel::universe_around({size.low_mm, size.high_mm}, voxel_mm), solid,
                             bench.progress("voxelising"));
  };
  const voxel::OctreeFile file{
      inside(), asked.out.stem().string(),
      json_text(Json{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                     {"operation", doing + " of " + asked.mesh.filename().string()}})};
  return octree_written(file, asked.out, bench.stop, bench.timings, findings, details);
}

}  // namespace

FileAnswer reshaped_file(const ReshapeFile& asked, const FileBench& bench, const std::string& doing,
                         const Reshape& reshape) {
  const bool to_octree = is_octree(asked.out);
  if (!to_octree) need_mesh_extension(asked.out);
  need_folder_of(asked.out);
  if (!to_octree && asked.voxel_mm)
    throw std::runtime_error(
        "--voxel applies only to an .octree output, because a mesh has no voxels: leave it out");
  std::vector<std::string> findings;
  const Read given = read(asked, bench, findings);
  if (to_octree && given.is_open)
    throw std::runtime_error(asked.mesh.string() +
                             ": is open, so no voxel is inside: write a mesh, or add --mend");
  Json details = Json::object();
  brep::Mesh made;
  {
    const Stopwatch watch(bench.timings, doing);
    made = reshape(given.mesh, details, findings);
  }
  if (to_octree) return voxels_written(asked, bench, doing, made, details, findings);
  const brep::Health health = brep::health(made);
  const brep::Triangles triangles = brep::triangles_of(made);
  write_surface(triangles, asked.out, bench.timings);
  FileAnswer answer{{{"path", asked.out.string()}}};
  answer.json.update(to_json(health));
  if (given.is_open) {
    answer.json["volume_mm3"] = nullptr;
    answer.json["area_mm2"] = brep::size_of(triangles).area_mm2;
  } else {
    answer.json.update(to_json(brep::measure(made)));
  }
  answer.json["area_estimator"] = "triangles";
  answer.json["health"] = to_json(health);
  answer.json.update(details);
  if (given.is_open && details.contains("volume_change_mm3")) answer.json["volume_change_mm3"] = nullptr;
  answer.json["findings"] = findings;
  answer.findings = findings;
  answer.rows = {
      {"written", asked.out.string()},
      {"volume", given.is_open ? "none: the surface is open"
                               : grouped(answer.json["volume_mm3"].get<double>(), 3) + " mm\u00b3"},
      {"area", grouped(answer.json["area_mm2"].get<double>(), 3) + " mm\u00b2"},
      {"triangles", grouped(static_cast<double>(made.n_faces()), 0)}};
  return answer;
}

}  // namespace octotomy::planner
