// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/measured.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "planner/procedure/cephalometry/cephalometry_table.h"
#include "verify/interval/size_interval.h"
#include "verify/phantom/chance.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

using Kind = CephalometricKind;
using Plane = CephalometricPlane;
using Points = std::vector<glm::dvec3>;

constexpr double shortest_line_mm = 1e-6;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

/// Computes one measure from points in the head's frame: x to the left, y to the back, z up.
class Ruler {
 public:
  /// `of` has, for each point of the measure, its index in `points`.
  Ruler(const CephalometricMeasure& measure, const Points& points, const std::vector<std::size_t>& of)
      : measure_(measure) {
    assert(of.size() <= points_.size());
    for (std::size_t i = 0; i < of.size(); ++i) points_[i] = projected(points[of[i]]);
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
      throw voxel::InvalidInput(measure_.name + ": " + measure_.points[from] + " and " + measure_.points[to] +
                                " lie at the same place and define no line: place one of them again");
    return line;
  }
  static double angle(const glm::dvec3& a, const glm::dvec3& b) {
    return degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  }
  /// The component of `b` perpendicular to `direction`, in the measure's plane. If the direction points
  /// forward (in the frontal plane: to the left), upward is positive. If it points down, forward (to the
  /// left) is positive.
  double across(const glm::dvec3& direction, const glm::dvec3& b) const {
    const double turn = measure_.plane == Plane::Lateral ? glm::cross(direction, b).x * -1.0
                                                         : glm::cross(direction, b).y * -1.0;
    return turn / glm::length(direction);
  }

  const CephalometricMeasure& measure_;
  std::array<glm::dvec3, 4> points_{};
};

/// The values of a chart's measures, in the chart's order.
using Values = std::vector<double>;

/// A measure that can be computed, with the indices of its landmarks and of the measures that it uses.
struct ChartedMeasure {
  const CephalometricMeasure* definition = nullptr;
  std::vector<std::size_t> points, of;
};

/// Measures bound to landmarks: names are looked up only once instead of in each trial.
class Chart {
 public:
  Chart(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks) {
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const auto [known, is_new] = place_of_.try_emplace(landmarks[i].landmark.name, places_.size());
      if (is_new) places_.emplace_back();
      places_[known->second].landmark = i;
    }
    for (const CephalometricLandmark& landmark : definitions.landmarks)
      if (!landmark.mean_of.empty() && !place_of_.contains(landmark.name)) add_mean(landmark);
    for (const CephalometricMeasure& measure : definitions.measures) add(measure);
    find_used();
  }

  const std::vector<ChartedMeasure>& measures() const { return measures_; }
  const auto& lacking() const { return lacking_; }
  /// The values of the measures. `landmarks_mm` must have the order of the constructor's landmarks; those
  /// that no measure uses are not read.
  Values values(const Points& landmarks_mm) const {
    Points points(places_.size());
    for (const std::size_t place : used_)
      points[place] = places_[place].landmark ? landmarks_mm[*places_[place].landmark]
                                              : mean(points, places_[place].mean_of);
    Values values;
    for (const ChartedMeasure& measure : measures_) values.push_back(value(measure, points, values));
    return values;
  }
  /// Indices of those landmarks that a measure uses.
  std::vector<std::size_t> used_landmarks() const {
    std::vector<std::size_t> numbers;
    for (const std::size_t place : used_)
      if (places_[place].landmark) numbers.push_back(*places_[place].landmark);
    return numbers;
  }

 private:
  /// A placed landmark, or the mean of earlier places in the list.
  struct PlacedPoint {
    std::optional<std::size_t> landmark;
    std::vector<std::size_t> mean_of;
  };

  void add_mean(const CephalometricLandmark& landmark) {
    PlacedPoint mean;
    for (const std::string& name : landmark.mean_of) {
      const auto part = place_of_.find(name);
      if (part == place_of_.end()) return;
      mean.mean_of.push_back(part->second);
    }
    place_of_.emplace(landmark.name, places_.size());
    places_.push_back(std::move(mean));
  }

  /// The measures of `of` were added before, so the landmarks that they lack are known.
  void add(const CephalometricMeasure& measure) {
    std::set<std::string> missing;
    for (const std::string& name : measure.points)
      if (!place_of_.contains(name)) missing.insert(name);
    for (const std::string& name : measure.of)
      if (const auto part = lacking_of_.find(name); part != lacking_of_.end())
        missing.insert(lacking_[part->second].second.begin(), lacking_[part->second].second.end());
    if (!missing.empty()) {
      lacking_of_.emplace(measure.name, lacking_.size());
      lacking_.emplace_back(measure.name, std::vector<std::string>(missing.begin(), missing.end()));
      return;
    }
    ChartedMeasure charted{&measure, {}, {}};
    for (const std::string& name : measure.points) charted.points.push_back(place_of_.at(name));
    for (const std::string& name : measure.of) charted.of.push_back(measure_of_.at(name));
    measure_of_.emplace(measure.name, measures_.size());
    measures_.push_back(std::move(charted));
  }

  void find_used() {
    std::vector<bool> is_used(places_.size(), false);
    for (const ChartedMeasure& measure : measures_)
      for (const std::size_t place : measure.points) is_used[place] = true;
    for (std::size_t place = places_.size(); place-- > 0;)
      if (is_used[place])
        for (const std::size_t part : places_[place].mean_of) is_used[part] = true;
    for (std::size_t place = 0; place < places_.size(); ++place)
      if (is_used[place]) used_.push_back(place);
  }

  static glm::dvec3 mean(const Points& points, const std::vector<std::size_t>& of) {
    glm::dvec3 sum(0.0);
    for (const std::size_t part : of) sum += points[part];
    return sum / static_cast<double>(of.size());
  }
  static double value(const ChartedMeasure& measure, const Points& points, const Values& values) {
    if (measure.of.empty()) return Ruler(*measure.definition, points, measure.points).value();
    const double a = values[measure.of[0]], b = values[measure.of[1]];
    return measure.definition->kind == Kind::Difference ? a - b : 100.0 * a / b;
  }

  std::vector<PlacedPoint> places_;
  std::vector<std::size_t> used_;  ///< places, ascending
  std::vector<ChartedMeasure> measures_;
  std::vector<std::pair<std::string, std::vector<std::string>>> lacking_;
  std::map<std::string, std::size_t> place_of_, measure_of_, lacking_of_;
};

class Trials {
 public:
  void add(const Values& values) {
    found_.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) found_[i].push_back(values[i]);
  }
  /// The half-width of the shortest interval around `value` that contains the claimed share of the trials of
  /// a measure.
  double half_width(std::size_t measure, double value) {
    std::vector<double>& found = found_[measure];
    for (double& each : found) each = std::abs(each - value);
    const auto at = static_cast<std::ptrdiff_t>(
        std::min(std::ceil(verify::claimed_coverage * static_cast<double>(found.size())),
                 static_cast<double>(found.size())) -
        1.0);
    std::nth_element(found.begin(), found.begin() + at, found.end());
    return found[static_cast<std::size_t>(at)];
  }

 private:
  std::vector<std::vector<double>> found_;
};

/// Positions of the landmarks along the head's directions, before and after the plan's motions, in one trial.
class Placing {
 public:
  Placing(const std::vector<MovedLandmark>& landmarks, const glm::dmat3& lps_from_head,
          std::vector<std::size_t> used)
      : landmarks_(landmarks),
        head_from_lps_(glm::transpose(lps_from_head)),
        used_(std::move(used)),
        before_mm_(landmarks.size()),
        after_mm_(landmarks.size()) {}

  /// Computes the positions of the used landmarks. `errors_mm` are the errors of their placement; `shares`
  /// are the errors of the motions, as multiples of their standard deviations.
  void place(const Points& errors_mm, const std::vector<double>& shares) {
    for (const std::size_t i : used_) {
      const glm::dvec3 p_mm = landmarks_[i].landmark.p_mm + errors_mm[i];
      before_mm_[i] = head_from_lps_ * p_mm;
      after_mm_[i] = head_from_lps_ * (glm::dvec3(landmarks_[i].moved_from_still * glm::dvec4(p_mm, 1.0)) +
                                       shares[i] * landmarks_[i].deviation_mm);
    }
  }
  const Points& before_mm() const { return before_mm_; }
  const Points& after_mm() const { return after_mm_; }

 private:
  const std::vector<MovedLandmark>& landmarks_;
  glm::dmat3 head_from_lps_;
  std::vector<std::size_t> used_;
  Points before_mm_, after_mm_;
};

std::optional<std::string> norm_of(const Cephalometry& definitions, const CephalometricMeasure& measure) {
  for (const CephalometricSource& source : definitions.sources)
    if (source.name == measure.source) return source.says;
  return {};
}

/// The names of a measure's landmarks that lie on the skin and whose motion nothing predicts.
std::vector<std::string> unpredicted(const CephalometricMeasure& measure, const Cephalometry& definitions,
                                     const std::vector<MovedLandmark>& landmarks) {
  std::vector<std::string> names;
  for (const std::string& name : measure.points) {
    const bool is_of_skin =
        std::any_of(definitions.landmarks.begin(), definitions.landmarks.end(),
                    [&](const CephalometricLandmark& one) { return one.name == name && one.is_of_skin; });
    const bool is_predicted = std::any_of(landmarks.begin(), landmarks.end(), [&](const MovedLandmark& one) {
      return one.landmark.name == name && one.is_predicted;
    });
    if (is_of_skin && !is_predicted && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  return names;
}

Values changes(const Values& before, const Values& after) {
  Values made(before.size());
  for (std::size_t i = 0; i < made.size(); ++i) made[i] = after[i] - before[i];
  return made;
}

}  // namespace

CephalometricResults measured(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks,
                              const glm::dmat3& lps_from_head, const LandmarkDoubt& doubt) {
  const Chart chart(definitions, landmarks);
  Placing placing(landmarks, lps_from_head, chart.used_landmarks());
  Points errors_mm(landmarks.size(), glm::dvec3(0.0));
  std::vector<double> shares(landmarks.size(), 0.0);
  placing.place(errors_mm, shares);
  const Values before = chart.values(placing.before_mm()), after = chart.values(placing.after_mm()),
               change = changes(before, after);
  const bool moves = std::any_of(landmarks.begin(), landmarks.end(), [](const MovedLandmark& landmark) {
    return landmark.moved_from_still != glm::dmat4(1.0);
  });
  Trials of_before, of_after, of_change;
  verify::Chance chance(doubt.seed);
  for (int trial = 0; trial < doubt.trials; ++trial) {
    for (glm::dvec3& error : errors_mm)
      for (int axis = 0; axis < 3; ++axis) error[axis] = doubt.deviation_mm * chance.normal();
    for (std::size_t i = 0; i < landmarks.size(); ++i)
      if (landmarks[i].deviation_mm != glm::dvec3(0.0)) shares[i] = chance.normal();
    placing.place(errors_mm, shares);
    const Values first = chart.values(placing.before_mm());
    of_before.add(first);
    if (!moves) continue;
    const Values second = chart.values(placing.after_mm());
    of_after.add(second);
    of_change.add(changes(first, second));
  }
  CephalometricResults results;
  results.lacking = chart.lacking();
  for (std::size_t i = 0; i < before.size(); ++i) {
    CephalometricResult result{*chart.measures()[i].definition,
                               norm_of(definitions, *chart.measures()[i].definition),
                               {before[i], of_before.half_width(i, before[i])},
                               {},
                               {}};
    std::vector<std::string> open;
    if (moves) open = unpredicted(result.measure, definitions, landmarks);
    if (!open.empty()) {
      results.unpredicted.emplace_back(result.measure.name, std::move(open));
    } else if (moves) {
      result.after = {after[i], of_after.half_width(i, after[i])};
      result.change = {change[i], of_change.half_width(i, change[i])};
    }
    results.measured.push_back(std::move(result));
  }
  return results;
}

Json to_json(const CephalometricResults& results, const LandmarkDoubt& doubt) {
  CephalometryTable table{{}, {}, {}, doubt.deviation_mm, verify::claimed_coverage};
  for (const auto& [measure, norm_of, before, after, change] : results.measured)
    table.measures.push_back({measure.name, measure.says, measure.unit(), before, after, change, measure.norm,
                              measure.deviation, measure.source, norm_of});
  for (const auto& [name, landmarks] : results.unpredicted) table.not_predicted.push_back({name, landmarks});
  for (const auto& [name, landmarks] : results.lacking) table.lacking.push_back({name, landmarks});
  return print_record(table);
}

}  // namespace octotomy::planner
