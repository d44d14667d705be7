// SPDX-License-Identifier: AGPL-3.0-or-later
// Whether a part that is pushed onto its bone can rock: the docking angle, by which the push may deviate at
// the worst place before the part begins to turn or to slide. The room's README defines it.
//
// 1 Each kernel finds the places where bone bears the part, the places that may be pushed, and the angle.
// 2 The mesh's angle is the answer. The voxels' must agree within what a change of the mesh's own contacts by
//   the resolution of voxels does to it.
// 3 Trials lose contacts by random errors of scan and printer. They give the interval.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "brep/measure/docking.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/part/docking_dispute.h"
#include "planner/operation/part/insertion.h"
#include "planner/operation/part/seated_part.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/phantom/chance.h"
#include "voxel/filter/docking.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

struct Rocking {
  ObjectName part;
  std::vector<ObjectName> against;
  Insertion insertion;
  std::optional<glm::dvec3> push;
  std::vector<Mark> at;
  double radius_mm = 5.0;
  double contact_mm = 0.4;
  double scan_mm = 0.2, printer_mm = 0.16;
  int trials = 200;
  int seed = 1;
};

/// Spacing of the contacts and of the pushed points on the mesh.
constexpr double contact_spacing_mm = 1.0;
/// Normals of contacts are averaged over the bone's surface within this distance.
constexpr double smooth_mm = 2.0;
/// The normals of triangles deviate by about a degree, which has the same effect as friction of that angle.
/// Smaller angles therefore count as zero.
constexpr double nothing_deg = 1.0;
/// The errors of scan and printer are constant within patches with this edge.
constexpr double patch_mm = 4.0;
/// Walls whose normal has a smaller cosine with the push, about six degrees, count as parallel to the push.
constexpr double least_facing = 0.1;
/// The voxels' angle of the same contacts may exceed the mesh's by 0.1 % (voxel/filter/docking.h); twice that,
/// and what rounding leaves of an angle of 0.
constexpr double same_contacts_share = 0.002, same_contacts_deg = 0.01;
/// Only this number of the worst points are used in trials.
constexpr std::size_t tried_points = 4;

void check(const Rocking& asked, const FieldLocation& place) {
  check(asked.insertion, place);
  check_against(asked.part, asked.against, place);
}

/// The objects, push direction and points for both kernels.
struct Question {
  const Object& part;
  std::vector<const Object*> against;
  glm::dvec3 push{0.0};
  std::vector<glm::dvec3> at_mm;  ///< the points at which the part is pushed
};

/// The points of a surface within the radius of a line along the push through one of the points, and the
/// points that the user typed.
std::vector<glm::dvec3> pushed_points(const std::vector<glm::dvec3>& surface, const Rocking& asked,
                                      const Question& question) {
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& p : surface)
    for (const glm::dvec3& at : question.at_mm)
      if (glm::length(glm::cross(p - at, question.push)) <= asked.radius_mm) {
        points.push_back(p);
        break;
      }
  // Typed points without a surface near them that faces the push are typing errors, so no points are
  // returned.
  if (points.empty() && asked.radius_mm > 0.0) return points;
  if (!asked.at.empty()) points.insert(points.end(), question.at_mm.begin(), question.at_mm.end());
  return points;
}

std::string in_words(const glm::dvec3& direction) {
  const auto two = [](double value) { return plain(std::round(100.0 * value) / 100.0 + 0.0); };
  return "(" + two(direction.x) + ", " + two(direction.y) + ", " + two(direction.z) + ")";
}
std::string names_of(const Question& question) {
  std::string names;
  for (const Object* object : question.against) names += (names.empty() ? "'" : ", '") + object->id + "'";
  return names;
}

std::vector<brep::DockingContact> mesh_contacts(const Question& question, const Rocking& asked,
                                                const AnswerBench& bench) {
  std::vector<brep::Solid> objects;
  for (const Object* object : question.against) objects.push_back(*object->mesh.within);
  return brep::docking_contacts(*question.part.mesh.within, objects,
                                {asked.contact_mm, contact_spacing_mm, smooth_mm, {bench.stop, {}}});
}

/// The voxel kernel's answer.
struct VoxelAnswer {
  std::vector<brep::DockingContact> contacts;
  std::optional<voxel::Docking> worst;
};

VoxelAnswer answer_by_voxels(const Question& question, const Rocking& asked, const AnswerBench& bench) {
  const voxel::Expression world(voxel::bounds(bench.universe.lattice()));
  const auto placed = [&](const Object& object) { return *object.voxel.symbol & world; };
  const voxel::Expression part_solid = placed(question.part);
  const voxel::PlacedSolid part{question.part.voxel.octree, part_solid};
  std::vector<voxel::Expression> solids;
  for (const Object* object : question.against) solids.push_back(placed(*object));
  std::vector<voxel::PlacedSolid> objects;
  for (std::size_t i = 0; i < solids.size(); ++i)
    objects.push_back({question.against[i]->voxel.octree, solids[i]});
  const std::vector<voxel::DockingContact> contacts =
      voxel::docking_contacts(part, objects, {asked.contact_mm, smooth_mm, {bench.stop, {}}});
  const std::vector<glm::dvec3> points =
      pushed_points(voxel::pushed_surface(part, question.push), asked, question);
  VoxelAnswer made;
  for (const voxel::DockingContact& one : contacts) made.contacts.push_back({one.p_mm, one.normal, 0.0});
  if (!contacts.empty() && !points.empty())
    made.worst = voxel::docking(contacts, question.push, points, {bench.stop, {}});
  return made;
}

double angle_of(const std::vector<brep::DockingContact>& contacts, const glm::dvec3& push,
                const std::vector<glm::dvec3>& points, double at_most_deg = brep::most_docking_deg) {
  if (contacts.empty()) return 0.0;
  double least = at_most_deg;
  for (const brep::Docking& one : brep::dockings(contacts, push, points, {}, at_most_deg))
    least = std::min(least, one.angle_deg);
  return least;
}

/// The angle by which two correct answers may differ, from changes of the mesh's contacts alone. It is the
/// largest effect of four changes: contacts a voxel wider or narrower, pushed points a voxel nearer or
/// farther, and gaps a tenth of a voxel wider. Added to it is the effect of random errors of normals: a tenth
/// of a voxel over the smoothing distance.
double allowed_deg(const std::vector<brep::DockingContact>& contacts, double angle_deg, const Rocking& asked,
                   const glm::dvec3& push, const std::vector<glm::dvec3>& points, double voxel_mm) {
  glm::dvec3 middle(0.0);
  for (const brep::DockingContact& one : contacts) middle += one.p_mm / static_cast<double>(contacts.size());
  double squares = 0.0;
  for (const brep::DockingContact& one : contacts) {
    const glm::dvec3 arm = one.p_mm - middle;
    squares += glm::dot(arm, arm) / static_cast<double>(contacts.size());
  }
  const double share = std::min(0.9, (voxel_mm + contact_spacing_mm) / std::max(std::sqrt(squares), 1e-9));
  double allowed = nothing_deg;
  std::vector<brep::DockingContact> changed = contacts;
  for (const double factor : {1.0 - share, 1.0 + share}) {
    for (std::size_t i = 0; i < contacts.size(); ++i)
      changed[i].p_mm = middle + factor * (contacts[i].p_mm - middle);
    allowed = std::max(allowed, std::abs(angle_of(changed, push, points) - angle_deg));
  }
  for (const double along_mm : {-voxel_mm, voxel_mm}) {
    std::vector<glm::dvec3> moved = points;
    for (glm::dvec3& p : moved) p += along_mm * push;
    allowed = std::max(allowed, std::abs(angle_of(contacts, push, moved) - angle_deg));
  }
  changed.clear();
  for (const brep::DockingContact& one : contacts)
    if (one.gap_mm <= asked.contact_mm - 0.1 * voxel_mm) changed.push_back(one);
  allowed = std::max(allowed, std::abs(angle_of(changed, push, points) - angle_deg));
  const double tilt = 0.1 * voxel_mm / std::max(smooth_mm, 2.0 * voxel_mm);
  double most = 0.0;
  for (int draw = 0; draw < 10; ++draw) {
    verify::Chance chance(static_cast<std::uint64_t>(asked.seed) +
                          1000003ULL * static_cast<std::uint64_t>(draw + 1));
    changed = contacts;
    for (brep::DockingContact& one : changed) {
      const double x = chance.normal(), y = chance.normal();
      one.normal = glm::normalize(one.normal + tilt * glm::dvec3(x, y, chance.normal()));
    }
    most = std::max(most, std::abs(angle_of(changed, push, points) - angle_deg));
  }
  return allowed + most;
}

/// The angles of all trials, ascending. In a trial, the errors of patches widen and narrow gaps. Contacts
/// whose gap exceeds the largest gap no longer support the part.
std::vector<double> trial_angles(const std::vector<brep::DockingContact>& contacts, const Rocking& asked,
                                 const glm::dvec3& push, const std::vector<glm::dvec3>& points,
                                 double angle_deg, const voxel::Progress& progress) {
  using Patch = std::array<double, 3>;
  const auto patch_of = [](const brep::DockingContact& contact) {
    const glm::dvec3 at = glm::floor(contact.p_mm / patch_mm);
    return Patch{at.x, at.y, at.z};
  };
  std::map<Patch, double> errors;
  for (const brep::DockingContact& contact : contacts) errors[patch_of(contact)] = 0.0;
  const double deviation_mm = std::hypot(asked.scan_mm, asked.printer_mm);
  std::vector<double> angles;
  for (int trial = 0; trial < asked.trials; ++trial) {
    progress.at(1.0 * trial / asked.trials);
    verify::Chance chance(1000003ULL * static_cast<std::uint64_t>(asked.seed) +
                          static_cast<std::uint64_t>(trial));
    for (auto& [patch, error_mm] : errors) error_mm = deviation_mm * chance.normal();
    std::vector<brep::DockingContact> left;
    for (const brep::DockingContact& contact : contacts)
      if (contact.gap_mm + errors.at(patch_of(contact)) <= asked.contact_mm) left.push_back(contact);
    // Fewer contacts hold less.
    angles.push_back(angle_of(left, push, points, angle_deg));
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

/// The value below which a share of the sorted values lies, interpolated.
double percentile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(at));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::string motion_in_words(const brep::Loosening& loosening) {
  return loosening.turns ? "turns it about the axis " + in_words(loosening.direction) + " through " +
                               voxel::rounded(loosening.about_mm) + " mm"
                         : "slides it along " + in_words(loosening.direction);
}

Json json_of(const brep::Loosening& loosening) {
  Json json{{"motion", loosening.turns ? "turn" : "slide"}, {"direction", to_json(loosening.direction)}};
  json["about_mm"] = loosening.turns ? to_json(loosening.about_mm) : Json(nullptr);
  return json;
}

Json empty_answer(const Rocking& asked, const Question& question) {
  Json on = Json::array();
  for (const Object* object : question.against) on.push_back(object->id);
  return {{"object", question.part.id},
          {"on", std::move(on)},
          {"direction", to_json(question.push)},
          {"verdict", nullptr},
          {"angle_deg", nullptr},
          {"low_deg", nullptr},
          {"high_deg", nullptr},
          {"share_of_ideal", nullptr},
          {"voxel_angle_deg", nullptr},
          {"allowed_deg", nullptr},
          {"at_mm", nullptr},
          {"voxel_at_mm", nullptr},
          {"voxel_again_deg", nullptr},
          {"dispute", nullptr},
          {"gives_way", nullptr},
          {"best_deg", nullptr},
          {"best_at_mm", nullptr},
          {"contacts", 0},
          {"voxel_contacts", 0},
          {"pushed_points", 0},
          {"contact_mm", asked.contact_mm},
          {"errors",
           {{"scan_mm", asked.scan_mm},
            {"printer_mm", asked.printer_mm},
            {"trials", asked.trials},
            {"seed", asked.seed}}},
          {"findings", Json::array()}};
}

Json failed(Json json, const std::string& finding) {
  json["verdict"] = "FAIL";
  json["findings"].push_back(finding);
  return json;
}

/// The position at which a push may deviate most, among positions on a surface at most 4 mm apart.
brep::Docking best_of(const std::vector<brep::DockingContact>& contacts, const Question& question,
                      const AnswerBench& bench) {
  std::vector<brep::Docking> all = brep::dockings(
      contacts, question.push,
      brep::pushed_surface(*question.part.mesh.within, question.push, 4.0 * contact_spacing_mm),
      {bench.stop, {}});
  return *std::max_element(all.begin(), all.end(), [](const brep::Docking& a, const brep::Docking& b) {
    return a.angle_deg < b.angle_deg;
  });
}

void judge(Json& json, const Question& question, const brep::Docking& worst) {
  const double angle = worst.angle_deg, low = json["low_deg"];
  const std::string pushed = "a push along " + in_words(question.push) + " at " +
                             voxel::rounded(worst.at_mm) + " mm",
                    best = json["best_deg"].get<double>() > std::max(nothing_deg, angle)
                               ? "; push near " +
                                     voxel::rounded(glm::dvec3(json["best_at_mm"][0], json["best_at_mm"][1],
                                                               json["best_at_mm"][2])) +
                                     " mm, where it may deviate by " + three_figures(json["best_deg"]) +
                                     " degrees"
                               : "; extend the part farther around the bone";
  json["verdict"] = "WARN";
  if (angle < nothing_deg)
    json["findings"].push_back("'" + question.part.id + "' rocks on " + names_of(question) + ": " + pushed +
                               " " + (worst.loosening ? motion_in_words(*worst.loosening) : "moves it") +
                               best);
  else if (low < nothing_deg)
    json["findings"].push_back("'" + question.part.id + "' may rock on " + names_of(question) +
                               " with the errors of scan and printer: in 0.5 % of the trials " + pushed +
                               " may not deviate" + best);
  else
    json["verdict"] = "PASS";
}

std::string in_words(const DockingDispute& dispute, double voxel_mm) {
  const std::string holds = dispute.first_holds ? "meshes" : "voxels",
                    other = dispute.first_holds ? "voxels" : "meshes";
  std::string words = holds + " find bone at " + voxel::rounded(dispute.at_mm) + " mm that holds the part";
  words +=
      ", " + other +
      (dispute.normals_deg ? " find it turned by " + three_figures(*dispute.normals_deg) + " degrees there"
                           : " find none there");
  words += "; with " + std::to_string(dispute.places) +
           (dispute.places == 1 ? " such place " : " such places ") + "more, " + other + " find " +
           three_figures(dispute.explained_deg) + " degrees";
  return words + "; rely on the smaller angle, or choose voxels finer than " + three_figures(voxel_mm) +
         " mm";
}

/// Compares the kernels. Their angles for the same contacts must be equal but for the voxels' samples of
/// sides. Where their own contacts give angles too far apart, the interval reaches to both.
void compare(Json& json, const Question& question, const std::vector<brep::DockingContact>& contacts,
             const std::vector<glm::dvec3>& points, const VoxelAnswer& by_voxels, double voxel_mm) {
  const double angle = json["angle_deg"];
  double by_voxels_deg = 0.0;
  if (by_voxels.worst) {
    by_voxels_deg = by_voxels.worst->angle_deg;
    const double again = angle_of(by_voxels.contacts, question.push, {by_voxels.worst->at_mm});
    json["voxel_at_mm"] = to_json(by_voxels.worst->at_mm);
    json["voxel_again_deg"] = again;
    if (std::abs(again - by_voxels_deg) > same_contacts_deg + same_contacts_share * again) {
      json["verdict"] = "FAIL";
      json["findings"].push_back(
          "the kernels compute different angles from the same contacts: " + three_figures(again) +
          " degrees in meshes, " + three_figures(by_voxels_deg) + " in voxels, of a push at " +
          voxel::rounded(by_voxels.worst->at_mm) + " mm");
    }
  }
  json["voxel_angle_deg"] = by_voxels_deg;
  const double allowed = json["allowed_deg"];
  if (std::abs(angle - by_voxels_deg) <= allowed) return;
  json["low_deg"] = std::min(json["low_deg"].get<double>(), by_voxels_deg);
  json["high_deg"] = std::max(json["high_deg"].get<double>(), by_voxels_deg);
  if (json["verdict"] == "PASS") json["verdict"] = "WARN";
  std::string finding = "the kernels disagree: the push may deviate by " + three_figures(angle) +
                        " degrees in meshes, by " + three_figures(by_voxels_deg) + " in voxels";
  if (const auto why = dispute(contacts, by_voxels.contacts, question.push, points,
                               {voxel_mm + contact_spacing_mm, patch_mm, allowed})) {
    finding += "; " + in_words(*why, voxel_mm);
    json["dispute"] = {{"holds_in", why->first_holds ? "mesh" : "voxel"},
                       {"at_mm", to_json(why->at_mm)},
                       {"normals_deg", why->normals_deg ? Json(*why->normals_deg) : Json(nullptr)},
                       {"places", why->places},
                       {"explained_deg", why->explained_deg}};
  }
  json["findings"].push_back(std::move(finding));
}

Json measure(const Rocking& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "rocking");
  Question question{bench.objects.at(asked.part.name), {}, {}, {}};
  question.push =
      asked.push ? glm::normalize(*asked.push) : direction_of(asked.insertion, bench.objects.lps_from_head);
  for (const ObjectName& name : asked.against) question.against.push_back(&bench.objects.at(name.name));
  Json json = empty_answer(asked, question);
  const auto add_missing = [&](const Object& object) {
    if (auto missing = missing_kernel(object, "its contacts cannot be examined"))
      json["findings"].push_back(std::move(*missing));
  };
  add_missing(question.part);
  for (const Object* object : question.against) add_missing(*object);
  if (!json["findings"].empty()) return json;

  const std::vector<brep::DockingContact> contacts = mesh_contacts(question, asked, bench);
  json["contacts"] = contacts.size();
  if (contacts.empty())
    return failed(
        json, "'" + question.part.id + "' touches " + names_of(question) + " nowhere within " +
                  three_figures(asked.contact_mm) +
                  " mm: raise 'contact_mm' above the part's clearance, or name the bone on which it sits");
  if (std::all_of(contacts.begin(), contacts.end(), [&](const brep::DockingContact& contact) {
        return glm::dot(contact.normal, question.push) > -least_facing;
      }))
    return failed(json, "the push along " + in_words(question.push) + " presses '" + question.part.id +
                            "' onto nothing of " + names_of(question) +
                            ": state the direction in which the part is put on");
  glm::dvec3 middle(0.0);
  for (const brep::DockingContact& contact : contacts)
    middle += contact.p_mm / static_cast<double>(contacts.size());
  for (const Mark& mark : asked.at) question.at_mm.push_back(mark_mm(mark, bench.objects));
  if (question.at_mm.empty()) question.at_mm.push_back(middle);
  const std::vector<glm::dvec3> points = pushed_points(
      brep::pushed_surface(*question.part.mesh.within, question.push, contact_spacing_mm), asked, question);
  json["pushed_points"] = points.size();
  if (points.empty())
    return failed(json, "no surface of '" + question.part.id + "' faces the push within " +
                            three_figures(asked.radius_mm) + " mm of the line through " +
                            voxel::rounded(question.at_mm.front()) +
                            " mm: name points in 'at', or raise 'radius_mm'");

  std::vector<brep::Docking> worst = brep::worst_dockings(contacts, question.push, points, {bench.stop, {}});
  worst.resize(std::min(worst.size(), tried_points));
  const VoxelAnswer by_voxels = answer_by_voxels(question, asked, bench);
  json["voxel_contacts"] = by_voxels.contacts.size();
  std::vector<glm::dvec3> tried;
  for (const brep::Docking& one : worst) tried.push_back(one.at_mm);
  const double angle = worst.front().angle_deg;
  const std::vector<double> angles =
      trial_angles(contacts, asked, question.push, tried, angle, bench.progress("rocking"));
  const brep::Docking best = best_of(contacts, question, bench);
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  const double voxel_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  json["angle_deg"] = angle;
  json["low_deg"] = std::min(angle, percentile(angles, 0.005));
  json["high_deg"] = std::max(angle, percentile(angles, 0.995));
  if (angle >= nothing_deg) json["share_of_ideal"] = percentile(angles, 0.5) / angle;
  json["at_mm"] = to_json(worst.front().at_mm);
  if (worst.front().loosening) json["gives_way"] = json_of(*worst.front().loosening);
  json["best_deg"] = best.angle_deg;
  json["best_at_mm"] = to_json(best.at_mm);
  json["allowed_deg"] = allowed_deg(contacts, angle, asked, question.push, tried, voxel_mm);
  judge(json, question, worst.front());
  compare(json, question, contacts, points, by_voxels, voxel_mm);
  return json;
}

}  // namespace

Operation rocking_operation() {
  return Describe<Rocking>("rocking",
                           "Tests whether a part that is pushed onto its bone can rock: computes the angle "
                           "by which the push may deviate before the part turns or slides.",
                           Makes::Measurement)
      .takes(field("object", &Rocking::part, "The part in its seated position.").required())
      .takes(field("against", &Rocking::against, "The bone or teeth on which it sits.").required().from(1))
      .takes(insertion_direction(&Rocking::insertion))
      .takes(insertion_view(&Rocking::insertion))
      .takes(field("push", &Rocking::push,
                   "The direction in which a finger pushes the part, LPS. Default: the insertion direction.")
                 .direction())
      .takes(field("at", &Rocking::at,
                   "Points at which the part is pushed. Default: over the middle of its contacts."))
      .takes(field("radius_mm", &Rocking::radius_mm,
                   "The part may also be pushed within this distance of the lines of push through these "
                   "points, where its outer surface faces the push; about half a fingertip.")
                 .from(0.0)
                 .to(500.0))
      .takes(field("contact_mm", &Rocking::contact_mm,
                   "Bone within this distance of the part supports it: the part's clearance plus the error "
                   "of its fit.")
                 .greater_than(0.0)
                 .to(5.0))
      .takes(field("scan_mm", &Rocking::scan_mm,
                   "Standard deviation of the error of the bone's surface, independent from patch to patch.")
                 .from(0.0)
                 .to(5.0))
      .takes(field("printer_mm", &Rocking::printer_mm,
                   "Standard deviation of the error of the printed surface; 0.16 is published for resin.")
                 .from(0.0)
                 .to(5.0))
      .takes(field("trials", &Rocking::trials, "Number of trials with random errors.").from(100).to(100000))
      .takes(field("seed", &Rocking::seed, "Seed of the random errors: the same seed gives the same numbers.")
                 .from(0)
                 .to(1e9))
      .example(R"({"id": "holds", "do": "rocking", "object": "advanced", "against": ["rest"],
        "direction": [0, 1, 0]})")
      .of_head()
      .check(check)
      .measure(measure);
}

}  // namespace octotomy::planner
