// SPDX-License-Identifier: AGPL-3.0-or-later
// An object moved as a solved deck moved: the face after the operation. Only the mesh kernel moves by a field
// of displacements; its answer is voxelised. Its certificate moves points back and reads the object there.
#include <algorithm>

#include "convert/deck/calculix_result.h"
#include "convert/deck/displacement_field.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/trace.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/warped_witness.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

struct Warp {
  ObjectName object;
  std::filesystem::path result, out;
};

/// The displacements of a solved deck, with their results for the report.
struct Displaced {
  convert::DisplacementField field;
  Json details;
  std::vector<std::string> findings;
};

Displaced displaced(const std::filesystem::path& path, const voxel::Progress& progress, Timings& timings) {
  convert::SolvedDeck deck;
  {
    const Stopwatch watch(timings, "read");
    deck = convert::read_solved_deck(path, progress);
  }
  double largest_mm = 0.0;
  for (const glm::dvec3& displacement : deck.displacement_mm)
    largest_mm = std::max(largest_mm, glm::length(displacement));
  Json details{{"nodes", deck.tetrahedra.nodes_mm.size()},
               {"tets", deck.tetrahedra.tets.size()},
               {"largest_displacement_mm", largest_mm}};
  Displaced made{{std::move(deck.tetrahedra), std::move(deck.displacement_mm)}, std::move(details), {}};
  const std::size_t turned_over = made.field.turned_over();
  if (turned_over > 0)
    made.findings.push_back(
        std::to_string(turned_over) +
        " elements are turned over by the displacements: there the motion is too large for one linear step");
  made.details["elements_turned_over"] = turned_over;
  return made;
}

std::string definition(const Warp& warp, const Objects&) {
  return warp.object.name + " moved as " + warp.result.filename().string();
}

void triangles(const Warp& warp, const MeshBench& bench, MeshSide& made) {
  Displaced by = displaced(bench.folder / warp.result, {bench.progress.stop, {}}, bench.timings);
  const Stopwatch watch(bench.timings, "warp");
  made.whole =
      brep::trusted_solid(convert::warped(bench.object(warp.object.name), by.field), brep::Proof::Connection);
  made.details = std::move(by.details);
  made.findings = std::move(by.findings);
  made.lineage = "vertices of a mesh, displaced as the elements about them";
}

void bound(const Warp& warp, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(warp.object.name);
  made.bound.shift_mm = object.bound.shift_mm;
  made.ends_with_universe = true;
  if (!made.mesh.whole || !object.mesh.whole) return;
  // Read now, because the file may have changed when the certificate is asked for.
  const auto deck =
      std::make_shared<const convert::SolvedDeck>(convert::read_solved_deck(bench.folder / warp.result));
  made.witness = verify::witness_of_reshaped([still = *object.mesh.whole, witness = object.witness,
                                              deck]() -> verify::Reshaped {
    const auto motion = std::make_shared<const verify::NodeMotion>(deck->tetrahedra, deck->displacement_mm);
    return {verify::surface_warped(still.triangles(), *motion),
            verify::witness_of_warped(witness, still.triangles(), motion)};
  });
}

FileAnswer on_files(const Warp& warp, const FileBench& bench) {
  const std::filesystem::path file = warp.object.name;
  if (is_mesh(file))
    need_mesh_extension(warp.out);
  else
    need_extension(warp.out, {".nrrd", ".nhdr", ".nii", ".nii.gz", ".mha", ".mhd"}, "a scan is");
  need_folder_of(warp.out);
  Displaced by = displaced(warp.result, bench.progress("reading"), bench.timings);
  if (is_mesh(file)) {
    const brep::Mesh mesh = read_surface(file, bench.timings);
    brep::Mesh warped;
    {
      const Stopwatch watch(bench.timings, "warp");
      warped = convert::warped(mesh, by.field);
    }
    write_surface(warped, warp.out, bench.timings);
  } else {
    const voxel::Scene scan = bench.read_scan(file);
    const LabelTable table = names_of_labels(scan, file);
    if (!table.names.empty()) need_label_table(warp.out, table.names);
    voxel::Scene warped;
    {
      const Stopwatch watch(bench.timings, "warp");
      warped = convert::warped(scan, by.field, bench.progress("warp"));
    }
    const Stopwatch watch(bench.timings, "write");
    voxel::write_scene(warped, warp.out);
    by.findings.insert(by.findings.end(), table.passed_over.begin(), table.passed_over.end());
    if (!table.names.empty())
      for (std::string& finding : write_label_table(warp.out, table.names))
        by.findings.push_back(std::move(finding));
  }
  FileAnswer answer{{{"path", warp.out.string()}}};
  answer.json.update(by.details);
  answer.findings = std::move(by.findings);
  answer.rows = {
      {"written", warp.out.string()},
      {"largest displacement", grouped(by.details["largest_displacement_mm"].get<double>(), 2) + " mm"},
      {"elements turned over", std::to_string(by.details["elements_turned_over"].get<std::size_t>())}};
  return answer;
}

}  // namespace

Operation warp_operation() {
  return Describe<Warp>("warp", "Moves an object as a solved deck moved: the face after the operation.",
                        Makes::Object)
      .takes(field("object", &Warp::object, "An object; of the verb a mesh or a scan.")
                 .required()
                 .positional("file"))
      .takes(field("result", &Warp::result, "CalculiX's .frd file of a deck of linear tetrahedra.")
                 .required()
                 .a_file())
      .verb_takes(field("out", &Warp::out, "A mesh, or a .nrrd, .nii.gz or .mha file.").required())
      .reads_scans()
      .example(R"({"id": "face", "do": "warp", "object": "soft", "result": "face.frd"})")
      .on_files(
          "octotomy run face.plan.json -o out && (cd out && ccx -i face)\n"
          "  octotomy warp skin.stl --result out/face.frd -o predicted.stl\n"
          "  octotomy warp head.nrrd --result out/face.frd -o predicted.nrrd",
          on_files)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
