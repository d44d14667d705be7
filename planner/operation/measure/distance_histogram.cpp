// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/distance_histogram.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "voxel/view/lettering.h"
#include "voxel/view/pen.h"

namespace octotomy::planner {
namespace {

constexpr glm::ivec2 size_px(900, 480);
/// Corners of the picture's field with the bars, in pixels.
constexpr glm::dvec2 field_low(70.0, 60.0), field_high(870.0, 410.0);
constexpr double cap_px = 11.0;

/// The step of a scale: 1, 2 or 5 times a power of ten, so that the extent has about five steps.
double tick_step(double extent) {
  const double rough = extent / 5.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / power;
  return power * (share < 1.5 ? 1.0 : share < 3.5 ? 2.0 : share < 7.5 ? 5.0 : 10.0);
}

class Sheet {
 public:
  Sheet(const brep::Difference& difference, double range_mm) : difference_(difference), range_mm_(range_mm) {
    picture_.size_px = size_px;
    picture_.rgb.assign(3 * static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y), 255);
    canvas_ = {size_px, &picture_.rgb};
    const brep::DistanceHistogram& histogram = difference.histogram;
    low_mm_ = histogram.low_mm;
    extent_mm_ = histogram.width_mm * static_cast<double>(histogram.shares.size());
    highest_ = *std::max_element(histogram.shares.begin(), histogram.shares.end());
  }

  HistogramPicture run() {
    draw_bars();
    draw_scales();
    write("signed distance of A's surface to B, mm: blue inside, red outside; share of area", {70, 30});
    write("mean " + ascii(difference_.mean_mm, 3) + "  rms " + ascii(difference_.rms_mm, 3) +
              "  Hausdorff 95 " + ascii(difference_.hausdorff95_mm, 3) + "  Hausdorff " +
              ascii(difference_.hausdorff_mm, 3) + " mm",
          {70, 462});
    return std::move(picture_);
  }

 private:
  static std::string ascii(double value, int decimals) {
    std::string text(40, '\0');
    text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.*f", decimals, value)));
    return text;
  }
  double x_of(double mm) const {
    return extent_mm_ > 0.0 ? field_low.x + (mm - low_mm_) / extent_mm_ * (field_high.x - field_low.x)
                            : 0.5 * (field_low.x + field_high.x);
  }
  double y_of(double share) const {
    return field_high.y - (highest_ > 0.0 ? share / highest_ : 0.0) * (field_high.y - field_low.y);
  }

  void draw_bars() {
    const brep::DistanceHistogram& histogram = difference_.histogram;
    for (std::size_t k = 0; k < histogram.shares.size(); ++k) {
      const double from = histogram.low_mm + static_cast<double>(k) * histogram.width_mm;
      const glm::u8vec3 colour = distance_colour(from + 0.5 * histogram.width_mm, range_mm_);
      const glm::ivec2 low(std::lround(x_of(from)), std::lround(y_of(histogram.shares[k])));
      const glm::ivec2 high(
          std::max(low.x + 1, static_cast<int>(std::lround(x_of(from + histogram.width_mm)))),
          std::lround(field_high.y));
      if (low.y >= high.y) continue;
      // A rim is drawn, because bars near zero are white.
      voxel::fill_rectangle(canvas_, low, high, glm::vec3(0.45f));
      if (high.x - low.x > 2 && high.y - low.y > 1)
        voxel::fill_rectangle(canvas_, low + glm::ivec2(1), high - glm::ivec2(1, 0),
                              glm::vec3(colour) / 255.0f);
    }
  }

  void draw_scales() {
    line({field_low.x, field_high.y}, field_high);
    line({field_low.x, field_low.y}, {field_low.x, field_high.y});
    if (extent_mm_ > 0.0) {
      const double step = tick_step(extent_mm_);
      for (double tick = std::ceil(low_mm_ / step) * step; tick <= low_mm_ + extent_mm_; tick += step) {
        line({x_of(tick), field_high.y}, {x_of(tick), field_high.y + 6});
        const std::string text = ascii(tick + 0.0, step < 0.01 ? 4 : step < 1.0 ? 2 : 0);
        write(text, {x_of(tick) - 0.5 * voxel::text_width_px(text, cap_px), field_high.y + 24});
      }
    }
    if (highest_ > 0.0) {
      const double step = tick_step(highest_);
      for (double tick = 0.0; tick <= highest_; tick += step) {
        line({field_low.x - 6, y_of(tick)}, {field_low.x, y_of(tick)});
        write(ascii(100.0 * tick, step < 0.01 ? 1 : 0) + " %", {8, y_of(tick) + 0.5 * cap_px});
      }
    }
  }

  void line(const glm::dvec2& from, const glm::dvec2& to) {
    voxel::draw_lines(canvas_, {{from, to}}, {1.0, glm::vec3(0.25f)});
  }
  void write(const std::string& text, const glm::dvec2& start) {
    voxel::draw_lines(canvas_, voxel::strokes_of_text(text, start, cap_px), {1.3, glm::vec3(0.1f)});
  }

  const brep::Difference& difference_;
  double range_mm_, low_mm_ = 0.0, extent_mm_ = 0.0, highest_ = 0.0;
  HistogramPicture picture_;
  voxel::Canvas canvas_;
};

}  // namespace

glm::u8vec3 distance_colour(double distance_mm, double range_mm) {
  const glm::dvec3 white(247.0), outside(178.0, 24.0, 43.0), inside(33.0, 102.0, 172.0);
  const double share = range_mm > 0.0 ? std::clamp(std::abs(distance_mm) / range_mm, 0.0, 1.0) : 0.0;
  return glm::u8vec3(glm::round(glm::mix(white, distance_mm > 0.0 ? outside : inside, share)));
}

HistogramPicture draw_histogram(const brep::Difference& difference, double range_mm) {
  if (difference.histogram.shares.empty())
    throw std::invalid_argument("draw_histogram: the histogram has no bins: request at least one");
  return Sheet(difference, range_mm).run();
}

}  // namespace octotomy::planner
