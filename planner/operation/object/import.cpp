// SPDX-License-Identifier: AGPL-3.0-or-later
// A mesh of any program as an object. Its voxels are digitised from it, so that it has no certificate of its
// own; objects that are made with it have one.
#include "planner/operation/object/import.h"

#include "brep/io/read_mesh.h"
#include "brep/mesh/error.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

constexpr const char* import_name = "import";

struct Import {
  std::filesystem::path path;
  std::optional<std::string> frame, unit;
};

void check(const Import& import, const FieldLocation& place) {
  if (import.frame && !brep::frame_named(*import.frame))
    place.at("frame").refuse(
        "'" + *import.frame +
        "' is not a frame: write three letters for the directions of x, y and z, such as LPS or RAS");
}

std::string definition(const Import& import, const Objects&) {
  return import.path.filename().string();
}

brep::MeshFile read(const Import& import, const std::filesystem::path& path) {
  return brep::read_mesh(path, {import.frame, import.unit});
}

std::filesystem::path path_of(const Import& import, const std::filesystem::path& folder) {
  return import.path.is_absolute() ? import.path : folder / import.path;
}

void triangles(const Import& import, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "read");
  const std::filesystem::path path = path_of(import, bench.folder);
  const brep::MeshFile file = read(import, path);
  std::vector<brep::MeshFinding> audit = file.audit;
  for (const brep::MeshFinding& finding :
       brep::findings_beside(file.extent(), {bench.low_mm, bench.high_mm}, "the plan's universe"))
    audit.push_back(finding);
  made.details["audit"] = to_json(audit);
  for (const std::string& line : warnings_of(audit))
    made.findings.push_back(import.path.filename().string() + ": " + line);
  try {
    made.whole = brep::solid_of(file.triangles);
  } catch (const brep::Error& error) {
    throw brep::Error(error.code(),
                      path.string() + ": " + error.what() + "; mend it first by octotomy repair");
  }
  made.lineage = "triangles of " + import.path.filename().string();
}

void bound(const Import&, const BoundBench&, Object&) {}

}  // namespace

bool is_import(const Action& action) {
  return action.operation().name == import_name;
}

voxel::Box import_box(const Action& action, const std::filesystem::path& folder) {
  const Import& import = *static_cast<const Import*>(action.value());
  const brep::Extent extent = read(import, path_of(import, folder)).extent();
  return {extent.low_mm, extent.high_mm};
}

Operation import_operation() {
  return Describe<Import>(import_name, "Reads a closed mesh of any program as an object.", Makes::Object)
      .takes(field("path", &Import::path,
                   std::string("The file: ") + brep::mesh_formats_read + ", relative to the plan's folder.")
                 .required())
      .takes(
          field("frame", &Import::frame,
                "Directions of x, y and z in the file: LPS, RAS, or other letters of L or R, A or P, S or I. "
                "It overrides the file's statement. Default: the file's statement, or LPS if there is none."))
      .takes(field("unit", &Import::unit,
                   "The unit of the file's lengths. It overrides the file's statement. Default: the file's "
                   "statement, or mm if there is none.")
                 .one_of({"um", "mm", "cm", "m", "inch", "foot"}))
      .check(check)
      .example(R"({"id": "plate", "do": "import", "path": "plate.stl"})")
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
