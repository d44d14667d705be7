// SPDX-License-Identifier: AGPL-3.0-or-later
// Seats an object on another one so that they touch at stated places, as a mandible on the upper teeth. With
// one place the object only slides along the direction, with two it also tilts, with three or more it is
// seated. The motion is determined first, on meshes, so that both kernels use the same motion.
//
// 1. For each place, compute the smallest signed distance from the object's vertices around it to the other
//    surface.
// 2. The rigid motion whose displacements along the direction are those distances, in least squares.
// 3. Again, as the nearest vertices change, until no place is farther off than the tolerance.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "brep/mesh/move.h"
#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/measure/near_surfaces.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/motion/first_contact.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Occlude {
  ObjectName object, against;
  std::vector<Mark> places;
  std::string towards = "up";
  double about_mm = 3.0, gap_mm = 0.0, most_mm = 20.0;
  // Settled.
  glm::dmat4 moved_from_still{1.0};
  std::vector<double> residuals_mm;
  double deepest_mm = 0.0;
};

/// The tolerance of a contact in mm, a small fraction of a voxel, because contacts are not more precise.
double tolerance_mm(const Object& object) {
  return 0.02 * voxel_mm(object);
}

/// A target place of contact, and the points of the surface around it.
struct Seat {
  glm::dvec3 place_mm;
  std::vector<glm::dvec3> points_mm;
};

void check(const Occlude& asked, const FieldLocation& place) {
  if (asked.object.name == asked.against.name)
    place.at("against").refuse("is the object itself: name the object that it is seated on");
}

/// The direction of the word up or down as a unit vector, LPS.
glm::dvec3 direction_of(const std::string& word, const glm::dmat3& lps_from_head) {
  Displacement by;
  by.up_mm = word == "up" ? 1.0 : -1.0;
  return lps_mm(by, lps_from_head);
}

/// A small rigid motion that displaces each place along the direction by its distance, as a least-squares
/// fit. If several motions do, the one with the smallest rotation.
glm::dmat4 step_of(const std::vector<glm::dvec3>& places_mm, const std::vector<double>& distances_mm,
                   const glm::dvec3& along) {
  glm::dvec3 middle(0.0);
  double lift = 0.0;
  for (std::size_t i = 0; i < places_mm.size(); ++i)
    middle += places_mm[i] / static_cast<double>(places_mm.size()),
        lift += distances_mm[i] / static_cast<double>(places_mm.size());
  // The slopes across the direction solve a 2 x 2 system. A small ridge term makes it solvable if the places
  // lie on one line.
  const glm::dvec3 u =
      glm::normalize(glm::cross(along, std::abs(along.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 v = glm::cross(along, u);
  glm::dmat2 normal(0.0);
  glm::dvec2 right(0.0);
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    const glm::dvec2 p(glm::dot(places_mm[i] - middle, u), glm::dot(places_mm[i] - middle, v));
    normal += glm::outerProduct(p, p);
    right += p * (distances_mm[i] - lift);
  }
  const double ridge = 1e-9 * (1.0 + normal[0][0] + normal[1][1]);
  const glm::dvec2 slope = glm::inverse(normal + glm::dmat2(ridge)) * right;
  const glm::dvec3 turn = glm::cross(slope.x * u + slope.y * v, along);
  glm::dmat4 motion = glm::translate(glm::dmat4(1.0), lift * along);
  // One step rotates by at most 0.1 rad, because a place far from the others could cause a large rotation.
  if (const double angle = glm::length(turn); angle > 1e-12)
    motion = motion * glm::translate(glm::dmat4(1.0), middle) *
             glm::rotate(glm::dmat4(1.0), std::min(angle, 0.1), turn / angle) *
             glm::translate(glm::dmat4(1.0), -middle);
  return motion;
}

std::vector<Seat> seats_of(const Occlude& asked, const brep::Solid& solid, const Objects& objects,
                           double spacing_mm) {
  std::vector<Seat> seats;
  for (const Mark& mark : asked.places) {
    const glm::dvec3 place_mm = mark_mm(mark, objects);
    Seat seat{place_mm, points_about(solid, place_mm, asked.about_mm, 0.5 * spacing_mm)};
    if (seat.points_mm.empty())
      throw std::runtime_error("'" + asked.object.name + "' has no surface within " + plain(asked.about_mm) +
                               " mm of place " + std::to_string(seats.size() + 1) +
                               ": choose places on its surface, or raise 'about_mm'");
    seats.push_back(std::move(seat));
  }
  return seats;
}

double least_of(const std::vector<glm::dvec3>& points_mm, const glm::dmat4& motion,
                const brep::Solid& against) {
  std::vector<glm::dvec3> there;
  there.reserve(points_mm.size());
  for (const glm::dvec3& p : points_mm) there.emplace_back(motion * glm::dvec4(p, 1.0));
  const std::vector<double> distances_mm = signed_distances_mm(against, there);
  return *std::min_element(distances_mm.begin(), distances_mm.end());
}

Occlude settle(const Occlude& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "occlude");
  const Object& object = bench.objects.at(asked.object.name);
  const brep::Solid &solid = bench.object(asked.object.name), &against = bench.object(asked.against.name);
  if (solid.empty() || against.empty())
    throw std::runtime_error("'" + (solid.empty() ? asked.object.name : asked.against.name) +
                             "' is empty, so it cannot touch anything");
  const glm::dvec3 along = direction_of(asked.towards, bench.objects.lps_from_head);
  const std::vector<Seat> seats = seats_of(asked, solid, bench.objects, voxel_mm(object));
  Occlude settled = asked;
  constexpr int most_rounds = 200;
  for (int round = 0; round < most_rounds; ++round) {
    if (bench.progress.stop.stop_requested()) throw voxel::Stopped("stopped while seating");
    std::vector<glm::dvec3> places_mm;
    settled.residuals_mm.clear();
    double worst = 0.0;
    for (const Seat& seat : seats) {
      places_mm.emplace_back(settled.moved_from_still * glm::dvec4(seat.place_mm, 1.0));
      settled.residuals_mm.push_back(least_of(seat.points_mm, settled.moved_from_still, against) -
                                     asked.gap_mm);
      worst = std::max(worst, std::abs(settled.residuals_mm.back()));
    }
    if (worst <= tolerance_mm(object)) break;
    settled.moved_from_still = step_of(places_mm, settled.residuals_mm, along) * settled.moved_from_still;
    for (const Seat& seat : seats)
      if (glm::distance(glm::dvec3(settled.moved_from_still * glm::dvec4(seat.place_mm, 1.0)),
                        seat.place_mm) > asked.most_mm)
        throw std::runtime_error("'" + asked.object.name + "' does not reach '" + asked.against.name +
                                 "' at all places within " + plain(asked.most_mm) +
                                 " mm: check 'towards' and the places, or raise 'most_mm'");
  }
  settled.deepest_mm = std::max(
      0.0, -least_distance_mm(brep::moved(solid, settled.moved_from_still), against, 0.5 * voxel_mm(object)));
  return settled;
}

std::string definition(const Occlude& asked, const Objects&) {
  return asked.object.name + " seated on " + asked.against.name + " at " +
         std::to_string(asked.places.size()) + (asked.places.size() == 1 ? " place" : " places");
}

void bound(const Occlude& asked, const BoundBench& bench, Object& made) {
  move_bound(asked, bench, made);
  made.moved->details = {{"distances_at_places_mm", asked.residuals_mm}, {"deepest_mm", asked.deepest_mm}};
  const double allowed_mm = voxel_mm(made);
  for (std::size_t i = 0; i < asked.residuals_mm.size(); ++i)
    if (std::abs(asked.residuals_mm[i]) > 0.5 * allowed_mm)
      made.findings.push_back("place " + std::to_string(i + 1) + " stays " +
                              three_figures(std::abs(asked.residuals_mm[i])) +
                              (asked.residuals_mm[i] > 0.0 ? " mm away" : " mm too deep") +
                              ", because no rigid motion touches at all places: state fewer places");
  if (asked.deepest_mm > allowed_mm)
    made.findings.push_back("overlaps '" + asked.against.name + "' by up to " +
                            three_figures(asked.deepest_mm) + " mm away from the places: add a place there");
}

}  // namespace

Operation occlude_operation() {
  return Describe<Occlude>("occlude", "Moves an object so that it touches another object at stated places.",
                           Makes::Object)
      .takes(field("object", &Occlude::object, "The object to move, such as the mandible.").required())
      .takes(field("against", &Occlude::against, "The object to touch, such as the upper jaw.").required())
      .takes(field("places", &Occlude::places,
                   "The places of contact: points or landmarks on the object. With one place the object "
                   "slides along the direction, with two it also tilts, with three its seat is determined.")
                 .required()
                 .from(1)
                 .to(16))
      .takes(field("towards", &Occlude::towards,
                   "The direction of the movement, relative to the head's position.")
                 .one_of({"up", "down"}))
      .takes(field("about_mm", &Occlude::about_mm, "A contact may lie up to this distance from its place.")
                 .greater_than(0.0)
                 .to(50.0))
      .takes(field("gap_mm", &Occlude::gap_mm, "The distance to the other object that remains at the places.")
                 .from(0.0)
                 .to(20.0))
      .takes(field("most_mm", &Occlude::most_mm, "The largest displacement of a place that is tried.")
                 .greater_than(0.0)
                 .to(200.0))
      .example(R"({"id": "seated", "do": "occlude", "object": "rest", "against": "advanced",
        "places": [[-25, -40, -58], [25, -40, -58], [0, -80, -58]]})")
      .motion()
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, moved_voxels<Occlude>, moved_triangles<Occlude>, bound);
}

}  // namespace octotomy::planner
