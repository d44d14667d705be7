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

#include "planner/export_step.h"
#include "planner/nearest_name.h"
#include "planner/plan_keys.h"

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

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
  for (const Json& point : value)
    polygon.push_back(point_of(point, where + "[" + std::to_string(polygon.size()) + "]"));
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

int whole_number(const Json& value, const std::string& where) {
  const double number = number_of(value, where);
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
    if (keys.find("big_endian") != nullptr) raw.big_endian = keys.flag("big_endian");
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
      step.points_mm.emplace_back(number_of(point[0], at), number_of(point[1], at), number_of(point[2], at));
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
  if (word == "export") step.action = read_export_step(keys, bound, taken);
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
