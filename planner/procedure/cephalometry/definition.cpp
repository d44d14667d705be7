// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/definition.h"

#include <algorithm>
#include <map>
#include <set>

#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"

namespace octotomy::planner {

/// Names and texts of the definition files in this folder. The list is generated when the build is
/// configured.
const std::vector<std::pair<std::string, std::string>>& cephalometry_files();

namespace {

using Kind = CephalometricKind;
using Plane = CephalometricPlane;

struct KindOf {
  Kind kind;
  std::size_t points;
};
const std::map<std::string, KindOf>& kinds() {
  static const std::map<std::string, KindOf> all{
      {"angle", {Kind::Angle, 3}},       {"bend", {Kind::Bend, 3}},
      {"lines", {Kind::Lines, 4}},       {"tilt", {Kind::Tilt, 2}},
      {"distance", {Kind::Distance, 2}}, {"along", {Kind::Along, 4}},
      {"across", {Kind::Across, 4}},     {"difference", {Kind::Difference, 0}},
      {"share", {Kind::Share, 0}}};
  return all;
}
const std::map<std::string, Plane>& planes() {
  static const std::map<std::string, Plane> all{
      {"lateral", Plane::Lateral}, {"frontal", Plane::Frontal}, {"space", Plane::Space}};
  return all;
}

template <typename Value>
const Value& chosen(const std::map<std::string, Value>& all, const std::string& word,
                    const std::string& where) {
  const auto found = all.find(word);
  if (found != all.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, unused] : all) known.push_back(name);
  refuse(where, "there is no '" + word + "'" + suggestion(word, known));
}

std::vector<std::string> words_of(const SortedJson& list, const std::string& where) {
  if (!list.is_array()) refuse(where, "must be a list of names");
  std::vector<std::string> words;
  for (const SortedJson& word : list) words.push_back(word_of(word, where));
  return words;
}

class Reader {
 public:
  Cephalometry read(const SortedJson& root) {
    check_keys(root, "cephalometry", {"cephalometry", "says", "landmarks", "sources", "measures"});
    made_.name = word_of(need(root, "cephalometry", ""), "cephalometry");
    made_.says = word_of(need(root, "says", ""), "says");
    for (const SortedJson& entry : need(root, "landmarks", "")) add_landmark(entry);
    if (root.contains("sources"))
      for (const SortedJson& entry : root["sources"]) add_source(entry);
    for (const SortedJson& entry : need(root, "measures", "")) add_measure(entry);
    return std::move(made_);
  }

 private:
  void add_landmark(const SortedJson& entry) {
    const std::string where = "landmarks[" + std::to_string(made_.landmarks.size()) + "]";
    check_keys(entry, where, {"name", "says", "mean_of", "of_skin"});
    CephalometricLandmark landmark{
        word_of(need(entry, "name", where), where), word_of(need(entry, "says", where), where), {}};
    if (entry.contains("mean_of")) landmark.mean_of = words_of(entry["mean_of"], where + ", mean_of");
    need_known(landmark.mean_of, landmarks_, where + ", mean_of");
    if (entry.contains("of_skin")) {
      if (!entry["of_skin"].is_boolean()) refuse(where + ", of_skin", "must be true or false");
      landmark.is_of_skin = entry["of_skin"].get<bool>();
    }
    if (!landmarks_.insert(landmark.name).second) refuse(where, "'" + landmark.name + "' is defined twice");
    made_.landmarks.push_back(std::move(landmark));
  }

  void add_source(const SortedJson& entry) {
    const std::string where = "sources[" + std::to_string(made_.sources.size()) + "]";
    check_keys(entry, where, {"name", "says"});
    CephalometricSource source{word_of(need(entry, "name", where), where),
                               word_of(need(entry, "says", where), where)};
    if (!sources_.insert(source.name).second) refuse(where, "'" + source.name + "' is defined twice");
    made_.sources.push_back(std::move(source));
  }

  void add_measure(const SortedJson& entry) {
    const std::string where = "measures[" + std::to_string(made_.measures.size()) + "]";
    check_keys(entry, where,
               {"name", "says", "kind", "plane", "points", "of", "norm", "deviation", "source"});
    CephalometricMeasure measure;
    measure.name = word_of(need(entry, "name", where), where);
    measure.says = word_of(need(entry, "says", where), where);
    const KindOf& kind = chosen(kinds(), word_of(need(entry, "kind", where), where), where + ", kind");
    measure.kind = kind.kind;
    if (entry.contains("plane"))
      measure.plane = chosen(planes(), word_of(entry["plane"], where), where + ", plane");
    if (entry.contains("points")) measure.points = words_of(entry["points"], where + ", points");
    if (entry.contains("of")) measure.of = words_of(entry["of"], where + ", of");
    if (measure.points.size() != kind.points)
      refuse(where + ", points", "must be " + std::to_string(kind.points) + " landmarks");
    if (measure.of.size() != (kind.points == 0 ? 2u : 0u))
      refuse(where + ", of",
             kind.points == 0 ? "must be two measures" : "applies only to a difference or a share");
    if (measure.plane == Plane::Space &&
        (kind.kind == Kind::Bend || kind.kind == Kind::Tilt || kind.kind == Kind::Across))
      refuse(where + ", plane",
             "must be lateral or frontal, because this measure has a sign only in a plane");
    need_known(measure.points, landmarks_, where + ", points");
    need_known(measure.of, measures_, where + ", of");
    if (entry.contains("norm")) measure.norm = number_of(entry["norm"], where + ", norm");
    if (entry.contains("deviation")) measure.deviation = number_of(entry["deviation"], where + ", deviation");
    if (entry.contains("source")) {
      measure.source = word_of(entry["source"], where + ", source");
      if (!sources_.empty()) need_known({measure.source}, sources_, where + ", source");
    }
    if (!measures_.insert(measure.name).second) refuse(where, "'" + measure.name + "' is defined twice");
    made_.measures.push_back(std::move(measure));
  }

  static void need_known(const std::vector<std::string>& names, const std::set<std::string>& known,
                         const std::string& where) {
    for (const std::string& name : names)
      if (!known.contains(name))
        refuse(where, "'" + name + "' is not defined before" +
                          suggestion(name, std::vector<std::string>(known.begin(), known.end())));
  }

  Cephalometry made_;
  std::set<std::string> landmarks_, sources_, measures_;
};

}  // namespace

const char* CephalometricMeasure::unit() const {
  switch (kind) {
    case Kind::Distance:
    case Kind::Along:
    case Kind::Across:
      return "mm";
    case Kind::Share:
      return "%";
    default:
      return "deg";
  }
}

LandmarkPlaces with_means(const Cephalometry& definitions, LandmarkPlaces points) {
  for (const CephalometricLandmark& landmark : definitions.landmarks) {
    if (landmark.mean_of.empty() || points.contains(landmark.name)) continue;
    glm::dvec3 sum(0.0);
    bool all = true;
    for (const std::string& name : landmark.mean_of) {
      const auto found = points.find(name);
      all = all && found != points.end();
      if (all) sum += found->second;
    }
    if (all) points[landmark.name] = sum / static_cast<double>(landmark.mean_of.size());
  }
  return points;
}

Cephalometry parse_cephalometry(const std::string& text) {
  return Reader().read(parse_json(text));
}

Cephalometry read_cephalometry(const std::string& name_or_path) {
  if (name_or_path.ends_with(".json")) {
    const SortedJson root = read_json(name_or_path);
    try {
      return Reader().read(root);
    } catch (const std::exception& error) {
      rethrow_at(name_or_path + ": ", error);
    }
  }
  for (const auto& [name, text] : cephalometry_files())
    if (name == name_or_path) return parse_cephalometry(text);
  throw std::runtime_error("there are no definitions '" + name_or_path + "'" +
                           suggestion(name_or_path, cephalometries()) + "; or give a .json file");
}

std::vector<std::string> cephalometries() {
  std::vector<std::string> names;
  for (const auto& [name, unused] : cephalometry_files()) names.push_back(name);
  return names;
}

}  // namespace octotomy::planner
