// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/shade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/surface_break.h"

// Passes over flat planes of floats, each in parallel over rows:
// 1 copy depths into a plane with a margin of background; 2 smooth, steps more than the rest; 3 slopes; 4 the
// mean depth about every cell of 4 x 4 pixels; 5 light every pixel from slope, depth and mean depth.
//
// Departures from Gordon and Reynolds: weights fall smoothly to nothing instead of in three pieces, and three
// parallel differences are averaged. Smoothing keeps planes, since it only ever averages two pixels on
// opposite sides, and keeps every depth within the voxel that it was found in (after Gibson 1998, constrained
// elastic surface nets).

namespace octotomy::voxel {
namespace {

/// Depth of pixels that see nothing: beyond every universe, small enough for differences to stay exact zeros
/// when weighted with zero.
constexpr float beyond_mm = 1e9f;
constexpr float surely_lit_mm = 0.5f * beyond_mm;

/// A plane of values with a margin on all sides.
struct Plane {
  Plane(const glm::ivec2& size, int margin_px, float value)
      : width(size.x + 2 * margin_px),
        margin(margin_px),
        values(static_cast<std::size_t>(width) * static_cast<std::size_t>(size.y + 2 * margin_px), value) {}
  /// Pixel 0 of a row; rows and pixels may reach into the margin.
  float* row(int y) { return values.data() + offset(y); }
  const float* row(int y) const { return values.data() + offset(y); }
  std::ptrdiff_t offset(int y) const { return static_cast<std::ptrdiff_t>(y + margin) * width + margin; }

  int width;
  int margin;
  std::vector<float> values;
};

/// Pixels between the points of a difference: those to a voxel, one at least. Closer, the difference would
/// see single facets of the interpolation.
int stride_px(const Scenery& scenery) {
  return std::clamp(static_cast<int>(std::lround(scenery.voxel_mm / scenery.pixel_mm)), 1, 64);
}

/// Taps of smoothing on each side, a voxel apart: so that a slope with a step every four voxels becomes a
/// plane, and waves as long as slices four voxels thick leave them in interpolated depths are flattened.
constexpr int smoothing_taps = 4;

/// One pass of smoothing along x or y: the mean over pairs of pixels at equal distance on both sides that
/// continue the surface, weighted by a triangle.
class Smoothing {
 public:
  explicit Smoothing(const Scenery& scenery)
      : step_(stride_px(scenery)),
        band_mm_(static_cast<float>(0.5 * scenery.voxel_mm)),
        limit_mm_(static_cast<float>(break_mm(step_ * scenery.pixel_mm) / 2.0)) {}

  int reach_px() const { return smoothing_taps * step_; }

  /// The depth at `here`, whose neighbours along the line are `stride` values apart and which was found at
  /// `found_mm`. Values as far as reach_px() must be there on both sides.
  float depth(const float* here, std::ptrdiff_t stride, float found_mm) const {
    const float centre = *here;
    float sum = static_cast<float>(smoothing_taps + 1) * centre;
    auto weights = static_cast<float>(smoothing_taps + 1);
    for (int tap = 1; tap <= smoothing_taps; ++tap) {
      const float one = here[tap * step_ * stride];
      const float other = here[-tap * step_ * stride];
      const float limit = limit_mm_ * static_cast<float>(tap);
      if (std::abs(one - centre) > limit || std::abs(other - centre) > limit) break;
      const auto weight = static_cast<float>(smoothing_taps + 1 - tap);
      sum += weight * (one + other);
      weights += 2.0f * weight;
    }
    return std::clamp(sum / weights, found_mm - band_mm_, found_mm + band_mm_);
  }

 private:
  int step_;       ///< pixels between taps
  float band_mm_;  ///< how far a depth may be moved
  float limit_mm_;
};

/// Passes along x and y, then for what is stepped once more.
void smooth(const DepthImage& image, const Smoothing& smoothing, bool any_stepped, Plane& depth) {
  const Plane original = depth;
  Plane between = depth;
  for (int pass = 0; pass < (any_stepped ? 4 : 2); ++pass) {
    const bool along_x = pass % 2 == 0;
    const Plane& from = along_x ? depth : between;
    Plane& to = along_x ? between : depth;
    const std::ptrdiff_t stride = along_x ? 1 : depth.width;
    tbb::parallel_for(0, image.size_px.y, [&](int y) {
      const float* here = from.row(y);
      const float* found = original.row(y);
      for (int x = 0; x < image.size_px.x; ++x) {
        const Seen& seen = image.at(x, y);
        if (!seen.lit()) continue;
        to.row(y)[x] = seen.stepped || pass < 2 ? smoothing.depth(here + x, stride, found[x]) : here[x];
      }
    });
  }
}

/// Passes 1 and 2.
Plane depth_plane(const DepthImage& image, const Scenery& scenery) {
  const Smoothing smoothing(scenery);
  Plane depth(image.size_px, smoothing.reach_px(), beyond_mm);
  std::vector<std::uint8_t> stepped(static_cast<std::size_t>(image.size_px.y), 0);
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    float* row = depth.row(y);
    bool any = false;
    for (int x = 0; x < image.size_px.x; ++x) {
      const Seen& seen = image.at(x, y);
      row[x] = seen.lit() ? seen.depth_mm : beyond_mm;
      any = any || seen.stepped;
    }
    stepped[static_cast<std::size_t>(y)] = any ? 1 : 0;
  });
  smooth(image, smoothing, std::find(stepped.begin(), stepped.end(), 1) != stepped.end(), depth);
  return depth;
}

/// A weighted sum of differences.
struct Mean {
  float sum = 0.0f;
  float weights = 0.0f;
};

/// The weight of a difference of depth, given 1 / limit^2: one for none, next to nothing from the limit on.
/// Next to nothing still lets a slope steeper than the limit be seen where no other difference is at hand.
float continuity(float difference, float per_limit2) {
  const float relative = 1.0f - difference * difference * per_limit2;
  const float weight = relative > 1e-4f ? relative : 1e-4f;
  return std::abs(difference) < surely_lit_mm ? weight : 0.0f;
}

void add(Mean& mean, float difference, float weight, float per_limit2) {
  const float w = weight * continuity(difference, per_limit2);
  mean.sum += w * difference;
  mean.weights += w;
}

/// Pass 3 for one row, in millimetres of depth for one stride.
void slope_row(const Plane& depth, int y, int width, int stride, float limit_mm, float* to_right,
               float* to_top) {
  const float per_limit2 = 1.0f / (limit_mm * limit_mm);
  const float* above = depth.row(y - stride);
  const float* here = depth.row(y);
  const float* below = depth.row(y + stride);
  for (int x = 0; x < width; ++x) {
    const float centre = here[x];
    const float side_above = continuity(above[x] - centre, per_limit2);
    const float side_below = continuity(below[x] - centre, per_limit2);
    const float side_left = continuity(here[x - stride] - centre, per_limit2);
    const float side_right = continuity(here[x + stride] - centre, per_limit2);
    Mean right;
    add(right, here[x + stride] - centre, 2.0f, per_limit2);
    add(right, centre - here[x - stride], 2.0f, per_limit2);
    add(right, above[x + stride] - above[x], side_above, per_limit2);
    add(right, above[x] - above[x - stride], side_above, per_limit2);
    add(right, below[x + stride] - below[x], side_below, per_limit2);
    add(right, below[x] - below[x - stride], side_below, per_limit2);
    Mean top;
    add(top, above[x] - centre, 2.0f, per_limit2);
    add(top, centre - below[x], 2.0f, per_limit2);
    add(top, above[x - stride] - here[x - stride], side_left, per_limit2);
    add(top, here[x - stride] - below[x - stride], side_left, per_limit2);
    add(top, above[x + stride] - here[x + stride], side_right, per_limit2);
    add(top, here[x + stride] - below[x + stride], side_right, per_limit2);
    to_right[x] = right.sum / (right.weights + 1e-20f);
    to_top[x] = top.sum / (top.weights + 1e-20f);
  }
}

/// Pass 4: mean depth of what is lit about a pixel, on a grid of cells.
class Surroundings {
 public:
  static constexpr int cell_px = 4;

  Surroundings(const Plane& depth, const glm::ivec2& size_px)
      : cells_((size_px + (cell_px - 1)) / cell_px), sums_(count()), lit_(count()) {
    tbb::parallel_for(0, cells_.y, [&](int cell_y) {
      for (int y = cell_y * cell_px; y < std::min((cell_y + 1) * cell_px, size_px.y); ++y) {
        const float* row = depth.row(y);
        for (int x = 0; x < size_px.x; ++x)
          if (row[x] < surely_lit_mm) {
            sums_[index(x / cell_px, cell_y)] += row[x];
            lit_[index(x / cell_px, cell_y)] += 1.0f;
          }
      }
    });
    // A fortieth of the picture on each side, twice.
    const int reach = std::max(1, std::max(size_px.x, size_px.y) / (40 * cell_px));
    for (int pass = 0; pass < 2; ++pass) {
      blur(sums_, reach);
      blur(lit_, reach);
    }
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] = lit_[i] > 0.0f ? sums_[i] / lit_[i] : 0.0f;
  }

  /// Precondition: the pixel is lit.
  float mean_mm(int x, int y) const {
    const auto along = [](int pixel, int cells, int& low, float& t) {
      const float at = std::clamp((static_cast<float>(pixel) + 0.5f) / static_cast<float>(cell_px) - 0.5f,
                                  0.0f, static_cast<float>(cells - 1));
      low = std::min(static_cast<int>(at), std::max(cells - 2, 0));
      t = at - static_cast<float>(low);
    };
    int i = 0;
    int j = 0;
    float s = 0.0f;
    float t = 0.0f;
    along(x, cells_.x, i, s);
    along(y, cells_.y, j, t);
    float sum = 0.0f;
    float weights = 0.0f;
    for (int corner = 0; corner < 4; ++corner) {
      const int ci = std::min(i + (corner & 1), cells_.x - 1);
      const int cj = std::min(j + (corner >> 1), cells_.y - 1);
      const float weight = lit_[index(ci, cj)] > 0.0f
                               ? ((corner & 1) != 0 ? s : 1.0f - s) * ((corner >> 1) != 0 ? t : 1.0f - t)
                               : 0.0f;
      sum += weight * sums_[index(ci, cj)];
      weights += weight;
    }
    return sum / weights;
  }

 private:
  std::size_t count() const {
    return static_cast<std::size_t>(cells_.x) * static_cast<std::size_t>(cells_.y);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
  }
  /// Sums over 2 reach + 1 cells along x, then y.
  void blur(std::vector<float>& values, int reach) const {
    std::vector<float> between(values.size());
    for (int y = 0; y < cells_.y; ++y)
      for (int x = 0; x < cells_.x; ++x) {
        float sum = 0.0f;
        for (int i = std::max(0, x - reach); i <= std::min(cells_.x - 1, x + reach); ++i)
          sum += values[index(i, y)];
        between[index(x, y)] = sum;
      }
    std::fill(values.begin(), values.end(), 0.0f);
    for (int y = 0; y < cells_.y; ++y)
      for (int j = std::max(0, y - reach); j <= std::min(cells_.y - 1, y + reach); ++j)
        for (int x = 0; x < cells_.x; ++x) values[index(x, y)] += between[index(x, j)];
  }

  glm::ivec2 cells_;
  std::vector<float> sums_;
  std::vector<float> lit_;
};

float linear_from_srgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}
float srgb_from_linear(float value) {
  return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
}

/// sRGB and linear light by table: IEC 61966-2-1.
class Tone {
 public:
  Tone() {
    for (std::size_t i = 0; i < to_srgb_.size(); ++i) {
      const float root = static_cast<float>(i) / static_cast<float>(to_srgb_.size() - 1);
      to_srgb_[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_from_linear(root * root)));
    }
    for (std::size_t i = 0; i < to_linear_.size(); ++i)
      to_linear_[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
  }
  /// The table runs over square roots, in which sRGB is nearly linear: 1024 steps meet all 256 values.
  std::uint8_t srgb(float linear) const {
    const float root = std::sqrt(std::clamp(linear, 0.0f, 1.0f));
    constexpr float to_nearest = 0.5f;
    return to_srgb_[static_cast<std::size_t>(to_nearest + root * static_cast<float>(to_srgb_.size() - 1))];
  }
  float linear(std::uint8_t srgb) const { return to_linear_[srgb]; }

 private:
  std::array<std::uint8_t, 1024> to_srgb_{};
  std::array<float, 256> to_linear_{};
};

const Tone& tone() {
  static const Tone table;
  return table;
}

glm::vec3 linear_from_srgb(const glm::vec3& colour) {
  return {linear_from_srgb(colour.x), linear_from_srgb(colour.y), linear_from_srgb(colour.z)};
}

void put(std::uint8_t* rgb, const glm::vec3& linear) {
  for (int channel = 0; channel < 3; ++channel) rgb[channel] = tone().srgb(linear[channel]);
}

/// Phong's model in (right, up, look).
class Lighting {
 public:
  explicit Lighting(const Scenery& scenery) : ambient_(scenery.ambient), gloss_(scenery.gloss) {
    for (const Light& light : scenery.lights)
      lights_.push_back({glm::normalize(light.towards), light.strength});
    // Halfway between the light and the observer: where a surface would mirror it.
    if (!lights_.empty()) halfway_ = glm::normalize(lights_.front().towards + glm::vec3(0.0f, 0.0f, -1.0f));
  }

  float diffuse(const glm::vec3& normal) const {
    float light = ambient_;
    for (const Light& each : lights_) light += each.strength * std::max(0.0f, glm::dot(normal, each.towards));
    return light;
  }
  /// The power of 48 by squarings.
  float glossy(const glm::vec3& normal) const {
    if (lights_.empty()) return 0.0f;
    const float mirror = std::max(0.0f, glm::dot(normal, halfway_));
    const float mirror2 = mirror * mirror;
    const float mirror8 = mirror2 * mirror2 * mirror2 * mirror2;
    const float mirror16 = mirror8 * mirror8;
    return gloss_ * mirror16 * mirror16 * mirror16;
  }

 private:
  std::vector<Light> lights_;
  glm::vec3 halfway_{0.0f, 0.0f, -1.0f};
  float ambient_, gloss_;
};

/// How much of the light reaches a pixel that lies `behind_mm` behind its surroundings, as a part of the
/// picture's width.
float openness(float behind_mm, float width_mm) {
  return 1.0f / (1.0f + 12.0f * std::max(0.0f, behind_mm) / width_mm);
}

std::size_t pixel_index(const DepthImage& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size_px.x) +
         static_cast<std::size_t>(x);
}

float nearest_mm(const DepthImage& image) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const Seen& seen : image.pixels) nearest = std::min(nearest, seen.depth_mm);
  return nearest;
}

/// Calls `row(y, to_right, to_top)` with each row's slopes, without unit.
template <typename Row>
void each_slope_row(const DepthImage& image, const Scenery& scenery, const Plane& depth, const Row& row) {
  const int stride = stride_px(scenery);
  const double stride_mm = stride * scenery.pixel_mm;
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    thread_local std::vector<float> to_right;
    thread_local std::vector<float> to_top;
    to_right.resize(static_cast<std::size_t>(image.size_px.x));
    to_top.resize(to_right.size());
    slope_row(depth, y, image.size_px.x, stride, static_cast<float>(break_mm(stride_mm)), to_right.data(),
              to_top.data());
    const auto per_mm = static_cast<float>(1.0 / stride_mm);
    for (std::size_t x = 0; x < to_right.size(); ++x) {
      to_right[x] *= per_mm;
      to_top[x] *= per_mm;
    }
    row(y, to_right, to_top);
  });
}

}  // namespace

std::vector<glm::vec2> slopes(const DepthImage& image, const Scenery& scenery) {
  const Plane depth = depth_plane(image, scenery);
  std::vector<glm::vec2> result(image.pixels.size());
  each_slope_row(image, scenery, depth,
                 [&](int y, const std::vector<float>& to_right, const std::vector<float>& to_top) {
                   for (int x = 0; x < image.size_px.x; ++x)
                     if (image.at(x, y).lit())
                       result[pixel_index(image, x, y)] = {to_right[static_cast<std::size_t>(x)],
                                                           to_top[static_cast<std::size_t>(x)]};
                 });
  return result;
}

namespace {

/// Pictures of one tone an object: Depth, Silhouette.
std::vector<std::uint8_t> flat_picture(const DepthImage& image, const Scenery& scenery) {
  std::vector<std::uint8_t> rgb(3 * image.pixels.size());
  const float nearest = nearest_mm(image);
  float farthest = nearest;
  for (const Seen& seen : image.pixels)
    if (seen.lit()) farthest = std::max(farthest, seen.depth_mm);
  const float per_span = farthest > nearest ? 1.0f / (farthest - nearest) : 0.0f;
  tbb::parallel_for(std::size_t{0}, image.pixels.size(), [&](std::size_t i) {
    const Seen& seen = image.pixels[i];
    glm::vec3 colour = linear_from_srgb(scenery.background);
    if (seen.lit()) {
      colour = linear_from_srgb(scenery.colours[static_cast<std::size_t>(seen.object)]);
      // The farthest keeps a tenth, so that it stays apart from black.
      if (scenery.style == Style::Depth) colour *= 1.0f - 0.9f * (seen.depth_mm - nearest) * per_span;
    }
    put(&rgb[3 * i], colour);
  });
  return rgb;
}

/// Lines where a surface ends or its slope changes by more than a crease's.
std::vector<std::uint8_t> outline_picture(const DepthImage& image, const Scenery& scenery) {
  std::vector<std::uint8_t> rgb(3 * image.pixels.size(), 255);
  const auto blacken = [&](std::size_t pixel) {
    for (std::size_t channel = 0; channel < 3; ++channel) rgb[3 * pixel + channel] = 0;
  };
  for (const std::uint32_t pixel : edge_pixels(image, scenery))
    if (image.pixels[pixel].lit()) blacken(pixel);
  const std::vector<glm::vec2> slope = slopes(image, scenery);
  const auto normal = [&](std::size_t pixel) {
    return glm::normalize(glm::vec3(slope[pixel].x, slope[pixel].y, -1.0f));
  };
  // Two sides of an edge of the body, not of its relief: 40 degrees apart within two pixels.
  constexpr float cosine_of_crease = 0.766f;
  for (int y = 0; y + 2 < image.size_px.y; ++y)
    for (int x = 0; x + 2 < image.size_px.x; ++x) {
      const std::size_t here = pixel_index(image, x, y);
      if (!image.pixels[here].lit()) continue;
      for (const std::size_t other : {pixel_index(image, x + 2, y), pixel_index(image, x, y + 2)})
        if (image.pixels[other].lit() && glm::dot(normal(here), normal(other)) < cosine_of_crease)
          blacken(here);
    }
  return rgb;
}

std::vector<std::uint8_t> shaded_picture(const DepthImage& image, const Scenery& scenery,
                                         std::span<const glm::vec3> normals) {
  const Plane depth = depth_plane(image, scenery);
  std::optional<Surroundings> surroundings;
  if (scenery.occlusion) surroundings.emplace(depth, image.size_px);
  const Lighting lighting(scenery);
  const float nearest = nearest_mm(image);
  const auto per_range = static_cast<float>(scenery.depth_cue ? 1.0 / scenery.depth_range_mm : 0.0);
  const auto width_mm = static_cast<float>(scenery.pixel_mm * image.size_px.x);
  std::vector<glm::vec3> colours;
  for (const glm::vec3& colour : scenery.colours) colours.push_back(linear_from_srgb(colour));
  const glm::vec3 background = linear_from_srgb(scenery.background);
  std::vector<std::uint8_t> rgb(3 * image.pixels.size());
  each_slope_row(image, scenery, depth,
                 [&](int y, const std::vector<float>& to_right, const std::vector<float>& to_top) {
                   const float* depths = depth.row(y);
                   for (int x = 0; x < image.size_px.x; ++x) {
                     const std::size_t index = pixel_index(image, x, y);
                     const Seen& seen = image.pixels[index];
                     if (!seen.lit()) {
                       put(&rgb[3 * index], background);
                       continue;
                     }
                     // Depth grows towards the side that a surface turns away from, so its normal leans
                     // there.
                     const glm::vec3 normal =
                         normals.empty()
                             ? glm::normalize(glm::vec3(to_right[static_cast<std::size_t>(x)],
                                                        to_top[static_cast<std::size_t>(x)], -1.0f))
                             : normals[index];
                     const float cue = 1.0f - 0.35f * std::min(1.0f, (seen.depth_mm - nearest) * per_range);
                     const float open =
                         surroundings ? openness(depths[x] - surroundings->mean_mm(x, y), width_mm) : 1.0f;
                     const float light = cue * open;
                     put(&rgb[3 * index],
                         colours[static_cast<std::size_t>(seen.object)] * (light * lighting.diffuse(normal)) +
                             light * lighting.glossy(normal));
                   }
                 });
  return rgb;
}

}  // namespace

std::vector<std::uint8_t> shade(const DepthImage& image, const Scenery& scenery,
                                std::span<const glm::vec3> normals) {
  switch (scenery.style) {
    case Style::Depth:
    case Style::Silhouette:
      return flat_picture(image, scenery);
    case Style::Outline:
      return outline_picture(image, scenery);
    case Style::Shaded:
      break;
  }
  return shaded_picture(image, scenery, normals);
}

std::vector<std::uint32_t> edge_pixels(const DepthImage& image, const Scenery& scenery) {
  // Breaks of less than twice the smallest show no jag.
  const auto limit_mm = static_cast<float>(2.0 * break_mm(std::max(scenery.pixel_mm, scenery.voxel_mm)));
  std::vector<std::uint32_t> edges;
  const auto ends = [&](const Seen& a, const Seen& b) {
    return a.object != b.object || std::abs(a.depth_mm - b.depth_mm) > limit_mm;
  };
  for (int y = 0; y < image.size_px.y; ++y)
    for (int x = 0; x < image.size_px.x; ++x) {
      const Seen& seen = image.at(x, y);
      if ((x > 0 && ends(seen, image.at(x - 1, y))) ||
          (x + 1 < image.size_px.x && ends(seen, image.at(x + 1, y))) ||
          (y > 0 && ends(seen, image.at(x, y - 1))) ||
          (y + 1 < image.size_px.y && ends(seen, image.at(x, y + 1))))
        edges.push_back(static_cast<std::uint32_t>(pixel_index(image, x, y)));
    }
  return edges;
}

std::array<std::uint8_t, 3> blend(const DepthImage& image, const std::vector<std::uint8_t>& rgb,
                                  const Scenery& scenery, std::uint32_t pixel, std::span<const Seen> parts) {
  const int x = static_cast<int>(pixel) % image.size_px.x;
  const int y = static_cast<int>(pixel) / image.size_px.x;
  const glm::vec3 background = linear_from_srgb(scenery.background);
  glm::vec3 sum(0.0f);
  for (const Seen& part : parts) {
    if (!part.lit()) {
      sum += background;
      continue;
    }
    std::size_t nearest = pixel;
    float least = std::numeric_limits<float>::infinity();
    for (int j = std::max(0, y - 1); j <= std::min(image.size_px.y - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(image.size_px.x - 1, x + 1); ++i) {
        const Seen& neighbour = image.at(i, j);
        const float apart = std::abs(neighbour.depth_mm - part.depth_mm);
        if (neighbour.object != part.object || apart >= least) continue;
        least = apart;
        nearest = pixel_index(image, i, j);
      }
    for (int channel = 0; channel < 3; ++channel)
      sum[channel] += tone().linear(rgb[3 * nearest + static_cast<std::size_t>(channel)]);
  }
  std::array<std::uint8_t, 3> mean{};
  put(mean.data(), sum / static_cast<float>(parts.size()));
  return mean;
}

}  // namespace octotomy::voxel
