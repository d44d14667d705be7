// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

namespace octotomy::planner {

/// The colour of a text #RRGGBB, sRGB from 0 to 1; none for any other text.
std::optional<glm::vec3> colour_of_text(const std::string& text);
/// The colour of a text, as colour_of_text() returns it. Throws std::runtime_error that states an example if
/// the text is not a colour.
glm::vec3 need_colour(const std::string& text);
/// #rrggbb.
std::string text_of_colour(const glm::vec3& colour);
/// Default colours of objects: first that of bone, then colours that people with any colour vision can
/// distinguish.
glm::vec3 colour_of(std::size_t number);

/// The red in which interference is drawn, #e5484d.
glm::vec3 interference_colour();

}  // namespace octotomy::planner
