// SPDX-License-Identifier: AGPL-3.0-or-later
// A screw's axis, and its distances from the parts that it must not touch: roots, a nerve's canal, saw cuts.
// Each kernel measures with its own version of those objects; the mesh's distance is reported as the result.
//
// A screw at a place in a view of the head enters along that view, where the view's line through the place
// first meets the bone. A flap's screw meets the axis of its segment, where the segment is placed, at a right
// angle and from a side of the head. On the uncut bone it lies where the segment's motion brings it to that
// place.
#include "planner/operation/part/screw.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <stdexcept>

#include "brep/measure/gap.h"
#include "brep/shape/prism.h"
#include "brep/shape/saw.h"
#include "planner/operation/flap/flap_space.h"
#include "planner/operation/measure/gap.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/mask.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/saw.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/saw_blade.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

/// A screw's point may lie this far from the bone's surface, because landmarks are placed by hand.
constexpr double on_surface_mm = 3.0;
/// The default side of a flap's screw, because jaw and fibula are reached from below.
constexpr const char* usual_side = "inferior";

void check(const Screw& screw, const FieldLocation& place) {
  if (screw.flap && (screw.at || screw.direction))
    place.at("flap").refuse("states the axis a second time: leave out 'flap', or 'at' and 'direction'");
  if (screw.side && screw.direction)
    place.at("side").refuse("states the axis a second time: leave out 'side' or 'direction'");
  if (!screw.flap && !screw.at) place.at("at").refuse("is missing: add it, or 'flap'");
  if (!screw.flap && !screw.direction && !screw.side)
    place.at("direction").refuse("is missing: add it, or 'side'");
  if (screw.side) try {
      voxel::parse_view(*screw.side);
    } catch (const voxel::InvalidInput& error) {
      place.at("side").refuse(error.what());
    }
  if (place.scope == nullptr) return;
  for (std::size_t i = 0; i < screw.cuts.size(); ++i) {
    const std::string& maker = place.scope->maker_of(screw.cuts[i].name).name;
    if (maker != "saw" && maker != "mask" && maker != "flap_space")
      place.at("cuts[" + std::to_string(i) + "]")
          .refuse("'" + screw.cuts[i].name + "' was made by '" + maker +
                  "': name a saw step, a mask whose walls are cuts or a flap's space");
  }
  for (const ObjectName& object : screw.away_from)
    if (object.name == screw.object.name)
      place.at("away_from").refuse("names '" + object.name + "', in which the screw sits");
}

/// The gap measured in voxels; none if either object has no voxels.
std::optional<double> voxel_gap_mm(const voxel::Octree& screw, const voxel::Octree& other) {
  if (screw.is_empty() || other.is_empty()) return std::nullopt;
  return gap_between(screw, other, std::nullopt, std::nullopt).voxel_mm;
}

ScrewClear clear_of_object(const Object& object, const brep::Solid& rod, const voxel::Octree& voxels) {
  ScrewClear clear{object.id, false, 0.0, voxel_gap_mm(voxels, object.voxel.octree)};
  const brep::Solid& solid = *object.mesh.whole;
  const bool is_inside = solid.tree().is_inside(rod.triangles().points_mm.front());
  if (!is_inside) clear.mesh_mm = brep::gap(rod.triangles(), solid.triangles()).distance_mm;
  return clear;
}

/// The distance in mm of a screw from the walls of a mask or of a flap's space, measured on either side of
/// them; or from the bone that a saw removes.
ScrewClear clear_of_cut(const Object& object, const Action& maker, const brep::Solid& rod,
                        const voxel::Octree& voxels, const std::filesystem::path& folder) {
  const voxel::Universe universe = voxels.universe();
  if (const Saw* typed = maker.get_if<Saw>()) {
    const Saw sawn = with_plane_read(*typed, folder);
    const Saw* const saw = &sawn;
    const brep::Solid blade = brep::saw_blade({saw->line_mm, *saw->direction, saw->depth_mm, saw->kerf_mm});
    const voxel::Octree taken = voxel::combine(
        universe, voxel::saw_blade({saw->line_mm, *saw->direction, saw->depth_mm, saw->kerf_mm}));
    return {object.id, true,
            blade.tree().is_inside(rod.triangles().points_mm.front())
                ? 0.0
                : brep::gap(rod.triangles(), blade.triangles()).distance_mm,
            voxel_gap_mm(voxels, taken)};
  }
  ScrewClear clear{
      object.id, true, brep::gap(rod.triangles(), object.mesh.whole->triangles()).distance_mm, {}};
  const voxel::Octree within =
      voxel::combine(universe, voxel::Expression(voxels) & voxel::Expression(object.voxel.octree));
  const bool is_inside = !within.is_empty();
  clear.voxel_mm =
      voxel_gap_mm(voxels, is_inside ? voxel::combine(universe, ~voxel::Expression(object.voxel.octree))
                                     : object.voxel.octree);
  return clear;
}

void need_mesh(const Object& object) {
  if (!object.mesh.whole || object.mesh.whole->empty())
    throw std::runtime_error("'" + object.id +
                             "' has no mesh, so no distance to it can be measured: see its findings");
}

std::vector<ScrewClear> clearances(const Screw& screw, const SettleBench& bench) {
  const Object& bone = bench.objects.at(screw.object.name);
  const brep::Solid body = rod(screw.head_mm, screw.tip_mm, 0.5 * screw.diameter_mm);
  const voxel::Octree voxels = voxel::combine(
      bone.voxel.octree.universe(),
      voxel::Expression(voxel::Cylinder{screw.head_mm, screw.tip_mm, 0.5 * screw.diameter_mm}));
  std::vector<ScrewClear> found = clear_of_objects(
      {{}, {}, screw.head_mm, *screw.direction, screw.diameter_mm, screw.length_mm}, screw.away_from, bench);
  for (const ObjectName& name : screw.cuts) {
    const Object& object = bench.objects.at(name.name);
    const Action* maker = bench.maker_of ? bench.maker_of(name.name) : nullptr;
    if (maker == nullptr)
      throw std::runtime_error("'" + name.name +
                               "' is not a step of this plan: name a saw step, a mask or a flap's space");
    if (maker->get_if<Saw>() == nullptr) need_mesh(object);
    found.push_back(clear_of_cut(object, *maker, body, voxels, bench.folder));
  }
  return found;
}

std::string in_words(const ScrewClear& clear) {
  return clear.is_cut ? "the cut '" + clear.object + "'" : "'" + clear.object + "'";
}

void report(const Screw& screw, const std::vector<ScrewClear>& clearances, const SettleBench& bench) {
  const voxel::Universe universe = bench.objects.at(screw.object.name).voxel.octree.universe();
  // Each digitised surface may be displaced by half a voxel's diagonal.
  const double voxel_error_mm = glm::length(universe.lattice().spacing_mm());
  bench.details["clearances"] = nlohmann::ordered_json::array();
  for (const ScrewClear& clear : clearances) {
    bench.details["clearances"].push_back(to_json(clear));
    if (std::string text = too_near("the screw", clear, screw.least_mm); !text.empty())
      bench.findings.push_back(std::move(text));
    if (clear.voxel_mm && std::abs(*clear.voxel_mm - clear.mesh_mm) > voxel_error_mm)
      bench.findings.push_back("the kernels disagree about the distance to " + in_words(clear) + ": " +
                               three_figures(clear.mesh_mm) + " mm in meshes, " +
                               three_figures(*clear.voxel_mm) + " mm in voxels");
  }
}

/// The point at which a line enters bone from outside, between two points on it. Throws std::runtime_error
/// that states the remedy if the object has no bone there, or if the first point lies in bone.
glm::dvec3 entry_mm(const std::string& name, const brep::Solid& bone, const glm::dvec3& from_mm,
                    const glm::dvec3& to_mm, const std::string& remedy) {
  constexpr double sample_mm = 0.1;  // thinner walls cannot hold a screw
  const int count = std::max(1, static_cast<int>(std::ceil(glm::distance(from_mm, to_mm) / sample_mm)));
  std::vector<glm::dvec3> places_mm;
  for (int i = 0; i <= count; ++i)
    places_mm.push_back(glm::mix(from_mm, to_mm, static_cast<double>(i) / count));
  const std::vector<std::uint8_t> inside = bone.tree().inside(places_mm);
  const auto first = std::find(inside.begin(), inside.end(), std::uint8_t{1});
  if (first == inside.end())
    throw std::runtime_error("no bone of '" + name + "' lies between " + voxel::rounded(from_mm) + " and " +
                             voxel::rounded(to_mm) + " mm, where the screw would enter it: " + remedy);
  if (first == inside.begin())
    throw std::runtime_error(
        "bone of '" + name + "' reaches farther than " + three_figures(glm::distance(from_mm, to_mm)) +
        " mm from the flap's axis on the side of the screw: raise 'reach_mm' of its flap_space step");
  const auto at = static_cast<std::size_t>(first - inside.begin());
  glm::dvec3 outer_mm = places_mm[at - 1], inner_mm = places_mm[at];
  constexpr int halvings = 20;  // halves the step to a millionth
  for (int i = 0; i < halvings; ++i) {
    const glm::dvec3 middle_mm = 0.5 * (outer_mm + inner_mm);
    (bone.tree().is_inside(middle_mm) ? inner_mm : outer_mm) = middle_mm;
  }
  return 0.5 * (outer_mm + inner_mm);
}

/// The head and direction of a screw at a place of the bone in which it sits.
struct Placed {
  glm::dvec3 head_mm{0.0};
  glm::dvec3 along{0.0, 1.0, 0.0};  ///< unit
};

/// The screw that enters along a view's line through the place, where this line first meets the bone.
Placed seen_from(const glm::dvec3& look, const Screw& asked, const SettleBench& bench) {
  const brep::Solid& bone = bench.object(asked.object.name);
  const glm::dvec3 at_mm = mark_mm(*asked.at, bench.objects);
  const brep::Size& size = bone.size();
  // No point of the bone's bounding box is farther from the place than this.
  const double far_mm = glm::length(glm::max(glm::abs(size.low_mm - at_mm), glm::abs(size.high_mm - at_mm)));
  return {entry_mm(asked.object.name, bone, at_mm - far_mm * look, at_mm + far_mm * look,
                   "move 'at', or choose another 'side'"),
          look};
}

Placed placed(const Screw& asked, const SettleBench& bench) {
  if (!asked.flap && asked.direction)
    return {mark_mm(*asked.at, bench.objects), glm::normalize(*asked.direction)};
  const std::string side = asked.side.value_or(usual_side);
  const glm::dvec3 look = bench.objects.lps_from_head * voxel::parse_view(side).look;
  if (!asked.flap) return seen_from(look, asked, bench);
  const Action* maker = bench.maker_of ? bench.maker_of(asked.flap->name) : nullptr;
  const FlapPlace place = flap_place(maker, asked.flap->name, asked.share);
  const glm::dvec3 square = look - place.along * glm::dot(look, place.along);
  constexpr double least_across = 0.5;
  if (glm::length(square) < least_across)
    throw std::runtime_error("the view from '" + side +
                             "' is less than 30 degrees off the flap's axis: choose another 'side'");
  const glm::dvec3 along = glm::normalize(square);
  const glm::dmat4 motion = place.uncut_from_placed.value_or(glm::dmat4(1.0));
  const auto here_mm = [&](double depth_mm) {
    return glm::dvec3(motion * glm::dvec4(place.on_axis_mm + depth_mm * along, 1.0));
  };
  return {entry_mm(asked.object.name, bench.object(asked.object.name), here_mm(-place.reach_mm),
                   here_mm(place.reach_mm), "change 'share', or choose another 'side'"),
          glm::dmat3(motion) * along};
}

Screw settle(const Screw& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "screw");
  Screw made = asked;
  const brep::Solid& bone = bench.object(asked.object.name);
  if (bone.empty())
    throw std::runtime_error("'" + asked.object.name + "' is empty, so it cannot hold a screw");
  const Placed at = placed(asked, bench);
  made.head_mm = at.head_mm;
  made.direction = at.along;
  std::uint32_t start = 0;
  const double off_mm = bone.tree().distance_mm(made.head_mm, start);
  if (off_mm > on_surface_mm)
    throw std::runtime_error("the point " + voxel::rounded(made.head_mm) + " mm lies " +
                             three_figures(off_mm) + " mm off the surface of '" + asked.object.name +
                             "': choose a point on that surface");
  made.tip_mm = made.head_mm + asked.length_mm * at.along;
  bench.details = {
      {"head_mm", to_json(made.head_mm)}, {"tip_mm", to_json(made.tip_mm)}, {"off_surface_mm", off_mm}};
  // The axis is sampled. If no sample lies in bone, the screw points out of the bone.
  constexpr int samples = 32;
  int inside = 0;
  for (int i = 0; i < samples; ++i)
    if (bone.tree().is_inside(glm::mix(made.head_mm, made.tip_mm, (i + 0.5) / samples))) ++inside;
  if (inside == 0)
    throw std::runtime_error("the screw does not enter '" + asked.object.name +
                             "': point 'direction' from its head into the bone");
  bench.details["in_bone_mm"] = asked.length_mm * inside / samples;
  report(made, clearances(made, bench), bench);
  return made;
}

std::string definition(const Screw& screw, const Objects&) {
  return "screw of " + plain(screw.diameter_mm) + " x " + plain(screw.length_mm) + " mm in " +
         screw.object.name;
}

void voxels(const Screw& screw, const VoxelBench& bench, VoxelSide& made) {
  const voxel::Expression body(voxel::Cylinder{screw.head_mm, screw.tip_mm, 0.5 * screw.diameter_mm});
  made.symbol = bench.within_universe(body);
  made.octree = bench.combined(body);
  made.lineage = "a cylinder at voxel centres";
}

void triangles(const Screw& screw, const MeshBench&, MeshSide& made) {
  made.whole = rod(screw.head_mm, screw.tip_mm, 0.5 * screw.diameter_mm);
  made.lineage = "a prism of 48 sides";
}

void bound(const Screw&, const BoundBench&, Object&) {}

}  // namespace

std::vector<ScrewClear> clear_of_objects(const ScrewAxis& axis, const std::vector<ObjectName>& away_from,
                                         const SettleBench& bench) {
  std::vector<ScrewClear> found;
  const glm::dvec3 tip_mm = axis.head_mm + axis.length_mm * axis.along;
  const brep::Solid body = rod(axis.head_mm, tip_mm, 0.5 * axis.diameter_mm);
  for (const ObjectName& name : away_from) {
    const Object& object = bench.objects.at(name.name);
    need_mesh(object);
    const voxel::Octree voxels =
        voxel::combine(object.voxel.octree.universe(),
                       voxel::Expression(voxel::Cylinder{axis.head_mm, tip_mm, 0.5 * axis.diameter_mm}));
    found.push_back(clear_of_object(object, body, voxels));
  }
  return found;
}

nlohmann::ordered_json to_json(const ScrewClear& clear) {
  nlohmann::ordered_json line{{"object", clear.object},
                              {"is_cut", clear.is_cut},
                              {"distance_mm", clear.mesh_mm},
                              {"voxel_distance_mm", nullptr}};
  if (clear.voxel_mm) line["voxel_distance_mm"] = *clear.voxel_mm;
  return line;
}

std::string too_near(const std::string& screw, const ScrewClear& clear, double least_mm) {
  if (clear.mesh_mm <= 0.0)
    return screw + " goes into " + in_words(clear) + ": move its point or turn its direction";
  if (clear.mesh_mm >= least_mm) return {};
  return screw + " comes within " + three_figures(clear.mesh_mm) + " mm of " + in_words(clear) +
         ", less than the " + three_figures(least_mm) +
         " mm of 'least_mm': move its point or turn its direction";
}

brep::Solid rod(const glm::dvec3& from_mm, const glm::dvec3& to_mm, double radius_mm) {
  constexpr int sides = 48;
  const double turn = 2.0 * glm::pi<double>() / sides;
  // The radius of the corners of a polygon that has the area of the disc.
  const double corner_mm = radius_mm * std::sqrt(turn / std::sin(turn));
  brep::Prism prism;
  prism.look = glm::normalize(to_mm - from_mm);
  const glm::dvec3 aside = std::abs(prism.look.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  prism.right = glm::normalize(glm::cross(prism.look, aside));
  prism.up = glm::cross(prism.right, prism.look);
  const glm::dvec2 middle(glm::dot(from_mm, prism.right), glm::dot(from_mm, prism.up));
  std::vector<glm::dvec2>& polygon = prism.polygons_mm.emplace_back();
  for (int i = 0; i < sides; ++i)
    polygon.push_back(middle + corner_mm * glm::dvec2(std::cos(i * turn), std::sin(i * turn)));
  prism.from_mm = glm::dot(from_mm, prism.look);
  prism.to_mm = glm::dot(to_mm, prism.look);
  return brep::solid_of(prism);
}

ScrewAxis screw_axis(const std::string& name, const SettleBench& bench) {
  const Object& object = bench.objects.at(name);
  const Object& still = still_of(bench.objects, object);
  const Action* maker = bench.maker_of ? bench.maker_of(still.id) : nullptr;
  const Screw* screw = maker == nullptr ? nullptr : maker->get_if<Screw>();
  if (screw == nullptr)
    throw std::runtime_error("'" + name + "' is not a screw: name a screw step, or a screw that was moved");
  if (object.image && !keeps_lengths(object.image->image_from_object))
    throw std::runtime_error("'" + name +
                             "' is scaled or sheared, but a screw must keep its shape: move it rigidly");
  const glm::dmat4 image = object.image ? object.image->image_from_object : glm::dmat4(1.0);
  const Placed at = placed(*screw, bench);
  return {name,
          screw->object.name,
          glm::dvec3(image * glm::dvec4(at.head_mm, 1.0)),
          glm::dmat3(image) * at.along,
          screw->diameter_mm,
          screw->length_mm};
}

std::optional<double> hole_off_mm(const brep::Solid& solid, const ScrewAxis& axis, double radius_mm) {
  constexpr double near_mm = 0.05;  // allows for the corners of the hole's prism and for their rounding
  const glm::dvec3 aside = std::abs(axis.along.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis.along, aside)), v = glm::cross(axis.along, u);
  // Fits the circle u^2 + v^2 = 2 a u + 2 b v + c. The sums run over all points.
  glm::dmat3 sums(0.0);
  glm::dvec3 right(0.0);
  int count = 0;
  for (const glm::dvec3& p_mm : solid.triangles().points_mm) {
    const glm::dvec3 from = p_mm - axis.head_mm;
    const glm::dvec2 q(glm::dot(from, u), glm::dot(from, v));
    if (std::abs(glm::length(q) - radius_mm) > near_mm) continue;
    const glm::dvec3 row(2.0 * q.x, 2.0 * q.y, 1.0);
    sums += glm::outerProduct(row, row);
    right += row * glm::dot(q, q);
    ++count;
  }
  constexpr int least = 12;
  if (count < least || !(std::abs(glm::determinant(sums)) > 0.0)) return std::nullopt;
  const glm::dvec3 found = glm::inverse(sums) * right;
  return std::hypot(found.x, found.y);
}

Operation screw_operation() {
  constexpr auto of_flap = [](const Screw& screw) { return screw.flap.has_value(); };
  const char* const needs_flap = "applies only to 'flap': leave it out";
  return Describe<Screw>(
             "screw",
             "Places a screw. Its axis moves with its bone and determines the holes of guides and plates.",
             Makes::Object)
      .takes(field("object", &Screw::object, "The bone or piece in which the screw sits.").required())
      .takes(field("at", &Screw::at,
                   "The point at which its axis meets the bone's surface; with 'side' it may lie before or "
                   "behind the surface: [x, y, z] or a landmark."))
      .takes(field("direction", &Screw::direction, "The direction from the screw's head to its tip, LPS.")
                 .direction())
      .takes(field("flap", &Screw::flap,
                   "Instead of 'at' and 'direction': the flap_space step of a segment or of the resection. "
                   "The screw meets the axis of that space at a right angle, from 'side'."))
      .takes(
          field(
              "share", &Screw::share,
              "The position on the flap's axis: for a segment from 0 at its first cut to 1 at its second "
              "cut. For the resection it lies in the bone that stays: from -1 at the first point of the "
              "stumps to 0 at the first cut, or from 1 at the last cut to 2 at the last point of the stumps.")
              .from(-1.0)
              .to(2.0)
              .read_if<Screw>(of_flap, needs_flap))
      .takes(field("side", &Screw::side,
                   "The side from which the screw enters, relative to the head's position: anterior, "
                   "posterior, left, right, superior, inferior, or AZ,EL in degrees. It replaces "
                   "'direction': with 'at', the screw enters the bone where 'at' is seen from that side. "
                   "With 'flap', it is the side of the segment in its new place; default: inferior."))
      .takes(field("diameter_mm", &Screw::diameter_mm,
                   "The outer diameter; 2 is usual for plates of the midface.")
                 .from(0.8)
                 .to(6.0))
      .takes(field("length_mm", &Screw::length_mm,
                   "The length below the bone's surface; 5 to 7 are usual in one cortex of the midface.")
                 .from(2.0)
                 .to(60.0))
      .takes(field("away_from", &Screw::away_from,
                   "Objects that the screw must not touch, such as roots or the nerve's canal."))
      .takes(field("cuts", &Screw::cuts,
                   "Saw steps, masks and spaces of flaps in this plan, from whose cuts the screw must keep a "
                   "distance."))
      .takes(field("least_mm", &Screw::least_mm,
                   "The least distance from the screw to 'away_from' and 'cuts'; a smaller distance is a "
                   "finding. 1 is published for screws between roots.")
                 .from(0.0)
                 .to(20.0))
      .example(R"({"id": "left_1", "do": "screw", "object": "maxilla", "at": [18, -80, -34],
        "direction": [0, 1, 0], "length_mm": 5, "cuts": ["sawn"]})")
      .tool()
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
