// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/export_object.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <variant>

#include "brep/components.h"
#include "brep/decimate.h"
#include "brep/write_mesh.h"
#include "convert/deck.h"
#include "convert/fill_cavities.h"
#include "convert/midline.h"
#include "convert/octree_tetrahedra.h"
#include "convert/tetrahedralise.h"
#include "planner/cut_surfaces.h"
#include "planner/figures.h"
#include "planner/finer_places.h"
#include "planner/region_deck.h"
#include "voxel/components.h"
#include "voxel/write_scene.h"

namespace octotomy::planner {
namespace {

void export_mesh(const Object& object, const std::filesystem::path& path, Exported& exported,
                 Timings& timings) {
  const Stopwatch watch(timings, "write");
  brep::write_mesh(*object.mesh, path);
  exported.written = true;
  exported.content = grouped(static_cast<double>(object.mesh->n_faces()), 0) + " triangles";
  exported.details = {{"faces", object.mesh->n_faces()},
                      {"vertices", object.mesh->n_vertices()},
                      {"volume_mm3", object.mesh_measures->volume_mm3}};
}

/// Of the largest part's volume, what a part has to have to be a body.
constexpr double crumb() {
  return 0.01;
}

/// The parts of the mesh that a deck is made of: crumbs that a cut leaves are no bodies to load and hold;
/// what is left out is a finding, and so are several bodies.
brep::Mesh bodies_of(const brep::Mesh& mesh, Filling& filling) {
  const auto parts = brep::components(mesh);
  std::vector<std::uint32_t> faces;
  std::size_t bodies = 0;
  double left_out_mm3 = 0.0;
  for (const brep::Component& part : parts) {
    if (part.volume_mm3 >= crumb() * parts.front().volume_mm3) {
      faces.insert(faces.end(), part.faces.begin(), part.faces.end());
      ++bodies;
    } else {
      left_out_mm3 += part.volume_mm3;
    }
  }
  filling.bodies = bodies;
  if (bodies > 1)
    filling.findings.push_back("holds " + std::to_string(bodies) +
                               " bodies that do not touch: hold each of them, or the stiffness is singular");
  if (bodies < parts.size())
    filling.findings.push_back(
        std::to_string(parts.size() - bodies) + " crumbs, " + grouped(left_out_mm3, 1) +
        " mm\u00b3 together, each under a hundredth of the largest body, are left out");
  return bodies < parts.size() ? brep::part_of(mesh, faces) : mesh;
}

/// The mesh without cavities smaller than a voxel, which are noise at the threshold; what is filled is a
/// finding.
brep::Mesh filled(const brep::Mesh& mesh, const voxel::Universe& universe, Filling& filling) {
  const glm::dvec3 edge_mm = universe.lattice().spacing_mm();
  convert::Filled made = convert::fill_cavities(mesh, edge_mm.x * edge_mm.y * edge_mm.z);
  if (made.cavities > 0)
    filling.findings.push_back(std::to_string(made.cavities) + " cavities smaller than a voxel, " +
                               grouped(made.volume_mm3, 3) + " mm\u00b3 together, are filled");
  return std::move(made.mesh);
}

/// A third of the voxel's edge: no more than sampling leaves unknown of a surface anyhow.
double simplification_mm(const voxel::Universe& universe) {
  const glm::dvec3 edge_mm = universe.lattice().spacing_mm();
  return std::min({edge_mm.x, edge_mm.y, edge_mm.z}) / 3.0;
}

/// The surface with fewer and better triangles, as tetrahedra can be no better than the triangles they stand
/// on; as it was where that cannot be done.
brep::Mesh simplified(const brep::Mesh& mesh, double error_mm, Filling& filling) {
  brep::DecimateOptions options;
  options.max_error_mm = error_mm;
  options.max_aspect = 5.0;
  try {
    brep::Mesh simple = brep::decimate(mesh, options);
    filling.findings.push_back("the surface was simplified from " +
                               grouped(static_cast<double>(mesh.n_faces()), 0) + " to " +
                               grouped(static_cast<double>(simple.n_faces()), 0) + " triangles, within " +
                               grouped(error_mm, 2) + " mm of the exact piece");
    return simple;
  } catch (const std::runtime_error& error) {
    filling.findings.push_back(std::string("the surface was not simplified: ") + error.what());
  } catch (const std::invalid_argument& error) {
    filling.findings.push_back(std::string("the surface was not simplified: ") + error.what());
  }
  return mesh;
}

/// The voxels' own elements, crumbs left out as of meshes.
Filling fallback_of(const Object& object, const std::string& why, const std::stop_token& stop) {
  Filling filling;
  const auto parts = voxel::components(object.octree).voxel_counts;
  const auto least = static_cast<std::uint64_t>(std::ceil(crumb() * static_cast<double>(parts.front())));
  const voxel::Octree bodies = voxel::components_of_at_least(object.octree, least);
  filling.tetrahedra = convert::tetrahedra_of(bodies, convert::BoundaryCells::Nodes, {stop, {}});
  filling.bodies = static_cast<std::size_t>(
      std::count_if(parts.begin(), parts.end(), [&](std::uint64_t voxels) { return voxels >= least; }));
  filling.fallback = true;
  filling.findings.push_back(
      "fallback: " + why +
      "; the elements are the voxels', whose surface is in steps: do not read stresses "
      "there");
  if (bodies.voxel_count() < object.octree.voxel_count())
    filling.findings.push_back(grouped(static_cast<double>(parts.size() - filling.bodies), 0) +
                               " crumbs, each under a hundredth of the largest body, are left out");
  return filling;
}

Filling filling_of(const Object& object, const std::vector<convert::Finer>& finer,
                   const std::stop_token& stop) {
  Filling filling;
  const voxel::Universe& universe = object.octree.universe();
  const brep::Mesh bodies = filled(bodies_of(*object.mesh, filling), universe, filling);
  convert::TetOptions options;
  options.mesher = convert::Mesher::Best;
  options.stop = stop;
  options.finer = finer;
  // Some times what a bone of 50 000 triangles takes, as machines are shared.
  options.time_limit = std::chrono::minutes(2);
  filling.tetrahedra =
      convert::tetrahedralise(simplified(bodies, simplification_mm(universe), filling), options);
  for (const std::string& finding : filling.tetrahedra.findings) filling.findings.push_back(finding);
  return filling;
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
  exported.details["quality"] = {{"min_dihedral_deg", quality.min_dihedral_deg},
                                 {"max_dihedral_deg", quality.max_dihedral_deg},
                                 {"max_radius_edge", quality.max_radius_edge},
                                 {"min_volume_mm3", quality.min_volume_mm3}};
}

/// The object's filling, or why there is none.
std::variant<Filling, std::string> fill(const Evaluation& evaluation, const Object& object,
                                        const ExportStep& step, const std::stop_token& stop) {
  if (!object.mesh) return "it has no mesh";
  if (object.mesh->n_faces() == 0) return "its mesh is empty";
  try {
    return filling_of(object, finer_places(evaluation, step), stop);
  } catch (const std::runtime_error& error) {
    if (stop.stop_requested()) throw Stopped("stopped while " + object.id + " was filled");
    return error.what();
  } catch (const std::logic_error& error) {
    return error.what();
  }
}

void export_tetrahedra(const Evaluation& evaluation, const Object& object, const ExportStep& step,
                       const std::filesystem::path& path, Exported& exported, Fillings& fillings,
                       Timings& timings) {
  const std::string key = object.id + (step.fallback ? " or its voxels" : "") + finer_key(step);
  if (!fillings.made.contains(key)) {
    const Stopwatch watch(timings, "tetrahedralise");
    std::variant<Filling, std::string> filled = fill(evaluation, object, step, fillings.stop);
    if (auto* filling = std::get_if<Filling>(&filled))
      if (const std::optional<std::string> why = convert::fault_in_shape(filling->tetrahedra)) {
        if (step.fallback && !object.octree.is_empty())
          filled = *why;
        else
          filling->findings.push_back(*why + "; \"fallback\": true takes the voxels' elements");
      }
    if (const auto* why = std::get_if<std::string>(&filled)) {
      if (!step.fallback || object.octree.is_empty()) {
        exported.findings.push_back(
            "not written: " + *why +
            (step.fallback ? "; and it has no voxel" : "; \"fallback\": true takes its voxels' elements"));
        return;
      }
      filled = fallback_of(object, *why, fillings.stop);
    }
    fillings.made.emplace(key, std::get<Filling>(std::move(filled)));
  }
  const Stopwatch watch(timings, "write");
  const auto& [tetrahedra, bodies, fallback, findings] = fillings.made.at(key);
  exported.details["regions"] = bodies;
  exported.details["fallback"] = fallback;
  exported.details["method"] = tetrahedra.method;
  exported.findings = findings;
  const convert::TetQuality quality = convert::quality(tetrahedra);
  convert::DeckOptions options;
  options.title = object.id + " = " + object.definition;
  options.second_order = step.second_order;
  if (object.mesh && object.mesh->n_faces() > 0) options.surfaces = cut_surfaces(object, tetrahedra);
  add_midline(tetrahedra, step, options, exported);
  options.notes = exported.findings;
  convert::write_deck(tetrahedra, path, options);
  say_written(tetrahedra, quality, options, exported);
}

void export_regions(const Evaluation& evaluation, const Object& object, const ExportStep& step,
                    const std::filesystem::path& path, Exported& exported, const std::stop_token& stop,
                    Timings& timings) {
  RegionDeck deck;
  try {
    const Stopwatch watch(timings, "tetrahedralise");
    deck = region_deck(evaluation, object, step, {stop, {}});
  } catch (const std::runtime_error& error) {
    if (stop.stop_requested()) throw;
    exported.findings.push_back(std::string("not written: ") + error.what());
    return;
  }
  const Stopwatch watch(timings, "write");
  exported.findings = deck.findings;
  deck.options.title = object.id + " = " + object.definition;
  deck.options.second_order = step.second_order;
  add_midline(deck.tetrahedra, step, deck.options, exported);
  deck.options.notes = exported.findings;
  exported.details["regions"] = step.regions.size() + 1;
  exported.details["contacts"] = deck.options.contacts.size();
  exported.details["fallback"] = deck.fallback;
  exported.details["method"] = deck.tetrahedra.method;
  convert::write_deck(deck.tetrahedra, path, deck.options);
  say_written(deck.tetrahedra, convert::quality(deck.tetrahedra), deck.options, exported);
}

void export_label(const Object& object, const std::filesystem::path& path, Exported& exported,
                  Timings& timings) {
  const Stopwatch watch(timings, "write");
  voxel::Scene scene;
  scene.lattice = object.octree.universe().lattice();
  scene.meaning = voxel::Meaning::Label;
  scene.source = object.id;
  voxel::Int16Samples labels(scene.lattice.sample_count(), 0);
  std::size_t at = 0;
  const int side = object.octree.universe().side();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) labels[at++] = object.octree.contains({x, y, z}) ? 1 : 0;
  scene.samples = std::move(labels);
  voxel::write_scene(scene, path);
  exported.written = true;
  exported.content = grouped(static_cast<double>(object.octree.voxel_count()), 0) + " voxels labelled 1";
  exported.details = {{"voxels", object.octree.voxel_count()},
                      {"volume_mm3", object.voxel_measures.volume_mm3}};
}

}  // namespace

Exported export_object(const Evaluation& evaluation, const std::string& id, const ExportStep& step,
                       const std::filesystem::path& folder, Fillings& fillings, Timings& timings) {
  const Object& object = evaluation.object(step.object);
  Exported exported;
  exported.id = id;
  exported.object = object.id;
  exported.path = step.path.generic_string();
  exported.details = nlohmann::ordered_json::object();
  const std::filesystem::path path = folder / step.path;
  const bool wants_mesh =
      step.kind != ExportKind::Label && !step.attachment.any() && !step.fallback && step.regions.empty();
  if (wants_mesh && !object.mesh)
    exported.findings.push_back("not written: '" + object.id + "' has no mesh, see its findings");
  else if (const bool has_faces = object.mesh && object.mesh->n_faces() > 0;
           wants_mesh ? !has_faces : object.octree.is_empty() && !(step.fallback && has_faces))
    exported.findings.push_back("not written: '" + object.id + "' is empty");
  if (!exported.findings.empty()) return exported;

  std::filesystem::create_directories(path.parent_path());
  if (step.kind == ExportKind::Mesh) export_mesh(object, path, exported, timings);
  if (!step.regions.empty() || step.attachment.any())
    export_regions(evaluation, object, step, path, exported, fillings.stop, timings);
  else if (step.kind == ExportKind::Tetrahedra)
    export_tetrahedra(evaluation, object, step, path, exported, fillings, timings);
  if (step.kind == ExportKind::Label) export_label(object, path, exported, timings);
  if (exported.written) exported.details["bytes"] = std::filesystem::file_size(path);
  return exported;
}

}  // namespace octotomy::planner
