// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>

namespace octotomy::voxel {

/// An orthographic way of looking: unit LPS vectors, right = look x up. A point's position in a view, in
/// millimetres, is (p . right, p . up).
struct View {
  glm::dvec3 look{0, 1, 0};
  glm::dvec3 up{0, 0, 1};
  glm::dvec3 right{1, 0, 0};

  glm::dvec2 project(const glm::dvec3& p_mm) const { return {glm::dot(p_mm, right), glm::dot(p_mm, up)}; }
};

/// Whether a view's directions are unit vectors, perpendicular to each other, right = look x up, to 1e-6; NaN
/// is not.
bool is_frame(const View& view);

/// A named view (anterior, posterior, left, right, superior, inferior) or "AZ,EL" in degrees: from anterior,
/// azimuth turns the observer towards the patient's left, elevation raises the observer. Throws
/// std::invalid_argument naming the text and the views there are.
View parse_view(const std::string& text);

/// What the left and the right eye see of what a view shows: the observer turned about `up`, by half the
/// angle between the eyes each. Precondition: finite.
std::array<View, 2> stereo_pair(const View& view, double between_deg);

}  // namespace octotomy::voxel
