// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A rectangle of pixels, from its top left corner to its bottom right one.
struct PixelBox {
  glm::dvec2 low{0.0}, high{0.0};
};

/// Chooses places for names beside their points in a picture. A name stands clear of the picture's edges, of
/// dots and of other names, and where there is room also of lines.
class NamePlaces {
 public:
  /// Capitals are cap_px high.
  NamePlaces(const glm::ivec2& size_px, double cap_px) : size_px_(size_px), cap_px_(cap_px) {}

  void keep_off(const PixelBox& dot) { taken_.push_back(dot); }
  void keep_off_line(const glm::dvec2& from_px, const glm::dvec2& to_px) {
    lines_.emplace_back(from_px, to_px);
  }

  /// The start of a name's baseline at the nearest free place: at the right or left of its point, or in rows
  /// above and below. None if every place overlaps a dot or a name. The place is taken from then on.
  std::optional<glm::dvec2> place(const std::string& name, const glm::dvec2& point_px);

 private:
  bool is_free(const PixelBox& box) const;
  bool meets_line(const PixelBox& box) const;

  glm::ivec2 size_px_;
  double cap_px_;
  std::vector<PixelBox> taken_;
  std::vector<std::pair<glm::dvec2, glm::dvec2>> lines_;
};

}  // namespace octotomy::planner
