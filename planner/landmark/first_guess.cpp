// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 The patient's bone is parted from what lies beside it.
// 2 Its mid-plane gives left and right. Up follows from nasion and nasal spine, found at several pitches.
// 3 All rules are applied once to fine maps, then with everything that they depend on changed, to coarse
// ones. 4 How far the answers scatter, with each rule's own doubt, is the interval; what scatters widely is
// missing.
#include "planner/landmark/first_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "planner/landmark/face_rules.h"
#include "planner/landmark/head_part.h"
#include "planner/landmark/plausible.h"
#include "voxel/solid/combine.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::planner {
namespace {

constexpr double least_left = 0.86;  ///< of the mid-plane's normal: turned and rolled by 20 degrees
/// Shares of the surface that have a counterpart, for the fit and for its doubt.
constexpr double usual_overlap = 0.7;
constexpr std::array<double, 2> other_overlaps{0.55, 0.85};
constexpr double coarse_mm = 1.0;  ///< step of the maps of other trials
/// Pitches in degrees at which a face is sought, nearest first; how often its pitch is corrected; the
/// direction from spine to nasion, leaning back from square to the Frankfurt plane.
constexpr std::array<double, 5> first_pitches{0.0, 12.0, -12.0, 24.0, -24.0};
constexpr int corrections = 2;
constexpr double nose_lean_deg = 1.0;
/// For the doubt: the head's pitch in degrees, the profile's half width and the rules' heights in mm.
constexpr std::array<std::array<double, 3>, 4> other_ways{
    {{6.0, 1.0, 1.5}, {3.0, 3.0, -1.0}, {-3.0, 1.0, 1.0}, {-6.0, 3.0, -1.5}}};
constexpr double threshold_share = 1.25;  ///< a higher threshold over the usual one, from -150 on
/// Of the scatter, the interval; and of the coarsest voxel edge.
constexpr double of_scatter = 1.3, of_voxel = 0.7;
constexpr double most_within_mm = 15.0;  ///< what may be farther off is no guess
constexpr double least_plane_deg = 0.5;

brep::MirrorFit mid_plane_of(const brep::Mesh& surface, double overlap,
                             const std::optional<brep::MirrorPlane>& start, const voxel::Progress& progress) {
  brep::MirrorFitOptions options;
  options.overlap = overlap;
  options.start = start;
  options.stop = progress.stop;
  try {
    return brep::fit_mirror_plane(surface, options);
  } catch (const std::runtime_error& error) {
    if (progress.stop.stop_requested()) throw voxel::Stopped(error.what());
    throw;
  }
}

/// One way to apply the rules: all that a guess depends on.
struct Trial {
  const voxel::DrawnObject* bone = nullptr;
  brep::MirrorPlane plane;
  double pitch_deg = 0.0;
  double step_mm = coarse_mm;
  double half_width_mm = 2.0;  ///< of the profile
  double higher_mm = 0.0;
};

/// The outer surface of the skull's wall in the mid-plane, on the way from the cavity; none where the scan
/// ends before.
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

/// Landmarks of one trial in the head's frame; none where there is no face.
FoundPlaces apply(const Trial& trial, const HeadFrame& frame) {
  const HeadMaps maps = map_head(*trial.bone, frame, trial.step_mm);
  Profile profile = profile_of(maps.front, trial.half_width_mm);
  profile.cut_mm = cut_height(maps.left);
  const std::optional<NasalOpening> nose = find_nasal_opening(profile, maps.front);
  if (!nose) return {};
  profile.chin_notch_mm = chin_notch(maps.front, profile, *nose);
  FoundPlaces found = places_of_profile(profile, *nose);
  find_face_places(maps, *nose, trial.higher_mm, found);
  // A neck under an occiput may look like the maxilla under a nose, but has no orbits.
  if (found.find("orbitale_left") == nullptr && found.find("orbitale_right") == nullptr) return {};
  find_nose_root(maps, *nose, found);
  return found;
}

HeadFrame frame_of(const Trial& trial) {
  return head_frame(trial.plane.point_mm, trial.plane.normal, trial.pitch_deg);
}

/// The pitch at which nasion and nasal spine are as in a head held by its Frankfurt plane; none: no face.
std::optional<double> held_pitch(const voxel::DrawnObject& bone, const brep::MirrorPlane& plane,
                                 const voxel::Progress& progress) {
  std::optional<double> without_nasion;
  for (const double first : first_pitches) {
    Trial trial{&bone, plane, first};
    for (int round = 0; round <= corrections; ++round) {
      progress.at(0.0);
      const FoundPlaces found = apply(trial, frame_of(trial));
      if (found.places.empty()) break;
      const glm::dvec3 *nasion = found.find("nasion"), *spine = found.find("ans");
      if (nasion == nullptr || spine == nullptr) {
        if (!without_nasion) without_nasion = trial.pitch_deg;
        break;
      }
      const double lean = glm::degrees(std::atan2(nasion->y - spine->y, nasion->z - spine->z));
      if (std::abs(lean) > 35.0) break;
      trial.pitch_deg += lean - nose_lean_deg;
      if (std::abs(lean - nose_lean_deg) < 2.0 || round == corrections) return trial.pitch_deg;
    }
  }
  return without_nasion;
}

/// How far the trials' answers lie from the first one's; infinite where two have none.
double scatter(const std::string& name, const glm::dvec3& first_mm, const std::vector<FoundPlaces>& others,
               const glm::dvec3& across) {
  // Any point of the mid-line does; only how far it may lie beside counts.
  const bool is_of_midline = name.starts_with("midline_");
  double most = 0.0;
  int without = 0;
  for (const FoundPlaces& other : others) {
    const glm::dvec3* at = other.find(name);
    if (at == nullptr && ++without > 1) return std::numeric_limits<double>::infinity();
    if (at == nullptr) continue;
    const glm::dvec3 off = *at - first_mm;
    most = std::max(most, is_of_midline ? std::abs(glm::dot(off, across)) : glm::length(off));
  }
  return most;
}

/// The same bone from a higher threshold on; none without samples.
std::optional<voxel::DrawnObject> with_higher_threshold(const voxel::DrawnObject& bone) {
  if (!bone.grey) return std::nullopt;
  constexpr double zero = -150.0;
  voxel::DrawnObject other = bone;
  other.threshold = zero + threshold_share * (bone.threshold - zero);
  voxel::Expression window(
      voxel::Window{*bone.grey, other.threshold, std::numeric_limits<double>::infinity()});
  if (bone.moved_from_still) window = moved(window, *bone.moved_from_still);
  other.octree = voxel::combine(bone.octree.universe(), voxel::Expression(bone.octree) & window);
  return other;
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)));
}

/// Adds the points of the brain case, which are found from within; their rule is the same in all trials but
/// for the mid-plane.
void add_brain_case(const HeadPart& head, const HeadFrame& frame, FoundPlaces& found) {
  const auto reach = [&](const char* name, const glm::dvec3& way, const char* missing) {
    if (!head.cavity_mm) {
      found.missing[name] = "the bone surrounds no brain case in this scan";
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
        "the bone's symmetry does not part left from right: is it a skull, turned by at most 20 degrees?");
  const std::optional<double> pitch = held_pitch(bone, plane, progress);
  const Trial usual{&bone, plane, pitch.value_or(0.0), head_map_step_mm};
  const HeadFrame frame = frame_of(usual);
  FoundPlaces first = pitch ? apply(usual, frame) : FoundPlaces();
  if (first.places.empty())
    throw std::runtime_error(
        "no nasal opening beside an orbit is seen from the front, from which the rules count: is it a skull, "
        "with its face in the scan, and the window that of bone?");

  // The same with other pitches, widths, heights, thresholds and mid-planes.
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
  std::vector<FoundPlaces> others;
  for (const Trial& trial : trials) {
    progress.at(0.3 + 0.7 * static_cast<double>(others.size()) / static_cast<double>(trials.size()));
    const HeadFrame other = frame_of(trial);
    others.push_back(apply(trial, other));
    add_brain_case(head, other, others.back());
    for (auto& [name, place] : others.back().places) place = other.lps_mm(place);
  }

  keep_plausible(first);
  const glm::dvec3 spacing = bone.octree.universe().lattice().spacing_mm();
  const double voxel_mm = std::max({spacing.x, spacing.y, spacing.z});
  std::map<std::string, std::string> missing = first.missing;
  for (const auto& [name, place] : first.places) {
    const glm::dvec3 p_mm = frame.lps_mm(place);
    const double moved = scatter(name, p_mm, others, plane.normal);
    // A middle beside the mid-plane is a finding of its own: of a crooked face, or of bone on one side alone.
    const bool is_of_middle =
        name.find("_left") == std::string::npos && name.find("_right") == std::string::npos;
    const double aside = is_of_middle ? 0.5 * std::abs(place.x) : 0.0;
    const double within_mm =
        std::hypot(of_scatter * moved, first.doubt_mm[name], aside) + of_voxel * voxel_mm;
    if (!(within_mm <= most_within_mm))
      missing[name] = "it is found elsewhere or not at all where the head is held a little otherwise";
    else
      guess.found.push_back({name, p_mm, within_mm});
  }
  guess.missing.assign(missing.begin(), missing.end());
  guess.findings = guess.mid_plane.findings;
  if (head.removed_count > 0)
    guess.findings.push_back(
        std::to_string(head.removed_count) +
        " other dense parts lie beside the skull and were left out, as of a couch or a marker");
  return guess;
}

}  // namespace octotomy::planner
