// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's mesh as a file.
#include "brep/io/write_mesh.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/space/disk_need.h"

namespace octotomy::planner {
namespace {

struct Surface {
  ObjectName object;
  std::filesystem::path path;
};

void check(const Surface& surface, const FieldLocation& place) {
  check_output_path(surface.path, {".stl", ".ply", ".obj", ".off", ".vtp", ".glb"}, place.at("path"));
}

void write(const Surface& surface, const AnswerBench& bench, Exported& made) {
  const Object& object = bench.objects.at(surface.object.name);
  made.object = object.id;
  made.path = output_path(surface.path).generic_string();
  if (!object.mesh.within)
    return made.findings.push_back("not written: '" + object.id + "' has no mesh, see its findings");
  const brep::Mesh& mesh = *object.mesh.within;
  if (mesh.n_faces() == 0) return made.findings.push_back("not written: '" + object.id + "' is empty");
  const Stopwatch watch(bench.timings, "write");
  const std::filesystem::path file = output_file(bench.folder, made.path);
  voxel::need_disk(file, brep::least_mesh_bytes(mesh.n_vertices(), mesh.n_faces(), file));
  brep::write_mesh(mesh, file);
  if (auto finding = rounding_finding(file, bench.timings)) made.findings.push_back(std::move(*finding));
  made.written = true;
  made.content = grouped(static_cast<double>(mesh.n_faces()), 0) + " triangles";
  made.details = {{"faces", mesh.n_faces()},
                  {"vertices", mesh.n_vertices()},
                  {"volume_mm3", object.mesh.within->size().volume_mm3}};
}

}  // namespace

Operation surface_operation() {
  return Describe<Surface>("surface", "Writes an object's surface as a mesh.", Makes::File)
      .takes(field("object", &Surface::object, "The object.").required())
      .takes(field("path", &Surface::path,
                   "Path of the file within the result's folder: .stl, .ply, .obj, .off, .vtp or .glb.")
                 .required())
      .example(R"({"id": "piece", "do": "surface", "object": "advanced", "path": "maxilla.stl"})")
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner
