// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/region_deck.h"

#include <algorithm>
#include <stdexcept>

#include "convert/tet/hinges.h"
#include "convert/tet/octree_tetrahedra.h"
#include "convert/tet/region_tetrahedra.h"
#include "convert/tet/separate_regions.h"
#include "convert/tet/tetrahedralise.h"
#include "planner/operation/deck/attach.h"
#include "planner/operation/deck/refinement.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

struct Regions {
  std::vector<std::string> names;
  std::vector<voxel::Octree> octrees;
  double voxels_mm3 = 0.0;  ///< sum of the regions' volumes; a voxel in several regions counts for each
};

Regions regions_of(const Objects& objects, const Object& object, const Deck& step,
                   const std::vector<Holder>& holders) {
  Regions regions;
  regions.names = {object.id};
  for (const ObjectName& other : step.regions) regions.names.push_back(other.name);
  for (const std::string& name : regions.names) {
    const auto holder =
        std::find_if(holders.begin(), holders.end(), [&](const Holder& h) { return h.id == name; });
    regions.octrees.push_back(holder != holders.end() ? holder->octree : objects.at(name).voxel.octree);
  }
  return regions;
}

/// Resamples the regions and holders in a universe of larger voxels with the edge `voxel_mm`.
void coarsen(double voxel_mm, Regions& regions, std::vector<Holder>& holders) {
  const voxel::Lattice fine = regions.octrees.front().universe().lattice();
  const voxel::Universe coarse = voxel::universe_around(voxel::bounds(fine), voxel_mm);
  const auto to_coarse = [&](voxel::Octree& octree) {
    octree = voxel::combine(coarse, voxel::Expression(octree));
  };
  for (voxel::Octree& octree : regions.octrees) to_coarse(octree);
  for (Holder& holder : holders) to_coarse(holder.octree);
}

void check_and_count(Regions& regions) {
  std::uint64_t counted = 0;
  for (std::size_t i = 0; i < regions.names.size(); ++i) {
    if (regions.octrees[i].is_empty())
      throw std::runtime_error("no voxel remains of '" + regions.names[i] +
                               "' at the size 'element_mm': state a smaller one");
    counted += regions.octrees[i].voxel_count();
  }
  regions.voxels_mm3 =
      static_cast<double>(counted) * regions.octrees.front().universe().lattice().voxel_mm3();
}

void fill_by_voxels(const Regions& regions, const Deck& step, const voxel::Progress& progress,
                    RegionDeck& deck) {
  // Holders' boundaries end at voxels' corners, so the elements of held objects must end there, too.
  const auto cells = step.is_held() ? convert::BoundaryCells::Voxels : convert::BoundaryCells::Nodes;
  if (regions.octrees.size() == 1) {
    deck.tetrahedra = convert::tetrahedra_of(regions.octrees.front(), cells, progress);
    return;
  }
  deck.tetrahedra = convert::tetrahedra_of(regions.octrees, cells, progress);
  deck.findings.emplace_back(
      "the elements are voxels, whose surface has steps: do not read stresses at the surface");
  const double volume_mm3 = convert::quality(deck.tetrahedra).volume_mm3;
  const double shared_mm3 = regions.voxels_mm3 - volume_mm3;
  if (shared_mm3 > 1e-6 * volume_mm3)
    deck.findings.push_back("regions overlap by " + grouped(shared_mm3, 1) +
                            " mm\u00b3: a voxel in several regions belongs to the first of them");
}

void fill(const Objects& objects, const Regions& regions, const Deck& step, const voxel::Progress& progress,
          RegionDeck& deck) {
  if (!step.smooth_mm) {
    fill_by_voxels(regions, step, progress, deck);
    return;
  }
  std::string why;
  try {
    convert::RegionMeshOptions options;
    options.size_mm = *step.smooth_mm;
    options.progress = progress;
    options.finer = refinements(objects, step);
    deck.tetrahedra = convert::smooth_tetrahedra_of(regions.octrees, options);
    why = convert::fault_in_shape(deck.tetrahedra).value_or("");
  } catch (const std::exception& error) {
    if (!step.fallback || !is_no_answer(error)) throw;
    why = error.what();
  }
  if (!why.empty() && step.fallback) {
    deck.fallback = true;
    deck.findings.push_back("fallback: " + why);
    fill_by_voxels(regions, step, progress, deck);
    return;
  }
  if (!why.empty())
    deck.findings.push_back(why + "; \"fallback\": true fills the regions with their voxels instead");
  for (const std::string& finding : deck.tetrahedra.findings) deck.findings.push_back(finding);
}

bool is_holder(const Deck& step, const std::string& name) {
  const auto has = [&](const std::vector<ObjectName>& holders) {
    return std::any_of(holders.begin(), holders.end(), [&](const ObjectName& h) { return h.name == name; });
  };
  return has(step.moved) || has(step.fixed);
}

/// The step's material, by default soft tissue: 15 kPa is the value of Chabanas, Luboz and Payan for the face
/// (2003). Poisson's ratio is 0.45 instead of their 0.49, because linear tetrahedra would be too stiff there.
convert::DeckMaterial tissue_of(const Deck& step, const std::string& name) {
  const Deck::Material tissue = step.material.value_or(Deck::Material{0.015, 0.45});
  return {name, tissue.youngs_modulus_mpa, tissue.poisson_ratio};
}

void add_materials(const Regions& regions, const Deck& step, RegionDeck& deck) {
  deck.options.materials.clear();
  if (regions.names.size() == 1) {
    deck.options.materials = {tissue_of(step, "SOFT_TISSUE")};
    return;
  }
  std::string unknown;
  for (const std::string& name : regions.names) {
    convert::DeckMaterial material{"OF_" + name};
    const auto given = std::find_if(step.materials.begin(), step.materials.end(),
                                    [&](const auto& entry) { return entry.first == name; });
    if (given != step.materials.end()) {
      material.youngs_modulus_mpa = given->second.youngs_modulus_mpa;
      material.poisson_ratio = given->second.poisson_ratio;
    } else if (!step.is_held()) {
      unknown += (unknown.empty() ? "" : ", ") + name;
    } else if (!is_holder(step, name)) {
      material = tissue_of(step, material.name);
    }
    deck.options.materials.push_back(material);
  }
  deck.options.material_of_tet = deck.tetrahedra.region_of_tet;
  if (!unknown.empty())
    deck.findings.push_back("no material is stated for " + unknown +
                            ": cortical bone is assumed; state others by 'materials' in the step");
}

/// The pairs of regions that slide, by number, the lower number first: the pairs that the step lists, in its
/// order, then all pairs if the step has contact everywhere.
std::vector<convert::RegionPair> sliding_pairs(const Regions& regions, const Deck& step) {
  const auto number_of = [&](const std::string& name) {
    const auto found = std::find(regions.names.begin(), regions.names.end(), name);
    return static_cast<std::uint32_t>(found - regions.names.begin());
  };
  std::vector<convert::RegionPair> pairs;
  for (const auto& [one, other] : step.sliding)
    pairs.push_back(std::minmax(number_of(one), number_of(other)));
  if (step.has_contact())
    for (std::uint32_t one = 0; one < regions.names.size(); ++one)
      for (std::uint32_t other = one + 1; other < regions.names.size(); ++other)
        pairs.emplace_back(one, other);
  return pairs;
}

/// Removes faces of an interface whose two sides still share a node.
void keep_parted(const convert::Tetrahedra& apart, convert::Interface& between) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < between.faces.size(); ++i) {
    const auto here = convert::corners_of(apart, between.faces[i]);
    const auto there = convert::corners_of(apart, between.opposite[i]);
    if (std::find_first_of(here.begin(), here.end(), there.begin(), there.end()) != here.end()) continue;
    between.faces[kept] = between.faces[i];
    between.opposite[kept++] = between.opposite[i];
  }
  between.faces.resize(kept);
  between.opposite.resize(kept);
}

void add_free_surfaces(const Regions& regions, RegionDeck& deck) {
  std::vector<convert::DeckSurface> free;
  for (const std::string& name : regions.names)
    free.push_back({regions.names.size() == 1 ? "FREE" : "FREE_" + name, {}});
  for (const convert::ElementFace& face : convert::surface_faces(deck.tetrahedra))
    free[convert::region_of(deck.tetrahedra, face.tet)].faces.push_back(face);
  for (convert::DeckSurface& surface : free)
    if (!surface.faces.empty()) deck.options.surfaces.push_back(std::move(surface));
}

/// Gives sliding regions separate nodes where they touch, and adds the surfaces where regions touch.
void add_interfaces(const Regions& regions, const Deck& step, RegionDeck& deck) {
  convert::DeckOptions& options = deck.options;
  std::vector<convert::Interface> touching = convert::interfaces(deck.tetrahedra);
  const std::vector<convert::RegionPair> pairs = sliding_pairs(regions, step);
  if (!pairs.empty()) deck.tetrahedra = convert::separate_regions(deck.tetrahedra, pairs);
  std::vector<convert::RegionPair> parted;
  for (convert::Interface& between : touching) {
    const convert::RegionPair pair(between.from, between.to);
    const bool slides = std::find(pairs.begin(), pairs.end(), pair) != pairs.end();
    if (slides) keep_parted(deck.tetrahedra, between);
    if (between.faces.empty()) continue;
    const std::string name = regions.names[between.from] + "_TO_" + regions.names[between.to];
    options.surfaces.push_back({name, std::move(between.faces)});
    if (!slides) continue;
    parted.push_back(pair);
    const std::string back = regions.names[between.to] + "_TO_" + regions.names[between.from];
    options.surfaces.push_back({back, std::move(between.opposite)});
    const bool first_is_softer =
        options.materials[between.from].youngs_modulus_mpa < options.materials[between.to].youngs_modulus_mpa;
    options.contacts.push_back({name, first_is_softer ? name : back, first_is_softer ? back : name});
  }
  for (std::size_t i = 0; i < step.sliding.size(); ++i)
    if (std::find(parted.begin(), parted.end(), pairs[i]) == parted.end())
      throw std::runtime_error("'" + step.sliding[i].first + "' and '" + step.sliding[i].second +
                               "' have no faces in common that could slide: leave the pair out of 'sliding'");
}

}  // namespace

RegionDeck region_deck(const Objects& objects, const Object& object, const Deck& step,
                       const voxel::Progress& progress) {
  std::vector<Holder> holders = holders_of(objects, step);
  Regions regions = regions_of(objects, object, step, holders);
  if (step.element_mm) coarsen(*step.element_mm, regions, holders);
  check_and_count(regions);
  RegionDeck deck;
  fill(objects, regions, step, progress, deck);
  if (std::optional<std::string> hinge = convert::hinge_in(deck.tetrahedra))
    deck.findings.push_back(*std::move(hinge));
  add_materials(regions, step, deck);
  add_free_surfaces(regions, deck);
  add_interfaces(regions, step, deck);
  if (step.is_held())
    for (std::string& finding : attach(holders, regions.names, deck.tetrahedra, deck.options))
      deck.findings.push_back(std::move(finding));
  return deck;
}

}  // namespace octotomy::planner
