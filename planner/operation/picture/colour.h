// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

namespace octotomy::planner {

/// The sRGB colour, 0..1, that #RRGGBB names; none where the text is anything else.
std::optional<glm::vec3> colour_of_text(const std::string& text);
/// As colour_of_text(), but throws std::runtime_error with an example if the text is no colour.
glm::vec3 need_colour(const std::string& text);
/// #rrggbb.
std::string text_of_colour(const glm::vec3& colour);
/// Colours of objects without a stated colour: bone, then colours that readers with any colour vision can
/// distinguish.
glm::vec3 colour_of(std::size_t number);

/// The red of interference, #e5484d.
glm::vec3 interference_colour();

}  // namespace octotomy::planner
