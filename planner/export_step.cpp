// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/export_step.h"

#include <algorithm>
#include <array>
#include <utility>

#include "planner/nearest_name.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

const std::array<std::pair<std::string, ExportKind>, 12> extensions{{{".stl", ExportKind::Mesh},
                                                                     {".ply", ExportKind::Mesh},
                                                                     {".obj", ExportKind::Mesh},
                                                                     {".off", ExportKind::Mesh},
                                                                     {".inp", ExportKind::Tetrahedra},
                                                                     {".vtu", ExportKind::Tetrahedra},
                                                                     {".feb", ExportKind::Tetrahedra},
                                                                     {".msh", ExportKind::Tetrahedra},
                                                                     {".node", ExportKind::Tetrahedra},
                                                                     {".nrrd", ExportKind::Label},
                                                                     {".nii.gz", ExportKind::Label},
                                                                     {".mha", ExportKind::Label}}};

RegionMaterial material_of(const Keys& material) {
  const RegionMaterial read{material.number("youngs_modulus_mpa"), material.number("poisson_ratio")};
  if (read.youngs_modulus_mpa <= 0.0)
    refuse(material.at("youngs_modulus_mpa"), "must be above zero, for example 0.015");
  if (read.poisson_ratio < 0.0 || read.poisson_ratio >= 0.5)
    refuse(material.at("poisson_ratio"), "must be from 0 to less than 0.5, for example 0.45");
  return read;
}

/// Pairs of a deck's regions that slide on each other.
std::vector<std::pair<std::string, std::string>> sliding_of(const Keys& keys,
                                                            const std::vector<std::string>& regions) {
  std::vector<std::pair<std::string, std::string>> pairs;
  const Json* list = keys.find("sliding");
  if (list == nullptr) return pairs;
  const std::string where = keys.at("sliding");
  const char* const example = "must be a list of pairs of regions, as [[\"upper_lip\", \"lower_lip\"]]";
  if (!list->is_array()) refuse(where, example);
  for (const Json& pair : *list) {
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string())
      refuse(where, example);
    pairs.emplace_back(pair[0].get<std::string>(), pair[1].get<std::string>());
    for (const std::string& name : {pairs.back().first, pairs.back().second})
      if (std::find(regions.begin(), regions.end(), name) == regions.end())
        refuse(where, "'" + name + "' is no region of this deck" + suggestion(name, regions));
    if (pairs.back().first == pairs.back().second)
      refuse(where, "'" + pairs.back().first + "' cannot slide on itself: cut it in two");
  }
  return pairs;
}

/// Elements of regions, and what holds them.
void check_filling(const Keys& keys, const ExportStep& step) {
  if (step.smooth_mm && *step.smooth_mm <= 0.0)
    refuse(keys.at("smooth_mm"), "must be above zero, for example 3.0");
  if (step.fallback && !step.smooth_mm)
    refuse(keys.at("fallback"), "regions are made of voxels unless 'smooth_mm' is there: leave it out");
  if (!step.smooth_mm) return;
  if (step.attachment.element_mm)
    refuse(keys.at("element_mm"), "is of voxels, and 'smooth_mm' of smooth elements: leave one out");
  for (const std::vector<std::string>* holders : {&step.attachment.moved, &step.attachment.fixed})
    for (const std::string& holder : *holders)
      if (holder != step.object &&
          std::find(step.regions.begin(), step.regions.end(), holder) == step.regions.end())
        refuse(keys.at("smooth_mm"), "smooth elements do not lie on voxels: add '" + holder +
                                         "', which holds them, to 'regions', or leave 'smooth_mm' out");
}

/// What only decks of several regions have.
void read_regions(const Keys& keys, const Bound& bound, ExportStep& step) {
  step.regions = keys.names("regions");
  for (const std::string& other : step.regions) bound.need_object(keys.at("regions"), other);
  if (step.regions.empty()) {
    for (const char* key : {"smooth_mm", "between", "sliding", "materials"})
      if (keys.find(key) != nullptr)
        refuse(keys.at(key), "is of several regions: add 'regions', or leave it out");
    return;
  }
  if (step.kind != ExportKind::Tetrahedra)
    refuse(keys.at("regions"), "only tetrahedra have regions: choose .inp, .feb, .vtu or .msh");
  step.smooth_mm = keys.number_if("smooth_mm");
  check_filling(keys, step);
  if (keys.find("between") != nullptr) {
    const std::string between = keys.text("between");
    if (between != "shared" && between != "contact")
      refuse(keys.at("between"), "must be \"shared\", nodes where regions touch, or \"contact\"");
    step.contact = between == "contact";
  }
  std::vector<std::string> names = step.regions;
  names.push_back(step.object);
  step.sliding = sliding_of(keys, names);
  if (const Json* materials = keys.find("materials")) {
    const Keys by_name(*materials, keys.at("materials"), names);
    for (const std::string& name : names)
      if (const Json* value = by_name.find(name))
        step.materials[name] =
            material_of(Keys(*value, by_name.at(name), {"youngs_modulus_mpa", "poisson_ratio"}));
  }
}

Attachment attachment_of(const Keys& keys, const Bound& bound) {
  Attachment attachment{keys.names("moved"), keys.names("fixed"), keys.number_if("element_mm")};
  for (const std::string& name : attachment.moved) bound.need_moved(keys.at("moved"), name);
  for (const std::string& name : attachment.fixed) bound.need_object(keys.at("fixed"), name);
  if (attachment.element_mm && *attachment.element_mm <= 0.0)
    refuse(keys.at("element_mm"), "must be above zero, for example 3.0");
  if (const Json* value = keys.find("material")) {
    const RegionMaterial material =
        material_of(Keys(*value, keys.at("material"), {"youngs_modulus_mpa", "poisson_ratio"}));
    attachment.youngs_modulus_mpa = material.youngs_modulus_mpa;
    attachment.poisson_ratio = material.poisson_ratio;
  }
  const bool any_text = keys.find("element_mm") != nullptr || keys.find("material") != nullptr;
  if (any_text && !attachment.any())
    refuse(keys.where(),
           "'element_mm' and 'material' are of an object that others hold: add 'moved' or 'fixed'");
  return attachment;
}

std::vector<FinerText> finer_of(const Keys& keys, const Bound& bound) {
  std::vector<FinerText> places;
  const Json* list = keys.find("finer");
  if (list == nullptr) return places;
  if (!list->is_array())
    refuse(keys.at("finer"), "must be a list, as [{\"at\": [0, -80, 20], \"size_mm\": 0.5}]");
  for (const Json& value : *list) {
    const Keys place(value, keys.at("finer[" + std::to_string(places.size()) + "]"), {"at", "size_mm"});
    FinerText text;
    text.size_mm = place.number("size_mm");
    if (text.size_mm <= 0.0) refuse(place.at("size_mm"), "must be above zero, for example 0.5");
    if (place.need("at").is_string()) {
      text.object = place.text("at");
      bound.need_object(place.at("at"), text.object);
    } else {
      text.point_mm = place.point("at");
    }
    places.push_back(std::move(text));
  }
  return places;
}

}  // namespace

ExportStep read_export_step(const Keys& keys, const Bound& bound, std::set<std::string>& taken) {
  ExportStep step{keys.text("object"), keys.text("path")};
  bound.need_object(keys.at("object"), step.object);
  const std::string name = step.path.lexically_normal().generic_string();
  const auto extension = std::find_if(extensions.begin(), extensions.end(),
                                      [&](const auto& known) { return name.ends_with(known.first); });
  const std::vector<std::string> known = names_of(extensions);
  if (extension == extensions.end())
    refuse(keys.at("path"),
           "nothing can be written as '" + name + "'" + suggestion(step.path.extension().string(), known));
  step.kind = extension->second;
  if (step.path.is_absolute() || name.starts_with("..") || name.starts_with("views/"))
    refuse(keys.at("path"), "'" + name + "' must be a path within the result folder, outside of views/");
  if (!taken.insert(name).second)
    refuse(keys.at("path"), "'" + name + "' is written by an earlier step: choose another");
  step.path = name;
  step.attachment = attachment_of(keys, bound);
  if (step.attachment.any() && step.kind != ExportKind::Tetrahedra)
    refuse(keys.at("path"), "only tetrahedra are moved and held by other objects: choose .inp, .feb or .vtu");
  if (keys.find("fallback") != nullptr) {
    step.fallback = keys.flag("fallback");
    if (step.kind != ExportKind::Tetrahedra)
      refuse(keys.at("fallback"),
             "only tetrahedra have a fallback: leave it out, or choose .inp, .feb or .vtu");
    if (step.attachment.any() && keys.find("smooth_mm") == nullptr)
      refuse(keys.at("fallback"), "what others hold is made of its voxels anyhow: leave it out");
  }
  if (const std::optional<double> order = keys.number_if("order")) {
    if (*order != 1.0 && *order != 2.0)
      refuse(keys.at("order"), "must be 1, four-node tetrahedra, or 2, ten-node ones");
    if (step.kind != ExportKind::Tetrahedra || name.ends_with(".node"))
      refuse(keys.at("order"), "is of tetrahedra in .inp, .feb, .vtu or .msh: leave it out");
    step.second_order = *order == 2.0;
  }
  if (const Json* value = keys.find("midline")) {
    const Keys plane(*value, keys.at("midline"), {"point_mm", "normal"});
    if (step.kind != ExportKind::Tetrahedra)
      refuse(keys.at("midline"), "is a set of a deck's nodes: leave it out");
    step.midline = PlaneText{plane.point("point_mm"), plane.point("normal")};
    if (step.midline->normal == glm::dvec3(0.0))
      refuse(plane.at("normal"), "has no direction: give for example [1, 0, 0]");
  }
  read_regions(keys, bound, step);
  step.finer = finer_of(keys, bound);
  if (!step.finer.empty() && step.kind != ExportKind::Tetrahedra)
    refuse(keys.at("finer"), "is of a deck's elements: leave it out");
  if (!step.finer.empty() && !step.smooth_mm && (step.attachment.any() || !step.regions.empty()))
    refuse(keys.at("finer"), "is not of voxels' elements: add 'smooth_mm', or leave it out");
  return step;
}

}  // namespace octotomy::planner
