// SPDX-License-Identifier: AGPL-3.0-or-later
// An object moved as a solved deck moved: the face after the operation. Only the mesh kernel moves by a field
// of displacements; its answer is voxelised. Its certificate moves points back and reads the object there.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "convert/deck/calculix_result.h"
#include "convert/deck/displacement_field.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/warped_witness.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

struct Warp {
  ObjectName object;
  std::filesystem::path result, out;
  std::optional<double> fade_mm;
};

/// The displacements of a solved deck, with facts about them for the answer.
struct Displaced {
  convert::DisplacementField field;
  Json details;
};

/// The distance in mm over which the displacement fades. Throws std::runtime_error if the stated distance
/// folds space.
double fade_of(const Warp& warp, double largest_mm) {
  constexpr double usual_mm = 20.0;
  // This much above the least distance, no part shrinks to less than a sixth.
  constexpr double clearance = 1.2;
  const double least_mm = clearance * convert::least_fade_mm(largest_mm);
  if (!warp.fade_mm) return std::max(usual_mm, least_mm);
  if (*warp.fade_mm < least_mm)
    throw std::runtime_error("'fade_mm' is " + three_figures(*warp.fade_mm) + " mm, but a displacement of " +
                             three_figures(largest_mm) +
                             " mm that fades over this distance folds the tissue: state at least " +
                             grouped(std::ceil(10.0 * least_mm) / 10.0, 1) + " mm");
  return *warp.fade_mm;
}

/// Throws std::runtime_error that states the position if elements are inverted. Tissue cannot move like that,
/// and a scan warped by such a field would show some places twice.
void refuse_turned_over(const convert::DisplacementField& field, const std::filesystem::path& path) {
  const std::vector<convert::TurnedOver> found = field.turned_over();
  if (found.empty()) return;
  glm::dvec3 low_mm = found.front().centre_mm, high_mm = low_mm;
  const convert::TurnedOver* worst = &found.front();
  for (const convert::TurnedOver& element : found) {
    low_mm = glm::min(low_mm, element.centre_mm);
    high_mm = glm::max(high_mm, element.centre_mm);
    if (element.volume_ratio < worst->volume_ratio) worst = &element;
  }
  throw std::runtime_error(
      path.string() + ": the displacements invert " + std::to_string(found.size()) +
      (found.size() == 1 ? " element" : " elements") + ", the worst at " + voxel::rounded(worst->centre_mm) +
      " mm, all between " + voxel::rounded(low_mm) + " and " + voxel::rounded(high_mm) +
      " mm (LPS), because a motion there exceeds the thickness of the tissue between moved and fixed nodes. "
      "Remove the fixed nodes there from 'fixed', or write *STEP, NLGEOM in the deck, so that the solver "
      "applies the motion in increments (linear steps only scale it); then solve the deck again");
}

Displaced displaced(const Warp& warp, const std::filesystem::path& path, const voxel::Progress& progress,
                    Timings& timings) {
  convert::SolvedDeck deck;
  {
    const Stopwatch watch(timings, "read");
    deck = convert::read_solved_deck(path, progress);
  }
  double largest_mm = 0.0;
  for (const glm::dvec3& displacement : deck.displacement_mm)
    largest_mm = std::max(largest_mm, glm::length(displacement));
  const double fade_mm = fade_of(warp, largest_mm);
  Json details{{"nodes", deck.tetrahedra.nodes_mm.size()},
               {"tets", deck.tetrahedra.tets.size()},
               {"largest_displacement_mm", largest_mm},
               {"fade_mm", fade_mm},
               {"elements_turned_over", 0}};
  Displaced made{{std::move(deck.tetrahedra), std::move(deck.displacement_mm), fade_mm}, std::move(details)};
  refuse_turned_over(made.field, path);
  return made;
}

std::string definition(const Warp& warp, const Objects&) {
  return warp.object.name + " moved as " + warp.result.filename().string();
}

void triangles(const Warp& warp, const MeshBench& bench, MeshSide& made) {
  Displaced by = displaced(warp, bench.folder / warp.result, {bench.progress.stop, {}}, bench.timings);
  const Stopwatch watch(bench.timings, "warp");
  made.whole =
      brep::trusted_solid(convert::warped(bench.object(warp.object.name), by.field), brep::Proof::Connection);
  made.details = std::move(by.details);
  made.lineage =
      "vertices of a mesh, displaced with the elements around them; the displacement fades outside the "
      "elements' box";
}

void bound(const Warp& warp, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(warp.object.name);
  made.bound.spacing_mm = object.bound.spacing_mm;
  made.bound.shift_mm = object.bound.shift_mm;
  made.bound.measured_apart_mm = object.bound.measured_apart_mm;
  made.ends_with_universe = true;
  if (!made.mesh.whole || !object.mesh.whole) return;
  // The file is read only once, because it may have changed before the certificate is computed.
  const auto deck =
      std::make_shared<const convert::SolvedDeck>(convert::read_solved_deck(bench.folder / warp.result));
  const double fade_mm = made.mesh.details.at("fade_mm");
  made.witness = verify::witness_of_reshaped(
      [still = *object.mesh.whole, witness = object.witness, deck, fade_mm]() -> verify::Reshaped {
        const auto motion =
            std::make_shared<const verify::NodeMotion>(deck->tetrahedra, deck->displacement_mm, fade_mm);
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
  const Displaced by = displaced(warp, warp.result, bench.progress("reading"), bench.timings);
  std::vector<std::string> findings;
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
    findings = table.passed_over;
    if (!table.names.empty())
      for (std::string& finding : write_label_table(warp.out, table.names))
        findings.push_back(std::move(finding));
  }
  FileAnswer answer{{{"path", warp.out.string()}}};
  answer.json.update(by.details);
  answer.findings = std::move(findings);
  answer.rows = {
      {"written", warp.out.string()},
      {"largest displacement", grouped(by.details["largest_displacement_mm"].get<double>(), 2) + " mm"},
      {"fades to zero within", grouped(by.details["fade_mm"].get<double>(), 1) + " mm of the deck's box"}};
  return answer;
}

}  // namespace

Operation warp_operation() {
  return Describe<Warp>("warp", "Deforms an object as a solved deck deforms: the face after the operation.",
                        Makes::Object)
      .takes(field("object", &Warp::object, "An object; on the command line a mesh or a scan.")
                 .required()
                 .positional("file"))
      .takes(
          field("result", &Warp::result, "The .frd file that CalculiX wrote for a deck of linear tetrahedra.")
              .required()
              .a_file())
      .takes(field("fade_mm", &Warp::fade_mm,
                   "Outside the deck's bounding box along the patient's axes, the displacement fades to zero "
                   "over this distance. It must be at least 2.54 times the largest displacement, or space "
                   "would fold. Default: 20 mm, or that minimum if it is longer.")
                 .greater_than(0.0))
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
