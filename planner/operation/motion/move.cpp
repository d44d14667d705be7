// SPDX-License-Identifier: AGPL-3.0-or-later
// A rigid motion, stated in one of four ways:
//   a turn, then a translation: numbers in LPS, along the directions of the head, or from one mark to another;
//   points and their target positions (Ong 1992, 8.3);
//   a matrix, as `register` prints it;
//   the motion of an earlier step.
#include "planner/operation/motion/move.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "brep/mesh/move.h"
#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/anatomy/motion_of_points.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

struct Move {
  struct Rotation {
    double degrees = 0.0;
    std::optional<glm::dvec3> axis;
    Mark about_mm;
    std::vector<Mark> through;
  };
  struct Turn : Turns {
    Mark about_mm;
  };
  struct Point : Displacement {
    Mark at;
    std::optional<Mark> to;
  };
  ObjectName object;
  std::optional<glm::dvec3> translate_mm;
  std::optional<Rotation> rotate;
  std::optional<Turn> turn;
  std::optional<Displacement> by;
  std::vector<Mark> along;
  std::optional<Mark> from, to;
  std::vector<Point> points;
  std::optional<std::string> fit;
  std::optional<glm::dmat4> matrix;
  std::optional<ObjectName> with;
};

bool is_translated(const Move& move) {
  return move.translate_mm || move.by || move.from;
}
bool is_turned(const Move& move) {
  return move.rotate || move.turn;
}

std::string name_of(const Mark& mark) {
  if (mark.landmark.empty())
    return "(" + plain(mark.p_mm.x) + ", " + plain(mark.p_mm.y) + ", " + plain(mark.p_mm.z) + ")";
  return mark.landmark + (mark.object.empty() ? "" : "@" + mark.object);
}

std::vector<WantedPoint> wanted_points(const Move& move, const MarkPlaces& places) {
  std::vector<WantedPoint> wanted;
  for (const Move::Point& point : move.points) {
    const glm::dvec3 from_mm = places.mark_mm(point.at);
    wanted.push_back({name_of(point.at), from_mm,
                      point.to ? places.mark_mm(*point.to) : from_mm + lps_mm(point, places.lps_from_head)});
  }
  return wanted;
}

/// The directions along which 'by' is stated: those of the head, or of a plane through a front point, a right
/// and a left point, such as the occlusal plane. Throws std::invalid_argument if these three lie on one line.
glm::dmat3 directions_of(const Move& move, const MarkPlaces& places) {
  if (move.along.empty()) return places.lps_from_head;
  const glm::dvec3 right = places.mark_mm(move.along[1]), left = places.mark_mm(move.along[2]);
  const glm::dvec3 front = places.mark_mm(move.along[0]) - 0.5 * (right + left);
  const glm::dvec3 up = glm::cross(front, left - right);
  if (!(glm::length(up) > 1e-3 * glm::length(front) * glm::length(left - right)))
    throw voxel::InvalidInput("'along' has its three points on one line, which does not determine a plane");
  const glm::dvec3 forward = glm::normalize(front);
  return {glm::cross(glm::normalize(up), forward), -forward, glm::normalize(up)};
}

PointFit fit_of(const Move& move) {
  return move.fit.value_or("best") == "first_point" ? PointFit::FirstPoint : PointFit::Best;
}

glm::dmat4 about_point(const glm::dmat3& turn, const glm::dvec3& p_mm) {
  glm::dmat4 motion(turn);
  motion[3] = glm::dvec4(p_mm - turn * p_mm, 1.0);
  return motion;
}

/// The rotation about the stated axis or pivot; the identity if there is no rotation.
glm::dmat4 turn_of(const Move& move, const MarkPlaces& places) {
  if (move.turn)
    return about_point(rotation_of(*move.turn, places.lps_from_head), places.mark_mm(move.turn->about_mm));
  if (!move.rotate) return glm::dmat4(1.0);
  voxel::Motion motion;
  motion.degrees = move.rotate->degrees;
  if (move.rotate->through.empty()) {
    motion.axis = *move.rotate->axis;
    motion.about_mm = places.mark_mm(move.rotate->about_mm);
  } else {
    motion.about_mm = places.mark_mm(move.rotate->through[0]);
    motion.axis = places.mark_mm(move.rotate->through[1]) - motion.about_mm;
  }
  return voxel::moved_from_still(motion);
}

/// The motion of a move. Throws std::invalid_argument if points or an axis do not determine it.
glm::dmat4 motion_of(const Move& move, const MarkPlaces& places) {
  if (move.matrix) return *move.matrix;
  if (move.with) {
    const glm::dmat4 motion = places.motion_of(move.with->name);
    if (!is_rigid(motion))
      throw voxel::InvalidInput(
          "'" + move.with->name +
          "' was scaled or sheared, but a move must be rigid: name the result of a rigid motion");
    return motion;
  }
  if (!move.points.empty())
    return motion_of_points(wanted_points(move, places), fit_of(move)).moved_from_still;
  glm::dvec3 by_mm = move.translate_mm.value_or(glm::dvec3(0.0));
  if (move.by) by_mm += lps_mm(*move.by, directions_of(move, places));
  if (move.from) by_mm += places.mark_mm(*move.to) - places.mark_mm(*move.from);
  if (!is_turned(move) || (move.rotate && move.rotate->through.empty())) {
    // One call, because results of plans without landmarks must not change by a bit.
    voxel::Motion motion;
    motion.translate_mm = by_mm;
    if (move.rotate) {
      motion.degrees = move.rotate->degrees;
      motion.axis = *move.rotate->axis;
      motion.about_mm = places.mark_mm(move.rotate->about_mm);
    }
    return voxel::moved_from_still(motion);
  }
  return glm::translate(glm::dmat4(1.0), by_mm) * turn_of(move, places);
}

void check_ways(const Move& move, const FieldLocation& place) {
  const bool by_parts = is_translated(move) || is_turned(move) || move.to;
  const int ways =
      int{by_parts} + int{!move.points.empty()} + int{move.matrix.has_value()} + int{move.with.has_value()};
  if (ways == 0)
    place.refuse(
        "moves nothing: add 'translate_mm', 'rotate' or both, 'by' and 'turn', 'from' and 'to', "
        "'points', 'matrix' or 'with'");
  if (ways > 1)
    place.refuse(
        "states its motion twice: keep only 'points', only 'matrix', only 'with', or only translations and "
        "rotations");
  if (move.from.has_value() != move.to.has_value())
    place.refuse(std::string("'") + (move.from ? "to" : "from") +
                 "' is missing: add it, because the translation leads from one mark to another");
  if (!move.along.empty() && !move.by)
    place.at("along").refuse("applies only to 'by': add 'by', or leave it out");
  if (move.rotate && move.turn)
    place.refuse("states its rotation twice, as 'rotate' and 'turn': keep one of them");
}

void check(const Move& move, const FieldLocation& place) {
  check_ways(move, place);
  if (move.rotate) {
    const FieldLocation rotate = place.at("rotate");
    if (move.rotate->axis.has_value() == !move.rotate->through.empty())
      rotate.refuse(move.rotate->axis ? "states its axis twice, as 'axis' and 'through': keep one of them"
                                      : "'axis' is missing: add it, or the two points 'through'");
  }
  if (move.matrix && !is_rigid(*move.matrix))
    place.at("matrix").refuse(
        "is not a rigid motion: its first three columns must be a rotation, and its last row [0, 0, 0, 1]; "
        "to scale and shear, use 'affine'");
  for (std::size_t i = 0; i < move.points.size(); ++i) {
    const Move::Point& point = move.points[i];
    const bool is_typed = point.forward_mm != 0.0 || point.left_mm != 0.0 || point.up_mm != 0.0;
    if (point.to && is_typed)
      place.at("points[" + std::to_string(i) + "]")
          .refuse("has two targets: keep either 'to' or the millimetres");
  }
  if (move.with && place.scope != nullptr) {
    const Operation& maker = place.scope->maker_of(move.with->name);
    if (!maker.is_motion)
      place.at("with").refuse("'" + move.with->name + "' was made by '" + maker.name +
                              "', which moves nothing: name the result of a step that moves an object");
    return;
  }
  // Positions of marks that move with objects are not known before the earlier motions are evaluated.
  std::vector<Mark> marks{move.from.value_or(Mark{}), move.to.value_or(Mark{})};
  if (move.turn) marks.push_back(move.turn->about_mm);
  if (move.rotate) marks.push_back(move.rotate->about_mm);
  if (move.rotate) marks.insert(marks.end(), move.rotate->through.begin(), move.rotate->through.end());
  marks.insert(marks.end(), move.along.begin(), move.along.end());
  for (const Move::Point& point : move.points) {
    marks.push_back(point.at);
    marks.push_back(point.to.value_or(Mark{}));
  }
  for (const Mark& mark : marks)
    if (!mark.object.empty()) return;
  const Objects none;
  try {
    motion_of(move, places_of(none));
  } catch (const std::invalid_argument& error) {
    if (fault_of(error) != Fault::Input) throw;
    (move.points.empty() ? place : place.at("points")).refuse(error.what());
  }
}

std::string definition(const Move& move, const Objects&) {
  const std::string& name = move.object.name;
  if (move.with) return name + " moved with " + move.with->name;
  if (move.matrix) return name + " moved by a matrix";
  if (!move.points.empty()) {
    std::string text;
    for (const Move::Point& point : move.points) text += (text.empty() ? "" : ", ") + name_of(point.at);
    return name + " moved by " + text + (fit_of(move) == PointFit::Best ? "" : ", the first one exactly");
  }
  const glm::dvec3 by_mm = move.translate_mm.value_or(glm::dvec3(0.0));
  std::string text;
  if (move.translate_mm || !(move.by || move.from || move.turn))
    text = " moved by (" + plain(by_mm.x) + ", " + plain(by_mm.y) + ", " + plain(by_mm.z) + ") mm";
  if (move.by) text += (text.empty() ? " moved " : ", ") + in_words(*move.by);
  if (!move.along.empty()) text += " along the plane of " + name_of(move.along[0]);
  if (move.from)
    text += (text.empty() ? " moved from " : ", from ") + name_of(*move.from) + " to " + name_of(*move.to);
  if (move.rotate) text += ", turned by " + plain(move.rotate->degrees) + "\u00b0";
  if (move.turn)
    text +=
        (text.empty() ? " turned, " : ", ") + in_words(*move.turn) + " about " + name_of(move.turn->about_mm);
  return name + text;
}

void voxels(const Move& move, const VoxelBench& bench, VoxelSide& made) {
  move_voxels(move.object.name, motion_of(move, places_of(bench.objects)), bench, made);
}

void triangles(const Move& move, const MeshBench& bench, MeshSide& made) {
  move_triangles(move.object.name, motion_of(move, places_of(bench.objects)), bench, made);
}

/// For each point its target, its position after the motion, and the remaining distance, as JSON.
Json points_json(const Move& move, const Objects& objects) {
  const std::vector<WantedPoint> wanted = wanted_points(move, places_of(objects));
  const PointMotion found = motion_of_points(wanted, fit_of(move));
  Json points = Json::array();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const glm::dvec3 comes(found.moved_from_still * glm::dvec4(wanted[i].from_mm, 1.0));
    const auto along = [&](const glm::dvec3& by_mm) { return displacement_of(by_mm, objects.lps_from_head); };
    const Displacement got = along(comes - wanted[i].from_mm);
    points.push_back({{"name", wanted[i].name},
                      {"wanted", in_words(along(wanted[i].to_mm - wanted[i].from_mm))},
                      {"achieved", in_words(got)},
                      {"forward_mm", got.forward_mm},
                      {"left_mm", got.left_mm},
                      {"up_mm", got.up_mm},
                      {"residual_mm", found.residuals_mm[i]}});
  }
  return {{"fit", move.fit.value_or("best")}, {"points", points}, {"rms_mm", found.rms_mm}};
}

void bound(const Move& move, const BoundBench& bench, Object& made) {
  carry(move.object.name, motion_of(move, places_of(bench.objects)), bench, made);
  if (!move.points.empty()) made.moved->details = points_json(move, bench.objects);
}

}  // namespace

MarkPlaces places_of(const Objects& objects) {
  return {[&objects](const Mark& mark) { return mark_mm(mark, objects); }, objects.lps_from_head,
          [&objects](const std::string& name) { return objects.at(name).moved->motion; }};
}

std::optional<glm::dmat4> motion_of(const Action& action, const MarkPlaces& places) {
  const Move* move = action.get_if<Move>();
  if (move == nullptr) return std::nullopt;
  return motion_of(*move, places);
}

void move_voxels(const std::string& object, const glm::dmat4& moved_from_still, const VoxelBench& bench,
                 VoxelSide& made) {
  const Object& still = bench.objects.at(object);
  if (is_voxelised(still))
    return voxelise(brep::moved(*still.mesh.whole, moved_from_still), bench.universe, made);
  made.symbol = moved(*bench.object(object).symbol, moved_from_still);
  made.octree = bench.combined(*made.symbol);
  made.lineage = "the object's own definition under a rigid motion, windows on interpolated samples";
}

void move_triangles(const std::string& object, const glm::dmat4& moved_from_still, const MeshBench& bench,
                    MeshSide& made) {
  const Stopwatch watch(bench.timings, "boolean_mesh");
  made.whole = brep::moved(bench.object(object), moved_from_still);
  made.lineage = "vertices of a mesh under a rigid motion";
}

Operation move_operation() {
  using Rotation = Move::Rotation;
  using Turn = Move::Turn;
  using Point = Move::Point;
  const auto along = [](auto forward, auto left, auto up) {
    return std::vector<Field>{
        field("forward_mm", forward, "Forward along the head's direction; negative: back."),
        field("left_mm", left, "To the patient's left; negative: right."),
        field("up_mm", up, "Upwards; negative: down.")};
  };
  std::vector<Field> point =
      along(static_cast<double Point::*>(&Point::forward_mm), static_cast<double Point::*>(&Point::left_mm),
            static_cast<double Point::*>(&Point::up_mm));
  point.insert(point.begin(),
               field("at", &Point::at, "The point before the motion: [x, y, z] or a landmark.").required());
  point.push_back(field("to", &Point::to, "Its target: [x, y, z] or a landmark, instead of millimetres."));
  return Describe<Move>("move", "Moves an object: rotates it, then translates it.", Makes::Object)
      .takes(field("object", &Move::object, "The object.").required())
      .takes(field("translate_mm", &Move::translate_mm, "The translation [x, y, z], LPS."))
      .takes(
          record("rotate", &Move::rotate, "The rotation, done before the translation.",
                 {field("degrees", &Rotation::degrees, "The angle, right-handed about the axis.").required(),
                  field("axis", &Rotation::axis, "The direction of the axis, LPS.").direction(),
                  field("about_mm", &Rotation::about_mm, "A point on the axis, LPS, or a landmark."),
                  field("through", &Rotation::through,
                        "Two points on the axis, instead of 'axis', for example both condyles.")
                      .from(2)
                      .to(2)}))
      .takes(record("by", &Move::by, "The translation along the head's directions.",
                    along(&Displacement::forward_mm, &Displacement::left_mm, &Displacement::up_mm)))
      .takes(field("along", &Move::along,
                   "Three points of a plane whose directions 'by' uses instead of the head's, such as the "
                   "occlusal plane: a front point, a right one and a left one.")
                 .from(3)
                 .to(3))
      .takes(record("turn", &Move::turn,
                    "The rotation about the head's directions, done before the translation: roll, then "
                    "pitch, then yaw.",
                    {field("pitch_deg", static_cast<double Turn::*>(&Turn::pitch_deg), "The front goes up."),
                     field("yaw_deg", static_cast<double Turn::*>(&Turn::yaw_deg),
                           "The front goes to the patient's left."),
                     field("roll_deg", static_cast<double Turn::*>(&Turn::roll_deg),
                           "The patient's left side goes up."),
                     field("about_mm", &Turn::about_mm, "The pivot: [x, y, z] or a landmark.").required()}))
      .takes(
          field("from", &Move::from, "With 'to': the translation from this mark, [x, y, z] or a landmark."))
      .takes(field("to", &Move::to, "The mark to which 'from' is translated."))
      .takes(records("points", &Move::points,
                     "Points with their targets; the motion is the one that brings them nearest to these.",
                     point))
      .takes(field("fit", &Move::fit,
                   "How points are fitted: best (default) by least squares; first_point moves the first "
                   "point exactly to its target, then rotates about it.")
                 .one_of({"best", "first_point"}))
      .takes(field("matrix", &Move::matrix,
                   "The motion as four rows of four numbers, LPS, in the form that register prints."))
      .takes(field("with", &Move::with,
                   "The object of an earlier step, such as move or register, whose motion is repeated."))
      .example(R"({"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 2],
        "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, -40, -30]}})")
      .motion()
      .of_head()
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
