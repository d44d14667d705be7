// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/pen.h"

namespace octotomy::voxel {

/// The letters of the patient's side to which an LPS direction points: L or R, A or P, S or I. The first
/// letter is that of the nearest axis. A second letter follows if the direction is nearer to the diagonal of
/// two axes than to the first axis, which means more than 22.5 degrees from it. DICOM's letters (PS3.3
/// C.7.6.1.1.1) except S and I for head and feet.
std::string patient_side(const glm::dvec3& direction);

/// The largest number that is 1, 2 or 5 times a power of ten and at most the given length. Precondition: the
/// length is positive.
double round_length(double most);

/// An entry of a legend: a name and its colour, sRGB 0..1.
struct LegendEntry {
  std::string name;
  glm::vec3 colour{0.0f};
};

/// A colour bar for numbers from low to high, with evenly spaced colours.
struct ColourBar {
  std::string title;
  double low = 0.0;
  double high = 1.0;
  std::vector<glm::vec3> colours;  ///< sRGB, 0..1, from low to high; at least one
};

/// The letters at a picture's four edges.
struct EdgeLetters {
  std::string left, right, top, bottom;
};
/// The letters of the patient's sides at the edges of a view.
EdgeLetters edge_letters(const View& view);

/// The texts, scale bar, legend and colour bar to draw on a picture.
struct Annotation {
  std::string title;  ///< top left
  /// Whether letters of the patient's sides are drawn at the picture's four edges.
  bool sides = true;
  /// Letters to draw instead of the view's, for a picture on a curved sheet.
  std::optional<EdgeLetters> letters;
  /// Whether a scale bar with a round length is drawn at the bottom right; never in perspective.
  bool scale = true;
  std::vector<LegendEntry> legend;  ///< bottom left
  std::optional<ColourBar> bar;     ///< at the right edge
};

/// Draws an annotation into a picture on `plane`, dark on a light picture and light on a dark one. Letters
/// are as high as a fiftieth of the picture's shorter side, but at least 7 pixels. Throws
/// std::invalid_argument if the number of pixels is not the plane's, or a colour bar has no colours or low is
/// not below high.
void annotate(std::vector<std::uint8_t>& rgb, const ImagePlane& plane, const Annotation& annotation);

}  // namespace octotomy::voxel
