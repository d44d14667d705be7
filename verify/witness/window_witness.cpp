// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The bound of the distance, in values of f, between a triangulated isosurface and the trilinear interpolant
// f of its samples: in each cell the part outside the mesh is a polyhedron whose corners are outside samples
// (f <= t) and crossings of edges (f = t). Each point p of the polyhedron is a mean of those corners, so the
// mean of f over them is at most t. f(p) differs from that mean by the terms of f that are not linear: with
// f = a + linear terms + b_xy xy + b_yz yz + b_zx zx + b_xyz xyz in the cell's unit coordinates,
//   f(p) - mean f = -sum of b (mean of the product - product of the means).
// The mean of xy over points of mean x and y lies between max(0, x + y - 1) and min(x, y), that of xyz
// between max(0, x + y + z - 2) and min(x, y, z) (Frechet's bounds). The same bound holds with the opposite
// sign for the part inside the mesh. It holds for every triangulation of the cell between its crossings,
// however ambiguous faces are resolved. At samples and on edges the difference is zero. A window with two
// bounds has two such surfaces, and the bound holds for each.
//
// Cells with a sample that was not measured, and what lies beyond the outermost samples, have the surface of
// the samples in the window alone. What passes through the window between a sample below and one above ends
// at such a cell's face (convert/surface/window_surface.h), so the face may be a surface.
//
// The voxel kernel's value is f, rounded at the centres of voxels. This file computes it again from the
// samples.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "verify/witness/affine.h"
#include "verify/witness/witness.h"

namespace octotomy::verify {
namespace {

/// Bound of the rounding of values and of sums of a few values, relative to the largest magnitude.
constexpr double rounding = 1e-9;

/// The vertices of an isosurface are at least a thousandth of an edge away from the edge's ends
/// (convert/surface/isosurface.h).
constexpr double kept_from_samples = 1e-3;
/// A point within this distance of a face of a cell, in samples, counts as on the face.
constexpr double on_face = 1e-6;

/// How far f may exceed a bound where the mesh is outside, and fall below it where the mesh is inside; see
/// above.
struct Stray {
  double above = 0.0, below = 0.0;
};

template <typename Sample>
class WindowWitness {
  static constexpr double infinite = std::numeric_limits<double>::infinity();

 public:
  WindowWitness(std::shared_ptr<const voxel::Scene> scan, double low, double high,
                const voxel::Universe& universe, double step)
      : scan_(std::move(scan)),
        samples_(std::get<voxel::Samples<Sample>>(scan_->samples).data()),
        dims_(scan_->lattice.dims),
        low_(low),
        high_(high),
        rounded_(step),
        padding_(scan_->padding.value_or(std::numeric_limits<double>::quiet_NaN())),
        scan_from_lps_(glm::inverse(scan_->lattice.lps_from_voxel)),
        universe_from_lps_(glm::inverse(universe.lps_from_voxel)),
        scan_from_universe_(glm::inverse(scan_->lattice.lps_from_voxel) * universe.lps_from_voxel),
        side_(universe.side()) {
    const glm::dvec3 spacing_mm = scan_->lattice.spacing_mm();
    finest_mm_ = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    std::size_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      strides_[static_cast<std::size_t>(axis)] = stride;
      stride *= static_cast<std::size_t>(dims_[axis]);
    }
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) const {
    const glm::dvec3 u = scan_from_lps_(p_mm);
    const double slack = slack_mm / finest_mm_;
    const AllowedSides mesh = mesh_sides(u, slack);
    return {needs_voxels(asked) ? voxel_sides(universe_from_lps_(p_mm), u) : AllowedSides{}, mesh,
            mesh.near && needs_surfaces(asked) ? surfaces(u, slack) : 0};
  }

 private:
  /// The eight samples around a position, and the position in shares of the cell's edges.
  struct Cell {
    std::array<double, 8> v{};
    std::array<double, 3> t{};
    double low = 0.0, high = 0.0;  ///< of the samples

    double value() const {
      const auto between = [&](std::size_t i) { return v[i] + t[0] * (v[i + 1] - v[i]); };
      const double a = between(0), b = between(2), c = between(4), d = between(6);
      const double below = a + t[1] * (b - a), above = c + t[1] * (d - c);
      return below + t[2] * (above - below);
    }
  };

  /// Returns the cell at a position. A position beyond the outermost samples is clamped to them.
  Cell cell(const glm::dvec3& u) const {
    Cell made;
    const Sample* corner = samples_;
    std::array<std::size_t, 3> step{};
    for (std::size_t i = 0; i < 3; ++i) {
      const int last = dims_[static_cast<int>(i)] - 1;
      const double at = std::clamp(u[static_cast<int>(i)], 0.0, static_cast<double>(last));
      const int first = std::min(static_cast<int>(at), std::max(last - 1, 0));
      made.t[i] = at - first;
      corner += static_cast<std::size_t>(first) * strides_[i];
      step[i] = last > 0 ? strides_[i] : 0;
    }
    Sample low = *corner, high = low;
    for (std::size_t i = 0; i < 8; ++i) {
      const Sample sample = corner[(i & 1) * step[0] + ((i >> 1) & 1) * step[1] + (i >> 2) * step[2]];
      made.v[i] = static_cast<double>(sample);
      low = std::min(low, sample);
      high = std::max(high, sample);
    }
    made.low = static_cast<double>(low);
    made.high = static_cast<double>(high);
    return made;
  }

  Stray stray_of(const Cell& at) const {
    const auto& v = at.v;
    const auto& t = at.t;
    Stray found;
    const auto stray = [&](double b, double product, double most_mean, double least_mean) {
      const double up = -b * (least_mean - product), down = -b * (most_mean - product);
      found.above += std::max(up, down);
      found.below += std::max(-up, -down);
    };
    const auto stray_of_two = [&](double b, double x, double y) {
      stray(b, x * y, std::min(x, y), std::max(0.0, x + y - 1.0));
    };
    stray_of_two(v[0] - v[1] - v[2] + v[3], t[0], t[1]);
    stray_of_two(v[0] - v[1] - v[4] + v[5], t[0], t[2]);
    stray_of_two(v[0] - v[2] - v[4] + v[6], t[1], t[2]);
    stray(-v[0] + v[1] + v[2] - v[3] + v[4] - v[5] - v[6] + v[7], t[0] * t[1] * t[2],
          std::min({t[0], t[1], t[2]}), std::max(0.0, t[0] + t[1] + t[2] - 2.0));
    // Two crossings on one edge are also kept apart by this share.
    const double kept = spans_window(at) ? 2.0 * kept_from_samples : kept_from_samples;
    const double moved = kept * (at.high - at.low) + rounding * std::max(std::abs(at.low), std::abs(at.high));
    found.above += moved;
    found.below += moved;
    return found;
  }

  /// Whether a cell has samples below the window and samples above it.
  bool spans_window(const Cell& at) const { return at.low < low_ && at.high > high_; }
  /// Whether the surfaces of the window's two bounds may end in the plane of the outermost samples or in a
  /// face of a cell with padding.
  bool may_end_in_face(double highest) const { return low_ > -infinite && highest > high_; }

  /// The allowed sides for the value f at a point. An answer must be inside if f exceeds the lower bound by
  /// more than `above`, and outside if f is more than `below` under it. The upper bound is treated in the
  /// same way with the opposite sign. NaN allows both sides.
  AllowedSides allowed(double value, double above, double below) const {
    const bool surely_in = value >= low_ + above && value <= high_ - below;
    const bool surely_out = value < low_ - below || value > high_ + above;
    return surely_in ? certainly_in : surely_out ? certainly_out : on_surface;
  }

  /// The side of a cell whose samples are so far from the window's bounds that the stray cannot matter; none
  /// for any other cell. Three of the four terms of stray_of() are at most half the samples' range each, the
  /// last one at most 1.6 times the range.
  std::optional<AllowedSides> clear_sides(const Cell& at, double slack) const {
    const double reach =
        (3.2 + 3.0 * slack) * (at.high - at.low) + rounding * std::max(std::abs(at.low), std::abs(at.high));
    if (at.high + reach < low_ || at.low - reach > high_) return certainly_out;
    if (at.low - reach >= low_ && at.high + reach <= high_) return certainly_in;
    return std::nullopt;
  }

  /// How far a position lies beyond the outermost samples, in samples; negative within them.
  double beyond(const glm::dvec3& u) const {
    double most = -infinite;
    for (int axis = 0; axis < 3; ++axis)
      most = std::max({most, -u[axis], u[axis] - static_cast<double>(dims_[axis] - 1)});
    return most;
  }

  /// Beyond the outermost samples the mesh ends half a sample away from each inside sample. In a cell there,
  /// let p_i be the distances beyond the samples along the axes, in samples. If all of the cell's own samples
  /// are inside, the surface is the plane where the p_i add up to a half. If some are inside, the surface
  /// does not reach beyond that plane.
  AllowedSides sides_beyond(const glm::dvec3& u, double slack) const {
    double past = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      past += std::max({0.0, -u[axis], u[axis] - static_cast<double>(dims_[axis] - 1)});
    const double near =
        rounding * (1.0 + static_cast<double>(std::max({dims_.x, dims_.y, dims_.z}))) + 3.0 * slack;
    if (past > 0.5 + near) return certainly_out;
    bool any_in = false, any_out = false;
    double highest = -infinite;
    for (const double v : own_corners(u, slack)) {
      (v != padding_ && v >= low_ && v <= high_ ? any_in : any_out) = true;
      highest = std::max(highest, v);
    }
    if (past <= near && may_end_in_face(highest)) return on_surface;
    if (!any_in) return certainly_out;
    return any_out || past > 0.5 - near ? on_surface : certainly_in;
  }

  /// The samples of the cell that holds a position beyond the outermost samples, and those of neighbouring
  /// cells within `slack` of the position. A sample may occur several times.
  std::vector<double> own_corners(const glm::dvec3& u, double slack) const {
    const double by = std::max(slack, 1e-6);
    const Cell low = cell(u - by), high = cell(u + by);
    std::vector<double> samples;
    for (const Cell* at : {&low, &high})
      for (std::size_t i = 0; i < 8; ++i) {
        // A corner without weight belongs to a cell on the other side of the position.
        double weight = 1.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double t = at->t[axis];
          weight *= ((i >> axis) & 1) != 0 ? t : 1.0 - t;
        }
        if (weight > 0.0) samples.push_back(at->v[i]);
      }
    return samples;
  }

  /// The sides at a cell with padding, or within `slack` of such a cell; none elsewhere. Padding is outside.
  /// The surface closes half way between an inside sample and padding, so both sides are allowed if the cell
  /// has both.
  std::optional<AllowedSides> sides_at_padding(const Cell& at, const glm::dvec3& u, double slack) const {
    const double by = std::max(slack, may_end_in_face(at.high) ? on_face : 0.0);
    if (by == 0.0 && at.low != padding_) return std::nullopt;
    bool is_near = false, any_in = false, any_measured = false;
    double highest = -infinite;
    const auto add = [&](const Cell& near) {
      (near.low == padding_ ? is_near : any_measured) = true;
      highest = std::max(highest, near.high);
      for (const double v : near.v) any_in = any_in || (v != padding_ && v >= low_ && v <= high_);
    };
    add(at);
    if (by > 0.0)
      for (int i = 0; i < 8; ++i)
        add(cell(u + by * glm::dvec3((i & 1) * 2 - 1, (i & 2) - 1, (i >> 2) * 2 - 1)));
    if (!is_near) return std::nullopt;
    return any_in || (any_measured && may_end_in_face(highest)) ? on_surface : certainly_out;
  }

  /// Returns the mesh's sides, beyond the outermost samples by sides_beyond().
  AllowedSides mesh_sides(const glm::dvec3& u, double slack) const {
    const double past = beyond(u);
    if (past >= 1.0) return certainly_out;
    if (past > rounding) return sides_beyond(u, slack);
    const Cell at = cell(u);
    if (past > -on_face - 3.0 * slack && may_end_in_face(at.high)) return on_surface;
    if (scan_->padding)
      if (const std::optional<AllowedSides> allowed = sides_at_padding(at, u, slack)) return *allowed;
    if (const std::optional<AllowedSides> clear = clear_sides(at, slack)) return *clear;
    const Stray stray = stray_of(at);
    // Within a cell, f changes along each axis by at most the samples' range per sample.
    const double moved = 3.0 * slack * (at.high - at.low);
    const AllowedSides answer = allowed(at.value(), stray.above + moved, stray.below + moved);
    // A cell beside one with padding may share the surface of that cell.
    if (answer == certainly_in && scan_->padding && spans_window(at) && is_beside_padding(u))
      return on_surface;
    return answer;
  }

  bool is_beside_padding(const glm::dvec3& u) const {
    for (int i = 0; i < 27; ++i)
      if (cell(u + glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)).low == padding_) return true;
    return false;
  }

  /// Number of surfaces at a point near the surface: two on an edge between samples, where the surface may
  /// have a vertex, and one elsewhere.
  int surfaces(const glm::dvec3& u, double slack) const {
    const double on_edge = 1e-6 + slack;
    int whole = 0;
    for (int axis = 0; axis < 3; ++axis) whole += std::abs(u[axis] - std::round(u[axis])) < on_edge ? 1 : 0;
    return whole >= 2 ? 2 : 1;
  }

  /// The voxel kernel's sides. At a voxel's centre they follow from the voxel's own sample, elsewhere from
  /// values interpolated between the samples around the position. Samples that were not measured are left out
  /// of the mean, provided that the nearest sample was measured.
  AllowedSides voxel_sides(const glm::dvec3& q, const glm::dvec3& u) const {
    const glm::dvec3 nearest = glm::round(q), off = glm::abs(q - nearest);
    if (std::max({off.x, off.y, off.z}) < 1e-7) {
      const Measured own = measured_at(nearest);
      if (!own.sure) return on_surface;
      return own.value ? allowed(*own.value, rounded_, rounded_) : certainly_out;
    }
    const glm::dvec3 first = glm::floor(u), t = u - first;
    double value = 0.0, weights = 0.0;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
      const glm::dvec3 share = glm::mix(1.0 - t, t, corner);
      const std::optional<double> sample = sample_at(first + corner);
      if (!sample) continue;
      const double weight = share.x * share.y * share.z;
      value += weight * *sample;
      weights += weight;
    }
    if (weights < 1.0 - 1e-9) {
      const glm::dvec3 halves = glm::abs(t - 0.5);
      if (weights > 1e-9 && std::min({halves.x, halves.y, halves.z}) < 1e-6) return on_surface;
      if (!sample_at(glm::floor(u + 0.5))) return certainly_out;
    }
    return allowed(value / weights, rounded_, rounded_);
  }

  /// Returns a sample of the scan. None beyond the scan and for padding.
  std::optional<double> sample_at(const glm::dvec3& index) const {
    if (glm::any(glm::lessThan(index, glm::dvec3(0.0))) ||
        glm::any(glm::greaterThanEqual(index, glm::dvec3(dims_))))
      return std::nullopt;
    const auto at = [&](int axis) {
      return static_cast<std::size_t>(index[axis]) * strides_[static_cast<std::size_t>(axis)];
    };
    const auto sample = static_cast<double>(samples_[at(0) + at(1) + at(2)]);
    return sample == padding_ ? std::nullopt : std::optional(sample);
  }

  /// The sample of a voxel. `value` is none if the scan has no sample for the voxel. `sure` is false if
  /// rounding decides between the two.
  struct Measured {
    std::optional<double> value;
    bool sure = true;
  };
  Measured measured_at(const glm::dvec3& voxel) const {
    if (glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) ||
        glm::any(glm::greaterThanEqual(voxel, glm::dvec3(side_))))
      return {};
    const glm::dvec3 u = scan_from_universe_(voxel);
    // The voxels of a scan end half a sample beyond the outermost samples.
    const double past = beyond(u);
    if (past > 0.5 + 1e-6) return {};
    const Cell made = cell(u);
    if (made.low != padding_) return {made.value(), past < 0.5 - 1e-6};
    return {std::nullopt,
            std::all_of(made.t.begin(), made.t.end(), [](double t) { return t > 1e-6 && t < 1.0 - 1e-6; })};
  }

  std::shared_ptr<const voxel::Scene> scan_;
  const Sample* samples_;
  glm::ivec3 dims_;
  double low_, high_;
  double rounded_;  ///< rounding error of a voxel's sample and of the window's bound
  double padding_;  ///< value of padding, below every measured sample; NaN: no padding
  std::array<std::size_t, 3> strides_{};
  Affine scan_from_lps_, universe_from_lps_, scan_from_universe_;
  int side_;
  double finest_mm_ = 1.0;
};

}  // namespace

Witness witness_of_window(std::shared_ptr<const voxel::Scene> scan, double low, double high,
                          const voxel::Universe& universe, double step) {
  LineReading lines = lines_in_window(scan, low, high);
  Witness made;
  if (std::holds_alternative<voxel::Int16Samples>(scan->samples))
    made = WindowWitness<std::int16_t>(std::move(scan), low, high, universe, step);
  else
    made = WindowWitness<float>(std::move(scan), low, high, universe, step);
  return std::move(made).with_lines(std::move(lines));
}

}  // namespace octotomy::verify
