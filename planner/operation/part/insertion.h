// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"
#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// The direction in which a part is put on: either a vector, or a view, which means that the part comes from
/// the viewer's side. Exactly one of the two is set.
struct Insertion {
  std::optional<glm::dvec3> direction;   ///< of any length, LPS
  std::optional<std::string> seen_from;  ///< a view's name or angles, relative to the head's position
};

/// Refuses an insertion with both a direction and a view, or with neither, and a direction without length or
/// an unknown view.
void check(const Insertion& insertion, const FieldLocation& place);
/// The insertion direction as a unit vector, LPS.
glm::dvec3 direction_of(const Insertion& insertion, const glm::dmat3& lps_from_head);
/// Directions around a first one, which comes first: rings of directions, `step_deg` apart, up to
/// `within_deg`. Neighbours on a ring are about one step apart. Precondition: `first` is a unit vector.
std::vector<glm::dvec3> directions_about(const glm::dvec3& first, double within_deg, double step_deg);
/// The direction as text for messages: "(0, 1, 0)" or "the view from anterior".
std::string in_words(const Insertion& insertion);

/// The fields "direction" and "seen_from" of an operation whose value contains an insertion.
Field insertion_direction(const std::function<Insertion&(void* owner)>& insertion);
Field insertion_view(const std::function<Insertion&(void* owner)>& insertion);
template <typename Owner>
Field insertion_direction(Insertion Owner::*member) {
  return insertion_direction(
      [member](void* owner) -> Insertion& { return static_cast<Owner*>(owner)->*member; });
}
template <typename Owner>
Field insertion_view(Insertion Owner::*member) {
  return insertion_view([member](void* owner) -> Insertion& { return static_cast<Owner*>(owner)->*member; });
}

}  // namespace octotomy::planner
