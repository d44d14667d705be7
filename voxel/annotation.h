// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/camera.h"
#include "voxel/pen.h"

namespace octotomy::voxel {

/// The side of the patient that an LPS direction points to: L or R, A or P, S or I, the nearest axis first;
/// a second letter where the direction is nearer to the diagonal than to the axis (22.5 degrees in their
/// plane). DICOM's letters (PS3.3 C.7.6.1.1.1) but S and I for head and feet, as on planes of a head.
std::string patient_side(const glm::dvec3& direction);

/// The largest 1, 2 or 5 times a power of ten that is not above a positive length.
double round_length(double most);

/// A name and the colour that stands for it, sRGB 0..1.
struct LegendEntry {
  std::string name;
  glm::vec3 colour{0.0f};
};

/// Colours that stand for a range of numbers, from low to high, evenly.
struct ColourBar {
  std::string title;
  double low = 0.0;
  double high = 1.0;
  std::vector<glm::vec3> colours;  ///< sRGB, 0..1; one at least
};

/// What stands at a picture's four edges.
struct EdgeLetters {
  std::string left, right, top, bottom;
};
/// The patient's sides in a view.
EdgeLetters edge_letters(const View& view);

/// What is written on a picture for print.
struct Annotation {
  std::string title;                   ///< top left
  bool sides = true;                   ///< letters of the patient's sides at the picture's four edges
  std::optional<EdgeLetters> letters;  ///< these instead of the view's, as in a picture that is no plane
  bool scale = true;                   ///< a bar of a round length, bottom right; perspective has no scale
  std::vector<LegendEntry> legend;     ///< bottom left
  std::optional<ColourBar> bar;        ///< at the right edge
};

/// Writes an annotation on the pixels of a picture of that plane, dark on light pictures and light on dark
/// ones. Letters are a fiftieth of the narrower side high, 7 pixels at the least. Throws
/// std::invalid_argument where the pixels are not the plane's, a bar has no colours or no range.
void annotate(std::vector<std::uint8_t>& rgb, const ImagePlane& plane, const Annotation& annotation);

}  // namespace octotomy::voxel
