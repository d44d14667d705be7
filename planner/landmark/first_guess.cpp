// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/landmark/first_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include "planner/landmark/face_rules.h"

namespace octotomy::planner {
namespace {

constexpr double least_left = 0.94;  ///< of the mid-plane's normal: the cosine of 20 degrees
/// Shares of the surface that have a counterpart, for the fit and for its doubt.
constexpr double usual_overlap = 0.7;
constexpr std::array<double, 2> other_overlaps{0.55, 0.85};
/// For the doubt: the head's pitch in degrees, the profile's half width and the rules' heights in mm.
constexpr std::array<std::array<double, 3>, 4> other_ways{
    {{5.0, 1.0, 2.0}, {2.5, 3.0, -1.0}, {-2.5, 1.0, 1.0}, {-5.0, 3.0, -2.0}}};
constexpr double most_within_mm = 15.0;  ///< what may be farther off is no guess

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

/// One way to ask: all that a guess depends on beside the bone.
struct Trial {
  brep::MirrorPlane plane;
  double pitch_deg = 0.0;
  double half_width_mm = 2.0;  ///< of the profile
  double higher_mm = 0.0;
};

/// Landmarks of one trial in LPS; none where there is no face.
FoundPlaces ask(const voxel::DrawnObject& bone, const Trial& trial) {
  const HeadMaps maps = map_head(bone, head_frame(trial.plane.point_mm, trial.plane.normal, trial.pitch_deg));
  Profile profile = profile_of(maps.front, trial.half_width_mm);
  profile.cut_mm = cut_height(maps.left);
  const std::optional<NasalOpening> nose = find_nasal_opening(profile, maps.front);
  if (!nose) return {};
  FoundPlaces found = places_of_profile(profile, *nose);
  find_face_places(maps, *nose, trial.higher_mm, found);
  // A neck under an occiput may look like the maxilla under a nose, but has no orbits.
  if (found.find("orbitale_left") == nullptr && found.find("orbitale_right") == nullptr) return {};
  find_midline_places(maps, *nose, found);
  for (auto& [name, place] : found.places) place = maps.frame.lps_mm(place);
  return found;
}

/// How far the trials' answers lie from the first one's, the farthest trial aside; infinite where two have
/// none.
double doubt(const std::string& name, const std::vector<FoundPlaces>& found, const glm::dvec3& across) {
  // Any point of the mid-line does; only how far it may lie beside counts.
  const bool is_of_midline = name.starts_with("midline_");
  const glm::dvec3 first_mm = *found.front().find(name);
  std::vector<double> away_mm;
  for (std::size_t i = 1; i < found.size(); ++i) {
    const glm::dvec3* other = found[i].find(name);
    const glm::dvec3 off = other == nullptr ? glm::dvec3(0.0) : *other - first_mm;
    away_mm.push_back(other == nullptr ? std::numeric_limits<double>::infinity()
                      : is_of_midline  ? std::abs(glm::dot(off, across))
                                       : glm::length(off));
  }
  std::sort(away_mm.begin(), away_mm.end());
  return head_map_step_mm + away_mm[away_mm.size() - 2];
}

}  // namespace

SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress) {
  SkullGuess guess;
  guess.mid_plane = mid_plane_of(surface, usual_overlap, std::nullopt, progress);
  const brep::MirrorPlane plane = guess.mid_plane.plane;
  if (plane.normal.x < least_left)
    throw std::runtime_error(
        "the bone's symmetry does not part left from right: is it a skull, turned by at most 20 degrees?");
  std::vector<Trial> trials{{plane}};
  for (const auto& [pitch_deg, width_mm, higher_mm] : other_ways)
    trials.push_back({plane, pitch_deg, width_mm, higher_mm});
  for (const double overlap : other_overlaps)
    trials.push_back({mid_plane_of(surface, overlap, plane, progress).plane});
  std::vector<FoundPlaces> found;
  for (const Trial& trial : trials) {
    progress.at(static_cast<double>(found.size()) / static_cast<double>(trials.size()));
    found.push_back(ask(bone, trial));
  }
  const FoundPlaces& first = found.front();
  if (first.places.empty())
    throw std::runtime_error(
        "no nasal opening beside an orbit is seen from the front, from which the rules count: is it a skull, "
        "with its face "
        "in "
        "the scan, and the window that of bone?");
  std::map<std::string, std::string> missing = first.missing;
  for (const auto& [name, p_mm] : first.places) {
    const double within_mm = doubt(name, found, plane.normal);
    if (within_mm > most_within_mm)
      missing[name] = "it is found elsewhere or not at all where the head is held a little otherwise";
    else
      guess.found.push_back({name, p_mm, within_mm});
  }
  guess.missing.assign(missing.begin(), missing.end());
  return guess;
}

}  // namespace octotomy::planner
