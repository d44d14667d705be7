// SPDX-License-Identifier: AGPL-3.0-or-later
// 1. The results: a list of numbers, each a function of one trial's motions and landmarks.
// 2. A trial draws an error for each landmark, saw, moved piece and for the segmentation, and applies the
//    plan's motions with these errors, symbolically: no object is made.
// 3. Run all trials with all errors, then with the errors of one source at a time.
#include "planner/plan/trial.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <set>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/anatomy/measured_movement.h"
#include "planner/operation/anatomy/movement.h"
#include "planner/operation/measure/measured_trials.h"
#include "planner/operation/measure/near_surfaces.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/object/combine.h"
#include "planner/operation/table/deformation.h"
#include "planner/plan/dependence.h"
#include "verify/interval/size_interval.h"
#include "verify/phantom/chance.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

/// The random errors of one trial.
struct Errors {
  std::map<std::string, glm::dvec3> landmarks_mm;
  std::map<std::string, double> kerf_mm;                             ///< by saw steps
  std::map<std::string, std::pair<glm::dvec3, glm::dvec3>> seating;  ///< by piece: mm and rotation in rad
  double outward_mm = 0.0;
};

/// Motions of objects in one trial, from LPS to LPS, by the objects' ids.
struct Motions {
  std::map<std::string, glm::dmat4> own;    ///< of the step that moved the object
  std::map<std::string, glm::dmat4> total;  ///< since the object was made, including errors of its
                                            ///< parts
  std::map<std::string, glm::dmat4> off;    ///< from the planned position of the object to that in the trial
};

struct Number {
  std::string what, of, unit;
  std::function<double(const Errors& errors, const Motions& motions)> value;
};

/// Two objects, and the points of the first one that may be the nearest to the second.
struct Pair {
  std::string one, other;
  std::vector<NearPoint> points;
  std::set<std::string> saws;  ///< ids of the saw steps that separated the two
  double scale = 1.0;          ///< of the overlap

  template <typename Each>
  void each_distance(const Errors& errors, const Motions& motions, const Each& each) const {
    const glm::dmat4 off = glm::inverse(motions.off.at(other)) * motions.off.at(one);
    double wider_mm = -2.0 * errors.outward_mm;
    for (const std::string& saw : saws) wider_mm += errors.kerf_mm.at(saw);
    for (const NearPoint& point : points)
      each(point, point.distance_mm + glm::dot(point.away, carried(off, point.p_mm) - point.p_mm) + wider_mm);
  }
  double gap_mm(const Errors& errors, const Motions& motions) const {
    double least = std::numeric_limits<double>::infinity();
    each_distance(errors, motions, [&](const NearPoint&, double mm) { least = std::min(least, mm); });
    return std::max(0.0, least);
  }
  double overlap_mm3(const Errors& errors, const Motions& motions) const {
    double sum = 0.0;
    each_distance(errors, motions,
                  [&](const NearPoint& point, double mm) { sum += point.area_mm2 * std::max(0.0, -mm); });
    return scale * sum;
  }
};

class Through {
 public:
  Through(const Plan& plan, const Evaluation& evaluation)
      : plan_(plan), objects_(evaluation.objects), head_(evaluation.objects.lps_from_head) {
    for (const Step& step : plan.steps) steps_.emplace(step.id, &step);
    std::set<std::pair<std::string, std::string>> known;
    for (const auto& [one, other] : pairs()) add_pair(one, other, known);
    add_displacements();
    add_marks();
  }

  const std::vector<Number>& numbers() const { return numbers_; }
  const std::vector<std::string>& findings() const { return findings_; }

  Errors drawn(const Trials& asked, verify::Chance& chance) const {
    Errors errors;
    const auto some = [&](double deviation) {
      const double x = chance.normal(), y = chance.normal();
      return deviation * glm::dvec3(x, y, chance.normal());
    };
    for (const NamedPoint& landmark : plan_.landmarks)
      errors.landmarks_mm[landmark.name] = some(asked.landmark_mm);
    for (const Object& object : objects_) {
      if (object.kind == "saw") errors.kerf_mm[object.id] = asked.kerf_mm * chance.normal();
      // A real piece is not scaled, so scaling adds no error.
      if (object.moved && is_rigid(object.moved->motion)) {
        const glm::dvec3 by_mm = some(asked.seating_mm);
        errors.seating[object.id] = {by_mm, some(glm::radians(asked.seating_deg))};
      }
    }
    errors.outward_mm = asked.segmentation_mm * chance.normal();
    return errors;
  }

  Motions motions(const Errors& errors) const {
    Motions made;
    const MarkPlaces places{[&](const Mark& mark) { return place_mm(mark, errors, made); }, head_,
                            [&](const std::string& name) { return made.own.at(name); }};
    for (const Object& object : objects_) {
      if (!object.moved) {
        made.total[object.id] = made.off[object.id] = inherited(object, made);
        continue;
      }
      const auto step = steps_.find(object.id);
      const std::optional<glm::dmat4> motion =
          step == steps_.end() ? std::nullopt : motion_of(step->second->action, places);
      made.own[object.id] = seated(object, errors) * motion.value_or(object.moved->motion);
      made.total[object.id] = made.own[object.id] * made.total.at(object.moved->object);
      made.off[object.id] = made.total[object.id] * glm::inverse(moved_since_made(objects_, object.id));
    }
    return made;
  }

 private:
  glm::dvec3 place_mm(const Mark& mark, const Errors& errors, const Motions& motions) const {
    if (mark.landmark.empty()) return mark.p_mm;
    const auto error = errors.landmarks_mm.find(mark.landmark);
    const glm::dvec3 p_mm =
        mark.p_mm + (error == errors.landmarks_mm.end() ? glm::dvec3(0.0) : error->second);
    return mark.object.empty() ? p_mm : carried(motions.total.at(mark.object), p_mm);
  }

  /// The seating error of a piece as a motion: displacement, and rotation about the planned centroid.
  glm::dmat4 seated(const Object& object, const Errors& errors) const {
    const auto found = errors.seating.find(object.id);
    if (found == errors.seating.end()) return glm::dmat4(1.0);
    const auto& [by_mm, turn] = found->second;
    const glm::dvec3 centre_mm = object.voxel.measures.centroid_mm.value_or(glm::dvec3(0.0));
    glm::dmat4 motion = glm::translate(glm::dmat4(1.0), by_mm + centre_mm);
    if (const double angle = glm::length(turn); angle > 0.0)
      motion = glm::rotate(motion, angle, turn / angle);
    return glm::translate(motion, -centre_mm);
  }

  /// The error that all operands of an object share. The identity if their errors differ.
  glm::dmat4 inherited(const Object& object, const Motions& made) const {
    const auto step = steps_.find(object.id);
    if (step == steps_.end()) return glm::dmat4(1.0);
    std::optional<glm::dmat4> common;
    for (const std::string& input : objects_used(step->second->action)) {
      if (objects_.at(input).is_tool) continue;
      const glm::dmat4& off = made.off.at(input);
      if (common && *common != off) return glm::dmat4(1.0);
      common = off;
    }
    return common.value_or(glm::dmat4(1.0));
  }

  std::vector<std::pair<std::string, std::string>> pairs() const {
    std::vector<std::pair<std::string, std::string>> found;
    std::vector<std::string> united;
    for (const Step& step : plan_.steps) {
      const std::vector<std::string> used = objects_used(step.action);
      const std::string& name = step.action.operation().name;
      if ((name == "measure" || name == "contacts") && used.size() == 2) found.emplace_back(used[0], used[1]);
      if (const auto* combine = step.action.get_if<Combine>();
          combine != nullptr && combine->expression.find_first_of("&-^~(") == std::string::npos)
        united = used;
    }
    for (std::size_t i = 0; i < united.size(); ++i)
      for (std::size_t k = i + 1; k < united.size(); ++k)
        if (objects_.at(united[i]).moved || objects_.at(united[k]).moved)
          found.emplace_back(united[i], united[k]);
    return found;
  }

  void add_pair(const std::string& one, const std::string& other,
                std::set<std::pair<std::string, std::string>>& known) {
    if (!known.insert(std::minmax(one, other)).second) return;
    const Object &a = objects_.at(one), &b = objects_.at(other);
    if (!a.mesh.within || !b.mesh.within || a.mesh.within->empty() || b.mesh.within->empty()) {
      findings_.push_back(one + " and " + other + " do not both have a mesh: their gap is left out");
      return;
    }
    const glm::dvec3 spacing_mm = a.voxel.octree.universe().lattice().spacing_mm();
    Pair pair{one, other, near_points(*a.mesh.within, *b.mesh.within, glm::length(spacing_mm)), {}};
    const std::set<std::string> of_one = needed_for(plan_, {one}), of_other = needed_for(plan_, {other});
    for (const Object& object : objects_)
      if (object.kind == "saw" && of_one.contains(object.id) && of_other.contains(object.id))
        pair.saws.insert(object.id);
    const double voxels_mm3 =
        static_cast<double>(
            voxel::combine(a.voxel.octree.universe(), voxel::Expression(a.voxel.octree) & b.voxel.octree)
                .voxel_count()) *
        a.voxel.octree.universe().lattice().voxel_mm3();
    const Errors none = no_errors();
    const Motions still = motions(none);
    if (const double flat = pair.overlap_mm3(none, still); flat > 0.0 && voxels_mm3 > 0.0)
      pair.scale = voxels_mm3 / flat;
    const std::string of = one + " and " + other;
    const auto kept = std::make_shared<const Pair>(std::move(pair));
    numbers_.push_back({"gap", of, "mm", [kept](const Errors& errors, const Motions& motions) {
                          return kept->gap_mm(errors, motions);
                        }});
    numbers_.push_back({"overlap", of, "mm3", [kept](const Errors& errors, const Motions& motions) {
                          return kept->overlap_mm3(errors, motions);
                        }});
  }

  Errors no_errors() const {
    verify::Chance chance(0);
    return drawn({0.0, 0.0, 0.0, 0.0, 0.0, 1, 0}, chance);
  }

  void add_point(const Object& object, const std::string& name, const glm::dvec3& p_mm, bool is_landmark) {
    const std::string still = object.moved->object;
    const auto by = [this, id = object.id, still, name, p_mm, is_landmark](const Errors& errors,
                                                                           const Motions& motions) {
      const glm::dvec3 placed = p_mm + (is_landmark ? errors.landmarks_mm.at(name) : glm::dvec3(0.0));
      const glm::dvec3 from = carried(motions.total.at(still), placed);
      return displacement_of(carried(motions.own.at(id), from) - from, head_);
    };
    const std::string of = object.id + (is_landmark ? " at " + name : ", its centroid");
    for (const auto& [word, part] :
         {std::pair("forward", &Displacement::forward_mm), std::pair("left", &Displacement::left_mm),
          std::pair("up", &Displacement::up_mm)})
      numbers_.push_back({word, of, "mm", [by, part = part](const Errors& errors, const Motions& motions) {
                            return by(errors, motions).*part;
                          }});
  }

  void add_displacements() {
    for (const ObjectMovement& moved : movements_of(objects_, plan_.landmarks)) {
      const Object& object = objects_.at(moved.object);
      const Object& still = objects_.at(object.moved->object);
      for (const auto& [word, part] :
           {std::pair("pitch", &Turns::pitch_deg), std::pair("yaw", &Turns::yaw_deg),
            std::pair("roll", &Turns::roll_deg)})
        numbers_.push_back({word, object.id, "deg",
                            [this, id = object.id, part = part](const Errors&, const Motions& motions) {
                              return turns_of(nearest_rotation(motions.own.at(id)), head_).*part;
                            }});
      if (const auto& centre = still.voxel.measures.centroid_mm)
        add_point(object, "", carried(glm::inverse(moved_since_made(objects_, still.id)), *centre), false);
      for (const LandmarkMovement& on : moved.landmarks)
        for (const NamedPoint& landmark : plan_.landmarks)
          if (landmark.name == on.name) add_point(object, landmark.name, landmark.p_mm, true);
    }
  }

  void add_marks() {
    for (const Step& step : plan_.steps) {
      const std::vector<Mark> marks = marks_used(step.action);
      if (step.action.operation().name != "measure" || marks.size() < 2) continue;
      const auto value = [this, marks](const Errors& errors, const Motions& motions) {
        std::vector<glm::dvec3> p;
        for (const Mark& mark : marks) p.push_back(place_mm(mark, errors, motions));
        if (p.size() == 2) return glm::distance(p[0], p[1]);
        const glm::dvec3 a = p[0] - p[1], b = p[2] - p[1];
        return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
      };
      numbers_.push_back(
          {marks.size() == 2 ? "distance" : "angle", step.id, marks.size() == 2 ? "mm" : "deg", value});
    }
  }

  const Plan& plan_;
  const Objects& objects_;
  glm::dmat3 head_;
  std::map<std::string, const Step*> steps_;
  std::vector<Number> numbers_;
  std::vector<std::string> findings_;
};

/// For each value, the half-width of the shortest interval around it that contains the claimed share of the
/// trials.
std::vector<double> half_widths(const Through& through, const Trials& asked,
                                const std::vector<double>& values) {
  std::vector<std::vector<double>> off(values.size());
  verify::Chance chance(static_cast<std::uint64_t>(asked.seed) + 1);
  for (int trial = 0; trial < asked.trials; ++trial) {
    const Errors errors = through.drawn(asked, chance);
    const Motions motions = through.motions(errors);
    for (std::size_t i = 0; i < values.size(); ++i)
      off[i].push_back(std::abs(through.numbers()[i].value(errors, motions) - values[i]));
  }
  std::vector<double> widths;
  for (std::vector<double>& each : off) {
    const auto at = static_cast<std::ptrdiff_t>(
        std::ceil(verify::claimed_coverage * static_cast<double>(each.size())) - 1.0);
    std::nth_element(each.begin(), each.begin() + at, each.end());
    widths.push_back(each[static_cast<std::size_t>(at)]);
  }
  return widths;
}

}  // namespace

Json trials_json(const Plan& plan, const Evaluation& evaluation, const Trials& asked) {
  const Through through(plan, evaluation);
  std::vector<double> values;
  {
    verify::Chance chance(0);
    const Errors none = through.drawn({0.0, 0.0, 0.0, 0.0, 0.0, 1, 0}, chance);
    const Motions still = through.motions(none);
    for (const Number& number : through.numbers()) values.push_back(number.value(none, still));
  }
  Trials landmark = asked, kerf = asked, segmentation = asked, seating = asked;
  landmark.kerf_mm = landmark.segmentation_mm = landmark.seating_mm = landmark.seating_deg = 0.0;
  kerf.landmark_mm = kerf.segmentation_mm = kerf.seating_mm = kerf.seating_deg = 0.0;
  segmentation.landmark_mm = segmentation.kerf_mm = segmentation.seating_mm = segmentation.seating_deg = 0.0;
  seating.landmark_mm = seating.kerf_mm = seating.segmentation_mm = 0.0;
  const std::vector<double> all = half_widths(through, asked, values);
  std::vector<std::pair<const char*, std::vector<double>>> sources;
  for (const auto& [name, alone] : {std::pair("landmarks", landmark), std::pair("kerf", kerf),
                                    std::pair("segmentation", segmentation), std::pair("seating", seating)})
    sources.emplace_back(name, half_widths(through, alone, values));
  std::vector<DoubtfulNumber> doubts;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Number& number = through.numbers()[i];
    DoubtfulNumber& doubt = doubts.emplace_back(
        DoubtfulNumber{number.what, number.of, values[i], number.unit, all[i], verify::claimed_coverage, {}});
    for (const auto& [name, widths] : sources)
      if (widths[i] > 1e-9) doubt.sources.push_back({name, widths[i]});
  }
  return {{"doubts", print_value(doubts)}, {"findings", through.findings()}};
}

}  // namespace octotomy::planner
