// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's surface of fewer triangles. Only the mesh kernel has triangles: its answer is voxelised. Its
// certificate measures the distances between both surfaces, in both directions.
#include "brep/shape/decimate.h"

#include <algorithm>
#include <cmath>

#include "brep/mesh/measure.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/reshape_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/reshaped_witness.h"

namespace octotomy::planner {
namespace {

struct Decimate {
  ObjectName object;
  std::optional<double> max_error_mm;
  std::optional<int> faces;
  double max_normal_deviation_deg = brep::DecimateOptions{}.max_normal_deviation_deg;
  // Of the verb.
  std::filesystem::path out;
  std::optional<double> voxel_mm;
  bool mend = false;
};

/// If no error is stated, the allowed error is this share of the surface's extent, at most 0.1 mm. For
/// extents below 20 mm, the share thus limits the error, so that small objects or those in another unit keep
/// their shape.
constexpr double default_share() {
  return 1.0 / 200.0;
}

/// A change of volume by more than this share is a finding.
constexpr double told_share() {
  return 0.05;
}

double max_error_mm(const Decimate& decimate, const brep::Mesh& mesh) {
  if (decimate.max_error_mm) return *decimate.max_error_mm;
  const brep::Size size = brep::size_of(brep::triangles_of(mesh));
  const glm::dvec3 extent = size.high_mm - size.low_mm;
  return std::min(brep::DecimateOptions{}.max_error_mm,
                  default_share() * std::max({extent.x, extent.y, extent.z}));
}

bool is_closed(const brep::Mesh& mesh) {
  return std::none_of(mesh.edges_begin(), mesh.edges_end(),
                      [&](const auto& edge) { return mesh.is_boundary(edge); });
}

brep::Mesh fewer(const Decimate& decimate, const brep::Mesh& mesh, Json& details,
                 std::vector<std::string>& findings) {
  brep::DecimateOptions options;
  options.max_error_mm = max_error_mm(decimate, mesh);
  if (decimate.faces) options.faces = static_cast<std::size_t>(*decimate.faces);
  options.max_normal_deviation_deg = decimate.max_normal_deviation_deg;
  brep::Mesh made = brep::decimate(mesh, options);
  const double before_mm3 = brep::volume_mm3(mesh), after_mm3 = brep::volume_mm3(made);
  details["faces_before"] = mesh.n_faces();
  details["volume_change_mm3"] = after_mm3 - before_mm3;
  details["max_error_mm"] = options.max_error_mm;
  if (made.n_faces() == mesh.n_faces())
    findings.push_back("no triangle could be removed within an error of " +
                       three_figures(options.max_error_mm) + " mm: allow a larger error");
  else if (decimate.faces && made.n_faces() > options.faces)
    findings.push_back(std::to_string(made.n_faces()) +
                       " triangles remain, more than requested, because fewer would deviate by more than " +
                       three_figures(options.max_error_mm) + " mm");
  if (is_closed(mesh) && std::abs(after_mm3 - before_mm3) > told_share() * std::abs(before_mm3))
    findings.push_back("WARN volume: it changed from " + three_figures(before_mm3) + " to " +
                       three_figures(after_mm3) + " mm\u00b3 within an error of " +
                       three_figures(options.max_error_mm) + " mm: allow only a smaller error");
  return made;
}

std::string definition(const Decimate& decimate, const Objects&) {
  return decimate.object.name + " of fewer triangles, within " +
         (decimate.max_error_mm ? plain(*decimate.max_error_mm) + " mm" : "0.1 mm or a 200th of its extent");
}

void triangles(const Decimate& decimate, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "decimate");
  const brep::Solid& solid = bench.object(decimate.object.name);
  made.whole =
      brep::trusted_solid(fewer(decimate, solid, made.details, made.findings), brep::Proof::Construction);
  made.lineage = "edges collapsed within an error";
}

void bound(const Decimate& decimate, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(decimate.object.name);
  made.bound.shift_mm = object.bound.shift_mm;
  if (made.mesh.whole && object.mesh.whole)
    made.witness = verify::witness_of_reshaped(
        [still = *object.mesh.whole,
         error_mm = max_error_mm(decimate, object.mesh.whole->mesh())]() -> verify::Reshaped {
          return {verify::surface_decimated(still.triangles(), error_mm)};
        });
  made.bound.reshaped = {decimate.object.name};
  made.ends_with_universe = true;
}

FileAnswer on_files(const Decimate& asked, const FileBench& bench) {
  return reshaped_file({asked.object.name, asked.out, asked.voxel_mm, asked.mend}, bench, "decimate",
                       [&](const brep::Mesh& mesh, Json& details, std::vector<std::string>& findings) {
                         return fewer(asked, mesh, details, findings);
                       });
}

}  // namespace

Operation decimate_operation() {
  return Describe<Decimate>("decimate", "Reduces the number of triangles of an object's surface.",
                            Makes::Object)
      .takes(field("object", &Decimate::object, "The object.").required().positional("mesh"))
      .takes(field("max_error_mm", &Decimate::max_error_mm,
                   "Largest distance between the old and new surfaces. Default: 0.1, or a 200th of the "
                   "object's extent if that is less.")
                 .greater_than(0.0))
      .takes(field("faces", &Decimate::faces, "Number of triangles at which decimation ends.")
                 .from(4)
                 .to(100000000))
      .takes(field("max_normal_deviation_deg", &Decimate::max_normal_deviation_deg,
                   "Largest rotation of a triangle by the collapse of one edge.")
                 .greater_than(0.0)
                 .to(90.0))
      .verb_takes(field("out", &Decimate::out,
                        "The file of the new surface: .stl, .ply, .obj, .off, .vtp or .glb; or an .octree of "
                        "the voxels inside it.")
                      .required())
      .verb_takes(field("voxel_mm", &Decimate::voxel_mm,
                        "Edge of an octree's voxels. Default: a 128th of the new surface's extent.")
                      .greater_than(0.0))
      .verb_takes(field("mend", &Decimate::mend,
                        "Mends a mesh that is not a solid first, as repair --solid does. Default: an open "
                        "mesh stays open."))
      .example(R"({"id": "light", "do": "decimate", "object": "skull", "max_error_mm": 0.2})")
      .on_files("octotomy decimate skull.stl -o light.stl --max-error 0.2 --json", on_files)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
