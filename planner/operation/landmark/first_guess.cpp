// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 The patient's bone is separated from the objects beside it.
// 2 Its mid-plane gives left and right. Up follows from nose and orbits, found at several pitches.
// 3 All rules are applied once to fine maps. They are then applied to coarse maps, with everything changed that they
//   depend on.
// 4 The interval follows from the scatter of the answers and from each rule's own doubt. A landmark whose answers
//   scatter widely is missing.
#include "planner/operation/landmark/first_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "planner/operation/landmark/face_rules.h"
#include "planner/operation/landmark/head_part.h"
#include "planner/operation/landmark/plausible.h"
#include "voxel/solid/combine.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::planner {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double least_left = 0.86;  ///< least component along LPS left of the mid-plane's normal, for a head
                                     ///< turned and rolled by 20 degrees
/// Shares of the surface that are assumed to have a mirrored counterpart: for the fit, and for the other fits
/// that show its error.
constexpr double usual_overlap = 0.7;
constexpr std::array<double, 2> other_overlaps{0.55, 0.85};
constexpr double plane_rest_mm = 0.02;  ///< a fit ends with a round that moves the surface by less than this,
                                        ///< which changes no result
constexpr double coarse_mm = 1.0;       ///< cell size of the maps in the other trials
/// Pitches in degrees at which a face is searched for, nearest first; then the number of times that the pitch
/// is corrected.
constexpr std::array<double, 5> first_pitches{0.0, 12.0, -12.0, 24.0, -24.0};
constexpr int corrections = 2;
/// Angles in a head whose Frankfurt plane is level. The line from spine to nasion leans back from upright by
/// `nose_lean_deg`. The line from the orbit's rim back to the arch's outermost point falls by
/// `arch_fall_deg`, about 4 mm over 45 mm. Lines that lean by more than `most_lean_deg` are not a face's.
constexpr double nose_lean_deg = 1.0, arch_fall_deg = 5.0, most_lean_deg = 35.0;
/// The changes of each other trial: the head's pitch in degrees, the half width of the profile in mm, and the
/// shift of the rules' heights in mm.
constexpr std::array<std::array<double, 3>, 4> other_ways{
    {{6.0, 1.0, 1.5}, {3.0, 3.0, -1.0}, {-3.0, 1.0, 1.0}, {-6.0, 3.0, -1.5}}};
constexpr double threshold_share = 1.25;  ///< ratio of a higher threshold to the usual one, both counted from
                                          ///< -150 HU
/// Factors in a landmark's error: of the scatter of the trials, and of the edge of the coarsest voxel.
constexpr double of_scatter = 1.3, of_voxel = 0.7;
constexpr double scan_end_mm = 2.0;      ///< more than a voxel; equal to scan_end in skull_profile.cpp
constexpr double most_within_mm = 15.0;  ///< a landmark with a larger error is not reported
constexpr double least_plane_deg = 0.5;

brep::MirrorFit mid_plane_of(const brep::Mesh& surface, double overlap,
                             const std::optional<brep::MirrorPlane>& start, const voxel::Progress& progress) {
  brep::MirrorFitOptions options;
  options.overlap = overlap;
  options.start = start;
  options.rest_mm = plane_rest_mm;
  options.stop = progress.stop;
  return brep::fit_mirror_plane(surface, options);
}

/// One trial: the rules applied with one set of assumptions, on which every guess depends.
struct Trial {
  const voxel::DrawnObject* bone = nullptr;
  brep::MirrorPlane plane;
  double pitch_deg = 0.0;
  double step_mm = coarse_mm;
  double half_width_mm = 2.0;  ///< of the profile
  double higher_mm = 0.0;
};

/// The outer surface of the skull's wall in the mid-plane, searched from the brain's cavity along a
/// direction; none if the scan ends before it.
std::optional<glm::dvec3> outer_wall(const voxel::Octree& bone, const glm::dvec3& from_mm,
                                     const glm::dvec3& way) {
  constexpr double step_mm = 0.5, far_mm = 160.0, least_wall_mm = 1.5, most_gap_mm = 6.0;
  const voxel::Lattice lattice = bone.universe().lattice();
  double entered = -1.0, last = -1.0;
  for (double t = 0.0; t <= far_mm; t += step_mm) {
    const bool is_bone = bone.contains(glm::ivec3(glm::round(lattice.voxel(from_mm + t * way))));
    if (is_bone) {
      if (entered < 0.0) entered = t;
      last = t;
    } else if (entered >= 0.0 && t - last > most_gap_mm) {
      if (last - entered >= least_wall_mm) return from_mm + last * way;
      entered = -1.0;
    }
  }
  return std::nullopt;
}

/// The landmarks of one trial in the head's frame; none if it finds no face.
FoundPlaces apply(const Trial& trial, const HeadFrame& frame) {
  const HeadMaps maps = map_head(*trial.bone, frame, trial.step_mm);
  Profile profile = profile_of(maps.front, trial.half_width_mm);
  profile.cut_mm = cut_height(maps.left);
  const std::optional<NasalOpening> nose = find_nasal_opening(profile, maps.front);
  if (!nose) return {};
  profile.chin_notch_mm = chin_notch(maps.front, profile, *nose);
  FoundPlaces found = places_of_profile(profile, *nose);
  find_face_places(maps, *nose, trial.higher_mm, found);
  // An occiput over a neck may look like a nose over a maxilla, but it has no orbits.
  if (found.find("orbitale_left") == nullptr && found.find("orbitale_right") == nullptr) return {};
  find_nose_root(maps, *nose, found);
  return found;
}

HeadFrame frame_of(const Trial& trial) {
  return head_frame(trial.plane.point_mm, trial.plane.normal, trial.pitch_deg);
}

/// The pitch in degrees that would bring the head's Frankfurt plane to the horizontal: the mean of two
/// estimates, from the line from nasal spine to nasion and from the line from orbit to zygomatic arch. Each
/// varies by about 4 degrees between faces. None without either line.
std::optional<double> to_raise_deg(const FoundPlaces& found) {
  double sum = 0.0, count = 0.0;
  const auto add = [&](double lean_deg, double usual_deg) {
    if (std::abs(lean_deg) > most_lean_deg) return;
    sum += lean_deg - usual_deg;
    count += 1.0;
  };
  const glm::dvec3 *nasion = found.find("nasion"), *spine = found.find("ans");
  if (nasion != nullptr && spine != nullptr)
    add(glm::degrees(std::atan2(nasion->y - spine->y, nasion->z - spine->z)), nose_lean_deg);
  for (const char* side : {"_left", "_right"}) {
    const glm::dvec3 *rim = found.find(std::string("orbitale") + side),
                     *arch = found.find(std::string("zygoma") + side);
    if (rim == nullptr || arch == nullptr) continue;
    add(glm::degrees(std::atan2(rim->z - arch->z, arch->y - rim->y)), arch_fall_deg);
    break;
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

/// The pitch at which the Frankfurt plane is horizontal; none if no face is found.
std::optional<double> held_pitch(const voxel::DrawnObject& bone, const brep::MirrorPlane& plane,
                                 const voxel::Progress& progress) {
  std::optional<double> of_face_alone;
  for (const double first : first_pitches) {
    Trial trial{&bone, plane, first};
    for (int round = 0; round <= corrections; ++round) {
      progress.at(0.0);
      const FoundPlaces found = apply(trial, frame_of(trial));
      if (found.places.empty()) break;
      const std::optional<double> raise_deg = to_raise_deg(found);
      if (!raise_deg) {
        if (!of_face_alone) of_face_alone = trial.pitch_deg;
        break;
      }
      trial.pitch_deg += *raise_deg;
      if (std::abs(*raise_deg) < 2.0 || round == corrections) return trial.pitch_deg;
    }
  }
  return of_face_alone;
}

/// The largest distance of the trials' results from the first trial's result. One trial may have no result or
/// one that is far away and thus on another structure, for example if a higher threshold opens thin bone.
/// With two such trials the scatter is infinite.
double scatter(const std::string& name, const glm::dvec3& first_mm, const std::vector<FoundPlaces>& others,
               const glm::dvec3& across) {
  // Any point of the mid-line is valid, so only the distance across the mid-plane counts.
  const bool is_of_midline = name.starts_with("midline_");
  double most = 0.0;
  int without = 0;
  for (const FoundPlaces& other : others) {
    const glm::dvec3* at = other.find(name);
    const glm::dvec3 off = at == nullptr ? glm::dvec3(unbounded) : *at - first_mm;
    const double off_mm = is_of_midline && at != nullptr ? std::abs(glm::dot(off, across)) : glm::length(off);
    if (off_mm <= most_within_mm)
      most = std::max(most, off_mm);
    else if (++without > 1)
      return unbounded;
  }
  return most;
}

/// The bone above a higher threshold; none if the object has no samples.
std::optional<voxel::DrawnObject> with_higher_threshold(const voxel::DrawnObject& bone) {
  if (!bone.grey) return std::nullopt;
  constexpr double zero = -150.0;
  voxel::DrawnObject other = bone;
  other.threshold = zero + threshold_share * (bone.threshold - zero);
  voxel::Expression window(voxel::window_of(*bone.grey, other.threshold));
  if (bone.moved_from_still) window = carried(window, *bone.moved_from_still);
  other.octree = voxel::combine(bone.octree.universe(), voxel::Expression(bone.octree) & window);
  return other;
}

/// Whether the samples end within scan_end_mm of a point, so that the bone may continue beyond.
bool is_at_scan_end(const voxel::DrawnObject& bone, const glm::dvec3& p_mm) {
  if (!bone.grey) return false;
  const voxel::Lattice lattice = bone.octree.universe().lattice();
  const std::optional<glm::dmat4> still = bone.still_from_voxel();
  for (int way = 0; way < 6; ++way) {
    glm::dvec3 off(0.0);
    off[way / 2] = way % 2 == 0 ? -scan_end_mm : scan_end_mm;
    const glm::dvec3 voxel = lattice.voxel(p_mm + off);
    const glm::dvec3 sample = still ? glm::dvec3(*still * glm::dvec4(voxel, 1.0)) : voxel;
    if (!bone.grey->scan().contains(glm::ivec3(glm::round(sample)))) return true;
  }
  return false;
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)));
}

/// Adds the points of the brain case, which are searched for from inside. Their rule is the same in all
/// trials except for the mid-plane.
void add_brain_case(const HeadPart& head, const HeadFrame& frame, FoundPlaces& found) {
  const auto reach = [&](const char* name, const glm::dvec3& way, const char* missing) {
    if (!head.cavity_mm) {
      found.missing[name] = "the bone in this scan surrounds no brain case";
      return;
    }
    const double aside = glm::dot(*head.cavity_mm, frame.left) - frame.mid_mm;
    const auto wall = outer_wall(head.bone, *head.cavity_mm - aside * frame.left, way);
    if (wall)
      found.places[name] = {0.0, glm::dot(*wall, frame.back), glm::dot(*wall, frame.up)};
    else
      found.missing[name] = missing;
  };
  reach("midline_back", frame.back, "the scan ends before the back of the skull");
  reach("midline_top", frame.up, "the scan ends below the top of the skull");
}

/// Some landmarks are searched for from other landmarks. Removes such a landmark if one of those was not
/// found and its counterpart on the other side was not found either, because then nothing confirms it.
void take_out_unfounded(std::vector<LandmarkGuess>& found, std::map<std::string, std::string>& missing) {
  const auto take_out = [&](const std::string& name, const std::string& opposite,
                            const std::vector<std::string>& sources) {
    if (!missing.contains(opposite)) return;
    for (const std::string& source : sources)
      if (missing.contains(source) &&
          std::erase_if(found, [&](const LandmarkGuess& at) { return at.name == name; }) > 0)
        missing[name] = "it is sought from " + source +
                        ", which was not found, and the landmark is missing on the other side, too";
  };
  for (const auto& [side, opposite] :
       {std::pair<std::string, std::string>("_left", "_right"), {"_right", "_left"}}) {
    take_out("zygoma" + side, "zygoma" + opposite, {"ans", "orbitale" + side});
    take_out("gonion" + side, "gonion" + opposite, {"menton", "ans"});
  }
}

}  // namespace

SkullGuess guess_landmarks(const voxel::DrawnObject& all_bone, const brep::Mesh& all_surface,
                           const voxel::Progress& progress) {
  SkullGuess guess;
  const HeadPart head = head_part(all_bone, voxel::part_of(progress, 0.0, 0.2));
  voxel::DrawnObject bone = all_bone;
  bone.octree = head.bone;
  bone.counted_in_grey = false;
  const brep::Mesh surface = head.surface_of(all_surface);
  guess.mid_plane = mid_plane_of(surface, usual_overlap, std::nullopt, progress);
  const brep::MirrorPlane plane = guess.mid_plane.plane;
  if (plane.normal.x < least_left)
    throw std::runtime_error(
        "the bone's plane of symmetry does not separate left from right: check that the object is a skull "
        "that is turned by at most 20 degrees");
  const std::optional<double> pitch = held_pitch(bone, plane, progress);
  const Trial usual{&bone, plane, pitch.value_or(0.0), head_map_step_mm};
  const HeadFrame frame = frame_of(usual);
  FoundPlaces first = pitch ? apply(usual, frame) : FoundPlaces();
  if (first.places.empty())
    throw std::runtime_error(
        "no nasal opening next to an orbit is visible from the front, and all rules start from these: check "
        "that the object is a skull with its face in the scan, and that the window selects bone");

  // The other trials, with changed pitches, widths, heights, thresholds and mid-planes.
  std::vector<Trial> trials;
  for (const auto& [pitch_deg, width_mm, higher_mm] : other_ways)
    trials.push_back({&bone, plane, *pitch + pitch_deg, coarse_mm, width_mm, higher_mm});
  const std::optional<voxel::DrawnObject> denser = with_higher_threshold(bone);
  if (denser) trials.push_back({&*denser, plane, *pitch});
  double plane_deg = 0.0;
  for (const double overlap : other_overlaps) {
    trials.push_back({&bone, mid_plane_of(surface, overlap, plane, progress).plane, *pitch});
    plane_deg = std::max(plane_deg, angle_deg(trials.back().plane.normal, plane.normal));
  }
  guess.mid_plane_within_deg = least_plane_deg + of_scatter * plane_deg;
  add_brain_case(head, frame, first);
  // If the two halves differ, the position of the mid-plane is uncertain by about their distance. A rotation
  // of the plane about its fitted point displaces it in proportion to the distance from that point.
  for (const auto& [name, place] : first.places)
    if (name.starts_with("midline_"))
      first.doubt_mm[name] +=
          std::hypot(guess.mid_plane.rms_mm, glm::distance(frame.lps_mm(place), plane.point_mm) *
                                                 std::tan(glm::radians(guess.mid_plane_within_deg)));
  std::vector<FoundPlaces> others;
  bool is_one_faceless = false;
  for (const Trial& trial : trials) {
    progress.at(0.3 + 0.7 * static_cast<double>(&trial - trials.data()) / static_cast<double>(trials.size()));
    const HeadFrame other = frame_of(trial);
    FoundPlaces found = apply(trial, other);
    const bool has_face = !found.places.empty();
    add_brain_case(head, other, found);
    for (auto& [name, place] : found.places) place = other.lps_mm(place);
    // A trial that did not find this face is ignored: a higher threshold may open the floors of the orbits,
    // or the rules may start from another edge than the spine. Every other trial counts.
    const glm::dvec3 *spine = first.find("ans"), *its = found.find("ans");
    const bool is_this_face = has_face && (spine == nullptr || its == nullptr ||
                                           glm::distance(frame.lps_mm(*spine), *its) <= most_within_mm);
    if (!is_this_face && !std::exchange(is_one_faceless, true)) continue;
    others.push_back(std::move(found));
  }

  keep_plausible(first);
  const glm::dvec3 spacing = bone.octree.universe().lattice().spacing_mm();
  const double voxel_mm = std::max({spacing.x, spacing.y, spacing.z});
  std::map<std::string, std::string> missing = first.missing;
  for (const auto& [name, place] : first.places) {
    const glm::dvec3 p_mm = frame.lps_mm(place);
    const double moved = scatter(name, p_mm, others, plane.normal);
    // A finding of its own reports that the face's middle lies beside the mid-plane: the face is crooked, or
    // bone is missing on one side.
    const bool is_of_middle =
        name.find("_left") == std::string::npos && name.find("_right") == std::string::npos;
    const double aside = is_of_middle ? 0.5 * std::abs(place.x) : 0.0;
    const double within_mm =
        std::hypot(of_scatter * moved, first.doubt_mm[name], aside) + of_voxel * voxel_mm;
    if (is_at_scan_end(bone, p_mm))
      missing[name] = "the scan ends there";
    else if (first.doubt_mm[name] > most_within_mm)
      missing[name] =
          "the bone is so flat there that the position of its extremal point is uncertain by more than 15 mm";
    else if (!(within_mm <= most_within_mm))
      missing[name] = "under a slightly different position of the head it is not found, or lies far away";
    else
      guess.found.push_back({name, p_mm, within_mm});
  }
  // As in keep_plausible(), a buttress is removed if the buttress on the other side is missing.
  for (const auto& [one, other] :
       {std::pair("buttress_left", "buttress_right"), {"buttress_right", "buttress_left"}})
    if (missing.contains(other) &&
        std::erase_if(guess.found,
                      [name = std::string(one)](const LandmarkGuess& at) { return at.name == name; }) > 0)
      missing[one] = "the landmark on the other side was not found, so this one cannot be checked";
  take_out_unfounded(guess.found, missing);
  guess.missing.assign(missing.begin(), missing.end());
  guess.findings = guess.mid_plane.findings;
  if (head.removed_count > 0)
    guess.findings.push_back(
        std::to_string(head.removed_count) +
        " other dense parts beside the skull, such as a couch or a marker, were left out");
  return guess;
}

}  // namespace octotomy::planner
