// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>

namespace octotomy::voxel {

/// An orthographic view: unit LPS vectors, right = look x up. The position of a point p in the view is (p .
/// right, p . up), in millimetres.
struct View {
  glm::dvec3 look{0, 1, 0};
  glm::dvec3 up{0, 0, 1};
  glm::dvec3 right{1, 0, 0};

  glm::dvec2 project(const glm::dvec3& p_mm) const { return {glm::dot(p_mm, right), glm::dot(p_mm, up)}; }
};

/// Whether a view's directions are perpendicular unit vectors with right = look x up, within 1e-6. False for
/// NaN.
bool is_frame(const View& view);

/// A named view (anterior, posterior, left, right, superior, inferior) or "AZ,EL" in degrees: from anterior,
/// azimuth turns the observer towards the patient's left, elevation raises the observer. Throws
/// std::invalid_argument with the text and the valid forms.
View parse_view(const std::string& text);

/// The views of the left and the right eye: the observer is turned about `up` by half of `between_deg` to
/// each side. Precondition: `between_deg` is finite.
std::array<View, 2> stereo_pair(const View& view, double between_deg);

}  // namespace octotomy::voxel
