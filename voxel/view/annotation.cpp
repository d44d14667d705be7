// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/annotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "voxel/view/lettering.h"
#include "voxel/view/pixel_index.h"
#include "voxel/view/srgb.h"

namespace octotomy::voxel {
namespace {

enum class Align { Left, Middle, Right };

/// A number with up to six significant digits.
std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// A picture, with the letter sizes and ink colours that suit it.
class Sheet {
 public:
  Sheet(const Canvas& canvas)
      : canvas_(canvas),
        cap_px_(std::max(7.0, std::min(canvas.size_px.x, canvas.size_px.y) / 50.0)),
        dark_(edge_light() >= 0.18f) {}

  double cap_px() const { return cap_px_; }
  glm::dvec2 size_px() const { return canvas_.size_px; }
  const Canvas& canvas() const { return canvas_; }
  Pen pen(double width_px) const {
    const glm::vec3 ink(dark_ ? 0.13f : 0.95f), paper(dark_ ? 1.0f : 0.0f);
    return {width_px, ink, std::max(1.0, cap_px_ / 7.0), paper};
  }
  double stroke_px() const { return std::max(1.1, cap_px_ / 7.5); }

  void write(const std::string& text, const glm::dvec2& baseline_px, Align align) const {
    const double width_px = text_width_px(text, cap_px_);
    const double shift_px = align == Align::Left ? 0.0 : align == Align::Middle ? 0.5 * width_px : width_px;
    draw_lines(canvas_, strokes_of_text(text, baseline_px - glm::dvec2(shift_px, 0.0), cap_px_),
               pen(stroke_px()));
  }

 private:
  /// The mean linear light of the picture's outermost pixels; 0.18 appears half-way between black and white.
  float edge_light() const {
    double sum = 0.0;
    std::size_t count = 0;
    for (int y = 0; y < canvas_.size_px.y; ++y) {
      const bool whole_row = y == 0 || y == canvas_.size_px.y - 1;
      for (int x = 0; x < canvas_.size_px.x; x += whole_row ? 1 : std::max(1, canvas_.size_px.x - 1)) {
        const std::uint8_t* rgb = &(*canvas_.rgb)[3 * pixel_index(canvas_.size_px, x, y)];
        for (int channel = 0; channel < 3; ++channel) sum += SrgbTable::table().linear(rgb[channel]);
        count += 3;
      }
    }
    return static_cast<float>(sum / static_cast<double>(count));
  }

  Canvas canvas_;
  double cap_px_;
  bool dark_;
};

void write_sides(const Sheet& sheet, const EdgeLetters& letters) {
  const double cap = sheet.cap_px();
  const glm::dvec2 size = sheet.size_px();
  const double middle = 0.5 * (size.y + cap);
  sheet.write(letters.left, {cap, middle}, Align::Left);
  sheet.write(letters.right, {size.x - cap, middle}, Align::Right);
  sheet.write(letters.top, {0.5 * size.x, 2.0 * cap}, Align::Middle);
  sheet.write(letters.bottom, {0.5 * size.x, size.y - cap}, Align::Middle);
}

void draw_scale(const Sheet& sheet, double pixel_mm) {
  const double cap = sheet.cap_px();
  const glm::dvec2 size = sheet.size_px();
  const double length_mm = round_length(0.25 * size.x * pixel_mm);
  const glm::dvec2 right(size.x - cap, size.y - 1.5 * cap);
  const glm::dvec2 left = right - glm::dvec2(length_mm / pixel_mm, 0.0);
  const glm::dvec2 tick(0.0, 0.4 * cap);
  draw_lines(sheet.canvas(), {{left - tick, left + tick}, {left, right}, {right - tick, right + tick}},
             sheet.pen(sheet.stroke_px()));
  sheet.write(number_text(length_mm) + " mm", {0.5 * (left.x + right.x), right.y - 0.8 * cap}, Align::Middle);
}

void write_legend(const Sheet& sheet, const std::vector<LegendEntry>& legend) {
  const double cap = sheet.cap_px();
  const double line_px = 1.9 * cap;
  // The legend must end before the letter at the middle of the lower edge.
  const double room_px = 0.5 * sheet.size_px().x - 5.0 * cap;
  double baseline = sheet.size_px().y - cap - line_px * (static_cast<double>(legend.size()) - 1.0);
  for (const LegendEntry& entry : legend) {
    const glm::ivec2 first(std::lround(cap), std::lround(baseline - 1.1 * cap));
    const glm::ivec2 last = first + glm::ivec2(std::lround(1.6 * cap), std::lround(1.2 * cap));
    const Pen rim = sheet.pen(1.0);
    fill_rectangle(sheet.canvas(), first - 1, last + 1, rim.colour);
    fill_rectangle(sheet.canvas(), first, last, entry.colour);
    sheet.write(shortened(entry.name, room_px, cap), {3.4 * cap, baseline}, Align::Left);
    baseline += line_px;
  }
}

void draw_bar(const Sheet& sheet, const ColourBar& bar) {
  const double cap = sheet.cap_px();
  const glm::dvec2 size = sheet.size_px();
  // The bar must lie above the letter at the middle of the right edge and below the title.
  const int top = static_cast<int>(std::lround(4.5 * cap));
  const int bottom = std::max(top + 1, static_cast<int>(std::lround(0.5 * size.y - 2.5 * cap)));
  const int right = static_cast<int>(std::lround(size.x - cap));
  const int left = right - static_cast<int>(std::lround(1.3 * cap));
  fill_rectangle(sheet.canvas(), {left - 1, top - 1}, {right + 1, bottom + 1}, sheet.pen(1.0).colour);
  for (int y = top; y < bottom; ++y) {
    const double place = (bottom - y - 0.5) / (bottom - top);
    const auto colour = static_cast<std::size_t>(place * static_cast<double>(bar.colours.size()));
    fill_rectangle(sheet.canvas(), {left, y}, {right, y + 1},
                   bar.colours[std::min(colour, bar.colours.size() - 1)]);
  }
  sheet.write(shortened(bar.title, 0.5 * size.x - 2.0 * cap, cap),
              {static_cast<double>(right), top - 1.6 * cap}, Align::Right);
  for (const double place : {0.0, 0.5, 1.0}) {
    const double y = bottom + place * (top - bottom);
    const glm::dvec2 end(left - 1.0, y);
    draw_lines(sheet.canvas(), {{end - glm::dvec2(0.4 * cap, 0.0), end}}, sheet.pen(1.0));
    sheet.write(number_text(bar.low + place * (bar.high - bar.low)), {end.x - 0.8 * cap, y + 0.5 * cap},
                Align::Right);
  }
}

}  // namespace

std::string patient_side(const glm::dvec3& direction) {
  constexpr std::array<std::array<char, 2>, 3> letters{{{'R', 'L'}, {'A', 'P'}, {'I', 'S'}}};
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(),
                   [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  const auto letter = [&](int axis) {
    return letters[static_cast<std::size_t>(axis)][direction[axis] > 0.0 ? 1 : 0];
  };
  std::string side(1, letter(axes[0]));
  const double tangent_22_5 = std::sqrt(2.0) - 1.0;
  if (std::abs(direction[axes[1]]) > tangent_22_5 * std::abs(direction[axes[0]])) side += letter(axes[1]);
  return side;
}

EdgeLetters edge_letters(const View& view) {
  return {patient_side(-view.right), patient_side(view.right), patient_side(view.up), patient_side(-view.up)};
}

double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  // Powers of ten below one are inexact. Because of the factor, 0.005 / 0.001 is not below 5.
  const double digits = most / power * (1.0 + 1e-12);
  if (digits >= 10.0) return 10.0 * power;
  return (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0) * power;
}

void annotate(std::vector<std::uint8_t>& rgb, const ImagePlane& plane, const Annotation& annotation) {
  if (plane.size_px.x < 1 || plane.size_px.y < 1 || rgb.size() != std::size_t{3} * pixel_count(plane.size_px))
    throw std::invalid_argument("the number of pixels to annotate is not that of the picture's plane");
  if (annotation.bar && (annotation.bar->colours.empty() || !(annotation.bar->high > annotation.bar->low)))
    throw std::invalid_argument("a colour bar needs at least one colour, and low below high");
  const Sheet sheet(Canvas{plane.size_px, &rgb});
  const double cap = sheet.cap_px();
  if (annotation.scale && !plane.eye) draw_scale(sheet, plane.pixel_mm);
  if (annotation.bar) draw_bar(sheet, *annotation.bar);
  write_legend(sheet, annotation.legend);
  // The title must end before the letter at the middle of the upper edge, or before the bar's title.
  const double share = annotation.sides || annotation.bar ? 0.5 : 1.0;
  sheet.write(shortened(annotation.title, share * sheet.size_px().x - 4.0 * cap, cap), {cap, 2.0 * cap},
              Align::Left);
  if (annotation.sides) write_sides(sheet, annotation.letters.value_or(edge_letters(plane.view)));
}

}  // namespace octotomy::voxel
