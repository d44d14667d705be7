// Steps:
// 1 Estimate the table's inclination to the lattice: the slope at which edges of a coarse copy line up best.
// 2 Compute the median of each column along the table, over all slices and then over shorter windows.
// 3 A column counts as extruded if its samples are material and remain near the medians of its neighbourhood.
// 4 Join extruded columns to parts; a part that is compact, narrow, enclosed, or thick without air around it
//   belongs to the body.
// 5 Follow each part beyond its window, slice by slice, while most of its samples still agree, and mark them.
#include "voxel/filter/extrusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "voxel/filter/slice_work.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// HU above the level of air: more than the noise of air, less than the lightest foam.
constexpr double above_air = 50.0;
constexpr double least_width_mm = 40.0;  ///< narrower parts are straps, tubes or arms
constexpr double limb_mm = 10.0;         ///< radius of discs that fit into a child's arm
constexpr double limb_edge_mm = 2.5;     ///< width of the blurred edge of a limb
/// Least length of a board or couch, as a multiple of its thickness; a head has 1.6, an arm 1.3.
constexpr double least_length = 2.5;
/// Largest distance of a body's outline from the discs that fit into the body.
constexpr double fringe_mm = 8.0;
constexpr double least_window_mm = 60.0;  ///< a head's outline changes within a shorter length
constexpr int slices_per_median = 48;
constexpr double lies_off_mm = 0.75;  ///< largest distance by which a part deviates sideways from its columns
/// Samples are averaged over this length along the table, to reduce noise.
constexpr double calm_mm = 4.0;
constexpr double steepest = 0.45;

/// Reads samples by the indices side, back and along, for any order of the lattice's axes.
struct View {
  const Int16Samples* samples;
  std::array<int, 3> size;            ///< side, back, along
  std::array<std::size_t, 3> stride;  ///< of side, back, along
  std::array<double, 3> mm;

  std::size_t at(int side, int back, int along) const {
    return static_cast<std::size_t>(side) * stride[0] + static_cast<std::size_t>(back) * stride[1] +
           static_cast<std::size_t>(along) * stride[2];
  }
  std::size_t columns() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  }
  std::size_t column(int side, int back) const {
    return static_cast<std::size_t>(back) * static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(side);
  }
  bool holds(const glm::ivec2& p) const { return p.x >= 0 && p.y >= 0 && p.x < size[0] && p.y < size[1]; }
};

View view_of(const Scene& scene, const Int16Samples& samples) {
  const PatientAxes axes = patient_axes(scene.lattice);
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  const std::array<std::size_t, 3> strides{1, static_cast<std::size_t>(dims.x), slice_size(scene.lattice)};
  View view{&samples, {}, {}, {}};
  int k = 0;
  for (const int axis : {axes.side, axes.back, axes.along}) {
    const auto i = static_cast<std::size_t>(k++);
    view.size[i] = dims[axis];
    view.stride[i] = strides[static_cast<std::size_t>(axis)];
    view.mm[i] = spacing[axis];
  }
  return view;
}

/// Edges across one axis in a coarse copy of the scan, and the slope at which most of them line up.
class Slope {
 public:
  Slope(const View& view, const ExtrusionOptions& options) : view_(view) {
    for (std::size_t i = 0; i < 3; ++i) {
      factor_[i] = std::max(1, static_cast<int>(std::lround(4.0 / view.mm[i])));
      size_[i] = view.size[i] / factor_[i];
    }
    if (size_[0] < 8 || size_[1] < 8 || size_[2] < 8) return;
    coarse_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                   static_cast<std::size_t>(size_[2]));
    tbb::parallel_for(0, size_[2], [&](int z) {
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x) coarse_[at(x, y, z)] = mean(x, y, z, options);
    });
  }

  /// The slope, in mm per mm, at which edges across `axis` (0: side, 1: back) line up best. Zero unless
  /// another slope is clearly better.
  double along(std::size_t axis) const {
    if (coarse_.empty()) return 0.0;
    const double cell = view_.mm[axis] * factor_[axis];
    const double length = (size_[2] - 1) * view_.mm[2] * factor_[2];
    const int reach = static_cast<int>(steepest * length / cell);
    std::vector<double> scores(static_cast<std::size_t>(2 * reach + 1));
    tbb::parallel_for(-reach, reach + 1,
                      [&](int k) { scores[static_cast<std::size_t>(k + reach)] = score(axis, k); });
    const auto best = std::max_element(scores.begin(), scores.end());
    const double straight = scores[static_cast<std::size_t>(reach)];
    if (*best < 1.1 * straight) return 0.0;
    const double coarse = static_cast<double>(best - scores.begin() - reach);
    std::array<double, 17> fine{};
    tbb::parallel_for(std::size_t{0}, fine.size(), [&](std::size_t i) {
      fine[i] = score(axis, coarse + (static_cast<double>(i) - 8.0) / 8.0);
    });
    const auto finest = static_cast<double>(std::max_element(fine.begin(), fine.end()) - fine.begin());
    return (coarse + (finest - 8.0) / 8.0) * cell / length;
  }

 private:
  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }

  float mean(int x, int y, int z, const ExtrusionOptions& options) const {
    double sum = 0.0;
    for (int k = 0; k < factor_[2]; ++k)
      for (int j = 0; j < factor_[1]; ++j)
        for (int i = 0; i < factor_[0]; ++i)
          sum += std::clamp<double>(
              (*view_.samples)[view_.at(x * factor_[0] + i, y * factor_[1] + j, z * factor_[2] + k)],
              options.air, options.threshold + 300.0);
    return static_cast<float>(sum / (factor_[0] * factor_[1] * factor_[2]));
  }

  /// A measure of how well edges line up at a slope. Averages the edges along each line that shifts by
  /// `cells` cells between both ends of the scan, and sums the cubes of the means.
  double score(std::size_t axis, double cells) const {
    const int width = size_[axis], others = size_[1 - axis], slices = size_[2];
    double total = 0.0;
    std::vector<double> mean(static_cast<std::size_t>(width) - 1);
    for (int other = 0; other < others; ++other) {
      std::fill(mean.begin(), mean.end(), 0.0);
      for (int z = 0; z < slices; ++z) {
        const double shift = cells * (static_cast<double>(z) / (slices - 1) - 0.5);
        const int whole = static_cast<int>(std::floor(shift));
        const double part = shift - whole;
        const auto value = [&](int p) {
          p = std::clamp(p, 0, width - 1);
          return axis == 0 ? coarse_[at(p, other, z)] : coarse_[at(other, p, z)];
        };
        const auto between = [&](int p) {
          return (1.0 - part) * static_cast<double>(value(p + whole)) +
                 part * static_cast<double>(value(p + whole + 1));
        };
        double before = between(0);
        for (int p = 1; p < width; ++p) {
          const double here = between(p);
          mean[static_cast<std::size_t>(p) - 1] += here - before;
          before = here;
        }
      }
      for (const double edge : mean) total += std::abs(edge) * edge * edge;
    }
    return total;
  }

  const View& view_;
  std::array<int, 3> factor_{}, size_{};
  std::vector<float> coarse_;
};

struct Window {
  int first, end;
};

/// Statistics of a column's samples over a window.
struct Column {
  float median = 0.0F, spread = 0.0F;   ///< median, and median distance of the samples from the median
  float material = 0.0F, solid = 0.0F;  ///< shares of the samples
};

/// Extruded columns that touch each other.
struct Part {
  std::vector<glm::ivec2> columns;  ///< side and back indices at the middle slice
};

class Finder {
 public:
  Finder(const View& view, const ExtrusionOptions& options, const glm::dvec2& slope, Extrusion& found)
      : view_(view), options_(options), found_(found) {
    const bool is_straight = slope == glm::dvec2(0.0);
    for (std::size_t i = 0; i < 2; ++i)
      lies_off_[static_cast<int>(i)] =
          static_cast<float>(std::min(1.0, lies_off_mm / view.mm[i] + (is_straight ? 0.0 : 0.5)));
    for (int along = 0; along < view.size[2]; ++along) {
      const double mm = (along - 0.5 * (view.size[2] - 1)) * view.mm[2];
      shifts_.emplace_back(static_cast<int>(std::lround(slope.x * mm / view.mm[0])),
                           static_cast<int>(std::lround(slope.y * mm / view.mm[1])));
    }
    calm_ = std::clamp(static_cast<int>(calm_mm / view.mm[2]), 0, 2);
  }

  void run() {
    const int slices = view_.size[2];
    const double length = slices * view_.mm[2];
    search({0, slices});
    options_.progress.at(0.4);
    const int window = static_cast<int>(std::ceil(std::max(least_window_mm, length / 3.0) / view_.mm[2]));
    if (window < 2 || window * 3 > slices * 2) return;
    for (int first = 0; first + window / 2 < slices; first += (window + 1) / 2)
      search({std::min(first, slices - window), std::min(first + window, slices)});
  }

 private:
  /// The position of a column in a slice, which may lie outside the slice.
  glm::ivec2 place(const glm::ivec2& column, int along) const {
    return column + shifts_[static_cast<std::size_t>(along)];
  }

  void search(const Window& window) {
    gather(window);
    std::vector<std::uint8_t> lasting(view_.columns(), 0);
    tbb::parallel_for(0, view_.size[1], [&](int y) {
      for (int x = 0; x < view_.size[0]; ++x) lasting[view_.column(x, y)] = lasts({x, y}, window) ? 1 : 0;
    });
    const DistanceMap depth = distances([&](std::size_t i) { return !is_solid(i); });
    without_compact(lasting, depth);
    // A slab thicker than thick_mm counts as a couch only if air borders nearly all of its outline.
    take(lasting, depth, 0.8, window);
    without_thick(lasting, depth);
    take(lasting, depth, 0.4, window);
  }

  /// Marks the supports among the columns in `lasting` and removes them from `lasting`.
  void take(std::vector<std::uint8_t>& lasting, const DistanceMap& depth, double least_free,
            const Window& window) {
    for (const Part& part : parts_of(lasting)) {
      if (!is_support(part, lasting, least_free) || disc_mm(part, depth) > options_.thick_mm) continue;
      mark(part, window);
      for (const glm::ivec2& p : part.columns) lasting[view_.column(p.x, p.y)] = 0;
    }
  }

  bool is_solid(std::size_t column) const { return columns_[column].solid >= 0.9F; }

  /// The radius of the largest disc of solid columns around a column, limited by the scan's border.
  double disc_mm(const glm::ivec2& p, const DistanceMap& depth) const {
    const glm::dvec2 border = glm::dvec2(glm::min(p + 1, glm::ivec2(view_.size[0], view_.size[1]) - p)) *
                              glm::dvec2(view_.mm[0], view_.mm[1]);
    const double solid = std::sqrt(static_cast<double>(depth.square_mm2[view_.column(p.x, p.y)]));
    return std::min({solid, border.x, border.y}) - 0.5 * std::min(view_.mm[0], view_.mm[1]);
  }

  double disc_mm(const Part& part, const DistanceMap& depth) const {
    double largest = 0.0;
    for (const glm::ivec2& p : part.columns) largest = std::max(largest, disc_mm(p, depth));
    return largest;
  }

  glm::dvec2 size_mm(const Part& part) const {
    glm::ivec2 low = part.columns.front(), high = low;
    for (const glm::ivec2& p : part.columns) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    return glm::dvec2(high - low + 1) * glm::dvec2(view_.mm[0], view_.mm[1]);
  }

  /// Removes the columns of discs of limb_mm if the discs of a part together are hardly longer than wide:
  /// they may be a head, a neck or an arm on a couch.
  void without_compact(std::vector<std::uint8_t>& lasting, const DistanceMap& depth) const {
    std::vector<std::uint8_t> inner(lasting.size(), 0), compact(lasting.size(), 0);
    for (int y = 0; y < view_.size[1]; ++y)
      for (int x = 0; x < view_.size[0]; ++x)
        inner[view_.column(x, y)] = is_solid(view_.column(x, y)) && disc_mm({x, y}, depth) > limb_mm ? 1 : 0;
    for (const Part& part : parts_of(inner))
      if (glm::length(size_mm(part)) + 2.0 * limb_mm < least_length * 2.0 * disc_mm(part, depth))
        for (const glm::ivec2& p : part.columns) compact[view_.column(p.x, p.y)] = 1;
    const DistanceMap away = distances([&](std::size_t i) { return compact[i] != 0; });
    const double reach = limb_mm + limb_edge_mm;
    for (std::size_t i = 0; i < lasting.size(); ++i)
      if (static_cast<double>(away.square_mm2[i]) <= reach * reach) lasting[i] = 0;
  }

  /// Fills columns_ for a window from at most slices_per_median evenly spaced slices, without marked samples.
  /// A column with more than a fifth of its samples marked remains empty.
  void gather(const Window& window) {
    columns_.assign(view_.columns(), {});
    const int length = window.end - window.first, used = std::min(length, slices_per_median);
    tbb::parallel_for(0, view_.size[1], [&](int y) {
      const auto width = static_cast<std::size_t>(view_.size[0]);
      std::vector<std::int16_t> rows(width * static_cast<std::size_t>(used));
      std::vector<int> counts(width, 0), marked(width, 0);
      for (int k = 0; k < used; ++k) {
        const int along = window.first + static_cast<int>((k + 0.5) * length / used);
        for (int x = 0; x < view_.size[0]; ++x) {
          const glm::ivec2 p = place({x, y}, along);
          if (!view_.holds(p)) continue;
          const std::size_t index = view_.at(p.x, p.y, along);
          const auto column = static_cast<std::size_t>(x);
          if (found_.marks[index] != 0) {
            ++marked[column];
            continue;
          }
          rows[column * static_cast<std::size_t>(used) + static_cast<std::size_t>(counts[column]++)] =
              (*view_.samples)[index];
        }
      }
      for (int x = 0; x < view_.size[0]; ++x) {
        const auto column = static_cast<std::size_t>(x);
        if (5 * counts[column] >= 3 * used && 5 * marked[column] <= used)
          columns_[view_.column(x, y)] =
              column_of(&rows[column * static_cast<std::size_t>(used)], counts[column]);
      }
    });
  }

  /// Computes a column's statistics. Overwrites the samples.
  Column column_of(std::int16_t* samples, int count) const {
    Column column;
    for (int i = 0; i < count; ++i) {
      column.material += static_cast<float>(samples[i] > options_.air + above_air);
      column.solid += static_cast<float>(samples[i] >= options_.threshold);
    }
    column.material /= static_cast<float>(count);
    column.solid /= static_cast<float>(count);
    std::int16_t* const middle = samples + count / 2;
    std::nth_element(samples, middle, samples + count);
    const std::int16_t median = *middle;
    column.median = median;
    for (int i = 0; i < count; ++i)
      samples[i] = static_cast<std::int16_t>(std::min(std::abs(samples[i] - median), 32767));
    std::nth_element(samples, middle, samples + count);
    column.spread = *middle;
    return column;
  }

  /// The range allowed for a column's samples: its median, plus and minus a margin for noise. If `is_wide`,
  /// the range also extends towards each neighbour's median, by the share lies_off_ of the difference of both
  /// medians.
  std::pair<float, float> allowed(const glm::ivec2& p, bool is_wide) const {
    const Column& own = columns_[view_.column(p.x, p.y)];
    float low = own.median, high = own.median;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        if (!is_wide || !view_.holds(p + glm::ivec2(i, j))) continue;
        const float share = std::min(i != 0 ? lies_off_.x : 1.0F, j != 0 ? lies_off_.y : 1.0F);
        const float beside =
            own.median + share * (columns_[view_.column(p.x + i, p.y + j)].median - own.median);
        low = std::min(low, beside);
        high = std::max(high, beside);
      }
    const float noise = std::max(40.0F, 2.5F * own.spread);
    return {low - noise, high + noise};
  }

  /// A column's mean sample over the slices near `along`.
  float calm_sample(const glm::ivec2& column, int along) const {
    float sum = 0.0F, count = 0.0F;
    for (int k = std::max(0, along - calm_); k <= std::min(view_.size[2] - 1, along + calm_); ++k) {
      const glm::ivec2 p = place(column, k);
      if (!view_.holds(p)) continue;
      sum += static_cast<float>((*view_.samples)[view_.at(p.x, p.y, k)]);
      count += 1.0F;
    }
    return sum / count;
  }

  bool lasts(const glm::ivec2& p, const Window& window) const {
    const Column& column = columns_[view_.column(p.x, p.y)];
    if (column.material < 0.9F || column.spread > 100.0F) return false;
    const auto [low, high] = allowed(p, true);
    const int step = std::max(1, (window.end - window.first) / slices_per_median);
    int agree = 0, all = 0;
    for (int along = window.first; along < window.end; along += step) {
      const glm::ivec2 q = place(p, along);
      if (!view_.holds(q)) continue;
      const float sample = calm_sample(p, along);
      agree += sample >= low && sample <= high;
      ++all;
    }
    return 20 * agree >= 17 * all;
  }

  /// For each column the squared distance in mm^2 to the nearest column for which `chosen` returns true.
  template <typename Chosen>
  DistanceMap distances(const Chosen& chosen) const {
    DistanceMap map{{glm::ivec3(0), glm::ivec3(view_.size[0] - 1, view_.size[1] - 1, 0)}, {}};
    map.square_mm2.resize(view_.columns());
    for (std::size_t i = 0; i < view_.columns(); ++i)
      map.square_mm2[i] = chosen(i) ? 0.0F : std::numeric_limits<float>::infinity();
    Universe plane;
    plane.lps_from_voxel = glm::dmat4(view_.mm[0], 0, 0, 0, 0, view_.mm[1], 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    spread(map, plane);
    return map;
  }

  /// Removes from `lasting` the columns of solid discs wider than thick_mm and the fringe around them.
  void without_thick(std::vector<std::uint8_t>& lasting, const DistanceMap& depth) const {
    const double radius = 0.5 * options_.thick_mm, reach = radius + fringe_mm;
    const auto centre = [&](std::size_t i) {
      return static_cast<double>(depth.square_mm2[i]) > radius * radius && is_solid(i);
    };
    const DistanceMap away = distances(centre);
    for (std::size_t i = 0; i < lasting.size(); ++i)
      if (static_cast<double>(away.square_mm2[i]) <= reach * reach) lasting[i] = 0;
  }

  std::vector<Part> parts_of(const std::vector<std::uint8_t>& lasting) const {
    std::vector<Part> parts;
    std::vector<std::uint8_t> seen(lasting.size(), 0);
    for (int y = 0; y < view_.size[1]; ++y)
      for (int x = 0; x < view_.size[0]; ++x) {
        if (lasting[view_.column(x, y)] == 0 || seen[view_.column(x, y)] != 0) continue;
        Part part{{{x, y}}};
        seen[view_.column(x, y)] = 1;
        for (std::size_t i = 0; i < part.columns.size(); ++i)
          for (int k = 0; k < 9; ++k) {
            const glm::ivec2 p = part.columns[i] + glm::ivec2(k % 3 - 1, k / 3 - 1);
            if (!view_.holds(p) || lasting[view_.column(p.x, p.y)] == 0 || seen[view_.column(p.x, p.y)] != 0)
              continue;
            seen[view_.column(p.x, p.y)] = 1;
            part.columns.push_back(p);
          }
        parts.push_back(std::move(part));
      }
    return parts;
  }

  /// Whether a part is wide and at least the share `least_free` of the columns around it has no solid
  /// samples.
  bool is_support(const Part& part, const std::vector<std::uint8_t>& lasting, double least_free) const {
    int free = 0, border = 0;
    for (const glm::ivec2& p : part.columns) {
      for (const glm::ivec2& step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const glm::ivec2 beside = p + step;
        if (view_.holds(beside) && lasting[view_.column(beside.x, beside.y)] != 0) continue;
        // Examines the column two steps away, because the adjacent column is the part's blurred edge, which
        // is solid on some slices. Such edges also occur within a part, between a cradle and the foam in it.
        const glm::ivec2 next = beside + step;
        if (view_.holds(next) && lasting[view_.column(next.x, next.y)] != 0) continue;
        ++border;
        free += !view_.holds(next) || columns_[view_.column(next.x, next.y)].solid <= 0.1F;
      }
    }
    return glm::length(size_mm(part)) >= least_width_mm && free >= least_free * border;
  }

  /// Marks a part's samples in its window, and slice by slice beyond the window while they belong to the
  /// part.
  void mark(const Part& part, const Window& window) {
    std::vector<std::pair<float, float>> wide, narrow;
    for (const glm::ivec2& p : part.columns) {
      wide.push_back(allowed(p, true));
      narrow.push_back(allowed(p, false));
    }
    const auto within = [](float sample, const std::pair<float, float>& values) {
      return sample >= values.first && sample <= values.second;
    };
    const auto goes_on = [&](int along) {
      std::size_t agree = 0, all = 0;
      for (std::size_t i = 0; i < part.columns.size(); ++i) {
        if (!view_.holds(place(part.columns[i], along))) continue;
        agree += within(calm_sample(part.columns[i], along), wide[i]);
        ++all;
      }
      return all > 0 && 10 * agree >= 8 * all;
    };
    Window whole = window;
    while (whole.first > 0 && goes_on(whole.first - 1)) --whole.first;
    while (whole.end < view_.size[2] && goes_on(whole.end)) ++whole.end;
    tbb::parallel_for(whole.first, whole.end, [&](int along) {
      std::vector<std::size_t> unsure;
      for (std::size_t i = 0; i < part.columns.size(); ++i) {
        const glm::ivec2 p = place(part.columns[i], along);
        if (!view_.holds(p)) continue;
        const float sample = calm_sample(part.columns[i], along);
        if (!within(sample, wide[i])) continue;
        found_.marks[view_.at(p.x, p.y, along)] = 1;
        if (!within(sample, narrow[i])) unsure.push_back(i);
      }
      unmark_at_contact(part, along, unsure);
    });
    ++found_.parts;
  }

  /// Unmarks the samples in `unsure`, which differ from their column, if a solid sample outside the part
  /// touches them.
  void unmark_at_contact(const Part& part, int along, const std::vector<std::size_t>& unsure) {
    std::vector<std::size_t> taken;
    for (const std::size_t i : unsure) {
      const glm::ivec2 p = place(part.columns[i], along);
      for (const glm::ivec2& step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const glm::ivec2 q = p + step;
        if (!view_.holds(q)) continue;
        const std::size_t beside = view_.at(q.x, q.y, along);
        if (found_.marks[beside] != 0 || (*view_.samples)[beside] < options_.threshold) continue;
        taken.push_back(view_.at(p.x, p.y, along));
        break;
      }
    }
    for (const std::size_t index : taken) found_.marks[index] = 0;
  }

  const View& view_;
  const ExtrusionOptions& options_;
  Extrusion& found_;
  glm::vec2 lies_off_{1.0F};        ///< in columns
  std::vector<glm::ivec2> shifts_;  ///< shift of the columns in each slice
  int calm_ = 0;                    ///< number of slices on either side that are averaged with a slice
  std::vector<Column> columns_;
};

}  // namespace

PatientAxes patient_axes(const Lattice& lattice) {
  const auto nearest = [&](int patient, int taken) {
    int best = -1;
    double most = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 direction = glm::normalize(glm::dvec3(lattice.lps_from_voxel[axis]));
      if (axis == taken || std::abs(direction[patient]) <= most) continue;
      most = std::abs(direction[patient]);
      best = axis;
    }
    return best;
  };
  PatientAxes axes;
  axes.along = nearest(2, -1);
  axes.back = nearest(1, axes.along);
  axes.side = 3 - axes.along - axes.back;
  return axes;
}

double air_level(const Scene& scene, const Int16Samples& samples) {
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::ivec3 block = glm::clamp(glm::ivec3(6.0 / scene.lattice.spacing_mm() + 0.5), 1, 16);
  constexpr int bins = 50;
  std::array<std::uint64_t, bins> counts{};
  for (int z = 0; z + block.z <= dims.z; z += block.z)
    for (int y = 0; y + block.y <= dims.y; y += block.y)
      for (int x = 0; x + block.x <= dims.x; x += block.x) {
        double sum = 0.0;
        std::int16_t low = 32767, high = -32768;
        for (int k = 0; k < block.z; ++k)
          for (int j = 0; j < block.y; ++j)
            for (int i = 0; i < block.x; ++i) {
              const std::int16_t sample = samples[sample_index(dims, {x + i, y + j, z + k})];
              sum += sample;
              low = std::min(low, sample);
              high = std::max(high, sample);
            }
        const double mean = sum / (block.x * block.y * block.z);
        // A block of a single value counts as padding, unless the block is one sample.
        if ((low == high && block != glm::ivec3(1) && low <= -1024) || mean < -1100.0 || mean >= -850.0)
          continue;
        ++counts[static_cast<std::size_t>((mean + 1100.0) / 5.0)];
      }
  const auto most = std::max_element(counts.begin(), counts.end());
  return *most == 0 ? -1000.0 : 5.0 * static_cast<double>(most - counts.begin()) - 1097.5;
}

Extrusion extrusion_of(const Scene& scene, const ExtrusionOptions& options) {
  check(scene);
  if (!(options.thick_mm > 0.0)) throw InvalidInput("a board's thickness must be above 0 mm");
  const auto* samples = std::get_if<Int16Samples>(&scene.samples);
  if (samples == nullptr) throw InvalidInput(scene.source + ": supports can be found only in int16 samples");
  const View view = view_of(scene, *samples);
  Extrusion found;
  found.marks.assign(samples->size(), 0);
  const Slope slope(view, options);
  found.slope = {slope.along(0), slope.along(1)};
  options.progress.at(0.2);
  Finder(view, options, found.slope, found).run();
  std::uint64_t solid = 0;
  for (std::size_t i = 0; i < samples->size(); ++i)
    solid += found.marks[i] != 0 && (*samples)[i] >= options.threshold;
  found.solid_mm3 = static_cast<double>(solid) * scene.lattice.voxel_mm3();
  return found;
}

}  // namespace octotomy::voxel
