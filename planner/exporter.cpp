// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/exporter.h"

#include <stdexcept>
#include <utility>

#include "brep/write_mesh.h"
#include "convert/deck.h"
#include "convert/midline.h"
#include "planner/cut_surfaces.h"
#include "planner/figures.h"
#include "planner/finer_places.h"
#include "planner/region_deck.h"
#include "planner/sha256.h"
#include "voxel/label_map.h"
#include "voxel/write_scene.h"

namespace octotomy::planner {
namespace {

/// Where a deck comes from, for its header.
std::vector<std::string> origins_of(const Plan& plan, const Evaluation& evaluation) {
  std::vector<std::string> lines{std::string("octotomy ") + OCTOTOMY_VERSION,
                                 "plan: " + plan.name + ", SHA-256 " + sha256_of(plan.text)};
  for (const ScanRecord& scan : evaluation.scans)
    lines.push_back("scan " + scan.name + ": SHA-256 " + scan.sha256);
  return lines;
}

/// The set of nodes along the step's mid-line.
void add_midline(const convert::Tetrahedra& tetrahedra, const ExportStep& step, convert::DeckOptions& options,
                 Exported& exported) {
  if (!step.midline) return;
  convert::NodeSet set{"MIDLINE",
                       convert::midline_nodes(tetrahedra, step.midline->point_mm, step.midline->normal)};
  if (set.nodes.empty())
    exported.findings.push_back("the plane of 'midline' passes the deck nowhere: there is no set MIDLINE");
  else
    options.node_sets.push_back(std::move(set));
}

void say_written(const convert::Tetrahedra& tetrahedra, const convert::TetQuality& quality,
                 const convert::DeckOptions& options, Exported& exported) {
  exported.written = true;
  exported.content = grouped(static_cast<double>(tetrahedra.tets.size()), 0) +
                     " tetrahedra, dihedral angles " + grouped(quality.min_dihedral_deg, 1) + "\u00b0 to " +
                     grouped(quality.max_dihedral_deg, 1) + "\u00b0";
  exported.details["nodes"] = tetrahedra.nodes_mm.size();
  exported.details["tets"] = tetrahedra.tets.size();
  exported.details["volume_mm3"] = quality.volume_mm3;
  for (const convert::NodeSet& set : options.node_sets)
    exported.details["node_sets"][set.name] = set.nodes.size();
  for (const convert::DeckSurface& surface : options.surfaces)
    exported.details["surfaces"][surface.name] = surface.faces.size();
  exported.details["quality"] = quality_json(quality);
}

/// Why there is nothing to write, or an empty text.
std::string want_of(const Object& object, const ExportStep& step) {
  const bool wants_mesh =
      step.kind != ExportKind::Label && !step.attachment.any() && !step.fallback && step.regions.empty();
  if (wants_mesh && !object.mesh) return "'" + object.id + "' has no mesh, see its findings";
  const bool has_faces = object.mesh && object.mesh->n_faces() > 0;
  const bool is_empty = wants_mesh ? !has_faces : object.octree.is_empty() && !(step.fallback && has_faces);
  return is_empty ? "'" + object.id + "' is empty" : "";
}

}  // namespace

Exporter::Exporter(const Plan& plan, const Evaluation& evaluation, std::filesystem::path folder,
                   ExportOptions options)
    : plan_(plan), evaluation_(evaluation), folder_(std::move(folder)), options_(std::move(options)) {}

Exported Exporter::write(const Step& step) {
  const auto& wanted = std::get<ExportStep>(step.action);
  Export to{evaluation_.object(wanted.object), wanted, folder_ / wanted.path, {}};
  to.exported.id = step.id;
  to.exported.object = wanted.object;
  to.exported.path = wanted.path.generic_string();
  to.exported.details = nlohmann::ordered_json::object();
  if (const std::string want = want_of(to.object, wanted); !want.empty()) {
    to.exported.findings.push_back("not written: " + want);
    return std::move(to.exported);
  }
  std::filesystem::create_directories(to.path.parent_path());
  if (wanted.kind == ExportKind::Mesh)
    write_mesh(to);
  else if (wanted.kind == ExportKind::Label)
    write_label(to);
  else if (!wanted.regions.empty() || wanted.attachment.any())
    write_regions(to);
  else
    write_filled(to);
  if (to.exported.written) to.exported.details["bytes"] = std::filesystem::file_size(to.path);
  return std::move(to.exported);
}

voxel::Progress Exporter::progress(const std::string& doing) const {
  voxel::Progress progress{options_.stop, {}};
  if (options_.progress)
    progress.report = [this, doing](double fraction) { options_.progress(doing, fraction); };
  return progress;
}

void Exporter::write_mesh(Export& to) {
  const Stopwatch watch(timings_, "write");
  brep::write_mesh(*to.object.mesh, to.path);
  to.exported.written = true;
  to.exported.content = grouped(static_cast<double>(to.object.mesh->n_faces()), 0) + " triangles";
  to.exported.details = {{"faces", to.object.mesh->n_faces()},
                         {"vertices", to.object.mesh->n_vertices()},
                         {"volume_mm3", to.object.mesh_measures->volume_mm3}};
}

void Exporter::write_label(Export& to) {
  const Stopwatch watch(timings_, "write");
  const voxel::Octree& octree = to.object.octree;
  voxel::LabelMap map =
      voxel::label_map(octree.universe().lattice(), {&octree, 1}, progress("labelling " + to.object.id));
  map.scene.source = to.object.id;
  voxel::write_scene(map.scene, to.path);
  to.exported.written = true;
  to.exported.content = grouped(static_cast<double>(octree.voxel_count()), 0) + " voxels labelled 1";
  to.exported.details = {{"voxels", octree.voxel_count()},
                         {"volume_mm3", to.object.voxel_measures.volume_mm3}};
}

void Exporter::write_filled(Export& to) {
  const std::string key = to.object.id + (to.step.fallback ? " or its voxels" : "") + finer_key(to.step);
  if (!filled_.contains(key)) {
    const Stopwatch watch(timings_, "tetrahedralise");
    FillingOptions options;
    options.fallback = to.step.fallback;
    options.progress = progress("filling " + to.object.id + ", of the time allowed");
    std::variant<Filling, std::string> filling;
    try {
      options.finer = finer_places(evaluation_, to.step);
      filling = filling_of(to.object, options);
    } catch (const Stopped&) {
      throw;
    } catch (const std::runtime_error& error) {
      filling = error.what();
    }
    if (const auto* why = std::get_if<std::string>(&filling)) {
      to.exported.findings.push_back("not written: " + *why);
      return;
    }
    Filled filled{std::get<Filling>(std::move(filling)), {}};
    if (to.object.mesh && to.object.mesh->n_faces() > 0)
      filled.surfaces = cut_surfaces(to.object, filled.filling.tetrahedra);
    filled_.emplace(key, std::move(filled));
  }
  const auto& [filling, surfaces] = filled_.at(key);
  to.exported.details["regions"] = filling.bodies;
  to.exported.details["fallback"] = filling.fallback;
  to.exported.findings = filling.findings;
  convert::DeckOptions options;
  options.surfaces = surfaces;
  write_deck(to, filling.tetrahedra, std::move(options));
}

void Exporter::write_regions(Export& to) {
  RegionDeck deck;
  try {
    const Stopwatch watch(timings_, "tetrahedralise");
    deck = region_deck(evaluation_, to.object, to.step, progress("filling " + to.object.id));
  } catch (const std::runtime_error& error) {
    if (options_.stop.stop_requested()) throw;
    to.exported.findings.push_back(std::string("not written: ") + error.what());
    return;
  }
  to.exported.findings = deck.findings;
  to.exported.details["regions"] = to.step.regions.size() + 1;
  to.exported.details["contacts"] = deck.options.contacts.size();
  to.exported.details["fallback"] = deck.fallback;
  write_deck(to, deck.tetrahedra, std::move(deck.options));
}

void Exporter::write_deck(Export& to, const convert::Tetrahedra& tetrahedra, convert::DeckOptions options) {
  const Stopwatch watch(timings_, "write");
  const convert::TetQuality quality = convert::quality(tetrahedra);
  to.exported.details["method"] = tetrahedra.method;
  options.title = to.object.id + " = " + to.object.definition;
  options.second_order = to.step.second_order;
  options.progress = progress("writing " + to.exported.path);
  add_midline(tetrahedra, to.step, options, to.exported);
  options.notes = origins_of(plan_, evaluation_);
  for (std::string& note : quality_notes(quality)) options.notes.push_back(std::move(note));
  options.notes.insert(options.notes.end(), to.exported.findings.begin(), to.exported.findings.end());
  convert::write_deck(tetrahedra, to.path, options);
  say_written(tetrahedra, quality, options, to.exported);
}

}  // namespace octotomy::planner
