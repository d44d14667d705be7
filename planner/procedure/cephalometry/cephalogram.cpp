// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/procedure/cephalometry/cephalogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "planner/procedure/cephalometry/name_places.h"
#include "voxel/view/lettering.h"
#include "voxel/view/pen.h"
#include "voxel/view/radiograph.h"

namespace octotomy::planner {
namespace {

using Kind = CephalometricKind;
using Places = LandmarkPlaces;

constexpr glm::vec3 as_is{0.55f, 0.85f, 0.95f}, as_planned{1.0f, 0.62f, 0.20f}, dark{0.05f, 0.06f, 0.08f};
constexpr double margin_mm = 25.0;
/// A landmark whose planned position is nearer than this to the scanned one is drawn only once.
constexpr double seen_mm = 0.05;

Places places_of(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks, bool planned) {
  std::set<std::string> known;
  for (const CephalometricLandmark& landmark : definitions.landmarks) known.insert(landmark.name);
  Places places;
  for (const MovedLandmark& each : landmarks)
    if (known.contains(each.landmark.name))
      places[each.landmark.name] =
          planned ? glm::dvec3(each.moved_from_still * glm::dvec4(each.landmark.p_mm, 1.0))
                  : each.landmark.p_mm;
  return with_means(definitions, std::move(places));
}

/// The lines between landmarks that the lateral measures use, each once.
std::set<std::pair<std::string, std::string>> lines_of(const Cephalometry& definitions) {
  std::set<std::pair<std::string, std::string>> lines;
  const auto add = [&](const std::string& a, const std::string& b) { lines.insert(std::minmax(a, b)); };
  for (const CephalometricMeasure& measure : definitions.measures) {
    if (measure.plane != CephalometricPlane::Lateral) continue;
    const std::vector<std::string>& p = measure.points;
    switch (measure.kind) {
      case Kind::Angle:
      case Kind::Bend:
        add(p[0], p[1]), add(p[1], p[2]);
        break;
      case Kind::Lines:
        add(p[0], p[1]), add(p[2], p[3]);
        break;
      case Kind::Tilt:
      case Kind::Distance:
      case Kind::Along:
      case Kind::Across:
        add(p[0], p[1]);
        break;
      case Kind::Difference:
      case Kind::Share:
        break;
    }
  }
  return lines;
}

/// Converts attenuations to grey tones from zero to the value that only one ray in 200 exceeds.
std::vector<std::uint8_t> toned(const voxel::RayImage& image) {
  std::vector<float> sorted = image.values;
  const auto at = static_cast<std::ptrdiff_t>(sorted.size() - sorted.size() / 200 - 1);
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return voxel::grey_tones(image, 0.0,
                           std::max(static_cast<double>(sorted[static_cast<std::size_t>(at)]), 1e-6));
}

/// Enlarges an image to `size_px` pixels along each side, by linear interpolation.
voxel::RayImage enlarged(const voxel::RayImage& image, int size_px) {
  voxel::RayImage made{glm::ivec2(size_px), {}};
  made.values.reserve(static_cast<std::size_t>(size_px) * static_cast<std::size_t>(size_px));
  const glm::dvec2 last(image.size_px - 1), scale = glm::dvec2(image.size_px) / static_cast<double>(size_px);
  const auto value = [&](int x, int y) {
    return static_cast<double>(
        image.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size_px.x) +
                     static_cast<std::size_t>(x)]);
  };
  for (int y = 0; y < size_px; ++y)
    for (int x = 0; x < size_px; ++x) {
      const glm::dvec2 at = glm::clamp((glm::dvec2(x, y) + 0.5) * scale - 0.5, glm::dvec2(0.0), last);
      const glm::ivec2 first = glm::min(glm::ivec2(at), image.size_px - 2);
      const glm::dvec2 t = at - glm::dvec2(first);
      made.values.push_back(static_cast<float>(
          glm::mix(glm::mix(value(first.x, first.y), value(first.x + 1, first.y), t.x),
                   glm::mix(value(first.x, first.y + 1), value(first.x + 1, first.y + 1), t.x), t.y)));
    }
  return made;
}

/// Draws a line from a point to its name from this many heights of a letter on.
constexpr double led_from_caps = 1.8;

class Tracing {
 public:
  Tracing(Cephalogram& picture, const voxel::ImagePlane& plane)
      : canvas_{picture.size_px, &picture.rgb},
        plane_(plane),
        names_(picture.size_px, letter_px_of(picture.size_px)) {}

  /// Draws the landmarks of `places` and the measures' lines; those that have not moved since `before`, which may
  /// be null, are left out.
  void draw(const Cephalometry& definitions, const Places& places, const Places* before,
            const glm::vec3& colour) {
    const auto moved = [&](const std::string& name) {
      return before == nullptr || glm::length(before->at(name) - places.at(name)) > seen_mm;
    };
    std::vector<voxel::Polyline> lines, dots;
    for (const auto& [a, b] : lines_of(definitions))
      if (places.contains(a) && places.contains(b) && (moved(a) || moved(b)))
        lines.push_back({pixel(places.at(a)), pixel(places.at(b))});
    for (const auto& [name, p_mm] : places)
      if (moved(name)) dots.push_back({pixel(p_mm), pixel(p_mm)});
    voxel::draw_lines(canvas_, lines, {width(), colour, 0.5 * width(), dark});
    voxel::draw_lines(canvas_, dots, {dot_widths * width(), colour, width(), dark});
    for (const voxel::Polyline& line : lines) names_.keep_off_line(line.front(), line.back());
    for (const voxel::Polyline& dot : dots) {
      const glm::dvec2 reach(0.5 * (dot_widths + 2.0) * width());
      names_.keep_off({dot.front() - reach, dot.front() + reach});
    }
  }

  /// Writes the names of landmarks, after everything else is drawn.
  void write_names(const Cephalometry& definitions, const Places& places) {
    std::vector<voxel::Polyline> leads, letters;
    for (const auto& [name, p_mm] : places) {
      if (!is_written(definitions, places, name)) continue;
      std::string words = name;
      std::replace(words.begin(), words.end(), '_', ' ');
      const glm::dvec2 at = pixel(p_mm);
      const auto start = names_.place(words, at);
      if (!start) continue;
      const glm::dvec2 middle = *start - glm::dvec2(0.0, 0.5 * letter_px());
      const double left = std::abs(at.x - middle.x), text_px = voxel::text_width_px(words, letter_px());
      const glm::dvec2 near = middle.x > at.x ? middle : middle + glm::dvec2(text_px, 0.0);
      if (std::max(std::abs(middle.y - at.y), std::min(left, std::abs(left - text_px))) >
          led_from_caps * letter_px())
        leads.push_back({at, near});
      for (voxel::Polyline& stroke : voxel::strokes_of_text(words, *start, letter_px()))
        letters.push_back(std::move(stroke));
    }
    voxel::draw_lines(canvas_, leads, {0.5 * width(), as_is, 0.5 * width(), dark});
    voxel::draw_lines(canvas_, letters, {width(), as_is, 1.5 * width(), dark});
  }

 private:
  static constexpr double dot_widths = 5.0;
  double width() const { return std::max(canvas_.size_px.x / 700.0, 1.0); }
  double letter_px() const { return letter_px_of(canvas_.size_px); }
  static double letter_px_of(const glm::ivec2& size_px) { return std::max(size_px.x / 60.0, 7.0); }
  glm::dvec2 pixel(const glm::dvec3& p_mm) const {
    const glm::dvec2 off = (plane_.view.project(p_mm) - plane_.centre_mm) / plane_.pixel_mm;
    return 0.5 * glm::dvec2(canvas_.size_px) + glm::dvec2(off.x, -off.y);
  }
  /// Names are written for placed landmarks; for landmarks of both sides once, at their mean if there is one.
  static bool is_written(const Cephalometry& definitions, const Places& places, const std::string& name) {
    bool is_placed = true;
    for (const CephalometricLandmark& landmark : definitions.landmarks) {
      const auto is_side = [&](const std::string& side) { return side.starts_with(landmark.name + "_"); };
      const bool of_sides =
          !landmark.mean_of.empty() && std::all_of(landmark.mean_of.begin(), landmark.mean_of.end(), is_side);
      if (of_sides && is_side(name)) return !places.contains(landmark.name);
      if (landmark.name == name) is_placed = landmark.mean_of.empty() || of_sides;
    }
    return is_placed;
  }

  voxel::Canvas canvas_;
  const voxel::ImagePlane& plane_;
  NamePlaces names_;
};

}  // namespace

Cephalogram draw_cephalogram(const voxel::GreyOctree& grey, const Cephalometry& definitions,
                             const std::vector<MovedLandmark>& landmarks, const glm::dmat3& lps_from_head,
                             int size_px, const voxel::Progress& progress) {
  const Places before = places_of(definitions, landmarks, false),
               after = places_of(definitions, landmarks, true);
  voxel::View view{lps_from_head[0], lps_from_head[2], -lps_from_head[1]};
  glm::dvec2 low(std::numeric_limits<double>::max()), high(-low);
  for (const Places* places : {&before, &after})
    for (const auto& [name, p_mm] : *places) {
      low = glm::min(low, view.project(p_mm));
      high = glm::max(high, view.project(p_mm));
    }
  if (before.empty()) low = high = glm::dvec2(0.0);
  const glm::dvec2 extent = high - low + 2.0 * margin_mm;
  Cephalogram made;
  made.size_px = glm::ivec2(size_px);
  const voxel::Frame frame{0.5 * (low + high), std::max(extent.x, extent.y)};
  const glm::dvec3 voxel_mm = grey.universe().lattice().spacing_mm();
  const double ray_mm = 0.5 * std::min({voxel_mm.x, voxel_mm.y, voxel_mm.z});
  // Rays nearer than half a voxel to each other show no more detail.
  const int rays = std::clamp(static_cast<int>(frame.width_mm / ray_mm), std::min(64, size_px), size_px);
  made.rgb = toned(enlarged(
      voxel::radiograph(grey, voxel::image_plane(grey.universe(), view, glm::ivec2(rays), frame), progress),
      size_px));
  const voxel::ImagePlane plane = voxel::image_plane(grey.universe(), view, made.size_px, frame);
  made.pixel_mm = plane.pixel_mm;
  Tracing tracing(made, plane);
  tracing.draw(definitions, before, nullptr, as_is);
  tracing.draw(definitions, after, &before, as_planned);
  tracing.write_names(definitions, before);
  return made;
}

}  // namespace octotomy::planner
