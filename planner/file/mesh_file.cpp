// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/mesh_file.h"

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"

namespace octotomy::planner {

brep::Mesh read_solid(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  const brep::Triangles triangles = brep::read_triangles(path);
  const brep::Health health = brep::health(triangles);
  if (!health.solid())
    throw std::runtime_error(path.string() + ": is not a solid: " + health.findings.front() +
                             "; mend it first, octotomy info tells all");
  return brep::mesh_of(triangles);
}

brep::Mesh read_surface(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  const brep::Triangles triangles = brep::read_triangles(path);
  try {
    return brep::mesh_of(triangles);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

void write_surface(const brep::Mesh& mesh, const std::filesystem::path& out, Timings& timings) {
  const Stopwatch watch(timings, "write");
  brep::write_mesh(mesh, out);
}

}  // namespace octotomy::planner
