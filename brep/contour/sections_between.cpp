// SPDX-License-Identifier: AGPL-3.0-or-later
// For each gap between two drawn sections: 1 compute once the distances to both outlines at the samples
// beside or between these; 2 for each section between, follow the weighted sum's zero; 3 move each point
// along its edge between samples onto the exact zero, which changes no contour's order.
#include "brep/contour/sections_between.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/segment.h"

namespace octotomy::brep {
namespace {

struct Box2 {
  glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const std::vector<Contour>& contours) {
    for (const Contour& contour : contours)
      for (const glm::dvec2& p : contour.points_mm) {
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
  }
};

/// The outline of a section, with a grid of square cells that finds the sides near a point.
class Outline {
 public:
  Outline(const std::vector<Contour>& contours, double cell_mm) {
    Box2 box;
    box.add(contours);
    low_ = box.low;
    const glm::dvec2 extent = box.high - box.low;
    constexpr double most_cells = 512.0;
    cell_mm_ = std::max(cell_mm, std::max(extent.x, extent.y) / most_cells);
    width_ = static_cast<int>(extent.x / cell_mm_) + 1;
    height_ = static_cast<int>(extent.y / cell_mm_) + 1;
    cells_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    rows_.resize(static_cast<std::size_t>(height_));
    for (const Contour& contour : contours)
      for (std::size_t i = 0; i < contour.points_mm.size(); ++i)
        add(contour.points_mm[i], contour.points_mm[(i + 1) % contour.points_mm.size()]);
  }

  /// Whether a point lies inside the outline, by the even-odd rule.
  bool contains(const glm::dvec2& p) const {
    const double row = std::floor((p.y - low_.y) / cell_mm_);
    if (row < 0.0 || row >= height_) return false;
    bool is_inside = false;
    for (const std::uint32_t s : rows_[static_cast<std::size_t>(row)]) {
      const auto& [a, b] = sides_[s];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
        is_inside = !is_inside;
    }
    return is_inside;
  }

  /// Negative inside.
  double signed_distance_mm(const glm::dvec2& p) const {
    const int x = column_of(p.x), y = row_of(p.y);
    double square = std::numeric_limits<double>::infinity();
    // Sides in cells beyond `ring` are at least `ring` cells away from p.
    for (int ring = 0; ring <= std::max(width_, height_); ++ring) {
      for (int j = std::max(0, y - ring); j <= std::min(height_ - 1, y + ring); ++j) {
        const bool is_whole_row = std::abs(j - y) == ring;
        for (int i = x - ring; i <= x + ring; i += is_whole_row || ring == 0 ? 1 : 2 * ring)
          if (i >= 0 && i < width_) nearest_in(i, j, p, square);
      }
      if (std::sqrt(square) <= ring * cell_mm_) break;
    }
    return contains(p) ? -std::sqrt(square) : std::sqrt(square);
  }

 private:
  int column_of(double x) const {
    return static_cast<int>(std::clamp(std::floor((x - low_.x) / cell_mm_), 0.0, width_ - 1.0));
  }
  int row_of(double y) const {
    return static_cast<int>(std::clamp(std::floor((y - low_.y) / cell_mm_), 0.0, height_ - 1.0));
  }
  void add(const glm::dvec2& a, const glm::dvec2& b) {
    const auto side = static_cast<std::uint32_t>(sides_.size());
    sides_.emplace_back(a, b);
    const int first = row_of(std::min(a.y, b.y)), last = row_of(std::max(a.y, b.y));
    for (int j = first; j <= last; ++j) {
      rows_[static_cast<std::size_t>(j)].push_back(side);
      // The part of the side in this row, longer by a millionth of a cell at either end because of rounding.
      double from = a.x, to = b.x;
      if (first != last) {
        const double low = low_.y + (j - 1e-6) * cell_mm_, high = low_.y + (j + 1.0 + 1e-6) * cell_mm_;
        const auto x_at = [&](double y) {
          return a.x + std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0) * (b.x - a.x);
        };
        from = x_at(low);
        to = x_at(high);
      }
      for (int i = column_of(std::min(from, to)); i <= column_of(std::max(from, to)); ++i)
        cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(i)]
            .push_back(side);
    }
  }
  void nearest_in(int i, int j, const glm::dvec2& p, double& square) const {
    for (const std::uint32_t s : cells_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
                                        static_cast<std::size_t>(i)]) {
      const auto& [a, b] = sides_[s];
      const glm::dvec2 apart = p - (a + share_along(p, a, b) * (b - a));
      square = std::min(square, glm::dot(apart, apart));
    }
  }

  glm::dvec2 low_{0.0};
  double cell_mm_ = 1.0;
  int width_ = 1, height_ = 1;
  std::vector<std::pair<glm::dvec2, glm::dvec2>> sides_;
  std::vector<std::vector<std::uint32_t>> cells_, rows_;
};

/// Samples in the plane for one gap, with their distances to the outlines at both ends of the gap.
class Gap {
 public:
  Gap(const Section& below, const Section& above, double sample_mm)
      : below_(below.contours, sample_mm), above_(above.contours, sample_mm) {
    Box2 box;
    box.add(below.contours);
    box.add(above.contours);
    const glm::dvec2 extent = box.high - box.low;
    constexpr double most_samples = 4096.0;
    sample_mm_ = std::max(sample_mm, std::max(extent.x, extent.y) / most_samples);
    // Irrational offsets, so that few samples coincide with typed coordinates of outlines.
    low_ = box.low - sample_mm_ * glm::dvec2(2.3819660, 2.4142136);
    const glm::dvec2 samples = glm::floor((box.high - low_) / sample_mm_) + 4.0;
    width_ = static_cast<std::uint32_t>(samples.x);
    height_ = static_cast<std::uint32_t>(samples.y);
    measure();
  }

  /// The outline at a share of the gap's height.
  std::vector<Contour> outline(double share) const {
    std::vector<float> depth(from_below_.size());
    for (std::size_t s = 0; s < depth.size(); ++s)
      depth[s] = static_cast<float>(-((1.0 - share) * from_below_[s] + share * from_above_[s]));
    std::vector<Contour> contours =
        follow({depth, width_, height_, {sample_mm_, sample_mm_}}, {.threshold = 0.0});
    for (Contour& contour : contours)
      for (glm::dvec2& p : contour.points_mm) p = low_ + sample_mm_ * exact(p / sample_mm_, share);
    return contours;
  }

 private:
  glm::dvec2 place(double x, double y) const { return low_ + sample_mm_ * glm::dvec2(x, y); }

  /// Exact distances beside outlines and between them; elsewhere the right sign suffices.
  void measure() {
    const std::size_t count = std::size_t{width_} * height_;
    std::vector<std::uint8_t> sides(count);
    for (std::size_t s = 0; s < count; ++s) {
      const glm::dvec2 p = place(static_cast<double>(s % width_), static_cast<double>(s / width_));
      sides[s] = static_cast<std::uint8_t>((below_.contains(p) ? 1 : 0) | (above_.contains(p) ? 2 : 0));
    }
    from_below_.resize(count);
    from_above_.resize(count);
    for (std::size_t s = 0; s < count; ++s) {
      const auto x = static_cast<std::uint32_t>(s % width_), y = static_cast<std::uint32_t>(s / width_);
      bool is_alone = sides[s] == 0 || sides[s] == 3;
      for (std::uint32_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, height_ - 1); ++j)
        for (std::uint32_t i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, width_ - 1); ++i)
          is_alone = is_alone && sides[std::size_t{j} * width_ + i] == sides[s];
      if (is_alone) {
        from_below_[s] = from_above_[s] = sides[s] == 3 ? -sample_mm_ : sample_mm_;
        continue;
      }
      const glm::dvec2 p = place(x, y);
      from_below_[s] = below_.signed_distance_mm(p);
      from_above_[s] = above_.signed_distance_mm(p);
    }
  }

  double value(const glm::dvec2& p_samples, double share) const {
    const glm::dvec2 p = place(p_samples.x, p_samples.y);
    return (1.0 - share) * below_.signed_distance_mm(p) + share * above_.signed_distance_mm(p);
  }

  /// Moves a followed point, which lies on an edge between samples, to the exact zero on that edge (Illinois
  /// method).
  glm::dvec2 exact(const glm::dvec2& p, double share) const {
    const glm::dvec2 nearest = glm::round(p), off = glm::abs(p - nearest);
    const int axis = off.x > off.y ? 0 : 1;
    // A point at a sample is already exact.
    if (off[axis] < 1e-6) return p;
    glm::dvec2 a = nearest, b = nearest;
    a[axis] = std::floor(p[axis]);
    b[axis] = a[axis] + 1.0;
    double at_a = value(a, share), at_b = value(b, share);
    if ((at_a <= 0.0) == (at_b <= 0.0)) return p;
    constexpr int most_steps = 6;
    glm::dvec2 found = p;
    for (int step = 0; step < most_steps; ++step) {
      if (step > 0) found[axis] = a[axis] + at_a / (at_a - at_b) * (b[axis] - a[axis]);
      const double at = value(found, share);
      if (std::abs(at) < 1e-4 * sample_mm_) break;
      if ((at <= 0.0) == (at_a <= 0.0)) {
        a = found;
        at_a = at;
        at_b *= 0.5;
      } else {
        b = found;
        at_b = at;
        at_a *= 0.5;
      }
    }
    return found;
  }

  Outline below_, above_;
  double sample_mm_ = 1.0;
  glm::dvec2 low_{0.0};
  std::uint32_t width_ = 0, height_ = 0;
  std::vector<double> from_below_, from_above_;
};

void check(const std::vector<Section>& drawn, const SectionsBetweenOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("sections_between: " + why); };
  if (!(options.step_mm > 0.0) || !std::isfinite(options.step_mm)) refuse("the step must be above 0 mm");
  if (drawn.size() < 2) refuse("two sections or more are needed");
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    const std::string name = "section " + std::to_string(s);
    if (!std::isfinite(drawn[s].z_mm) || (s > 0 && !(drawn[s - 1].z_mm < drawn[s].z_mm)))
      refuse(name + " is not higher than the one before it: sort them by height");
    for (const Contour& contour : drawn[s].contours) {
      if (!contour.closed) refuse("a contour of " + name + " is open: close it");
      if (contour.points_mm.size() < 3) refuse("a contour of " + name + " has fewer than three points");
      for (const glm::dvec2& p : contour.points_mm)
        if (!std::isfinite(p.x) || !std::isfinite(p.y))
          refuse("a contour of " + name + " has a point that is not finite");
    }
  }
}

/// Divides the contours' sides so that none is longer than this.
std::vector<Contour> divided(const std::vector<Contour>& contours, double most_mm) {
  std::vector<Contour> all;
  for (const Contour& contour : contours) {
    all.emplace_back();
    for (std::size_t i = 0; i < contour.points_mm.size(); ++i) {
      const glm::dvec2 &a = contour.points_mm[i], &b = contour.points_mm[(i + 1) % contour.points_mm.size()];
      const auto pieces =
          std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(glm::distance(a, b) / most_mm)));
      for (std::size_t k = 0; k < pieces; ++k)
        all.back().points_mm.push_back(glm::mix(a, b, static_cast<double>(k) / static_cast<double>(pieces)));
    }
  }
  return all;
}

/// The sections within a gap, without those at its ends.
std::vector<Section> sections_in_gap(const Section& below, const Section& above,
                                     const SectionsBetweenOptions& options) {
  if (below.contours.empty() && above.contours.empty()) return {};
  const double gap_mm = above.z_mm - below.z_mm;
  if (options.between == Between::nearest || below.contours.empty() || above.contours.empty()) {
    const double middle_mm = below.z_mm + 0.5 * gap_mm, half_mm = std::min(half_terrace_mm(), gap_mm / 8.0);
    return {{middle_mm - half_mm, below.contours}, {middle_mm + half_mm, above.contours}};
  }
  const auto steps = static_cast<std::size_t>(std::ceil(gap_mm / options.step_mm));
  if (steps < 2) return {};
  const Gap gap(below, above, 0.5 * options.step_mm);
  std::vector<Section> sections(steps - 1);
  tbb::parallel_for(std::size_t{1}, steps, [&](std::size_t k) {
    if (options.stop.stop_requested()) return;
    const double share = static_cast<double>(k) / static_cast<double>(steps);
    sections[k - 1] = {below.z_mm + share * gap_mm, gap.outline(share)};
  });
  return sections;
}

/// Moves the tiles' points back to the points of their sections. Moves the points of both sections at a step
/// into one plane half way. The tiles' points begin with those of the sections, in the sections' order;
/// contours may be reversed.
Triangles put_back(const Triangles& tiles, const std::vector<Section>& sections) {
  Triangles back = tiles;
  std::size_t first = 0;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    Box2 drawn, moved;
    drawn.add(sections[s].contours);
    std::size_t end = first;
    for (const Contour& contour : sections[s].contours) end += contour.points_mm.size();
    for (std::size_t i = first; i < end; ++i) moved.low = glm::min(moved.low, glm::dvec2(tiles.points_mm[i]));
    // A step has a section on either side of its plane.
    double z_mm = sections[s].z_mm;
    const auto is_step = [&](std::size_t below) {
      return sections[below + 1].z_mm - sections[below].z_mm <= 2.0 * half_terrace_mm() * (1.0 + 1e-6);
    };
    if (s > 0 && is_step(s - 1))
      z_mm = 0.5 * (sections[s - 1].z_mm + z_mm);
    else if (s + 1 < sections.size() && is_step(s))
      z_mm = 0.5 * (z_mm + sections[s + 1].z_mm);
    for (std::size_t i = first; i < end; ++i)
      back.points_mm[i] = glm::dvec3(glm::dvec2(tiles.points_mm[i]) - (moved.low - drawn.low), z_mm);
    first = end;
  }
  return back;
}

}  // namespace

std::vector<Section> sections_between(const std::vector<Section>& drawn,
                                      const SectionsBetweenOptions& options) {
  check(drawn, options);
  std::vector<Section> whole = drawn;
  for (Section& section : whole) section.contours = divided(section.contours, options.step_mm);
  const std::size_t last = drawn.size() - 1;
  // Adds an empty section beyond each end, at the distance between the end section and its neighbour.
  whole.insert(whole.begin(), {2.0 * drawn[0].z_mm - drawn[1].z_mm, {}});
  whole.push_back({2.0 * drawn[last].z_mm - drawn[last - 1].z_mm, {}});
  std::vector<std::vector<Section>> gaps(whole.size() - 1);
  tbb::parallel_for(std::size_t{0}, gaps.size(), [&](std::size_t s) {
    if (options.stop.stop_requested()) return;
    gaps[s] = sections_in_gap(whole[s], whole[s + 1], options);
  });
  if (options.stop.stop_requested()) throw Stopped("interpolating sections was stopped");
  std::vector<Section> all;
  for (std::size_t s = 0; s < whole.size(); ++s) {
    all.push_back(std::move(whole[s]));
    if (s < gaps.size()) std::move(gaps[s].begin(), gaps[s].end(), std::back_inserter(all));
  }
  return all;
}

TiledBetween tile_between(const std::vector<Section>& drawn, const SectionsBetweenOptions& options,
                          std::optional<TileCost> cost) {
  const std::vector<Section> sections = sections_between(drawn, options);
  TileSectionsOptions tiling;
  tiling.cost = cost;
  tiling.stop = options.stop;
  // With longer spans, strips could leave the area between two outlines, for example between the halves of an
  // hourglass.
  tiling.most_span_mm = options.step_mm;
  TiledBetween tiled{tile_sections(sections, tiling).surface, sections.size()};
  Triangles back = put_back(tiled.surface, sections);
  const Health found = health(back, {.self_intersections = true});
  tiled.is_whole_flat = tiled.is_apart = found.solid();
  if (found.solid())
    tiled.surface = std::move(back);
  else
    tiled.is_apart = health(tiled.surface, {.self_intersections = true}).solid();
  return tiled;
}

}  // namespace octotomy::brep
