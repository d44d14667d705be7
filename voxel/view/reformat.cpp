// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/reformat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/space/error.h"
#include "voxel/space/progress.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

void need_pixel(double pixel_mm) {
  if (!(pixel_mm > 0.0) || !std::isfinite(pixel_mm))
    throw InvalidInput("the edge of a picture's pixels must be positive, not " + rounded(pixel_mm) + " mm");
}

// The number of pixels that cover a length. Subtracts a bound on the rounding of lengths (sums of a few
// products of coordinates), so that rounding adds no pixel.
int pixels(double length_mm, double pixel_mm) {
  const double exact = length_mm / pixel_mm;
  const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * (1.0 + exact) * most_sheet_px;
  // The condition also refuses NaN, which infinite lengths produce.
  if (!(std::ceil(exact - rounding) <= most_sheet_px))
    throw InvalidInput("a picture of " +
                       (std::isfinite(length_mm) ? rounded(length_mm) + " mm" : "points that far apart") +
                       " takes more than " + std::to_string(most_sheet_px) + " pixels of " +
                       rounded(pixel_mm) + " mm: choose larger pixels");
  return static_cast<int>(std::max(1.0, std::ceil(exact - rounding)));
}

struct Rectangle {
  glm::dvec2 low{std::numeric_limits<double>::infinity()};
  glm::dvec2 high{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec2& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

// The bounding rectangle, in the view's millimetres, of the plane's cut through the lattice's box. It is
// computed from the points at which the plane meets the box's twelve edges.
Rectangle cut_rectangle(const Lattice& lattice, const View& view, double position_mm) {
  std::array<glm::dvec3, 8> corners;
  for (int corner = 0; corner < 8; ++corner)
    corners[static_cast<std::size_t>(corner)] = lattice.lps_mm(
        glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2) * glm::dvec3(lattice.dims) - 0.5);
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  Rectangle rectangle;
  for (std::size_t from = 0; from < 8; ++from) {
    const double here = glm::dot(corners[from], view.look) - position_mm;
    lowest = std::min(lowest, here);
    highest = std::max(highest, here);
    for (const std::size_t axis : {std::size_t{1}, std::size_t{2}, std::size_t{4}}) {
      if (from & axis) continue;
      const glm::dvec3& end = corners[from | axis];
      const double there = glm::dot(end, view.look) - position_mm;
      if ((here > 0.0) == (there > 0.0) && here != 0.0 && there != 0.0) continue;
      // If an edge lies in the plane, both its ends are added.
      if (here == there) {
        rectangle.add(view.project(corners[from]));
        rectangle.add(view.project(end));
      } else {
        rectangle.add(view.project(corners[from] + (end - corners[from]) * (here / (here - there))));
      }
    }
  }
  if (!(lowest <= 0.0 && highest >= 0.0))
    throw InvalidInput("the plane at " + rounded(position_mm) + " mm misses the scan, which reaches from " +
                       rounded(lowest + position_mm) + " to " + rounded(highest + position_mm) +
                       " mm along its normal: choose a position in between");
  return rectangle;
}

// Calls pixel(number, p_mm) for every pixel of the sheet.
template <typename Pixel>
void for_each_pixel(const Sheet& sheet, const Progress& progress, const Pixel& pixel) {
  const int width = static_cast<int>(sheet.columns_mm.size());
  tbb::parallel_for(0, sheet.height_px, [&](int row) {
    if (progress.stop.stop_requested()) return;
    for (int column = 0; column < width; ++column)
      pixel(
          static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column),
          sheet.lps_mm(column, row));
  });
  progress.at(1.0);
}

// Maps millimetres to index space. The matrix is inverted only once.
class VoxelOf {
 public:
  explicit VoxelOf(const glm::dmat4& lps_from_voxel)
      : first_mm_(lps_from_voxel[3]), voxel_from_lps_(glm::inverse(glm::dmat3(lps_from_voxel))) {}
  glm::dvec3 operator()(const glm::dvec3& p_mm) const { return voxel_from_lps_ * (p_mm - first_mm_); }

 private:
  glm::dvec3 first_mm_;
  glm::dmat3 voxel_from_lps_;
};

bool within(const glm::dvec3& p_voxel, const glm::ivec3& dims) {
  return glm::all(glm::greaterThanEqual(p_voxel, glm::dvec3(-0.5))) &&
         glm::all(glm::lessThan(p_voxel, glm::dvec3(dims) - 0.5));
}

// Interpolates like interpolate() of a grey octree. Beyond the border, the border's samples repeat. None if
// the value would depend on padding.
template <typename Samples>
std::optional<double> interpolated(const Samples& samples, const glm::ivec3& dims, const glm::dvec3& p_voxel,
                                   Interpolation interpolation, std::optional<double> padding) {
  std::array<Stencil, 3> along;
  for (int axis = 0; axis < 3; ++axis)
    along[static_cast<std::size_t>(axis)] = stencil(p_voxel[axis], interpolation);
  const auto place = [&](int axis, int i) {
    return static_cast<std::size_t>(
        std::clamp(along[static_cast<std::size_t>(axis)].first + i, 0, dims[axis] - 1));
  };
  double value = 0.0;
  for (int k = 0; k < along[2].count; ++k) {
    double plane = 0.0;
    for (int j = 0; j < along[1].count; ++j) {
      const std::size_t row =
          (place(2, k) * static_cast<std::size_t>(dims.y) + place(1, j)) * static_cast<std::size_t>(dims.x);
      double line = 0.0;
      for (int i = 0; i < along[0].count; ++i) {
        const auto sample = static_cast<double>(samples[row + place(0, i)]);
        const double weight = along[0].weight[static_cast<std::size_t>(i)];
        if (sample == padding && weight != 0.0) return std::nullopt;
        line += weight * sample;
      }
      plane += along[1].weight[static_cast<std::size_t>(j)] * line;
    }
    value += along[2].weight[static_cast<std::size_t>(k)] * plane;
  }
  return value;
}

SheetSamples empty_samples(const Sheet& sheet) {
  SheetSamples samples;
  samples.image.size_px = sheet.size_px();
  const std::size_t count = sheet.columns_mm.size() * static_cast<std::size_t>(sheet.height_px);
  samples.image.values.resize(count);
  samples.inside.resize(count);
  return samples;
}

}  // namespace

Sheet plane_sheet(const Lattice& lattice, const View& view, double position_mm, double pixel_mm) {
  need_pixel(pixel_mm);
  if (!std::isfinite(position_mm)) throw InvalidInput("a slice's position must be a finite number");
  const Rectangle rectangle = cut_rectangle(lattice, view, position_mm);
  const glm::dvec2 extent_mm = rectangle.high - rectangle.low;
  Sheet sheet;
  sheet.down = -view.up;
  sheet.pixel_mm = pixel_mm;
  sheet.height_px = pixels(extent_mm.y, pixel_mm);
  const int width = pixels(extent_mm.x, pixel_mm);
  for (int column = 0; column < width; ++column)
    sheet.columns_mm.push_back(view.look * position_mm +
                               view.right * (rectangle.low.x + pixel_mm * (column + 0.5)) +
                               view.up * (rectangle.high.y - 0.5 * pixel_mm));
  return sheet;
}

Sheet curved_sheet(const CurveOptions& options) {
  need_pixel(options.pixel_mm);
  if (!(options.height_mm > 0.0) || !std::isfinite(options.height_mm))
    throw InvalidInput("the height of a curved slice must be positive, not " + rounded(options.height_mm) +
                       " mm");
  const double up_length = glm::length(options.up);
  if (!(up_length > 0.0) || !std::isfinite(up_length))
    throw InvalidInput("the up vector of a curved slice must be finite and not zero");
  const glm::dvec3 up = options.up / up_length;
  std::vector<glm::dvec3> flat;   // the curve's points, projected along `up`
  std::vector<double> length_mm;  // length of the polyline up to each point
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const glm::dvec3& point : options.points_mm) {
    const double height = glm::dot(point, up);
    if (!std::isfinite(height)) throw InvalidInput("a curve's points must be finite numbers");
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    flat.push_back(point - up * height);
    length_mm.push_back(flat.size() == 1 ? 0.0
                                         : length_mm.back() + glm::distance(flat.back(), flat.end()[-2]));
  }
  if (flat.size() < 2 || !(length_mm.back() > 0.0))
    throw InvalidInput(
        "a curved slice needs at least two points that differ in a direction other than its up vector");
  Sheet sheet;
  sheet.down = -up;
  sheet.pixel_mm = options.pixel_mm;
  sheet.height_px = pixels(options.height_mm, options.pixel_mm);
  const int width = pixels(length_mm.back(), options.pixel_mm);
  const glm::dvec3 top = up * (0.5 * (lowest + highest) + 0.5 * options.pixel_mm * (sheet.height_px - 1));
  std::size_t to = 1;
  for (int column = 0; column < width; ++column) {
    const double at = options.pixel_mm * (column + 0.5);
    while (to + 1 < flat.size() && length_mm[to] <= at) ++to;
    const double run = length_mm[to] - length_mm[to - 1];
    const double t = run > 0.0 ? (at - length_mm[to - 1]) / run : 0.0;
    sheet.columns_mm.push_back(top + flat[to - 1] + (flat[to] - flat[to - 1]) * t);
  }
  return sheet;
}

SheetSamples sample(const Scene& scene, const Sheet& sheet, Interpolation interpolation,
                    const Progress& progress) {
  check(scene);
  SheetSamples result = empty_samples(sheet);
  const VoxelOf voxel_of(scene.lattice.lps_from_voxel);
  const glm::ivec3 dims = scene.lattice.dims;
  std::visit(
      [&](const auto& samples) {
        for_each_pixel(sheet, progress, [&](std::size_t pixel, const glm::dvec3& p_mm) {
          const glm::dvec3 p_voxel = voxel_of(p_mm);
          // The index of a pixel far outside must not overflow an int.
          const glm::dvec3 near = glm::clamp(p_voxel, glm::dvec3(-1.0), glm::dvec3(dims));
          const auto value = interpolated(samples, dims, near, interpolation, scene.padding);
          result.inside[pixel] = value && within(p_voxel, dims) ? 1 : 0;
          result.image.values[pixel] = static_cast<float>(value.value_or(scene.padding.value_or(0.0)));
        });
      },
      scene.samples);
  return result;
}

SheetSamples sample(const GreyOctree& grey, const Sheet& sheet, Interpolation interpolation,
                    const Progress& progress) {
  SheetSamples result = empty_samples(sheet);
  const Universe& universe = grey.universe();
  const VoxelOf voxel_of(universe.lps_from_voxel);
  const glm::ivec3 dims(universe.side());
  for_each_pixel(sheet, progress, [&](std::size_t pixel, const glm::dvec3& p_mm) {
    const glm::dvec3 p_voxel = voxel_of(p_mm);
    result.inside[pixel] = within(p_voxel, dims) ? 1 : 0;
    const glm::dvec3 near = glm::clamp(p_voxel, glm::dvec3(-3.0), glm::dvec3(dims) + 3.0);
    result.image.values[pixel] = static_cast<float>(grey.step() * interpolate(grey, near, interpolation));
  });
  return result;
}

std::vector<std::uint8_t> cut(const Octree& octree, const Sheet& sheet) {
  std::vector<std::uint8_t> inside(sheet.columns_mm.size() * static_cast<std::size_t>(sheet.height_px));
  const VoxelOf voxel_of(octree.universe().lps_from_voxel);
  const glm::ivec3 dims(octree.universe().side());
  for_each_pixel(sheet, {}, [&](std::size_t pixel, const glm::dvec3& p_mm) {
    const glm::dvec3 p_voxel = voxel_of(p_mm);
    inside[pixel] = within(p_voxel, dims) && octree.contains(glm::ivec3(glm::floor(p_voxel + 0.5))) ? 1 : 0;
  });
  return inside;
}

std::vector<std::uint8_t> outline(const std::vector<std::uint8_t>& cut, const glm::ivec2& size_px) {
  const auto width = static_cast<std::size_t>(size_px.x);
  const auto height = static_cast<std::size_t>(size_px.y);
  if (cut.size() != width * height)
    throw std::invalid_argument("the number of a cut's pixels must equal its width times its height");
  std::vector<std::uint8_t> edge(cut.size());
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = y * width + x;
      const bool leaves = (x > 0 && cut[at - 1] == 0) || (x + 1 < width && cut[at + 1] == 0) ||
                          (y > 0 && cut[at - width] == 0) || (y + 1 < height && cut[at + width] == 0);
      edge[at] = cut[at] != 0 && leaves ? 1 : 0;
    }
  return edge;
}

EdgeLetters edge_letters(const Sheet& sheet) {
  EdgeLetters letters;
  letters.top = patient_side(-sheet.down);
  letters.bottom = patient_side(sheet.down);
  const std::vector<glm::dvec3>& columns = sheet.columns_mm;
  if (columns.empty()) return letters;
  // The letters name the directions from the curve's middle to its ends. The curve's tangents would not do:
  // at both ends of a dental arch they point to the back, but one end lies on the right and one on the left.
  const glm::dvec3 middle_mm = 0.5 * (columns[(columns.size() - 1) / 2] + columns[columns.size() / 2]);
  if (columns.front() != middle_mm) letters.left = patient_side(columns.front() - middle_mm);
  if (columns.back() != middle_mm) letters.right = patient_side(columns.back() - middle_mm);
  return letters;
}

}  // namespace octotomy::voxel
