// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/region_deck.h"

#include <stdexcept>

#include "convert/octree_tetrahedra.h"
#include "convert/region_tetrahedra.h"
#include "convert/separate_regions.h"
#include "convert/tetrahedralise.h"
#include "planner/figures.h"

namespace octotomy::planner {
namespace {

struct Regions {
  std::vector<std::string> names;
  std::vector<voxel::Octree> octrees;
  double voxels_mm3 = 0.0;  ///< of all, what overlaps more than once
};

Regions regions_of(const Evaluation& evaluation, const Object& object, const ExportStep& step) {
  Regions regions;
  regions.names = {object.id};
  regions.names.insert(regions.names.end(), step.regions.begin(), step.regions.end());
  std::uint64_t counted = 0;
  for (const std::string& name : regions.names) {
    regions.octrees.push_back(evaluation.object(name).octree);
    if (regions.octrees.back().is_empty()) throw std::runtime_error("region '" + name + "' is empty");
    counted += regions.octrees.back().voxel_count();
  }
  regions.voxels_mm3 =
      static_cast<double>(counted) * regions.octrees.front().universe().lattice().voxel_mm3();
  return regions;
}

void fill_by_voxels(const Regions& regions, const voxel::Progress& progress, RegionDeck& deck) {
  deck.tetrahedra = convert::tetrahedra_of(regions.octrees, convert::BoundaryCells::Nodes, progress);
  deck.findings.emplace_back(
      "the elements are the voxels', whose surface is in steps: do not read stresses there");
  const double volume_mm3 = convert::quality(deck.tetrahedra).volume_mm3;
  const double shared_mm3 = regions.voxels_mm3 - volume_mm3;
  if (shared_mm3 > 1e-6 * volume_mm3)
    deck.findings.push_back("regions overlap by " + grouped(shared_mm3, 1) +
                            " mm\u00b3: what is in several is the first's");
}

void fill(const Regions& regions, const ExportStep& step, const voxel::Progress& progress, RegionDeck& deck) {
  if (!step.smooth_mm) {
    fill_by_voxels(regions, progress, deck);
    return;
  }
  std::string why;
  try {
    convert::RegionMeshOptions options;
    options.size_mm = *step.smooth_mm;
    options.stop = progress.stop;
    deck.tetrahedra = convert::smooth_tetrahedra_of(regions.octrees, options);
    why = convert::fault_in_shape(deck.tetrahedra).value_or("");
  } catch (const std::exception& error) {
    if (progress.stop.stop_requested()) throw Stopped("stopped while regions were filled");
    if (!step.fallback) throw std::runtime_error(error.what());
    why = error.what();
  }
  if (!why.empty() && step.fallback) {
    deck.fallback = true;
    deck.findings.push_back("fallback: " + why);
    fill_by_voxels(regions, progress, deck);
    return;
  }
  if (!why.empty()) deck.findings.push_back(why + "; \"fallback\": true takes the voxels' elements");
  for (const std::string& finding : deck.tetrahedra.findings) deck.findings.push_back(finding);
}

void add_materials(const Regions& regions, const ExportStep& step, RegionDeck& deck) {
  deck.options.materials.clear();
  std::string unknown;
  for (const std::string& name : regions.names) {
    convert::DeckMaterial material{"OF_" + name};
    if (const auto given = step.materials.find(name); given != step.materials.end()) {
      material.youngs_modulus_mpa = given->second.youngs_modulus_mpa;
      material.poisson_ratio = given->second.poisson_ratio;
    } else {
      unknown += (unknown.empty() ? "" : ", ") + name;
    }
    deck.options.materials.push_back(material);
  }
  deck.options.material_of_tet = deck.tetrahedra.region_of_tet;
  if (!unknown.empty())
    deck.findings.push_back(
        "no material is given of " + unknown +
        ": cortical bone's stiffness is taken; \"materials\" of the step gives each its own");
}

void add_surfaces(const Regions& regions, const ExportStep& step, RegionDeck& deck) {
  convert::DeckOptions& options = deck.options;
  std::vector<convert::DeckSurface> free;
  for (const std::string& name : regions.names) free.push_back({"FREE_" + name, {}});
  for (const convert::ElementFace& face : convert::surface_faces(deck.tetrahedra))
    free[deck.tetrahedra.region_of_tet[face.tet]].faces.push_back(face);
  for (convert::DeckSurface& surface : free)
    if (!surface.faces.empty()) options.surfaces.push_back(std::move(surface));
  for (convert::Interface& between : convert::interfaces(deck.tetrahedra)) {
    const std::string name = regions.names[between.from] + "_TO_" + regions.names[between.to];
    options.surfaces.push_back({name, std::move(between.faces)});
    if (!step.contact) continue;
    const std::string back = regions.names[between.to] + "_TO_" + regions.names[between.from];
    options.surfaces.push_back({back, std::move(between.opposite)});
    const bool first_is_softer =
        options.materials[between.from].youngs_modulus_mpa < options.materials[between.to].youngs_modulus_mpa;
    options.contacts.push_back({name, first_is_softer ? name : back, first_is_softer ? back : name});
  }
}

}  // namespace

RegionDeck region_deck(const Evaluation& evaluation, const Object& object, const ExportStep& step,
                       const voxel::Progress& progress) {
  const Regions regions = regions_of(evaluation, object, step);
  RegionDeck deck;
  fill(regions, step, progress, deck);
  add_materials(regions, step, deck);
  add_surfaces(regions, step, deck);
  if (step.contact) deck.tetrahedra = convert::separate_regions(deck.tetrahedra);
  return deck;
}

}  // namespace octotomy::planner
