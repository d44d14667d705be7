// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/pen.h"

namespace octotomy::voxel {

/// The side of the patient that an LPS direction points to: L or R, A or P, S or I. The nearest axis comes
/// first; a second letter follows if the direction is nearer to the diagonal than to the axis (22.5 degrees
/// in their plane). DICOM's letters (PS3.3 C.7.6.1.1.1) except S and I for head and feet.
std::string patient_side(const glm::dvec3& direction);

/// The largest 1, 2 or 5 times a power of ten that is at most a positive length.
double round_length(double most);

/// A name and its colour, sRGB 0..1.
struct LegendEntry {
  std::string name;
  glm::vec3 colour{0.0f};
};

/// Colours of a range of numbers, evenly from low to high.
struct ColourBar {
  std::string title;
  double low = 0.0;
  double high = 1.0;
  std::vector<glm::vec3> colours;  ///< sRGB, 0..1; one at least
};

/// The letters at a picture's four edges.
struct EdgeLetters {
  std::string left, right, top, bottom;
};
/// The patient's sides in a view.
EdgeLetters edge_letters(const View& view);

/// The texts, scale and legend to write on a picture.
struct Annotation {
  std::string title;                   ///< top left
  bool sides = true;                   ///< letters of the patient's sides at the picture's four edges
  std::optional<EdgeLetters> letters;  ///< replace the view's letters, for a picture on a curved sheet
  bool scale = true;                   ///< a bar of a round length, bottom right; not drawn in perspective
  std::vector<LegendEntry> legend;     ///< bottom left
  std::optional<ColourBar> bar;        ///< at the right edge
};

/// Writes an annotation into a picture on `plane`: dark on a light picture, light on a dark one. Letters are
/// a fiftieth of the narrower side high, and at least 7 pixels. Throws std::invalid_argument if the number of
/// pixels is not the plane's, or a bar has no colours or no range.
void annotate(std::vector<std::uint8_t>& rgb, const ImagePlane& plane, const Annotation& annotation);

}  // namespace octotomy::voxel
