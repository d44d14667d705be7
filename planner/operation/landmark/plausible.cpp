// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Ranges are wide: means of adults (Farkas, Anthropometry of the head and face, 1994; Martin and Saller,
// Lehrbuch der Anthropologie, 1957) with four deviations and more, children's faces within.
#include "planner/operation/landmark/plausible.h"

#include <array>
#include <cmath>

namespace octotomy::planner {
namespace {

/// The allowed range of a landmark's position relative to another landmark: height or depth in millimetres,
/// or as a share of the nose's height.
struct Relation {
  const char *first, *second;
  enum Of { Below, Behind } of;
  bool is_share;
  double low, high;
};
constexpr std::array<Relation, 14> relations{{
    {"nasion", "ans", Relation::Below, false, 30.0, 66.0},
    {"nasion", "ans", Relation::Behind, false, -16.0, 14.0},
    {"ans", "a_point", Relation::Below, true, 0.03, 0.45},
    {"ans", "incisor", Relation::Below, true, 0.34, 0.9},
    {"ans", "incisor", Relation::Behind, false, -18.0, 14.0},
    {"incisor", "lower_incisor", Relation::Below, false, 0.5, 45.0},
    {"lower_incisor", "menton", Relation::Below, true, 0.55, 1.15},
    {"ans", "menton", Relation::Below, true, 1.1, 2.2},
    {"pogonion", "menton", Relation::Below, true, 0.02, 0.45},
    {"nasion", "pogonion", Relation::Behind, false, -25.0, 30.0},
    {"b_point", "pogonion", Relation::Below, true, 0.08, 0.6},
    {"pogonion", "menton", Relation::Behind, false, 0.0, 20.0},
    {"nasion", "orbitale", Relation::Below, true, 0.3, 0.85},
    {"nasion", "midline_front", Relation::Behind, false, -14.0, 14.0},
}};

/// The allowed distances of a pair of landmarks from the mid-plane, and the allowed differences between its
/// sides: across the mid-plane, and parallel to it.
struct Pair {
  const char* name;
  double least_out, most_out, most_across, most_along;
  bool is_known_by_both = false;  ///< the landmark is removed if its counterpart is missing
};
constexpr std::array<Pair, 5> pairs{{{"piriform", 6.5, 19.0, 5.0, 8.0},
                                     {"orbitale", 18.0, 48.0, 14.0, 9.0},
                                     {"buttress", 20.0, 62.0, 14.0, 14.0, true},
                                     {"zygoma", 48.0, 80.0, 9.0, 14.0},
                                     {"gonion", 34.0, 72.0, 12.0, 14.0}}};

void take_out(FoundPlaces& found, const std::string& name, const std::string& why) {
  if (found.places.erase(name) > 0) found.missing[name] = why;
}

void keep_related(FoundPlaces& found) {
  const glm::dvec3 *nasion = found.find("nasion"), *spine = found.find("ans");
  const bool has_nose = nasion != nullptr && spine != nullptr;
  const double nose_mm = has_nose ? nasion->z - spine->z : 1.0;
  std::map<std::string, std::string> wrong;
  for (const Relation& relation : relations) {
    if (relation.is_share && !has_nose) continue;
    for (const char* side : {"", "_left", "_right"}) {
      const std::string second = std::string(relation.second) + side;
      const glm::dvec3 *a = found.find(relation.first), *b = found.find(second);
      if (a == nullptr || b == nullptr) continue;
      const double apart = relation.of == Relation::Below ? a->z - b->z : b->y - a->y;
      const double value = relation.is_share ? apart / nose_mm : apart;
      if (value >= relation.low && value <= relation.high) continue;
      const std::string where = relation.of == Relation::Below ? "below" : "behind";
      wrong[second] = "its position is implausible: it would lie farther or nearer " + where + " " +
                      relation.first + " than in any face";
      // Either of the two may be wrong.
      wrong[relation.first] = "it and " + second + " lie at a distance that no face has";
    }
  }
  for (const auto& [name, why] : wrong) take_out(found, name, why);
}

void keep_alike(FoundPlaces& found) {
  for (const Pair& pair : pairs) {
    const std::string left = std::string(pair.name) + "_left", right = std::string(pair.name) + "_right";
    for (const std::string& name : {left, right})
      if (const glm::dvec3* at = found.find(name))
        if (std::abs(at->x) < pair.least_out || std::abs(at->x) > pair.most_out)
          take_out(found, name,
                   "its position is implausible: it would lie farther from the middle or nearer to it than "
                   "in any face");
    const glm::dvec3 *a = found.find(left), *b = found.find(right);
    if (a == nullptr || b == nullptr) {
      // A single side cannot be compared. The maxilla's outer end is uncertain without the other side,
      // because its rule ends at the first wide hole.
      for (const std::string& name : {left, right}) {
        if (found.find(name) != nullptr) found.doubt_mm[name] += 2.0;
        if (pair.is_known_by_both)
          take_out(found, name,
                   "the landmark on the other side was not found, so this one cannot be checked");
      }
      continue;
    }
    const double across = std::abs(a->x + b->x), along = std::hypot(a->y - b->y, a->z - b->z);
    if (across > pair.most_across || along > pair.most_along) {
      for (const std::string& name : {left, right})
        take_out(found, name, "the positions on the left and right differ by more than in any face");
      continue;
    }
    // Either side may be wrong, so the whole difference is added to the doubt of each.
    for (const std::string& name : {left, right}) found.doubt_mm[name] += std::hypot(across, along);
  }
}

}  // namespace

void keep_plausible(FoundPlaces& found) {
  keep_related(found);
  keep_alike(found);
}

}  // namespace octotomy::planner
