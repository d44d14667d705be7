// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes tetrahedra for finite elements: an object's filling, several objects as regions, or an object that
// others hold.
#include "convert/deck/deck.h"

#include <algorithm>

#include "convert/deck/deck_names.h"
#include "convert/tet/midline.h"
#include "planner/operation/deck/cut_surfaces.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/deck/filling.h"
#include "planner/operation/deck/refinement.h"
#include "planner/operation/deck/region_deck.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

bool contains(const std::vector<ObjectName>& names, const std::string& name) {
  return std::any_of(names.begin(), names.end(), [&](const ObjectName& each) { return each.name == name; });
}

std::vector<std::string> region_names(const Deck& deck) {
  std::vector<std::string> names;
  for (const ObjectName& region : deck.regions) names.push_back(region.name);
  names.push_back(deck.object.name);
  return names;
}

void check_held(const Deck& deck, const FieldLocation& place) {
  if (place.scope != nullptr)
    for (const ObjectName& moved : deck.moved)
      if (const Operation& maker = place.scope->maker_of(moved.name); !maker.is_motion)
        place.at("moved").refuse("'" + moved.name + "' was made by '" + maker.name +
                                 "', which moves nothing: name the result of a step that moves an object, or "
                                 "list it as fixed");
  if ((deck.element_mm || deck.material) && !deck.is_held())
    place.refuse(
        "'element_mm' and 'material' apply only to an object that others hold: add 'moved' or 'fixed'");
}

void check_regions(const Deck& deck, const FieldLocation& place) {
  const std::vector<std::string> names = region_names(deck);
  for (const auto& [one, other] : deck.sliding) {
    for (const std::string& name : {one, other})
      if (std::find(names.begin(), names.end(), name) == names.end())
        place.at("sliding").refuse("'" + name + "' is not a region of this deck" + suggestion(name, names));
    if (one == other)
      place.at("sliding").refuse("'" + one +
                                 "' cannot slide on itself: cut it into two objects and name both");
  }
  for (const auto& [name, unused] : deck.materials)
    if (std::find(names.begin(), names.end(), name) == names.end())
      place.at("materials").refuse("unknown key '" + name + "'" + suggestion(name, names));
  if (deck.regions.empty()) {
    const char* alone = deck.smooth_mm            ? "smooth_mm"
                        : deck.has_contact()      ? "between"
                        : !deck.sliding.empty()   ? "sliding"
                        : !deck.materials.empty() ? "materials"
                                                  : nullptr;
    if (alone != nullptr)
      place.at(alone).refuse("applies only to several regions: add 'regions', or leave it out");
    return;
  }
  if (deck.fallback && !deck.smooth_mm)
    place.at("fallback")
        .refuse(
            "applies only to smooth elements, and regions without 'smooth_mm' are filled with their voxels: "
            "leave it out, or add 'smooth_mm'");
  if (!deck.smooth_mm) return;
  if (deck.element_mm)
    place.at("element_mm")
        .refuse(
            "applies only to elements of voxels, 'smooth_mm' only to smooth elements: leave out one of them");
  for (const std::vector<ObjectName>* holders : {&deck.moved, &deck.fixed})
    for (const ObjectName& holder : *holders)
      if (holder.name != deck.object.name && !contains(deck.regions, holder.name))
        place.at("smooth_mm")
            .refuse("smooth elements do not follow the voxels of an object outside of the deck: add '" +
                    holder.name + "' to 'regions', or leave 'smooth_mm' out");
}

void check(const Deck& deck, const FieldLocation& place) {
  check_output_path(deck.path, {".inp", ".vtu", ".feb", ".msh", ".node"}, place.at("path"));
  check_held(deck, place);
  if (deck.fallback && deck.is_held() && !deck.smooth_mm)
    place.at("fallback")
        .refuse(
            "an object that others hold is always filled with its voxels, so no mesher can fail: leave it "
            "out");
  if (deck.order == 2 && deck.path.extension() == ".node")
    place.at("order").refuse("applies only to tetrahedra in .inp, .feb, .vtu or .msh: leave it out");
  check_regions(deck, place);
  if (deck.stiffness && (deck.is_held() || !deck.regions.empty()))
    place.at("stiffness")
        .refuse(
            "applies only to a single filled object: leave it out, or leave out 'regions' and the holders");
  if (!deck.finer.empty() && !deck.smooth_mm && (deck.is_held() || !deck.regions.empty()))
    place.at("finer").refuse("does not apply to elements of voxels: add 'smooth_mm', or leave 'finer' out");
}

/// The reason why the object cannot be filled; empty if it can.
std::string obstacle_of(const Object& object, const Deck& deck) {
  const bool wants_mesh = !deck.is_held() && !deck.fallback && deck.regions.empty();
  if (wants_mesh && !object.mesh.within) return "'" + object.id + "' has no mesh, see its findings";
  const bool has_faces = object.mesh.within && !object.mesh.within->empty();
  const bool is_empty =
      wants_mesh ? !has_faces : object.voxel.octree.is_empty() && !(deck.fallback && has_faces);
  return is_empty ? "'" + object.id + "' is empty" : "";
}

/// Adds the node set MIDLINE, the nodes along the plane `midline`, or a finding if there are none.
void add_midline(const convert::Tetrahedra& tetrahedra, const Deck& deck, convert::DeckOptions& options,
                 Exported& made) {
  if (!deck.midline) return;
  convert::NodeSet set{"MIDLINE",
                       convert::midline_nodes(tetrahedra, deck.midline->point_mm, deck.midline->normal)};
  if (set.nodes.empty())
    made.findings.push_back("the plane of 'midline' does not meet the deck: there is no set MIDLINE");
  else
    options.node_sets.push_back(std::move(set));
}

void tell_written(const convert::Tetrahedra& tetrahedra, const convert::TetQuality& quality,
                  const convert::DeckOptions& options, Exported& made) {
  made.written = true;
  made.content = grouped(static_cast<double>(tetrahedra.tets.size()), 0) + " tetrahedra, dihedral angles " +
                 grouped(quality.min_dihedral_deg, 1) + "\u00b0 to " + grouped(quality.max_dihedral_deg, 1) +
                 "\u00b0";
  Json node_sets, surfaces;
  for (const convert::NodeSet& set : options.node_sets) node_sets[set.name] = set.nodes.size();
  for (const convert::DeckSurface& surface : options.surfaces) surfaces[surface.name] = surface.faces.size();
  made.details.update({{"nodes", tetrahedra.nodes_mm.size()},
                       {"tets", tetrahedra.tets.size()},
                       {"volume_mm3", quality.volume_mm3}});
  if (!node_sets.empty()) made.details.update({{"node_sets", node_sets}});
  if (!surfaces.empty()) made.details.update({{"surfaces", surfaces}});
  made.details.update({{"quality", quality_json(quality)}});
}

void write_elements(const convert::Tetrahedra& tetrahedra, convert::DeckOptions options, const Deck& deck,
                    const AnswerBench& bench, Exported& made) {
  const Stopwatch watch(bench.timings, "write");
  const convert::TetQuality quality = convert::quality(tetrahedra);
  made.details["method"] = tetrahedra.method;
  options.title = deck.object.name + " = " + bench.objects.at(deck.object.name).definition;
  options.second_order = deck.order == 2;
  options.progress = bench.progress("writing " + made.path);
  add_midline(tetrahedra, deck, options, made);
  for (std::string& changed : convert::make_names_unique(tetrahedra, options))
    made.findings.push_back(std::move(changed));
  options.notes.insert(options.notes.begin(), bench.origins.begin(), bench.origins.end());
  for (std::string& note : quality_notes(quality)) options.notes.push_back(std::move(note));
  options.notes.insert(options.notes.end(), made.findings.begin(), made.findings.end());
  convert::write_deck(tetrahedra, output_file(bench.folder, made.path), options);
  tell_written(tetrahedra, quality, options, made);
}

/// A filling that all decks of one object use.
struct SharedFilling {
  Filling filling;
  std::vector<convert::DeckSurface> surfaces;
};

/// The filling, or the reason why there is none.
using Tried = std::variant<SharedFilling, std::string>;

Tried fill(const Object& object, const Deck& deck, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "tetrahedralise");
  FillingOptions options;
  options.fallback = deck.fallback;
  options.progress = bench.progress("filling " + object.id + ", of the time allowed");
  std::variant<Filling, std::string> filling;
  try {
    options.finer = refinements(bench.objects, deck);
    filling = filling_of(object, options);
  } catch (const std::exception& error) {
    if (!is_no_answer(error)) throw;
    return error.what();
  }
  if (const auto* why = std::get_if<std::string>(&filling)) return *why;
  SharedFilling filled{std::get<Filling>(std::move(filling)), {}};
  if (object.mesh.within && !object.mesh.within->empty())
    filled.surfaces = cut_surfaces(object, filled.filling.tetrahedra);
  return filled;
}

/// The filling of an object. It is computed for the first deck and read by the later ones.
const Tried& filled_once(const Object& object, const Deck& deck, const AnswerBench& bench) {
  const std::string key = object.id + (deck.fallback ? " or its voxels" : "") + refinement_key(deck);
  std::shared_ptr<const void>& kept = bench.kept[key];
  if (!kept) kept = std::make_shared<const Tried>(fill(object, deck, bench));
  return *static_cast<const Tried*>(kept.get());
}

/// The combined motion of all steps that moved an object, LPS to LPS.
glm::dmat4 moved_from_still(const Object& object, const Objects& objects) {
  return object.moved ? object.moved->motion * moved_from_still(objects.at(object.moved->object), objects)
                      : glm::dmat4(1.0);
}

std::vector<Field> stiffness_record() {
  std::vector<Field> fields{field("scan", &Stiffness::scan, "The scan, in HU.").required()};
  for (Field& field : stiffness_fields()) fields.push_back(std::move(field));
  return fields;
}

void write_filled(const Object& object, const Deck& deck, const AnswerBench& bench, Exported& made) {
  const Tried& tried = filled_once(object, deck, bench);
  if (const auto* why = std::get_if<std::string>(&tried))
    return made.findings.push_back("not written: " + *why);
  const auto& [filling, surfaces] = std::get<SharedFilling>(tried);
  made.details.update({{"regions", filling.bodies}, {"fallback", filling.fallback}});
  made.findings = filling.findings;
  convert::DeckOptions options;
  options.surfaces = surfaces;
  if (deck.stiffness) {
    const Stopwatch watch(bench.timings, "materials");
    const std::vector<std::string> findings = add_stiffness(
        *deck.stiffness, filling.tetrahedra, glm::inverse(moved_from_still(object, bench.objects)),
        bench.samples(deck.stiffness->scan.name), bench.progress("materials of " + object.id), options);
    made.findings.insert(made.findings.end(), findings.begin(), findings.end());
    made.details["materials"] = options.materials.size();
  }
  write_elements(filling.tetrahedra, std::move(options), deck, bench, made);
}

void write_regions(const Object& object, const Deck& deck, const AnswerBench& bench, Exported& made) {
  RegionDeck regions;
  const voxel::Progress progress = bench.progress("filling " + object.id);
  try {
    const Stopwatch watch(bench.timings, "tetrahedralise");
    regions = region_deck(bench.objects, object, deck, progress);
  } catch (const std::exception& error) {
    if (!is_no_answer(error)) throw;
    return made.findings.push_back(std::string("not written: ") + error.what());
  }
  made.findings = regions.findings;
  made.details.update({{"regions", deck.regions.size() + 1},
                       {"contacts", regions.options.contacts.size()},
                       {"fallback", regions.fallback}});
  write_elements(regions.tetrahedra, std::move(regions.options), deck, bench, made);
}

void write(const Deck& deck, const AnswerBench& bench, Exported& made) {
  const Object& object = bench.objects.at(deck.object.name);
  made.object = object.id;
  made.path = output_path(deck.path).generic_string();
  if (const std::string obstacle = obstacle_of(object, deck); !obstacle.empty())
    return made.findings.push_back("not written: " + obstacle);
  if (!deck.regions.empty() || deck.is_held())
    write_regions(object, deck, bench, made);
  else
    write_filled(object, deck, bench, made);
}

/// Fills a single object before the deck is written. Several regions and held objects are filled during
/// writing.
void prepare_file(const Deck& deck, const AnswerBench& bench) {
  const Object& object = bench.objects.at(deck.object.name);
  if (deck.regions.empty() && !deck.is_held() && obstacle_of(object, deck).empty())
    filled_once(object, deck, bench);
}

std::vector<Field> material_fields() {
  return {field("youngs_modulus_mpa", &Deck::Material::youngs_modulus_mpa, "Young's modulus.")
              .required()
              .greater_than(0.0)
              .for_example("0.015"),
          field("poisson_ratio", &Deck::Material::poisson_ratio, "Poisson's ratio.")
              .required()
              .from(0.0)
              .less_than(0.5)
              .for_example("0.45")};
}

}  // namespace

Operation deck_operation() {
  return Describe<Deck>("deck", "Fills an object with finite elements and writes them as a solver's deck.",
                        Makes::File)
      .takes(field("object", &Deck::object, "The object.").required())
      .takes(field("path", &Deck::path,
                   "Path of the deck within the result's folder: .inp, .feb, .vtu, .msh or .node.")
                 .required())
      .takes(field("moved", &Deck::moved, "Moved objects; elements that touch one of them move with it."))
      .takes(field("fixed", &Deck::fixed,
                   "Objects that stay; elements that touch one of them are held in place."))
      .takes(field("element_mm", &Deck::element_mm,
                   "Edge of the smallest elements of an object that others hold. Default: the plan's voxels.")
                 .greater_than(0.0)
                 .for_example("3.0"))
      .takes(record("material", &Deck::material,
                    "Material of an object that others hold. Default: soft tissue of 15 kPa.",
                    material_fields()))
      .takes(field("fallback", &Deck::fallback,
                   "If no mesher succeeds, the object's voxels become the elements; the deck states this."))
      .takes(records(
                 "finer", &Deck::finer, "Smaller elements at points or along objects.",
                 {field("at", &Deck::Finer::at, "A point [x, y, z], LPS mm, or an object's name.").required(),
                  field("size_mm", &Deck::Finer::size_mm, "The elements' size there.")
                      .required()
                      .greater_than(0.0)
                      .for_example("0.5")})
                 .for_example("[{\"at\": [0, -80, 20], \"size_mm\": 0.5}]"))
      .takes(field("regions", &Deck::regions, "Further objects, each one region of the same deck."))
      .takes(field("order", &Deck::order, "1: four-node tetrahedra; 2: ten-node ones.").from(1).to(2))
      .takes(record(
          "midline", &Deck::midline, "A plane; the nodes where it meets the surface become the set MIDLINE.",
          {field("point_mm", &Deck::Plane::point_mm, "A point of the plane, LPS.").required(),
           field("normal", &Deck::Plane::normal, "The plane's normal, LPS.").required().direction()}))
      .takes(
          field("smooth_mm", &Deck::smooth_mm,
                "Size of smooth elements that fill several regions. Default: the voxels become the elements.")
              .greater_than(0.0)
              .for_example("3.0"))
      .takes(field("between", &Deck::between,
                   "Nodes where regions touch: shared, or separate nodes with contact pairs.")
                 .one_of({"shared", "contact"}))
      .takes(field("sliding", &Deck::sliding, "Pairs of regions that slide on each other.")
                 .for_example("[[\"upper_lip\", \"lower_lip\"]]"))
      .takes(records_by_name("materials", &Deck::materials, "Materials of regions, by their names.",
                             material_fields()))
      .takes(record("stiffness", &Deck::stiffness, "Stiffness of each element from the samples of a scan.",
                    stiffness_record()))
      .example(R"({"id": "deck", "do": "deck", "object": "advanced", "path": "maxilla.inp"})")
      .check(check)
      .prepares_file(prepare_file)
      .write(write);
}

}  // namespace octotomy::planner
