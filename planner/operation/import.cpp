// SPDX-License-Identifier: AGPL-3.0-or-later
// A mesh of any program as an object. Its voxels are made of it, so that it has no certificate of its own;
// the objects made with it have.
#include "brep/io/read_mesh.h"
#include "brep/mesh/error.h"
#include "planner/operation/trace.h"
#include "planner/table/operation.h"

namespace octotomy::planner {
namespace {

struct Import {
  std::filesystem::path path;
};

std::string definition(const Import& import, const Objects&) {
  return import.path.filename().string();
}

void triangles(const Import& import, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "read");
  const std::filesystem::path path = import.path.is_absolute() ? import.path : bench.folder / import.path;
  const brep::Triangles read = brep::read_triangles(path);
  try {
    made.whole = brep::solid_of(read);
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(),
                      path.string() + ": " + error.what() + "; mend it first by octotomy repair");
  }
  made.lineage = "triangles of " + import.path.filename().string();
}

void bound(const Import&, const BoundBench&, Object&) {}

}  // namespace

Operation import_operation() {
  return Describe<Import>("import", "Reads a closed mesh of any program as an object.", Makes::Object)
      .takes(field("path", &Import::path,
                   "The file: .stl, .ply, .obj, .off, .vtk or .vtp, relative to the plan's folder.")
                 .required())
      .example(R"({"id": "plate", "do": "import", "path": "plate.stl"})")
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
