// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "planner/nearest_name.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw std::runtime_error(where.empty() ? what : where + ": " + what);
}

std::string type_of(const Json& value) {
  return value.is_number() ? "a number"
         : value.is_null() ? "null"
                           : "a JSON " + std::string(value.type_name());
}

/// The names of pairs or of a map's entries, in their order.
template <typename Pairs>
std::vector<std::string> names_of(const Pairs& pairs) {
  std::vector<std::string> names(pairs.size());
  std::transform(pairs.begin(), pairs.end(), names.begin(), [](const auto& pair) { return pair.first; });
  return names;
}

/// Reads JSON, refusing keys that an object says twice, which would otherwise silently take the last.
Json strict_json(const std::string& text) {
  std::vector<std::set<std::string>> open;
  const auto watch = [&open](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second)
      throw std::runtime_error("the key '" + parsed.get<std::string>() +
                               "' is said twice in one object: keep one");
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& error) {
    throw std::runtime_error("not JSON: " + std::string(error.what()));
  }
}

/// One JSON object, read key by key; finish() refuses what nobody asked for.
class Keys {
 public:
  Keys(const Json& value, std::string where, std::vector<std::string> known)
      : value_(value), where_(std::move(where)), known_(std::move(known)) {
    if (!value.is_object()) refuse(where_, "must be an object in braces, not " + type_of(value));
    std::sort(known_.begin(), known_.end());
    for (const auto& [key, unused] : value.items())
      if (!std::binary_search(known_.begin(), known_.end(), key))
        refuse(where_, "unknown key '" + key + "'" + suggestion(key, known_));
  }

  const std::string& where() const { return where_; }
  std::string at(const std::string& key) const { return where_.empty() ? key : where_ + ", " + key; }
  const Json* find(const std::string& key) const {
    const auto found = value_.find(key);
    return found == value_.end() || found->is_null() ? nullptr : &*found;
  }
  const Json& need(const std::string& key) const {
    const Json* found = find(key);
    if (found == nullptr) refuse(where_, "'" + key + "' is missing: add it");
    return *found;
  }
  std::string text(const std::string& key) const {
    const Json& value = need(key);
    if (!value.is_string()) refuse(at(key), "must be a text in quotes, not " + type_of(value));
    if (value.get_ref<const std::string&>().empty()) refuse(at(key), "is empty: say what is meant");
    return value.get<std::string>();
  }
  double number(const std::string& key) const { return number(need(key), at(key)); }
  std::optional<double> number_if(const std::string& key) const {
    return find(key) == nullptr ? std::nullopt : std::optional(number(key));
  }
  glm::dvec3 point(const std::string& key) const {
    const Json& value = need(key);
    if (!value.is_array() || value.size() != 3) refuse(at(key), "must be three numbers [x, y, z]");
    return {number(value[0], at(key)), number(value[1], at(key)), number(value[2], at(key))};
  }
  static double number(const Json& value, const std::string& where) {
    if (!value.is_number()) refuse(where, "must be a number, not " + type_of(value));
    const double number = value.get<double>();
    if (!std::isfinite(number)) refuse(where, "must be a finite number");
    return number;
  }

 private:
  const Json& value_;
  std::string where_;
  std::vector<std::string> known_;
};

// In the order of Step::action's alternatives, so that an index tells the word.
const std::vector<std::pair<std::string, std::vector<std::string>>> steps_known{
    {"window", {"id", "do", "scan", "low", "high"}},
    {"mask", {"id", "do", "regions"}},
    {"combine", {"id", "do", "expression"}},
    {"move", {"id", "do", "object", "translate_mm", "rotate"}},
    {"measure", {"id", "do", "object", "to", "points_mm"}},
    {"export",
     {"id", "do", "object", "path", "moved", "fixed", "element_mm", "material", "fallback", "finer",
      "regions", "order", "midline", "smooth_mm", "between", "sliding", "materials"}},
};

std::vector<std::string> step_words() {
  return names_of(steps_known);
}

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

/// Names that steps have bound so far; objects can be computed with, the rest only exists.
class Bound {
 public:
  void bind(const std::string& where, const std::string& id, const std::string& word) {
    const bool letter_first =
        !id.empty() && (std::isalpha(static_cast<unsigned char>(id[0])) || id[0] == '_');
    const bool identifier = letter_first && std::all_of(id.begin(), id.end(), [](unsigned char c) {
                              return c < 128 && (std::isalnum(c) || c == '_');
                            });
    if (!identifier)
      refuse(where, "id '" + id + "' is not a name: use letters, digits and underscores, a letter first");
    if (!words_.emplace(id, word).second)
      refuse(where, "id '" + id + "' is taken by an earlier step: choose another");
    if (word != "measure" && word != "export") objects_.push_back(id);
  }
  void need_moved(const std::string& where, const std::string& name) const {
    need_object(where, name);
    if (words_.at(name) != "move")
      refuse(where, "'" + name + "' is a " + words_.at(name) +
                        " step: name the result of a move step, or list it as fixed");
  }
  void need_object(const std::string& where, const std::string& name) const {
    if (std::find(objects_.begin(), objects_.end(), name) != objects_.end()) return;
    const auto found = words_.find(name);
    if (found != words_.end()) refuse(where, "'" + name + "' is a " + found->second + " step, not an object");
    refuse(where, "no earlier step is called '" + name + "'" + suggestion(name, objects_));
  }

 private:
  std::map<std::string, std::string> words_;
  std::vector<std::string> objects_;
};

WindowStep window_step(const Keys& keys, const std::map<std::string, ScanSource>& scans) {
  WindowStep step{keys.text("scan"), keys.number("low"), keys.number_if("high")};
  const std::vector<std::string> names = names_of(scans);
  if (!scans.contains(step.scan))
    refuse(keys.at("scan"), "no scan is called '" + step.scan + "'" + suggestion(step.scan, names));
  if (step.high && *step.high < step.low)
    refuse(keys.at("high"), "is below 'low': nothing would be in the window, swap them");
  return step;
}

std::vector<glm::dvec2> polygon_of(const Json& value, const std::string& where) {
  if (!value.is_array()) refuse(where, "must be a list of points [u, v]");
  std::vector<glm::dvec2> polygon;
  for (const Json& point : value) {
    const std::string at = where + "[" + std::to_string(polygon.size()) + "]";
    if (!point.is_array() || point.size() != 2) refuse(at, "must be two numbers [u, v]");
    polygon.emplace_back(Keys::number(point[0], at), Keys::number(point[1], at));
  }
  return polygon;
}

MaskStep mask_step(const Keys& keys) {
  const Json& regions = keys.need("regions");
  if (!regions.is_array() || regions.empty())
    refuse(keys.at("regions"), "must be a list of at least one region");
  MaskStep step;
  for (const Json& value : regions) {
    const Keys region(value, keys.at("regions[" + std::to_string(step.regions.size()) + "]"),
                      {"view", "polygons_mm"});
    RegionText text{region.text("view"), {}};
    const Json& polygons = region.need("polygons_mm");
    if (!polygons.is_array()) refuse(region.at("polygons_mm"), "must be a list of polygons");
    for (const Json& polygon : polygons)
      text.polygons_mm.push_back(
          polygon_of(polygon, region.at("polygons_mm[" + std::to_string(text.polygons_mm.size()) + "]")));
    try {
      voxel::parse_view(text.view);
    } catch (const std::invalid_argument& error) {
      refuse(region.at("view"), error.what());
    }
    step.regions.push_back(std::move(text));
  }
  try {
    voxel::check(mask_of(step));
  } catch (const std::invalid_argument& error) {
    refuse(keys.at("regions"), error.what());
  }
  return step;
}

CombineStep combine_step(const Keys& keys, const Bound& bound) {
  CombineStep step{keys.text("expression")};
  // Any object will do to check the grammar and the names; motions belong into move steps.
  voxel::Names names;
  names.object = [&](std::string_view name) -> voxel::Expression {
    bound.need_object(keys.at("expression"), std::string(name));
    return voxel::Sphere{};
  };
  try {
    voxel::parse_expression(step.expression, names);
  } catch (const std::invalid_argument& error) {
    refuse(keys.at("expression"), error.what());
  }
  return step;
}

MoveStep move_step(const Keys& keys, const Bound& bound) {
  MoveStep step;
  step.object = keys.text("object");
  bound.need_object(keys.at("object"), step.object);
  if (keys.find("translate_mm") == nullptr && keys.find("rotate") == nullptr)
    refuse(keys.where(), "moves nothing: add 'translate_mm', 'rotate' or both");
  if (keys.find("translate_mm") != nullptr) step.translate_mm = keys.point("translate_mm");
  if (const Json* value = keys.find("rotate")) {
    const Keys rotate(*value, keys.at("rotate"), {"degrees", "axis", "about_mm"});
    RotateText text{rotate.number("degrees"), rotate.point("axis"), glm::dvec3(0.0)};
    if (rotate.find("about_mm") != nullptr) text.about_mm = rotate.point("about_mm");
    if (text.axis == glm::dvec3(0.0))
      refuse(rotate.at("axis"), "has no direction: give for example [1, 0, 0]");
    step.rotate = text;
  }
  try {
    voxel::moved_from_still(motion_of(step));
  } catch (const std::invalid_argument& error) {
    refuse(keys.where(), error.what());
  }
  return step;
}

std::vector<std::string> names_in(const Keys& keys, const std::string& key) {
  std::vector<std::string> names;
  const Json* list = keys.find(key);
  if (list == nullptr) return names;
  if (!list->is_array()) refuse(keys.at(key), "must be a list of names of earlier steps");
  for (const Json& name : *list) {
    if (!name.is_string()) refuse(keys.at(key), "must hold names of earlier steps, not " + type_of(name));
    names.push_back(name.get<std::string>());
  }
  return names;
}

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
  step.regions = names_in(keys, "regions");
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
  Attachment attachment{names_in(keys, "moved"), names_in(keys, "fixed"), keys.number_if("element_mm")};
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

ExportStep export_step(const Keys& keys, const Bound& bound, std::set<std::string>& taken) {
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
  if (const Json* fallback = keys.find("fallback")) {
    if (!fallback->is_boolean()) refuse(keys.at("fallback"), "must be true or false");
    if (step.kind != ExportKind::Tetrahedra)
      refuse(keys.at("fallback"),
             "only tetrahedra have a fallback: leave it out, or choose .inp, .feb or .vtu");
    if (step.attachment.any() && keys.find("smooth_mm") == nullptr)
      refuse(keys.at("fallback"), "what others hold is made of its voxels anyhow: leave it out");
    step.fallback = fallback->get<bool>();
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

int whole_number(const Json& value, const std::string& where) {
  const double number = Keys::number(value, where);
  if (number != std::trunc(number) || std::abs(number) > std::numeric_limits<int>::max())
    refuse(where, "must be a whole number");
  return static_cast<int>(number);
}

/// How a scan is read: its series, and what images and raw files do not say of themselves.
voxel::ReadOptions read_options_of(const Keys& scan) {
  voxel::ReadOptions read;
  if (scan.find("series") != nullptr) read.series = scan.text("series");
  if (scan.find("spacing_mm") != nullptr) read.spacing_mm = scan.point("spacing_mm");
  if (const Json* value = scan.find("raw")) {
    const Keys keys(*value, scan.at("raw"), {"dims", "type", "big_endian", "offset"});
    voxel::RawLayout raw;
    const Json& dims = keys.need("dims");
    if (!dims.is_array() || dims.size() != 3) refuse(keys.at("dims"), "must be three numbers [x, y, z]");
    for (int axis = 0; axis < 3; ++axis)
      raw.dims[axis] = whole_number(dims[static_cast<std::size_t>(axis)], keys.at("dims"));
    const std::optional<voxel::SampleType> type = voxel::sample_type(keys.text("type"));
    if (!type) refuse(keys.at("type"), "'" + keys.text("type") + "' is no type: use for example int16");
    raw.type = *type;
    if (const Json* big_endian = keys.find("big_endian")) {
      if (!big_endian->is_boolean()) refuse(keys.at("big_endian"), "must be true or false");
      raw.big_endian = big_endian->get<bool>();
    }
    if (const Json* offset = keys.find("offset")) {
      const int bytes = whole_number(*offset, keys.at("offset"));
      if (bytes < 0) refuse(keys.at("offset"), "must not be negative");
      raw.offset = static_cast<std::uint64_t>(bytes);
    }
    read.raw = raw;
  }
  return read;
}

std::map<std::string, ScanSource> scans_of(const Keys& top) {
  const Json& value = top.need("scans");
  if (!value.is_object() || value.empty())
    refuse("scans", "must name at least one scan, as {\"ct\": {\"path\": \"head.nrrd\"}}");
  std::map<std::string, ScanSource> scans;
  for (const auto& [name, entry] : value.items()) {
    const Keys keys(entry, "scans, " + name, {"path", "sha256", "series", "spacing_mm", "raw"});
    ScanSource source{keys.text("path"), std::nullopt, read_options_of(keys)};
    if (keys.find("sha256") != nullptr) {
      source.sha256 = keys.text("sha256");
      const bool hex = source.sha256->size() == 64 &&
                       source.sha256->find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
      if (!hex) refuse(keys.at("sha256"), "must be 64 hexadecimal digits, or null");
      for (char& digit : *source.sha256)
        digit = static_cast<char>(std::tolower(static_cast<unsigned char>(digit)));
    }
    scans.emplace(name, std::move(source));
  }
  return scans;
}

MeasureStep measure_step(const Keys& keys, const Bound& bound) {
  MeasureStep step;
  if (const Json* points = keys.find("points_mm")) {
    const std::string where = keys.at("points_mm");
    if (keys.find("object") != nullptr || keys.find("to") != nullptr)
      refuse(where, "stands alone: measure an object or points, in a step each");
    if (!points->is_array() || (points->size() != 2 && points->size() != 3))
      refuse(where, "must be two points [x, y, z] for a distance, or three for the angle at the second");
    for (const Json& point : *points) {
      const std::string at = where + "[" + std::to_string(step.points_mm.size()) + "]";
      if (!point.is_array() || point.size() != 3) refuse(at, "must be three numbers [x, y, z]");
      step.points_mm.emplace_back(Keys::number(point[0], at), Keys::number(point[1], at),
                                  Keys::number(point[2], at));
    }
    if (step.points_mm.size() == 3 &&
        (step.points_mm[1] == step.points_mm[0] || step.points_mm[1] == step.points_mm[2]))
      refuse(where, "has its second point twice: an angle needs two legs");
    return step;
  }
  step.object = keys.text("object");
  bound.need_object(keys.at("object"), step.object);
  if (keys.find("to") != nullptr) {
    step.to = keys.text("to");
    bound.need_object(keys.at("to"), *step.to);
    if (*step.to == step.object) refuse(keys.at("to"), "is the object itself: name another");
  }
  return step;
}

Step step_of(const Json& value, std::size_t index, const Plan& plan, Bound& bound,
             std::set<std::string>& taken) {
  std::string where = "step " + std::to_string(index + 1);
  if (!value.is_object()) refuse(where, "must be an object in braces, not " + type_of(value));
  if (const auto id = value.find("id"); id != value.end() && id->is_string())
    where = "step '" + id->get<std::string>() + "'";
  const auto found_do = value.find("do");
  if (found_do == value.end() || !found_do->is_string())
    refuse(where, "'do' is missing" + suggestion("", step_words()));
  const std::string word = found_do->get<std::string>();
  const auto known =
      std::find_if(steps_known.begin(), steps_known.end(), [&](const auto& k) { return k.first == word; });
  if (known == steps_known.end())
    refuse(where + ", do", "unknown step '" + word + "'" + suggestion(word, step_words()));

  const Keys keys(value, where, known->second);
  Step step;
  step.id = keys.text("id");
  if (word == "window") step.action = window_step(keys, plan.scans);
  if (word == "mask") step.action = mask_step(keys);
  if (word == "combine") step.action = combine_step(keys, bound);
  if (word == "move") step.action = move_step(keys, bound);
  if (word == "export") step.action = export_step(keys, bound, taken);
  if (word == "measure") step.action = measure_step(keys, bound);
  // Bound last, so that no step can name itself.
  bound.bind(where, step.id, word);
  return step;
}

}  // namespace

Plan parse_plan(const std::string& json, const std::filesystem::path& folder) {
  const Json root = strict_json(json);
  const Keys top(root, "", {"octotomy_plan", "name", "scans", "universe", "steps"});
  const Json& version = top.need("octotomy_plan");
  if (!version.is_number_integer() || version.get<std::int64_t>() != 1)
    refuse("octotomy_plan", "must be 1, the only version of plans there is");
  Plan plan;
  plan.text = json;
  plan.folder = folder;
  plan.name = top.text("name");
  plan.scans = scans_of(top);
  if (const Json* universe = top.find("universe")) {
    const Keys keys(*universe, "universe", {"voxel_mm"});
    plan.voxel_mm = keys.number_if("voxel_mm");
    if (plan.voxel_mm && *plan.voxel_mm <= 0.0)
      refuse(keys.at("voxel_mm"), "must be above zero, for example 1.0");
  }
  const Json& steps = top.need("steps");
  if (!steps.is_array() || steps.empty()) refuse("steps", "must be a list of at least one step");
  Bound bound;
  std::set<std::string> taken;
  for (const Json& step : steps) plan.steps.push_back(step_of(step, plan.steps.size(), plan, bound, taken));
  return plan;
}

Plan read_plan(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": cannot be opened as a plan: check the path");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  try {
    Plan plan = parse_plan(text, std::filesystem::absolute(path).parent_path());
    plan.file = path;
    return plan;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

std::filesystem::path scan_path(const Plan& plan, const ScanSource& scan) {
  return scan.path.is_absolute() ? scan.path : plan.folder / scan.path;
}

std::string verb(const Step& step) {
  return steps_known[step.action.index()].first;
}

voxel::RegionMask mask_of(const MaskStep& step) {
  voxel::RegionMask mask;
  for (const RegionText& region : step.regions)
    mask.regions.push_back({voxel::parse_view(region.view), region.polygons_mm});
  return mask;
}

voxel::Motion motion_of(const MoveStep& step) {
  voxel::Motion motion;
  motion.translate_mm = step.translate_mm;
  if (step.rotate) {
    motion.degrees = step.rotate->degrees;
    motion.axis = step.rotate->axis;
    motion.about_mm = step.rotate->about_mm;
  }
  return motion;
}

}  // namespace octotomy::planner
