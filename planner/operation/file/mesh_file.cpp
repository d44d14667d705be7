// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/mesh_file.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "brep/io/read_mesh.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/parallel_tasks.h"
#include "brep/mesh/split_fans.h"
#include "brep/shape/repair.h"
#include "brep/shape/repair_effect.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

brep::Linked joined(const std::filesystem::path& path, std::vector<std::string>& findings) {
  brep::Triangles triangles = read_mesh_in(path);
  try {
    brep::JoinedSurface joined = brep::joined_surface(std::move(triangles));
    for (const std::string& finding : joined.findings)
      findings.push_back(path.filename().string() + ": " + finding);
    return brep::linked(std::move(joined.surface));
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(), path.string() + ": " + error.what());
  }
}

/// The solid of triangles whose sheets share points or sides only because the file stores each point once.
/// Each sheet gets separate copies of its points; the surface does not change. None if the triangles have any
/// other fault.
std::optional<brep::Solid> solid_of_sheets(const brep::Triangles& triangles) {
  try {
    const brep::SplitFans split = brep::split_fans(triangles);
    if (split.surface.points_mm.size() == triangles.points_mm.size() || !split.left_out.empty())
      return std::nullopt;
    return brep::solid_of(split.surface);
  } catch (const brep::Error&) {
    return std::nullopt;
  }
}

brep::Solid solid_in(const std::filesystem::path& path, const brep::Triangles& triangles) {
  try {
    return brep::solid_of(triangles);
  } catch (const brep::Error& error) {
    if (const std::optional<brep::Solid> solid = solid_of_sheets(triangles)) return *solid;
    throw brep::Error(error.code(), path.string() + ": " + error.what() +
                                        "; mend it first, for example by octotomy repair " +
                                        path.filename().string() + " --solid -o solid.ply");
  }
}

}  // namespace

brep::Solid read_solid(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  return solid_in(path, read_mesh_in(path));
}

brep::Solid read_turned_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings) {
  const Stopwatch watch(timings, "read");
  const brep::Triangles triangles = read_mesh_in(path);
  const auto [surface, turned] = brep::turned_alike(triangles);
  if (turned > 0)
    findings.push_back("orient: " + std::to_string(turned) + " of " + std::to_string(triangles.faces.size()) +
                       " triangles of " + path.filename().string() +
                       " were turned, so that outer shells face outward and cavities inward");
  return solid_in(path, turned > 0 ? surface : triangles);
}

brep::Solid read_mended_solid(const std::filesystem::path& path, Timings& timings,
                              std::vector<std::string>& findings, const brep::Progress& progress) {
  brep::Triangles triangles;
  brep::Health health;
  {
    const Stopwatch watch(timings, "read");
    triangles = read_mesh_in(path);
    health = brep::health(triangles);
    if (health.solid()) return brep::trusted_solid(triangles, brep::Proof::Health);
  }
  const Stopwatch watch(timings, "repair");
  try {
    brep::RepairOptions options;
    options.solid = true;
    options.progress = progress;
    const brep::Repair repaired = brep::repair(triangles, options);
    brep::Solid solid = brep::solid_of(repaired.surface);
    const brep::RepairEffect effect =
        brep::repair_effect(triangles, repaired.surface, {.before = false, .after = true});
    findings.push_back(
        path.filename().string() + " is no solid (" + health.findings.front() + "), so it was mended: " +
        (repaired.enclosed_cell_mm ? "a new surface was built around it from cells of " +
                                         three_figures(*repaired.enclosed_cell_mm) + " mm"
                                   : grouped(static_cast<double>(repaired.changes.size()), 0) + " changes") +
        ", volume from " + grouped(effect.volume_before_mm3, 1) + " to " +
        grouped(effect.volume_after_mm3, 1) +
        " mm\u00b3, with the old and new surfaces nowhere farther apart than " +
        three_figures(effect.largest_distance_mm) + " mm; octotomy repair --solid lists each change");
    return solid;
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(), path.string() + ": " + error.what());
  }
}

brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings,
                        std::vector<std::string>* findings) {
  const Stopwatch watch(timings, "read");
  std::vector<std::string> told;
  const brep::Mesh mesh = brep::mesh_of(joined(path, told));
  if (findings != nullptr) findings->insert(findings->end(), told.begin(), told.end());
  return mesh;
}

std::array<brep::Linked, 2> read_surfaces(const std::array<std::filesystem::path, 2>& paths, Timings& timings,
                                          std::vector<std::string>& findings) {
  const Stopwatch watch(timings, "read");
  std::array<brep::Linked, 2> surfaces;
  std::array<std::vector<std::string>, 2> told;
  brep::run_parallel_tasks(paths.size(), [&](std::size_t i) { surfaces[i] = joined(paths[i], told[i]); });
  for (const std::vector<std::string>& of_file : told)
    findings.insert(findings.end(), of_file.begin(), of_file.end());
  return surfaces;
}

std::optional<std::string> rounding_finding(const std::filesystem::path& written, Timings& timings) {
  if (written.extension() != ".stl" && written.extension() != ".STL") return std::nullopt;
  const Stopwatch watch(timings, "health");
  const brep::Health health = brep::health(brep::read_triangles(written));
  if (health.solid()) return std::nullopt;
  return "WARN rounding: the surface is no longer a solid after its points were rounded to .stl's single "
         "precision (" +
         health.findings.front() + "): write .ply, .off or .vtp instead";
}

void write_surface(const brep::Triangles& triangles, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data) {
  const Stopwatch watch(timings, "write");
  voxel::need_disk(out, brep::least_mesh_bytes(triangles.points_mm.size(), triangles.faces.size(), out));
  voxel::StagedFiles staged(out.parent_path());
  const std::filesystem::path file = staged.folder() / out.filename();
  try {
    brep::write_mesh(triangles, file, data);
  } catch (const brep::Error& error) {
    std::string reason = error.what();  // begins with the path of the staged file
    if (reason.starts_with(file.string())) reason.replace(0, file.string().size(), out.string());
    throw brep::Error(error.code(), reason);
  }
  staged.commit();
}

void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings,
                   const brep::VertexData& data) {
  write_surface(brep::triangles_of(mesh), out, timings, data);
}

}  // namespace octotomy::planner
