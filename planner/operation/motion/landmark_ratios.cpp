// SPDX-License-Identifier: AGPL-3.0-or-later
// The face after the operation by ratios of landmarks, the quick alternative beside finite elements (thesis 9.2.2):
//   1 Each landmark of the skin moves by its ratio of the motion of a landmark of the bone; others stay where they are.
//   2 Between landmarks the displacement is interpolated by functions of compact support. It is zero beyond their reach.
//   3 The mesh kernel displaces points; the voxel kernel reads the object at the origin of each voxel. Each computes the
//     displacement by itself from the landmarks' displacements.
#include <algorithm>
#include <cmath>
#include <set>

#include "brep/align/landmark_warp.h"
#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/measure/measured_ratios.h"
#include "planner/operation/motion/published_ratios.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/field_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/landmark_motion.h"
#include "verify/witness/reshaped_witness.h"
#include "voxel/solid/landmark_warp.h"
#include "voxel/space/rounded.h"

namespace octotomy::planner {
namespace {

/// Landmarks farther from the skin than this are refused. It is about twice the error with which observers
/// place them.
constexpr double off_skin_mm = 5.0;
/// The largest allowed change of displacement per distance. At 1 the tissue folds.
constexpr double steepest_allowed = 0.9;
/// 99 of 100 values of a normal distribution lie within this multiple of its standard deviation.
constexpr double coverage_factor = 2.5758;

/// The source of a ratio that the user states.
constexpr const char* typed_source = "typed";

struct LandmarkRatios {
  /// A landmark of the skin and the landmark of the bone that it follows.
  struct Pair {
    Mark soft;
    std::optional<Mark> bone;
    std::optional<double> ratio, ratio_up, deviation;
  };
  ObjectName object;
  std::vector<Pair> pairs;
  std::filesystem::path before, after;
  std::vector<std::string> ratios;
  double fade_mm = 60.0;
  // Settled.
  std::vector<glm::dvec3> points_mm, displacement_mm;
};

bool has_pairs(const LandmarkRatios& step) {
  return !step.pairs.empty();
}
bool has_files(const LandmarkRatios& step) {
  return !step.before.empty() || !step.after.empty();
}

/// A landmark's name for people. A typed point has its coordinates as its name.
std::string landmark_name(const Mark& mark) {
  return mark.landmark.empty() ? voxel::rounded(mark.p_mm) : mark.landmark;
}

/// "upper_lip:incisor:0.6".
struct TypedRatio {
  std::string soft, bone;
  double ratio = 0.0;
};

TypedRatio typed_ratio(const std::string& text) {
  const std::size_t first = text.find(':'), second = text.find(':', first + 1);
  const auto refuse = [&] {
    throw std::runtime_error("'" + text +
                             "' is not a ratio: write SOFT:BONE:RATIO, for example upper_lip:incisor:0.6");
  };
  if (first == std::string::npos || second == std::string::npos || first == 0 || second == first + 1)
    refuse();
  TypedRatio made{text.substr(0, first), text.substr(first + 1, second - first - 1)};
  std::size_t used = 0;
  try {
    made.ratio = std::stod(text.substr(second + 1), &used);
  } catch (const std::logic_error&) {
    refuse();
  }
  if (used != text.size() - second - 1 || !(made.ratio >= 0.0 && made.ratio <= 2.0)) refuse();
  return made;
}

void check_pair(const LandmarkRatios::Pair& pair, const FieldLocation& place) {
  if (!pair.bone) {
    if (pair.ratio || pair.ratio_up || pair.deviation)
      place.refuse(
          "states a ratio without a landmark of the bone: add 'bone', for example \"incisor@advanced\"");
    return;
  }
  const FieldLocation bone = place.at("bone");
  if (pair.bone->landmark.empty())
    bone.refuse(
        "is a typed point, which has no motion: name a landmark and the object that carries it, for example "
        "\"incisor@advanced\"");
  if (pair.bone->object.empty())
    bone.refuse("'" + pair.bone->landmark +
                "' has no motion: add the object that carries it, for example \"" + pair.bone->landmark +
                "@advanced\"");
  if (!pair.ratio && !published_ratio(pair.soft.landmark, pair.bone->landmark))
    place.refuse("there is no published ratio for '" + landmark_name(pair.soft) + "' to '" +
                 pair.bone->landmark + "': add 'ratio', or choose one of: " + published_pairs());
  if (pair.deviation && !pair.ratio)
    place.at("deviation").refuse("applies only to a typed ratio: add 'ratio'");
}

void check(const LandmarkRatios& step, const FieldLocation& place) {
  if (!has_pairs(step) && !has_files(step))
    place.refuse(std::string("moves no landmark: add ") + (place.scope != nullptr ? "'pairs', or " : "") +
                 "the files 'before' and 'after'");
  if (has_pairs(step)) {
    std::set<std::string> softs;
    bool moves = false;
    for (std::size_t i = 0; i < step.pairs.size(); ++i) {
      const FieldLocation at = place.at("pairs[" + std::to_string(i) + "]");
      check_pair(step.pairs[i], at);
      moves = moves || step.pairs[i].bone;
      if (!softs.insert(landmark_name(step.pairs[i].soft)).second)
        at.at("soft").refuse("'" + landmark_name(step.pairs[i].soft) +
                             "' occurs in an earlier pair, too: delete one of the pairs");
    }
    if (!moves)
      place.at("pairs").refuse(
          "move nothing, because no pair has a landmark of the bone: add 'bone' to one of them");
    return;
  }
  for (const auto& [name, path] : {std::pair("before", &step.before), std::pair("after", &step.after)}) {
    if (path->empty())
      place.refuse(std::string("'") + name +
                   "' is missing: add it, because displacements are computed from both files");
    check_field_file(place.at(name), *path, [](const std::filesystem::path& file) { read_landmarks(file); });
  }
  for (const std::string& text : step.ratios) {
    try {
      typed_ratio(text);
    } catch (const std::runtime_error& error) {
      place.at("ratios").refuse(error.what());
    }
  }
}

/// A landmark of the skin, with the displacement of the bone's landmark and the ratio. If `bone` is empty, it
/// stays where it is.
struct Follower {
  std::string name, bone;
  glm::dvec3 at_mm{0.0}, bone_by_mm{0.0};
  PublishedRatio ratio;
  std::optional<double> up, deviation;
};

std::vector<Follower> followers_of_pairs(const LandmarkRatios& step, const Objects& objects) {
  std::vector<Follower> all;
  for (const LandmarkRatios::Pair& pair : step.pairs) {
    Follower one{pair.soft.landmark, "", mark_mm(pair.soft, objects), {}, {}, {}, {}};
    if (pair.bone) {
      one.bone = pair.bone->landmark + "@" + pair.bone->object;
      Mark still = *pair.bone;
      still.object.clear();
      one.bone_by_mm = mark_mm(*pair.bone, objects) - mark_mm(still, objects);
      if (pair.ratio) {
        one.ratio.ratio = *pair.ratio;
        one.ratio.source = typed_source;
        one.deviation = pair.deviation;
      } else {
        one.ratio = *published_ratio(pair.soft.landmark, pair.bone->landmark);
        one.deviation = one.ratio.deviation;
      }
      one.up = pair.ratio_up;
    }
    all.push_back(std::move(one));
  }
  return all;
}

std::optional<glm::dvec3> at(const std::vector<brep::Landmark>& landmarks, const std::string& name) {
  for (const brep::Landmark& each : landmarks)
    if (each.name == name) return each.p_mm;
  return std::nullopt;
}

/// All pairs of landmarks that have a ratio and occur in both files. A typed ratio replaces a published ratio
/// for the same landmark of the skin.
std::vector<Follower> followers_of_files(const LandmarkRatios& step, const std::filesystem::path& folder) {
  const std::vector<brep::Landmark> before = read_landmarks(folder / step.before),
                                    after = read_landmarks(folder / step.after);
  std::vector<Follower> all;
  const auto add = [&](const PublishedRatio& ratio, const std::optional<double>& deviation, bool is_typed) {
    const auto soft_mm = at(before, ratio.soft), bone_mm = at(before, ratio.bone),
               to_mm = at(after, ratio.bone);
    if (is_typed && !soft_mm)
      throw std::runtime_error(step.before.string() + ": has no landmark '" + ratio.soft +
                               "' for the ratio " + ratio.soft + ":" + ratio.bone +
                               ": add it, or leave the ratio out");
    if (is_typed && (!bone_mm || !to_mm))
      throw std::runtime_error((bone_mm ? step.after : step.before).string() + ": has no landmark '" +
                               ratio.bone + "' for the ratio " + ratio.soft + ":" + ratio.bone +
                               ": add it, or leave the ratio out");
    const bool is_there =
        std::any_of(all.begin(), all.end(), [&](const Follower& one) { return one.name == ratio.soft; });
    if (!soft_mm || !bone_mm || !to_mm || is_there) return;
    all.push_back({ratio.soft, ratio.bone, *soft_mm, *to_mm - *bone_mm, ratio, std::nullopt, deviation});
  };
  for (const std::string& text : step.ratios) {
    const TypedRatio typed = typed_ratio(text);
    add({typed.soft, typed.bone, typed.ratio, 0.0, typed_source}, std::nullopt, true);
  }
  for (const PublishedRatio& ratio : published_ratios()) add(ratio, ratio.deviation, false);
  if (all.empty())
    throw std::runtime_error(step.before.string() + " and " + step.after.string() +
                             ": no pair of landmarks with a ratio is in both; there are ratios of " +
                             published_pairs());
  return all;
}

RatioLandmark predicted(const Follower& follower, const glm::dmat3& lps_from_head) {
  RatioLandmark made;
  made.name = follower.name;
  made.follows = follower.bone;
  made.at_mm = follower.at_mm;
  made.bone_moved_mm = follower.bone_by_mm;
  if (!follower.bone.empty()) {
    made.ratio = follower.ratio.ratio;
    made.ratio_up = follower.up.value_or(follower.ratio.ratio);
    made.source = follower.ratio.source;
    Displacement along = displacement_of(follower.bone_by_mm, lps_from_head);
    along.forward_mm *= *made.ratio;
    along.left_mm *= *made.ratio;
    along.up_mm *= *made.ratio_up;
    made.moved_mm = lps_mm(along, lps_from_head);
    made.deviation = follower.deviation;
    if (follower.deviation)
      made.half_width_mm = coverage_factor * *follower.deviation * glm::length(follower.bone_by_mm);
  }
  const Displacement by = displacement_of(made.moved_mm, lps_from_head);
  made.forward_mm = by.forward_mm;
  made.left_mm = by.left_mm;
  made.up_mm = by.up_mm;
  made.words = in_words(by);
  return made;
}

std::string landmark_name(const RatioLandmark& landmark) {
  return landmark.name.empty() ? voxel::rounded(landmark.at_mm) : landmark.name;
}

void need_motion(const std::vector<RatioLandmark>& landmarks) {
  std::string followed;
  for (const RatioLandmark& each : landmarks) {
    if (glm::length(each.bone_moved_mm) > 0.0) return;
    if (!each.follows.empty()) followed += (followed.empty() ? "'" : ", '") + each.follows + "'";
  }
  throw std::runtime_error(
      "there is no motion: " + followed + (followed.find(',') == std::string::npos ? " stays" : " stay") +
      " at the same place: move the bone in an earlier step, or state its later landmarks");
}

/// Sets the distance of each landmark from the object's surface. Throws if one exceeds off_skin_mm.
void need_skin(std::vector<RatioLandmark>& landmarks, const ObjectName& object, const brep::Solid& solid) {
  std::vector<glm::dvec3> points_mm;
  for (const RatioLandmark& each : landmarks) points_mm.push_back(each.at_mm);
  if (solid.empty()) throw std::runtime_error("'" + object.name + "' is empty, so it has no skin");
  const std::vector<double> off_mm = solid.tree().distances_mm(points_mm);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    landmarks[i].off_skin_mm = off_mm[i];
    if (off_mm[i] > off_skin_mm)
      throw std::runtime_error("'" + landmark_name(landmarks[i]) + "' lies " + three_figures(off_mm[i]) +
                               " mm from the surface of '" + object.name +
                               "': place it on the skin, within " + plain(off_skin_mm) + " mm");
  }
}

/// Throws std::runtime_error if the displacements fold the tissue. The message states a fade that is long
/// enough, or else the two landmarks that are too near each other for their displacements.
void need_no_fold(const LandmarkRatios& step, const std::vector<RatioLandmark>& landmarks) {
  const auto steepest = [&](double reach_mm) {
    return brep::LandmarkWarp(step.points_mm, step.displacement_mm, reach_mm).steepest();
  };
  if (steepest(step.fade_mm) <= steepest_allowed) return;
  constexpr double longer = 1.25, most = 4.0;
  for (double times = longer; times <= most; times *= longer)
    if (steepest(times * step.fade_mm) <= steepest_allowed)
      throw std::runtime_error("a fade of " + three_figures(step.fade_mm) +
                               " mm folds the tissue under these displacements: state at least " +
                               grouped(std::ceil(times * step.fade_mm), 0) + " mm");
  std::size_t a = 0, b = 1;
  double worst = 0.0;
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    for (std::size_t j = i + 1; j < landmarks.size(); ++j) {
      const double change = glm::distance(step.displacement_mm[i], step.displacement_mm[j]) /
                            glm::distance(step.points_mm[i], step.points_mm[j]);
      if (change > worst) std::tie(a, b, worst) = std::tuple(i, j, change);
    }
  throw std::runtime_error(
      "'" + landmark_name(landmarks[a]) + "' and '" + landmark_name(landmarks[b]) + "' are " +
      three_figures(glm::distance(step.points_mm[a], step.points_mm[b])) +
      " mm apart, and their displacements differ by " +
      three_figures(glm::distance(step.displacement_mm[a], step.displacement_mm[b])) +
      " mm, which folds the tissue between them: leave out one of them, or check their positions and ratios");
}

/// Published ratios were measured for bone that moved forward. A ratio applies without a finding if at least
/// this share of the motion is forward.
constexpr double least_forward = 0.7;

/// Adds a finding that describes the displacement of each landmark, and findings on what was assumed.
void report(const MeasuredRatios& measured, const glm::dmat3& lps_from_head,
            std::vector<std::string>& findings) {
  std::string text, unsure;
  bool has_published = false;
  for (const RatioLandmark& each : measured.landmarks) {
    text += (text.empty() ? "" : "; ") + landmark_name(each);
    if (each.follows.empty()) {
      text += " stays";
      continue;
    }
    text += " " + each.words +
            (each.half_width_mm ? " \u00b1 " + grouped(*each.half_width_mm, 1) + " mm" : "") + " (" +
            three_figures(*each.ratio) + " of " + each.follows + ", " + each.source + ")";
    if (!each.half_width_mm) unsure += (unsure.empty() ? "'" : ", '") + landmark_name(each) + "'";
    if (each.source == typed_source) continue;
    has_published = true;
    const Displacement bone = displacement_of(each.bone_moved_mm, lps_from_head);
    if (bone.forward_mm < least_forward * glm::length(each.bone_moved_mm))
      findings.push_back("the published ratio of '" + landmark_name(each) +
                         "' was measured for operations that advance the bone, but " + each.follows +
                         " moves " + in_words(bone) + ": type a ratio that was measured for such a motion");
  }
  findings.push_back("landmarks by ratios: " + text);
  if (has_published)
    findings.push_back(
        "the published ratios are those that later literature attributes to the named papers, and their "
        "deviations are estimates: if measured ratios and deviations are known, type these");
  if (!unsure.empty())
    findings.push_back("no interval for " + unsure + ": no deviation of the ratio is known");
}

LandmarkRatios settle(const LandmarkRatios& asked, const SettleBench& bench) {
  LandmarkRatios settled = asked;
  MeasuredRatios measured;
  measured.fade_mm = asked.fade_mm;
  const std::vector<Follower> followers =
      has_pairs(asked) ? followers_of_pairs(asked, bench.objects) : followers_of_files(asked, bench.folder);
  for (const Follower& follower : followers) {
    measured.landmarks.push_back(predicted(follower, bench.objects.lps_from_head));
    const RatioLandmark& one = measured.landmarks.back();
    settled.points_mm.push_back(one.at_mm);
    settled.displacement_mm.push_back(one.moved_mm);
    measured.largest_displacement_mm = std::max(measured.largest_displacement_mm, glm::length(one.moved_mm));
  }
  need_motion(measured.landmarks);
  const Object& object = bench.objects.at(asked.object.name);
  if (object.mesh.whole) need_skin(measured.landmarks, asked.object, *object.mesh.whole);
  need_no_fold(settled, measured.landmarks);
  report(measured, bench.objects.lps_from_head, bench.findings);
  bench.details.update(print_record(measured));
  return settled;
}

std::string definition(const LandmarkRatios& step, const Objects&) {
  return step.object.name + " moved by ratios of " + std::to_string(step.points_mm.size()) +
         (step.points_mm.size() == 1 ? " landmark" : " landmarks");
}

constexpr const char* mesh_lineage = "vertices of a mesh, displaced between landmarks";

brep::Solid displaced(const LandmarkRatios& step, const brep::Solid& still) {
  return brep::warped(still, {step.points_mm, step.displacement_mm, step.fade_mm});
}

/// For an object that is only known by whole voxels, the warped mesh is digitised. Voxels read at other
/// positions than their centres would shift the surface by up to half a voxel.
void voxels(const LandmarkRatios& step, const VoxelBench& bench, VoxelSide& made) {
  const Object& still = bench.objects.at(step.object.name);
  if (still.mesh.whole && is_whole_voxels(still.voxel)) {
    voxelise(displaced(step, *still.mesh.whole), bench.universe, made);
    made.makers = {std::string("landmark_ratios: ") + mesh_lineage};
    return;
  }
  std::vector<voxel::LandmarkShift> landmarks;
  for (std::size_t i = 0; i < step.points_mm.size(); ++i)
    landmarks.push_back({step.points_mm[i], step.displacement_mm[i]});
  const Stopwatch watch(bench.timings, "warp_voxel");
  made.octree = voxel::warped_by_landmarks(
      still.voxel.octree, still.voxel.symbol ? *still.voxel.symbol : voxel::Expression(still.voxel.octree),
      landmarks, step.fade_mm, bench.progress);
  made.symbol = voxel::Expression(made.octree);
  made.lineage =
      "the object's own definition, read at each voxel's origin under the landmarks' displacements";
}

void triangles(const LandmarkRatios& step, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "warp");
  made.whole = displaced(step, bench.object(step.object.name));
  made.lineage = mesh_lineage;
  made.makers = {std::string("landmark_ratios: ") + mesh_lineage};
}

void bound(const LandmarkRatios& step, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(step.object.name);
  made.bound.spacing_mm = object.bound.spacing_mm;
  made.bound.shift_mm = object.bound.shift_mm;
  made.bound.measured_apart_mm = object.bound.measured_apart_mm;
  made.bound.reshaped = {step.object.name};
  made.ends_with_universe = true;
  made.shared_values.push_back("the landmarks' displacements");
  if (!made.mesh.whole || !object.mesh.whole) return;
  made.witness = verify::witness_of_reshaped(
      [still = *object.mesh.whole, witness = object.witness, points_mm = step.points_mm,
       displacement_mm = step.displacement_mm, fade_mm = step.fade_mm]() -> verify::Reshaped {
        const auto motion =
            std::make_shared<const verify::LandmarkMotion>(points_mm, displacement_mm, fade_mm);
        return {verify::surface_warped(still.triangles(), *motion),
                verify::witness_of_warped(witness, still.triangles(), motion)};
      });
}

}  // namespace

Operation landmark_ratios_operation() {
  using Pair = LandmarkRatios::Pair;
  return Describe<LandmarkRatios>("landmark_ratios",
                                  "Predicts the face after an operation: each landmark of the skin moves by "
                                  "a ratio of the motion of a bone's landmark.",
                                  Makes::Object)
      .takes(field("object", &LandmarkRatios::object, "The object whose surface is the skin.")
                 .required()
                 .positional("solid"))
      .takes(
          records(
              "pairs", &LandmarkRatios::pairs,
              "Landmarks of the skin, each with the landmark of the bone that it follows.",
              {field("soft", &Pair::soft, "A landmark of the skin, or its point [x, y, z].").required(),
               field("bone", &Pair::bone,
                     "A landmark of the bone and the object with which it moves, for example "
                     "incisor@advanced. Default: the skin's landmark stays where it is."),
               field("ratio", &Pair::ratio,
                     "The share of the bone's motion with which the skin moves. Default: the pair's ratio "
                     "for operations that advance the bone, which later literature attributes to Freihofer "
                     "1976 and 1977 or to Lines and Steinhauser 1974.")
                   .from(0.0)
                   .to(2.0),
               field("ratio_up", &Pair::ratio_up, "The share of the bone's upward motion. Default: 'ratio'.")
                   .from(0.0)
                   .to(2.0),
               field("deviation", &Pair::deviation,
                     "Standard deviation of a typed ratio among people; the displacement's interval is "
                     "computed from it.")
                   .from(0.0)
                   .to(2.0)})
              .in_plans_only())
      .takes(field("before", &LandmarkRatios::before,
                   "A file with the landmarks of skin and bone before the operation: JSON, or 3D Slicer's "
                   ".mrk.json or .fcsv. All pairs that have a ratio move. In plans it replaces 'pairs'.")
                 .a_file()
                 .read_if<LandmarkRatios>([](const LandmarkRatios& step) { return !has_pairs(step); },
                                          "and 'pairs' exclude each other: keep one of them"))
      .takes(field("after", &LandmarkRatios::after, "The file of the bone's landmarks after the operation.")
                 .a_file()
                 .read_if<LandmarkRatios>([](const LandmarkRatios& step) { return !has_pairs(step); },
                                          "and 'pairs' exclude each other: keep one of them"))
      .takes(field("ratios", &LandmarkRatios::ratios,
                   "Ratios for landmarks of the files, each SOFT:BONE:RATIO. They replace published ratios.")
                 .called("ratio")
                 .repeated()
                 .for_example("[\"upper_lip:incisor:0.6\"]")
                 .read_if<LandmarkRatios>(
                     [](const LandmarkRatios& step) { return !has_pairs(step); },
                     "applies only to the files 'before' and 'after': state 'ratio' in each pair instead"))
      .takes(field("fade_mm", &LandmarkRatios::fade_mm,
                   "Tissue farther than this from all landmarks does not move. The distance must be so long "
                   "that the tissue does not fold.")
                 .greater_than(0.0)
                 .to(1000.0))
      .example(R"({"id": "quick", "do": "landmark_ratios", "object": "soft", "pairs": [
        {"soft": "upper_lip", "bone": "incisor@advanced"}, {"soft": "subnasale", "bone": "a_point@advanced", "ratio": 0.5},
        {"soft": "lower_lip"}]})")
      .on_files(
          "octotomy landmark_ratios skin.stl --before now.mrk.json --after planned.mrk.json -o face.stl\n"
          "  octotomy landmark_ratios skin.stl --before now.json --after planned.json --ratio "
          "upper_lip:incisor:0.7 "
          "-o face.ply --certify")
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
