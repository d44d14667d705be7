// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cephalometry/measured.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "planner/table/json.h"
#include "verify/chance.h"
#include "verify/size_interval.h"

namespace octotomy::planner {
namespace {

using Kind = CephalometricKind;
using Plane = CephalometricPlane;
using Points = LandmarkPlaces;
using Values = std::map<std::string, double>;

constexpr double shortest_line_mm = 1e-6;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// Measures in the head's directions: x to the left, y back, z up.
class Ruler {
 public:
  Ruler(const CephalometricMeasure& measure, const Points& points) : measure_(measure) {
    for (const std::string& name : measure.points) points_.push_back(projected(points.at(name)));
  }

  double value() const {
    switch (measure_.kind) {
      case Kind::Angle:
        return angle(line(1, 0), line(1, 2));
      case Kind::Bend:
        return (across(line(0, 2), line(0, 1)) < 0.0 ? -1.0 : 1.0) * angle(line(0, 1), line(1, 2));
      case Kind::Lines:
        return angle(line(0, 1), line(2, 3));
      case Kind::Tilt:
        return degrees(std::atan2(line(0, 1).z, std::hypot(line(0, 1).x, line(0, 1).y)));
      case Kind::Distance:
        return glm::length(points_[1] - points_[0]);
      case Kind::Along:
        return glm::dot(points_[3] - points_[2], glm::normalize(line(0, 1)));
      case Kind::Across:
        return across(glm::normalize(line(0, 1)), points_[3] - points_[2]);
      case Kind::Difference:
      case Kind::Share:
        break;
    }
    return 0.0;
  }

 private:
  glm::dvec3 projected(glm::dvec3 p) const {
    if (measure_.plane == Plane::Lateral) p.x = 0.0;
    if (measure_.plane == Plane::Frontal) p.y = 0.0;
    return p;
  }
  glm::dvec3 line(std::size_t from, std::size_t to) const {
    const glm::dvec3 line = points_[to] - points_[from];
    if (!(glm::length(line) > shortest_line_mm))
      throw std::invalid_argument(measure_.name + ": " + measure_.points[from] + " and " +
                                  measure_.points[to] +
                                  " lie in one point, so that no line goes through them");
    return line;
  }
  static double angle(const glm::dvec3& a, const glm::dvec3& b) {
    return degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  }
  /// How far `b` leads off to the upper side of a direction that goes forward; in the frontal plane, of one
  /// that goes to the left. Of a line that goes down, that is its front.
  double across(const glm::dvec3& direction, const glm::dvec3& b) const {
    const double turn = measure_.plane == Plane::Lateral ? glm::cross(direction, b).x * -1.0
                                                         : glm::cross(direction, b).y * -1.0;
    return turn / glm::length(direction);
  }

  const CephalometricMeasure& measure_;
  std::vector<glm::dvec3> points_;
};

/// The measures that have their points, in the order of their definitions.
Values values_of(const Cephalometry& definitions, const Points& placed) {
  const Points points = with_means(definitions, placed);
  Values values;
  for (const CephalometricMeasure& measure : definitions.measures) {
    const bool has_points = std::all_of(measure.points.begin(), measure.points.end(),
                                        [&](const std::string& name) { return points.contains(name); });
    const bool has_measures = std::all_of(measure.of.begin(), measure.of.end(),
                                          [&](const std::string& name) { return values.contains(name); });
    if (!has_points || !has_measures) continue;
    if (measure.of.empty()) {
      values[measure.name] = Ruler(measure, points).value();
      continue;
    }
    const double a = values.at(measure.of[0]), b = values.at(measure.of[1]);
    values[measure.name] = measure.kind == Kind::Difference ? a - b : 100.0 * a / b;
  }
  return values;
}

/// The landmarks that a measure needs and nobody placed.
std::vector<std::string> lacking(const Cephalometry& definitions, const CephalometricMeasure& measure,
                                 const Points& points) {
  std::set<std::string> names;
  for (const std::string& part : measure.of)
    for (const CephalometricMeasure& other : definitions.measures)
      if (other.name == part)
        names.merge(std::set<std::string>([&] {
          const std::vector<std::string> of_part = lacking(definitions, other, points);
          return std::set<std::string>(of_part.begin(), of_part.end());
        }()));
  for (const std::string& name : measure.points)
    if (!points.contains(name)) names.insert(name);
  return {names.begin(), names.end()};
}

class Trials {
 public:
  void add(const Values& value) {
    for (const auto& [name, number] : value) found_[name].push_back(number);
  }
  /// Half of the shortest interval about the value that holds the claimed share of the trials.
  double half_width(const std::string& name, double value) {
    std::vector<double>& found = found_[name];
    for (double& each : found) each = std::abs(each - value);
    const auto at = static_cast<std::ptrdiff_t>(
        std::min(std::ceil(verify::claimed_coverage * static_cast<double>(found.size())),
                 static_cast<double>(found.size())) -
        1.0);
    std::nth_element(found.begin(), found.begin() + at, found.end());
    return found[static_cast<std::size_t>(at)];
  }

 private:
  std::map<std::string, std::vector<double>> found_;
};

/// The landmarks along the head's directions, before and after.
struct Placed {
  Points before, after;
};
Placed placed(const std::vector<MovedLandmark>& landmarks, const glm::dmat3& head_from_lps,
              const std::vector<glm::dvec3>* errors_mm) {
  Placed made;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const glm::dvec3 p =
        landmarks[i].landmark.p_mm + (errors_mm == nullptr ? glm::dvec3(0.0) : (*errors_mm)[i]);
    made.before[landmarks[i].landmark.name] = head_from_lps * p;
    made.after[landmarks[i].landmark.name] =
        head_from_lps * glm::dvec3(landmarks[i].moved_from_still * glm::dvec4(p, 1.0));
  }
  return made;
}

Values changes(const Values& before, const Values& after) {
  Values made;
  for (const auto& [name, value] : before) made[name] = after.at(name) - value;
  return made;
}

Json value_json(const CephalometricValue& value) {
  return {{"value", value.value}, {"half_width", value.half_width}};
}

}  // namespace

CephalometricResults measured(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks,
                              const glm::dmat3& lps_from_head, const LandmarkDoubt& doubt) {
  const glm::dmat3 head_from_lps = glm::transpose(lps_from_head);
  const Placed still = placed(landmarks, head_from_lps, nullptr);
  const Values before = values_of(definitions, still.before), after = values_of(definitions, still.after),
               change = changes(before, after);
  const bool moves = std::any_of(landmarks.begin(), landmarks.end(), [](const MovedLandmark& landmark) {
    return landmark.moved_from_still != glm::dmat4(1.0);
  });
  Trials of_before, of_after, of_change;
  verify::Chance chance(doubt.seed);
  std::vector<glm::dvec3> errors_mm(landmarks.size());
  for (int trial = 0; trial < doubt.trials; ++trial) {
    for (glm::dvec3& error : errors_mm)
      for (int axis = 0; axis < 3; ++axis) error[axis] = doubt.deviation_mm * chance.normal();
    const Placed off = placed(landmarks, head_from_lps, &errors_mm);
    const Values first = values_of(definitions, off.before);
    of_before.add(first);
    if (!moves) continue;
    const Values second = values_of(definitions, off.after);
    of_after.add(second);
    of_change.add(changes(first, second));
  }
  CephalometricResults results;
  const Points points = with_means(definitions, still.before);
  for (const CephalometricMeasure& measure : definitions.measures) {
    const std::string& name = measure.name;
    if (!before.contains(name)) {
      results.lacking.emplace_back(name, lacking(definitions, measure, points));
      continue;
    }
    CephalometricResult result{
        measure, {before.at(name), of_before.half_width(name, before.at(name))}, {}, {}};
    if (moves) {
      result.after = {after.at(name), of_after.half_width(name, after.at(name))};
      result.change = {change.at(name), of_change.half_width(name, change.at(name))};
    }
    results.measured.push_back(std::move(result));
  }
  return results;
}

Json to_json(const CephalometricResults& results, const LandmarkDoubt& doubt) {
  Json json{{"measures", Json::array()},
            {"lacking", Json::array()},
            {"landmark_deviation_mm", doubt.deviation_mm},
            {"coverage", verify::claimed_coverage}};
  for (const CephalometricResult& result : results.measured) {
    const CephalometricMeasure& measure = result.measure;
    Json row{{"name", measure.name},
             {"says", measure.says},
             {"unit", measure.unit()},
             {"before", value_json(result.before)},
             {"after", result.after ? value_json(*result.after) : Json()},
             {"change", result.change ? value_json(*result.change) : Json()},
             {"norm", measure.norm ? Json(*measure.norm) : Json()},
             {"deviation", measure.deviation ? Json(*measure.deviation) : Json()},
             {"source", measure.source}};
    json["measures"].push_back(std::move(row));
  }
  for (const auto& [name, landmarks] : results.lacking)
    json["lacking"].push_back({{"name", name}, {"landmarks", landmarks}});
  return json;
}

}  // namespace octotomy::planner
