// SPDX-License-Identifier: AGPL-3.0-or-later
//
// How far a triangulated surface may stray from the trilinear interpolant f of the samples it is made from:
// in each cell the part that the mesh calls outside is a polyhedron whose corners are outside samples (f <=
// t) and crossings of edges (f = t). Each of its points p is a mean of those corners, so the mean of f over
// them is at most t, and f(p) differs from that mean by the terms of f that are not linear: with f = a +
// linear terms + b_xy xy + b_yz yz + b_zx zx + b_xyz xyz in the cell's unit coordinates,
//   f(p) - mean f = -sum of b (mean of the product - product of the means).
// The mean of xy over points of mean x and y lies between max(0, x + y - 1) and min(x, y), that of xyz
// between max(0, x + y + z - 2) and min(x, y, z) (Frechet's bounds). The part that it calls inside strays
// likewise to the other side. No triangulation of the cell between its crossings can break this, whatever it
// does with ambiguous faces; at samples and on edges nothing strays.
//
// The voxel kernel's value at p is a weighted mean of at most eight voxels' samples, each f at the voxel's
// centre, rounded: it is computed here from f itself.
// The readings of all leaves stand beside what joins them, which makes the source long.
#include "verify/witness/witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "brep/mesh/distance.h"
#include "verify/question/expression_on_meshes.h"

namespace octotomy::verify {
namespace {

/// Rounding of numbers and of a few sums of them: a share of the largest magnitude.
constexpr double rounding = 1e-9;

/// The vertices of an isosurface keep a thousandth of an edge from its ends (convert/surface/isosurface.h).
constexpr double kept_from_samples = 1e-3;

/// A voxel's sample is rounded to an integer, and so is a window's bound.
constexpr double rounded_samples = 1.0;

/// An affine map, without the products that a matrix of four rows has beyond it.
struct Affine {
  glm::dvec3 x, y, z, at;

  explicit Affine(const glm::dmat4& map) : x(map[0]), y(map[1]), z(map[2]), at(map[3]) {}
  glm::dvec3 operator()(const glm::dvec3& p) const { return p.x * x + p.y * y + p.z * z + at; }
};

/// How far f may exceed a bound where the mesh is outside, and fall short of it where the mesh is inside.
struct Stray {
  double above = 0.0, below = 0.0;
};

template <typename Sample>
class WindowWitness {
 public:
  WindowWitness(std::shared_ptr<const voxel::Scene> scan, double low, double high,
                const voxel::Universe& universe)
      : scan_(std::move(scan)),
        samples_(std::get<voxel::Samples<Sample>>(scan_->samples).data()),
        dims_(scan_->lattice.dims),
        low_(low),
        high_(high),
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

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, Asked asked) const {
    const glm::dvec3 u = scan_from_lps_(p_mm);
    const double slack = slack_mm / finest_mm_;
    const Word mesh = mesh_word(u, slack);
    return {needs_voxels(asked) ? voxel_word(universe_from_lps_(p_mm)) : Word{}, mesh,
            mesh.near && needs_surfaces(asked) ? surfaces(u, slack) : 0};
  }

 private:
  /// The samples about a position, and where it lies between them.
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

  /// Positions beyond the outermost samples take the nearest value.
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

  static Stray stray_of(const Cell& at) {
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
    const double moved =
        kept_from_samples * (at.high - at.low) + rounding * std::max(std::abs(at.low), std::abs(at.high));
    found.above += moved;
    found.below += moved;
    return found;
  }

  /// Where f exceeds the lower bound by more than `above` the mesh cannot call it outside, where it is short
  /// of it by more than `below` not inside; mirrored for the upper bound. A value that is no number allows
  /// both answers.
  Word word(double value, double above, double below) const {
    const bool surely_in = value >= low_ + above && value <= high_ - below;
    const bool surely_out = value < low_ - below || value > high_ + above;
    return surely_in ? certainly_in : surely_out ? certainly_out : on_surface;
  }

  /// The word of a cell whose samples are so far from the window's bounds that no stray reaches them: of the
  /// four terms of stray_of() three are at most half the samples' range each, the last 1.6 times it.
  std::optional<Word> clear_word(const Cell& at, double slack) const {
    const double reach =
        (3.2 + 3.0 * slack) * (at.high - at.low) + rounding * std::max(std::abs(at.low), std::abs(at.high));
    if (at.high + reach < low_ || at.low - reach > high_) return certainly_out;
    if (at.low - reach >= low_ && at.high + reach <= high_) return certainly_in;
    return std::nullopt;
  }

  /// How far a position lies beyond the outermost samples, in samples.
  double beyond(const glm::dvec3& u) const {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      most = std::max({most, -u[axis], u[axis] - static_cast<double>(dims_[axis] - 1)});
    return most;
  }

  /// Beyond the outermost samples the mesh ends half a sample away from each that is inside. In a cell there,
  /// with p_i the distances beyond along the axes in samples, that is the plane where they add up to a half:
  /// the surface where all of the cell's own samples are inside, and the farthest that it reaches where some
  /// are.
  Word word_beyond(const glm::dvec3& u, double slack) const {
    double past = 0.0;
    for (int axis = 0; axis < 3; ++axis)
      past += std::max({0.0, -u[axis], u[axis] - static_cast<double>(dims_[axis] - 1)});
    const double near =
        rounding * (1.0 + static_cast<double>(std::max({dims_.x, dims_.y, dims_.z}))) + 3.0 * slack;
    if (past > 0.5 + near) return certainly_out;
    bool any_in = false, any_out = false;
    for (const double v : own_corners(u, slack))
      (v != padding_ && v >= low_ && v <= high_ ? any_in : any_out) = true;
    if (!any_in) return certainly_out;
    return any_out || past > 0.5 - near ? on_surface : certainly_in;
  }

  /// The samples of the cell that holds a position beyond the outermost ones, each maybe several times; of
  /// its neighbours, too, where the position lies within `slack` of them.
  std::vector<double> own_corners(const glm::dvec3& u, double slack) const {
    const double by = std::max(slack, 1e-6);
    const Cell low = cell(u - by), high = cell(u + by);
    std::vector<double> samples;
    for (const Cell* at : {&low, &high})
      for (std::size_t i = 0; i < 8; ++i) {
        // A corner without weight belongs to the cell on the other side of the position.
        double weight = 1.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double t = at->t[axis];
          weight *= ((i >> axis) & 1) != 0 ? t : 1.0 - t;
        }
        if (weight > 0.0) samples.push_back(at->v[i]);
      }
    return samples;
  }

  /// Padding is outside, and the surface closes half way to it from each sample inside.
  Word word_at_padding(const Cell& at) const {
    return std::any_of(at.v.begin(), at.v.end(),
                       [&](double v) { return v != padding_ && v >= low_ && v <= high_; })
               ? on_surface
               : certainly_out;
  }

  /// The mesh's answer, beyond the outermost samples as word_beyond() has it.
  Word mesh_word(const glm::dvec3& u, double slack) const {
    const double past = beyond(u);
    if (past >= 1.0) return certainly_out;
    if (past > rounding) return word_beyond(u, slack);
    const Cell at = cell(u);
    if (at.low == padding_) return word_at_padding(at);
    if (const std::optional<Word> clear = clear_word(at, slack)) return *clear;
    const Stray stray = stray_of(at);
    // In a cell f changes by its samples' range a sample along each axis at most.
    const double moved = 3.0 * slack * (at.high - at.low);
    Word answer = word(at.value(), stray.above + moved, stray.below + moved);
    // A cell with samples below and above the window has outside parts that are no mean of like corners.
    if (answer == certainly_in && at.low < low_ && at.high > high_) answer = on_surface;
    return answer;
  }

  /// Where it is near, the surface has vertices on the edges between samples alone.
  int surfaces(const glm::dvec3& u, double slack) const {
    const double on_edge = 1e-6 + slack;
    int whole = 0;
    for (int axis = 0; axis < 3; ++axis) whole += std::abs(u[axis] - std::round(u[axis])) < on_edge ? 1 : 0;
    return whole >= 2 ? 2 : 1;
  }

  Word voxel_word(const glm::dvec3& q) const {
    const glm::dvec3 nearest = glm::round(q);
    // A voxel's own centre has its own sample.
    const glm::dvec3 at = glm::dvec3(glm::abs(q.x - nearest.x) < 1e-7 ? nearest.x : q.x,
                                     glm::abs(q.y - nearest.y) < 1e-7 ? nearest.y : q.y,
                                     glm::abs(q.z - nearest.z) < 1e-7 ? nearest.z : q.z);
    const glm::dvec3 first = glm::floor(at), t = at - first;
    if (t == glm::dvec3(0.0)) {
      const Measured own = measured_at(at);
      if (!own.sure) return on_surface;
      return own.value ? word(*own.value, rounded_samples, rounded_samples) : certainly_out;
    }
    double value = 0.0, weights = 0.0;
    bool unsure = false;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
      const glm::dvec3 share = glm::mix(1.0 - t, t, corner);
      const double weight = share.x * share.y * share.z;
      if (weight == 0.0) continue;
      const Measured measured = measured_at(first + corner);
      unsure = unsure || !measured.sure;
      if (!measured.value) continue;
      value += weight * *measured.value;
      weights += weight;
    }
    if (weights == 0.0 && !unsure) return certainly_out;
    // Where some of the voxels have no sample of the scan's, the others stand for them as far as the voxel
    // that holds the position is the scan's.
    if (weights < 1.0 - 1e-9 || unsure) {
      const Measured own = measured_at(glm::floor(at + 0.5));
      const glm::dvec3 halves = glm::abs(t - 0.5);
      if (unsure || std::min({halves.x, halves.y, halves.z}) < 1e-6) return on_surface;
      if (!own.value) return certainly_out;
    }
    return word(value / weights, rounded_samples, rounded_samples);
  }

  /// A voxel's sample, none where the scan has none for it, and whether that is sure.
  struct Measured {
    std::optional<double> value;
    bool sure = true;
  };
  Measured measured_at(const glm::dvec3& voxel) const {
    if (glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) ||
        glm::any(glm::greaterThanEqual(voxel, glm::dvec3(side_))))
      return {};
    const glm::dvec3 u = scan_from_universe_(voxel);
    // A scan's voxels reach half a sample beyond their centres.
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
  double padding_;  ///< below every measured sample; NaN without padding
  std::array<std::size_t, 3> strides_{};
  Affine scan_from_lps_, universe_from_lps_, scan_from_universe_;
  int side_;
  double finest_mm_ = 1.0;
};

}  // namespace

Witness witness_of_window(std::shared_ptr<const voxel::Scene> scan, double low, double high,
                          const voxel::Universe& universe) {
  LineReading lines = lines_in_window(scan, low, high);
  Witness made;
  if (std::holds_alternative<voxel::Int16Samples>(scan->samples))
    made = WindowWitness<std::int16_t>(std::move(scan), low, high, universe);
  else
    made = WindowWitness<float>(std::move(scan), low, high, universe);
  return std::move(made).with_lines(std::move(lines));
}

namespace {

Word negated(const Word& a) {
  return {a.out, a.in, a.near};
}

Word conjunction(const Word& a, const Word& b) {
  const Word word{a.in && b.in, a.out || b.out, false};
  return {word.in, word.out, word.in && word.out && ((a.near && b.in) || (b.near && a.in))};
}

/// A surface is met where one operand's surface is and the other does not decide.
Word exclusive(const Word& a, const Word& b) {
  return {(a.in && b.out) || (a.out && b.in), (a.in && b.in) || (a.out && b.out), a.near || b.near};
}

/// Operands that decide alone spare the others, the cheap ones come first.
double cost_of(const Witness& witness) {
  constexpr double of_a_window = 100.0;
  return witness.lines() ? witness.lines().cost : of_a_window;
}

Reading negated(const Reading& a) {
  return {negated(a.voxel), negated(a.mesh), a.surfaces};
}

Reading conjunction(const Reading& a, const Reading& b) {
  return {conjunction(a.voxel, b.voxel), conjunction(a.mesh, b.mesh), a.surfaces + b.surfaces};
}
Reading exclusive(const Reading& a, const Reading& b) {
  return {exclusive(a.voxel, b.voxel), exclusive(a.mesh, b.mesh), a.surfaces + b.surfaces};
}

/// Whether no further operand of an intersection changes what is needed of the reading.
bool decides(const Reading& a, Asked asked) {
  return !needs_surfaces(asked) && a.mesh == certainly_out &&
         (!needs_voxels(asked) || a.voxel == certainly_out);
}

/// The intersection of operands, some of them as their complements.
struct Operand {
  Witness witness;
  bool is_complement = false;
};
Witness intersection(Operand a, Operand b) {
  if (!a.witness || !b.witness) return {};
  if (cost_of(b.witness) < cost_of(a.witness)) std::swap(a, b);
  return
      [a = std::move(a), b = std::move(b)](const glm::dvec3& p_mm, double slack_mm, Asked asked) -> Reading {
        const auto read = [&](const Operand& operand) {
          const Reading reading = operand.witness(p_mm, slack_mm, asked);
          return operand.is_complement ? negated(reading) : reading;
        };
        const Reading first = read(a);
        return decides(first, asked) ? first : conjunction(first, read(b));
      };
}

/// A vertex on a plane of the plan lies this share of its coordinates away after several Booleans and
/// motions.
constexpr double on_plane = 1e-8;

/// Right and up of a view's picture, from its name or its two angles.
std::array<glm::dvec3, 2> picture_axes(const std::string& view) {
  const glm::dvec3 left(1, 0, 0), back(0, 1, 0), head(0, 0, 1);
  if (view == "anterior") return {left, head};
  if (view == "posterior") return {-left, head};
  if (view == "left") return {back, head};
  if (view == "right") return {-back, head};
  if (view == "superior") return {-left, -back};
  if (view == "inferior") return {left, -back};
  double azimuth = 0.0, elevation = 0.0;
  char comma = 0, rest = 0;
  if (std::sscanf(view.c_str(), "%lf%c%lf%c", &azimuth, &comma, &elevation, &rest) != 3 || comma != ',')
    throw std::invalid_argument("no view '" + view + "'");
  azimuth *= std::numbers::pi / 180.0;
  elevation *= std::numbers::pi / 180.0;
  // The observer's place on the unit sphere, and what is right and up for somebody who looks from there to
  // the centre.
  const glm::dvec3 level = std::sin(azimuth) * left - std::cos(azimuth) * back;
  const glm::dvec3 right = std::cos(azimuth) * left + std::sin(azimuth) * back;
  return {right, std::cos(elevation) * head - std::sin(elevation) * level};
}

/// The polygons of one region, their edges by rows of the picture.
class RegionWitness {
 public:
  explicit RegionWitness(const DrawnRegion& region) : axes_(picture_axes(region.view)) {
    for (const auto& polygon : region.polygons_mm)
      for (std::size_t i = 0; i < polygon.size(); ++i)
        edges_.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
    for (const auto& [a, b] : edges_) {
      low_ = std::min({low_, a.y, b.y});
      high_ = std::max({high_, a.y, b.y});
      reach_mm_ = std::max({reach_mm_, glm::length(a), glm::length(b)});
    }
    // Rows much lower than the slack would each list the same edges.
    const double most_rows = high_ > low_ ? 4.0 * (high_ - low_) / most_slack_mm : 0.0;
    rows_.resize(std::max<std::size_t>(
        1, static_cast<std::size_t>(std::min(static_cast<double>(edges_.size()), most_rows))));
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const auto [from, to] = std::minmax(edges_[i][0].y, edges_[i][1].y);
      for (std::size_t row = row_of(from - most_slack_mm); row <= row_of(to + most_slack_mm); ++row)
        rows_[row].push_back(i);
    }
  }

  Reading operator()(const glm::dvec3& p_mm, double slack_mm) const {
    const glm::dvec2 p(glm::dot(p_mm, axes_[0]), glm::dot(p_mm, axes_[1]));
    const double near = near_mm(glm::length(p_mm)) + slack_mm;
    if (p.y < low_ - near || p.y > high_ + near) return {certainly_out, certainly_out};
    bool inside = false;
    int sides = 0;
    for (const std::size_t i : rows_[row_of(p.y)]) {
      const auto& [a, b] = edges_[i];
      const glm::dvec2 along = b - a, to = p - a;
      const double squared = glm::dot(along, along);
      const double part = squared > 0.0 ? std::clamp(glm::dot(to, along) / squared, 0.0, 1.0) : 0.0;
      if (glm::distance(to, part * along) <= near) ++sides;
      // The edge crosses the ray towards growing x; its ends count once.
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const double side = along.x * to.y - along.y * to.x;
      if ((side > 0.0) == (b.y > a.y)) inside = !inside;
    }
    const Word word = sides > 0 ? on_surface : inside ? certainly_in : certainly_out;
    return {word, word, sides};
  }

 private:
  /// An edge is looked for in the rows that it reaches with this much slack.
  static constexpr double most_slack_mm = 0.25;

  double near_mm(double p_mm) const { return on_plane * (reach_mm_ + p_mm); }
  std::size_t row_of(double y) const {
    const double share = high_ > low_ ? (y - low_) / (high_ - low_) : 0.0;
    return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(rows_.size() - 1));
  }

  std::array<glm::dvec3, 2> axes_;
  std::vector<std::array<glm::dvec2, 2>> edges_;
  std::vector<std::vector<std::size_t>> rows_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, reach_mm_ = 0.0;
};

/// A straight piece of a blade: planes where the blade ends, and those through which it goes on in the next
/// piece.
struct BladePiece {
  std::vector<HalfSpace> ends, joints;

  /// Farthest beyond one of the planes, in millimetres; negative inside of all.
  static double beyond_mm(const std::vector<HalfSpace>& planes, const glm::dvec3& p_mm) {
    double most = -std::numeric_limits<double>::infinity();
    for (const HalfSpace& plane : planes)
      most = std::max(most, glm::dot(plane.normal, p_mm) - plane.offset_mm);
    return most;
  }
};

std::vector<BladePiece> pieces_of(const DrawnBlade& blade) {
  const glm::dvec3 look = glm::normalize(blade.direction);
  std::vector<glm::dvec3> line;
  double first_mm = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : blade.line_mm) {
    first_mm = std::min(first_mm, glm::dot(p, look));
    const glm::dvec3 flat = p - glm::dot(p, look) * look;
    if (line.empty() || glm::distance(flat, line.back()) > 0.0) line.push_back(flat);
  }
  if (line.size() < 2)
    throw std::invalid_argument("a blade's line needs two points apart, seen along its direction");
  std::vector<glm::dvec3> along;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) along.push_back(glm::normalize(line[i + 1] - line[i]));
  std::vector<BladePiece> pieces(along.size());
  for (std::size_t i = 0; i < along.size(); ++i) {
    const glm::dvec3 aside = glm::cross(look, along[i]);
    const double middle_mm = glm::dot(aside, line[i]), half_mm = 0.5 * blade.kerf_mm;
    pieces[i].ends = {{aside, middle_mm + half_mm},
                      {-aside, half_mm - middle_mm},
                      {look, first_mm + blade.depth_mm},
                      {-look, -first_mm}};
    const glm::dvec3 back = i == 0 ? along[i] : glm::normalize(along[i - 1] + along[i]);
    const glm::dvec3 on = i + 1 == along.size() ? along[i] : glm::normalize(along[i] + along[i + 1]);
    (i == 0 ? pieces[i].ends : pieces[i].joints).push_back({-back, -glm::dot(back, line[i])});
    (i + 1 == along.size() ? pieces[i].ends : pieces[i].joints).push_back({on, glm::dot(on, line[i + 1])});
  }
  return pieces;
}

/// Those of all operands, each once.
std::vector<PartChoice> choices_of(const std::vector<Witness>& operands) {
  std::vector<PartChoice> all;
  for (const Witness& operand : operands)
    for (const PartChoice& choice : operand.choices())
      if (std::none_of(all.begin(), all.end(), [&](const PartChoice& known) {
            return known.necks == choice.necks && known.chosen_from_made == choice.chosen_from_made;
          }))
        all.push_back(choice);
  return all;
}

/// An expression's operands, numbered as its leaves.
class ReadExpression {
 public:
  ReadExpression(const ExpressionTree& tree, std::vector<Witness> leaves)
      : leaves_(std::move(leaves)),
        is_read_once_(static_cast<std::size_t>(tree.leaf_count()) == leaves_.size()),
        whole_(joint_of(tree)) {}

  Reading operator()(const glm::dvec3& p_mm, double slack_mm, Asked asked) const {
    if (is_read_once_)
      return read(
          whole_, [&](std::size_t leaf) { return leaves_[leaf](p_mm, slack_mm, asked); }, asked);
    std::vector<std::optional<Reading>> known(leaves_.size());
    const auto once = [&](std::size_t leaf) {
      if (!known[leaf]) known[leaf] = leaves_[leaf](p_mm, slack_mm, asked);
      return *known[leaf];
    };
    return read(whole_, once, asked);
  }

 private:
  /// A leaf, or what joins parts: an intersection, or where they are exclusive.
  struct Joint {
    bool is_complement = false, is_exclusive = false;
    std::size_t leaf = 0;
    double cost = 0.0;
    std::vector<Joint> parts = {};
  };

  Joint joint_of(const ExpressionTree& tree) const {
    Joint made;
    if (tree.parts.empty()) {
      made.leaf = static_cast<std::size_t>(tree.leaf);
      made.cost = cost_of(leaves_[made.leaf]);
      return made;
    }
    for (const ExpressionTree& part : tree.parts) {
      made.parts.push_back(joint_of(part));
      made.cost += made.parts.back().cost;
    }
    const auto complement = [](Joint& part) { part.is_complement = !part.is_complement; };
    made.is_exclusive = tree.symbol == '^';
    if (tree.symbol == '~') made.is_complement = true;
    if (tree.symbol == '-') std::for_each(made.parts.begin() + 1, made.parts.end(), complement);
    if (tree.symbol == '|') {
      made.is_complement = true;
      std::for_each(made.parts.begin(), made.parts.end(), complement);
    }
    std::stable_sort(made.parts.begin(), made.parts.end(),
                     [](const Joint& a, const Joint& b) { return a.cost < b.cost; });
    return made;
  }

  /// Recursion is as deep as the text's parentheses, not as long as a row of operands.
  template <typename ReadLeaf>
  static Reading read(const Joint& joint, const ReadLeaf& leaf, Asked asked) {
    if (joint.parts.empty()) return joint.is_complement ? negated(leaf(joint.leaf)) : leaf(joint.leaf);
    Reading made = read(joint.parts.front(), leaf, asked);
    for (std::size_t i = 1; i < joint.parts.size() && (joint.is_exclusive || !decides(made, asked)); ++i) {
      const Reading next = read(joint.parts[i], leaf, asked);
      made = joint.is_exclusive ? exclusive(made, next) : conjunction(made, next);
    }
    return joint.is_complement ? negated(made) : made;
  }

  std::vector<Witness> leaves_;
  bool is_read_once_;  ///< no leaf occurs twice
  Joint whole_;
};

}  // namespace

Witness witness_of_regions(const std::vector<DrawnRegion>& regions) {
  const auto readers = std::make_shared<const std::vector<RegionWitness>>(regions.begin(), regions.end());
  LineReading lines;
  for (const DrawnRegion& region : regions) {
    const auto [right, up] = picture_axes(region.view);
    LineReading one = lines_in_region(right, up, region.polygons_mm);
    lines = lines ? lines_in_both(std::move(lines), std::move(one)) : std::move(one);
  }
  return Witness([readers](const glm::dvec3& p_mm, double slack_mm) {
           Reading all{certainly_in, certainly_in, 0};
           for (const RegionWitness& reader : *readers) {
             const Reading one = reader(p_mm, slack_mm);
             all = conjunction(all, one);
           }
           return all;
         })
      .with_lines(std::move(lines));
}

Witness witness_of_box(const voxel::Box& box) {
  const auto read = [box](const glm::dvec3& p_mm, double slack_mm) {
    int sides = 0;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis)
      for (const double inner_mm : {p_mm[axis] - box.low_mm[axis], box.high_mm[axis] - p_mm[axis]}) {
        const double near_mm = on_plane * (std::abs(p_mm[axis]) + std::abs(box.low_mm[axis])) + slack_mm;
        sides += std::abs(inner_mm) <= near_mm ? 1 : 0;
        inside = inside && inner_mm >= -near_mm;
      }
    const Word word = !inside ? certainly_out : sides > 0 ? on_surface : certainly_in;
    return Reading{word, word, inside ? sides : 0};
  };
  return Witness(read).with_lines(lines_in_box(box));
}

Witness witness_of_blade(const DrawnBlade& blade) {
  const std::vector<BladePiece> pieces = pieces_of(blade);
  LineReading lines;
  for (const BladePiece& piece : pieces) {
    std::vector<HalfSpace> sides = piece.ends;
    sides.insert(sides.end(), piece.joints.begin(), piece.joints.end());
    LineReading one = lines_in_half_spaces(std::move(sides));
    lines = lines ? lines_in_either(std::move(lines), std::move(one)) : std::move(one);
  }
  const auto read = [pieces](const glm::dvec3& p_mm, double slack_mm) {
    const double near_mm = on_plane * (1.0 + glm::length(p_mm)) + slack_mm;
    int sides = 0;
    for (const BladePiece& piece : pieces) {
      if (BladePiece::beyond_mm(piece.joints, p_mm) > near_mm) continue;
      const double beyond_mm = BladePiece::beyond_mm(piece.ends, p_mm);
      if (beyond_mm < -near_mm) return Reading{certainly_in, certainly_in, 0};
      if (beyond_mm > near_mm) continue;
      for (const HalfSpace& plane : piece.ends)
        sides += std::abs(glm::dot(plane.normal, p_mm) - plane.offset_mm) <= near_mm ? 1 : 0;
    }
    return sides > 0 ? Reading{on_surface, on_surface, sides} : Reading{certainly_out, certainly_out, 0};
  };
  return Witness(read).with_lines(std::move(lines));
}

Witness witness_of_surface(brep::Solid solid) {
  return [solid = std::move(solid)](const glm::dvec3& p_mm, double slack_mm) {
    const double near_mm = on_plane * (1.0 + glm::length(p_mm)) + slack_mm;
    const bool near = !solid.empty() && solid.tree().distances_mm({p_mm}).front() <= near_mm;
    return Reading{near ? on_surface : untold, near ? on_surface : untold, near ? 2 : 0};
  };
}

Witness both(Witness a, Witness b) {
  LineReading lines = lines_in_both(a.lines(), b.lines());
  std::vector<PartChoice> choices = choices_of({a, b});
  return intersection({std::move(a)}, {std::move(b)})
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness without(Witness a, Witness b) {
  LineReading lines = lines_without(a.lines(), b.lines());
  std::vector<PartChoice> choices = choices_of({a, b});
  return intersection({std::move(a)}, {std::move(b), true})
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness carried(Witness still, const glm::dmat4& moved_from_still) {
  if (!still) return {};
  LineReading lines = lines_moved(still.lines(), moved_from_still);
  const glm::dmat4 still_from_moved = glm::inverse(moved_from_still);
  std::vector<PartChoice> choices = still.choices();
  for (PartChoice& choice : choices) choice.chosen_from_made = choice.chosen_from_made * still_from_moved;
  return Witness([still = std::move(still), back = Affine(still_from_moved)](const glm::dvec3& p_mm,
                                                                             double slack_mm, Asked asked) {
           return still(back(p_mm), slack_mm, asked);
         })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness loosened(Witness tight, double by_mm) {
  if (!tight) return {};
  LineReading lines = tight.lines();
  std::vector<PartChoice> choices = tight.choices();
  return Witness([tight = std::move(tight), by_mm](const glm::dvec3& p_mm, double slack_mm, Asked asked) {
           return tight(p_mm, slack_mm + by_mm, asked);
         })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

Witness witness_of_expression(std::string_view text,
                              const std::function<Witness(const std::string&)>& lookup) {
  std::vector<std::string> names;
  const ExpressionTree tree = expression_tree_of(text, names);
  std::vector<Witness> leaves;
  for (const std::string& name : names) {
    leaves.push_back(lookup(name));
    if (!leaves.back()) return {};
  }
  LineReading lines =
      lines_in_expression(text, [&](const std::string& name) { return lookup(name).lines(); });
  std::vector<PartChoice> choices = choices_of(leaves);
  const auto read = std::make_shared<const ReadExpression>(tree, std::move(leaves));
  return Witness([read](const glm::dvec3& p_mm, double slack_mm, Asked asked) {
           return (*read)(p_mm, slack_mm, asked);
         })
      .with_lines(std::move(lines))
      .with_choices(std::move(choices));
}

}  // namespace octotomy::verify
