// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/record.h"

// A first guess of a skull's landmarks: a record below `measurements` in a result.
namespace octotomy::planner {

struct GuessedLandmark {
  std::string name, says;
  glm::dvec3 point_mm{0.0};
  double uncertainty_mm = 0.0;
  bool confirmed = false;
};
constexpr auto members_of(const GuessedLandmark&) {
  using L = GuessedLandmark;
  return std::tuple(member("name", &L::name), member("says", &L::says), member("point_mm", &L::point_mm),
                    member("uncertainty_mm", &L::uncertainty_mm), member("confirmed", &L::confirmed));
}

struct MissingLandmark {
  std::string name, says, why;
};
constexpr auto members_of(const MissingLandmark&) {
  using L = MissingLandmark;
  return std::tuple(member("name", &L::name), member("says", &L::says), member("why", &L::why));
}

struct MidPlaneGuess {
  glm::dvec3 point_mm{0.0}, normal{1.0, 0.0, 0.0};
  double rms_mm = 0.0, uncertainty_deg = 0.0;
};
constexpr auto members_of(const MidPlaneGuess&) {
  using P = MidPlaneGuess;
  return std::tuple(member("point_mm", &P::point_mm), member("normal", &P::normal),
                    member("rms_mm", &P::rms_mm), member("uncertainty_deg", &P::uncertainty_deg));
}

struct LandmarkGuesses {
  std::optional<MidPlaneGuess> mid_plane;  ///< none if no mid-plane was found
  std::vector<GuessedLandmark> landmarks;
  std::vector<MissingLandmark> missing;
  std::vector<std::string> findings;

  static constexpr const char* key = "missing";
};
constexpr auto members_of(const LandmarkGuesses&) {
  using G = LandmarkGuesses;
  return std::tuple(member_if_any("mid_plane", &G::mid_plane), member("landmarks", &G::landmarks),
                    member("missing", &G::missing), member("findings", &G::findings));
}

}  // namespace octotomy::planner
