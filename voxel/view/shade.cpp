// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/shade.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "voxel/space/vector_clones.h"
#include "voxel/view/depth_plane.h"
#include "voxel/view/mean_depth.h"
#include "voxel/view/pixel_index.h"
#include "voxel/view/srgb.h"

// Passes over flat planes of floats, each in parallel over rows:
// 1 smooth depths (depth_plane.h); 2 compute slopes; 3 compute the mean depth around every cell of 4 x 4
// pixels (mean_depth.h); 4 light every pixel from slope, depth and mean depth; 5 map light to sRGB.
//
// Departures from Gordon and Reynolds: the weights are a smooth function that falls to almost zero, instead
// of three pieces, and three parallel differences are averaged.

namespace octotomy::voxel {
namespace {

/// The weight of a difference of depth, given 1 / limit^2: 1 for no difference, 0.0001 from the limit on.
/// Because this weight is not zero, a slope steeper than the limit is still computed where no other
/// difference is available.
inline float continuity(float difference, float per_limit2) {
  const float relative = 1.0f - difference * difference * per_limit2;
  const float weight = relative > 1e-4f ? relative : 1e-4f;
  return std::abs(difference) < surely_lit_mm ? weight : 0.0f;
}

/// The depths of three rows, `stride` apart, and the constants for computing slopes from them.
struct SlopeRows {
  const float* above = nullptr;
  const float* here = nullptr;
  const float* below = nullptr;
  int stride = 1;
  float per_limit2 = 1.0f;
  float per_mm = 1.0f;  ///< 1 / the length of a stride in mm
};

/// Pass 2 for the pixels of one row from `first` up to, not including, `last`: slopes without unit.
OCTOTOMY_VECTOR_CLONES void slope_row(const SlopeRows& rows, int first, int last, float* __restrict to_right,
                                      float* __restrict to_top) {
  const float* const above = rows.above;
  const float* const here = rows.here;
  const float* const below = rows.below;
  const int stride = rows.stride;
  const float per_limit2 = rows.per_limit2;
  const float per_mm = rows.per_mm;
  for (int x = first; x < last; ++x) {
    const float c = here[x], l = here[x - stride], r = here[x + stride];
    const float a = above[x], al = above[x - stride], ar = above[x + stride];
    const float b = below[x], bl = below[x - stride], br = below[x + stride];
    // The weights of the four differences to the centre are used for both directions.
    const float to_l = continuity(c - l, per_limit2), to_r = continuity(r - c, per_limit2);
    const float to_a = continuity(a - c, per_limit2), to_b = continuity(c - b, per_limit2);
    const float r1 = to_a * continuity(ar - a, per_limit2), r2 = to_a * continuity(a - al, per_limit2);
    const float r3 = to_b * continuity(br - b, per_limit2), r4 = to_b * continuity(b - bl, per_limit2);
    const float right = 2.0f * to_r * (r - c) + 2.0f * to_l * (c - l) + r1 * (ar - a) + r2 * (a - al) +
                        r3 * (br - b) + r4 * (b - bl);
    to_right[x] = per_mm * right / (2.0f * to_r + 2.0f * to_l + r1 + r2 + r3 + r4 + 1e-20f);
    const float t1 = to_l * continuity(al - l, per_limit2), t2 = to_l * continuity(l - bl, per_limit2);
    const float t3 = to_r * continuity(ar - r, per_limit2), t4 = to_r * continuity(r - br, per_limit2);
    const float top = 2.0f * to_a * (a - c) + 2.0f * to_b * (c - b) + t1 * (al - l) + t2 * (l - bl) +
                      t3 * (ar - r) + t4 * (r - br);
    to_top[x] = per_mm * top / (2.0f * to_a + 2.0f * to_b + t1 + t2 + t3 + t4 + 1e-20f);
  }
}

/// The directions and strengths of the scenery's lights in (right, up, look), as flat arrays.
struct Lighting {
  static constexpr int most_lights = 8;
  explicit Lighting(const Scenery& scenery)
      : count(std::min(static_cast<int>(scenery.lights.size()), most_lights)),
        ambient(scenery.ambient),
        gloss(scenery.lights.empty() ? 0.0f : scenery.gloss),
        exponent(scenery.exponent) {
    for (int i = 0; i < count; ++i) {
      const Light& light = scenery.lights[static_cast<std::size_t>(i)];
      const glm::vec3 towards = glm::normalize(light.towards) * light.strength;
      x[i] = towards.x;
      y[i] = towards.y;
      z[i] = towards.z;
    }
    // A surface with this normal, half-way between the directions to light and observer, mirrors the first
    // light to the observer.
    if (count > 0)
      halfway = glm::normalize(glm::normalize(scenery.lights.front().towards) + glm::vec3(0.0f, 0.0f, -1.0f));
  }

  int count = 0;
  float x[most_lights] = {}, y[most_lights] = {}, z[most_lights] = {};
  float ambient = 0.0f, gloss = 0.0f, exponent = Scenery{}.exponent;
  glm::vec3 halfway{0.0f, 0.0f, -1.0f};
};

/// Pass 4: Phong's model over a row of slopes, into diffuse and mirrored light. The outer loop is over
/// lights, because the compiler vectorises only an inner loop over pixels.
OCTOTOMY_VECTOR_CLONES void light_row(const Lighting& lighting, const float* __restrict to_right,
                                      const float* __restrict to_top, int first, int last,
                                      float* __restrict diffuse, float* __restrict mirrored) {
  float* const per_length = mirrored;
  const float ambient = lighting.ambient;
  for (int i = first; i < last; ++i) {
    // The normal of a surface points to the side towards which the depth grows.
    const float nx = to_right[i], ny = to_top[i];
    per_length[i] = 1.0f / std::sqrt(nx * nx + ny * ny + 1.0f);
    diffuse[i] = ambient;
  }
  for (int l = 0; l < lighting.count; ++l) {
    const float x = lighting.x[l], y = lighting.y[l], z = lighting.z[l];
    for (int i = first; i < last; ++i) {
      const float facing = (to_right[i] * x + to_top[i] * y - z) * per_length[i];
      diffuse[i] += facing > 0.0f ? facing : 0.0f;
    }
  }
  const glm::vec3 halfway = lighting.halfway;
  const float gloss = lighting.gloss;
  for (int i = first; i < last; ++i) {
    const float mirror = (to_right[i] * halfway.x + to_top[i] * halfway.y - halfway.z) * per_length[i];
    // The 48th power by squaring.
    const float m1 = mirror > 0.0f ? mirror : 0.0f;
    const float m2 = m1 * m1;
    const float m8 = m2 * m2 * m2 * m2;
    const float m16 = m8 * m8;
    mirrored[i] = gloss * (m16 * m16 * m16);
  }
}

/// The parameters of the darkening of far pixels and of pixels behind their surroundings.
struct Dimming {
  float nearest_mm = 0.0f;
  float per_range = 0.0f;  ///< 0: no depth cue
  float per_width = 0.0f;  ///< 12 / the picture's width in mm; 0: no occlusion
};

OCTOTOMY_VECTOR_CLONES void dim_row(const Dimming& dimming, const float* __restrict depth,
                                    const float* __restrict mean, int first, int last,
                                    float* __restrict diffuse, float* __restrict mirrored) {
  for (int i = first; i < last; ++i) {
    const float far = (depth[i] - dimming.nearest_mm) * dimming.per_range;
    const float behind = depth[i] - mean[i];
    const float light = (1.0f - 0.35f * (far < 1.0f ? far : 1.0f)) /
                        (1.0f + dimming.per_width * (behind > 0.0f ? behind : 0.0f));
    diffuse[i] *= light;
    mirrored[i] *= light;
  }
}

/// Pass 5 for one channel: computes indices into the table of tones, clamped to the table's range.
OCTOTOMY_VECTOR_CLONES void root_row(const float* __restrict colour, const float* __restrict diffuse,
                                     const float* __restrict mirrored, int first, int last,
                                     int* __restrict root) {
  for (int i = first; i < last; ++i) {
    const float light = colour[i] * diffuse[i] + mirrored[i];
    const float at_most = light < 1.0f ? light : 1.0f;
    constexpr float to_nearest = 0.5f;
    root[i] =
        static_cast<int>(to_nearest + std::sqrt(at_most > 0.0f ? at_most : 0.0f) * SrgbTable::root_steps);
  }
}

float nearest_mm(const DepthImage& image) {
  float nearest = std::numeric_limits<float>::infinity();
  for (const Seen& seen : image.pixels) nearest = std::min(nearest, seen.depth_mm);
  return nearest;
}

/// The rows of intermediate numbers that one thread uses.
struct Rows {
  explicit Rows(int width)
      : to_right(static_cast<std::size_t>(width)),
        to_top(to_right),
        diffuse(to_right),
        mirrored(to_right),
        mean(to_right),
        colour{to_right, to_right, to_right},
        root{std::vector<int>(to_right.size()), std::vector<int>(to_right.size()),
             std::vector<int>(to_right.size())} {}
  std::vector<float> to_right, to_top, diffuse, mirrored, mean;
  std::array<std::vector<float>, 3> colour;
  std::array<std::vector<int>, 3> root;
};

/// Computes the mirrored light of a row for any exponent; light_row() computes it for the default one.
void mirror_row(const Lighting& lighting, const glm::ivec2& lit, Rows& rows) {
  for (int x = lit.x; x < lit.y; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const glm::vec3 normal = glm::normalize(glm::vec3(rows.to_right[i], rows.to_top[i], -1.0f));
    const float mirror = std::max(0.0f, glm::dot(normal, lighting.halfway));
    rows.mirrored[i] = lighting.gloss * std::pow(mirror, lighting.exponent);
  }
}

void slopes_of_row(const Scenery& scenery, const DepthPlane& plane, int y, Rows& rows) {
  const int stride = stride_px(scenery);
  const double stride_mm = stride * scenery.pixel_mm;
  const auto limit_mm = static_cast<float>(break_mm(stride_mm));
  const glm::ivec2& lit = plane.lit[static_cast<std::size_t>(y)];
  slope_row({plane.depth.row(y - stride), plane.depth.row(y), plane.depth.row(y + stride), stride,
             1.0f / (limit_mm * limit_mm), static_cast<float>(1.0 / stride_mm)},
            lit.x, lit.y, rows.to_right.data(), rows.to_top.data());
}

/// The slopes of given normals. A normal that points away from the observer is replaced by one seen edge-on.
void slopes_of_normals(std::span<const glm::vec3> normals, const glm::ivec2& lit, Rows& rows) {
  constexpr float edgewise = -1e-3f;
  for (int x = lit.x; x < lit.y; ++x) {
    const auto i = static_cast<std::size_t>(x);
    const float towards = std::min(normals[i].z, edgewise);
    rows.to_right[i] = normals[i].x / -towards;
    rows.to_top[i] = normals[i].y / -towards;
  }
}

/// Calls `row(y, rows)` for every row, in parallel. `rows` are the thread's rows of intermediate numbers.
template <typename Row>
void each_row(const glm::ivec2& size_px, const Row& row) {
  constexpr int rows_a_task = 8;
  tbb::parallel_for(tbb::blocked_range<int>(0, size_px.y, rows_a_task),
                    [&](const tbb::blocked_range<int>& range) {
                      Rows rows(size_px.x);
                      for (int y = range.begin(); y < range.end(); ++y) row(y, rows);
                    });
}

}  // namespace

std::vector<glm::vec2> slopes(const DepthImage& image, const Scenery& scenery) {
  const DepthPlane plane = depth_plane(image, scenery);
  std::vector<glm::vec2> result(image.pixels.size());
  each_row(image.size_px, [&](int y, Rows& rows) {
    slopes_of_row(scenery, plane, y, rows);
    const glm::ivec2& lit = plane.lit[static_cast<std::size_t>(y)];
    for (int x = lit.x; x < lit.y; ++x)
      if (image.at(x, y).lit())
        result[pixel_index(image.size_px, x, y)] = {rows.to_right[static_cast<std::size_t>(x)],
                                                    rows.to_top[static_cast<std::size_t>(x)]};
  });
  return result;
}

namespace {

/// Draws the styles with one tone per object: Depth and Silhouette.
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
      // The farthest pixels keep a tenth of the light, so that they are not black.
      if (scenery.style == Style::Depth) colour *= 1.0f - 0.9f * (seen.depth_mm - nearest) * per_span;
    }
    put_srgb(&rgb[3 * i], colour);
  });
  return rgb;
}

/// Draws lines at the edges of surfaces and at creases.
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
  // A crease turns the normal by 40 degrees within two pixels; the surface's relief turns it by less.
  constexpr float cosine_of_crease = 0.766f;
  for (int y = 0; y + 2 < image.size_px.y; ++y)
    for (int x = 0; x + 2 < image.size_px.x; ++x) {
      const std::size_t here = pixel_index(image.size_px, x, y);
      if (!image.pixels[here].lit()) continue;
      for (const std::size_t other :
           {pixel_index(image.size_px, x + 2, y), pixel_index(image.size_px, x, y + 2)})
        if (image.pixels[other].lit() && glm::dot(normal(here), normal(other)) < cosine_of_crease)
          blacken(here);
    }
  return rgb;
}

/// The linear colours of a row's pixels. `colours` are the objects'.
void colours_of_row(const DepthImage& image, const std::vector<glm::vec3>& colours, const Paint& paint, int y,
                    const glm::ivec2& lit, Rows& rows) {
  if (!paint.kinds.empty()) {
    for (int x = lit.x; x < lit.y; ++x) {
      const Seen& seen = image.at(x, y);
      const std::size_t pixel = pixel_index(image.size_px, x, y);
      glm::vec3 colour(0.0f);
      if (seen.lit())
        colour = paint.kinds[pixel] == Paint::Kind::Lit ? linear_from_srgb(paint.colours[pixel])
                                                        : colours[static_cast<std::size_t>(seen.object)];
      for (int channel = 0; channel < 3; ++channel)
        rows.colour[static_cast<std::size_t>(channel)][static_cast<std::size_t>(x)] = colour[channel];
    }
    return;
  }
  // In most pictures all objects are parts of one bone and have one colour, so that colours need not be
  // looked up. Colours of background pixels are not used.
  const bool same =
      !colours.empty() && std::all_of(colours.begin(), colours.end(),
                                      [&](const glm::vec3& colour) { return colour == colours.front(); });
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<float>& row = rows.colour[static_cast<std::size_t>(channel)];
    if (same) {
      std::fill(row.begin() + lit.x, row.begin() + lit.y, colours.front()[channel]);
      continue;
    }
    for (int x = lit.x; x < lit.y; ++x) {
      const Seen& seen = image.at(x, y);
      row[static_cast<std::size_t>(x)] =
          seen.lit() ? colours[static_cast<std::size_t>(seen.object)][channel] : 0.0f;
    }
  }
}

std::vector<std::uint8_t> shaded_picture(const DepthImage& image, const Scenery& scenery,
                                         std::span<const glm::vec3> normals) {
  const DepthPlane plane = depth_plane(image, scenery);
  std::optional<MeanDepth> surroundings;
  if (scenery.occlusion) surroundings.emplace(plane, image.size_px);
  const Lighting lighting(scenery);
  const auto width_mm = static_cast<float>(scenery.pixel_mm * image.size_px.x);
  const Dimming dimming{plane.nearest_mm,
                        static_cast<float>(scenery.depth_cue ? 1.0 / scenery.depth_range_mm : 0.0),
                        scenery.occlusion ? 12.0f / width_mm : 0.0f};
  std::vector<glm::vec3> colours;
  for (const glm::vec3& colour : scenery.colours) colours.push_back(linear_from_srgb(colour));
  std::array<std::uint8_t, 3> background{};
  put_srgb(background.data(), linear_from_srgb(scenery.background));
  std::vector<std::uint8_t> rgb(3 * image.pixels.size());
  const SrgbTable& table = SrgbTable::table();
  each_row(image.size_px, [&](int y, Rows& rows) {
    const glm::ivec2& lit = plane.lit[static_cast<std::size_t>(y)];
    if (normals.empty())
      slopes_of_row(scenery, plane, y, rows);
    else
      slopes_of_normals(normals.subspan(pixel_index(image.size_px, 0, y), rows.to_right.size()), lit, rows);
    light_row(lighting, rows.to_right.data(), rows.to_top.data(), lit.x, lit.y, rows.diffuse.data(),
              rows.mirrored.data());
    if (lighting.exponent != Scenery{}.exponent) mirror_row(lighting, lit, rows);
    if (surroundings) surroundings->mean_row(y, lit, rows.mean);
    dim_row(dimming, plane.depth.row(y), rows.mean.data(), lit.x, lit.y, rows.diffuse.data(),
            rows.mirrored.data());
    colours_of_row(image, colours, scenery.paint, y, lit, rows);
    for (std::size_t channel = 0; channel < 3; ++channel)
      root_row(rows.colour[channel].data(), rows.diffuse.data(), rows.mirrored.data(), lit.x, lit.y,
               rows.root[channel].data());
    std::uint8_t* pixel = &rgb[3 * pixel_index(image.size_px, 0, y)];
    for (int x = 0; x < image.size_px.x; ++x, pixel += 3) {
      const bool seen = x >= lit.x && x < lit.y && image.at(x, y).lit();
      for (std::size_t channel = 0; channel < 3; ++channel)
        pixel[channel] =
            seen ? table.srgb_of_root(rows.root[channel][static_cast<std::size_t>(x)]) : background[channel];
    }
  });
  for (std::size_t i = 0; i < scenery.paint.kinds.size(); ++i)
    if (scenery.paint.kinds[i] == Paint::Kind::Tone)
      for (int channel = 0; channel < 3; ++channel)
        rgb[3 * i + static_cast<std::size_t>(channel)] =
            static_cast<std::uint8_t>(std::lround(255.0f * scenery.paint.colours[i][channel]));
  return rgb;
}

}  // namespace

std::vector<std::uint8_t> shade(const DepthImage& image, const Scenery& scenery,
                                std::span<const glm::vec3> normals) {
  assert(normals.empty() || normals.size() == image.pixels.size());
  assert(scenery.paint.kinds.empty() || scenery.paint.kinds.size() == image.pixels.size());
  assert(scenery.lights.size() <= 8);
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
  // At a break of less than twice break_mm() no jagged edge is visible.
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
        edges.push_back(static_cast<std::uint32_t>(pixel_index(image.size_px, x, y)));
    }
  return edges;
}

std::array<std::uint8_t, 3> blend(const DepthImage& image, const std::vector<std::uint8_t>& rgb,
                                  const Scenery& scenery, std::uint32_t pixel, std::span<const Seen> parts) {
  assert(pixel < image.pixels.size() && rgb.size() == 3 * image.pixels.size() && !parts.empty());
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
        nearest = pixel_index(image.size_px, i, j);
      }
    for (int channel = 0; channel < 3; ++channel)
      sum[channel] += SrgbTable::table().linear(rgb[3 * nearest + static_cast<std::size_t>(channel)]);
  }
  std::array<std::uint8_t, 3> mean{};
  put_srgb(mean.data(), sum / static_cast<float>(parts.size()));
  return mean;
}

}  // namespace octotomy::voxel
