// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The volume and area that an isosurface loses of a solid. t is a direction in the surface, s(t) the samples'
// spacing along t, k(t) the curvature along t, d(t) = 1 / |t / s| the spacing by its inverse squares.
//
// volume   1 A sample is the mean over its voxel, which is a blur of variance s^2 / 12. The scan adds a blur
//            of variance b^2 s^2. Blur moves the half level of curved boundary inward by half the variance
//            times k, summed over two directions. So V loses (1/12 + b^2) B, B the integral of s(t)^2 k(t).
//            Where the variance depends on the direction, only its part independent of the normal's direction
//            counts, which is d(t)^2. The integral of d(t)^2 k(t) is C. The loss of solids at spacings up to
//            5:1:1 lies between that by B and that by C, so the term with b^2 uses their mean.
//          2 Triangles are chords between crossings on the lattice's edges. They lose 0.2 C (0.21 for balls
//            at 1:1:1 to 5:1:1).
//          3 The loss at an edge grows with the tangent of half its angle. At a sharp edge that is more than
//            terms 1 and 2. The tangent's next term is cubic: F, s times the integral of (s H)^3 over the
//            parts of E below. The loss is 0.15 F, half of the loss of edges at 1:1:1, because edges lose
//            less between coarse slices.
// area     The same displacements times 2 H, H the mean curvature: 2 (0.29 + b^2) E on smooth boundary, E the
//          integral of (s H)^2. An edge has no H. There E is computed over parts of six samples, because blur
//          spreads an edge over that distance. Chamfers lose (0.28 + b^2) E as well. On smooth boundary this
//          is less than the loss above, and ripple, which adds area, makes up for the difference.
//
// Integrals of curvature are sums over edges of length times angle (Cohen-Steiner and Morvan, 2003), by parts
// of six samples along each axis and by the direction of the normal, so that ripple and noise cancel. The
// area of ripple and noise is R, the area that one step of smoothing removes.
//
// None of these losses is added to a value; the value is that of the triangles. The losses hold at the half
// level of a solid of one density, and no threshold of a patient's scan is known to be a half level. Where a
// scan is known to have two densities, two_phase.h computes the value. The blur b^2 measured in the samples
// may also be a gradient of the object itself, such as a ramp or spongy bone.
//
// sources  interpolation: the whole loss at a half level, or the difference from the volume by counting
//          samples if that is larger. Counting does not depend on the interpolation: between coarse slices
//          the surface of a low threshold bulges, and that of thin walls shrinks. digitisation, edges: a
//          share of that loss. blur: the loss by blur, and a share of it. flat: a plane along the lattice
//          lies between samples of shares 1, f and 0, and linear interpolation displaces the whole plane
//          equally, by up to 0.086 s. Noise tilts its triangles, so a part whose mean normal is along the
//          lattice counts with its whole area. sheet: the blur of the other side lowers a sheet's samples
//          (step_share()). window: the surface's shift for ten sample units. The constants were calibrated
//          with solids of all groups in poses of other seeds than those of interval_suite(), so that the
//          intervals contain the truth at the suite's 99th percentile.
#include "verify/interval/size_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <vector>

#include "brep/mesh/triangles.h"
#include "verify/interval/bend_of_edges.h"
#include "verify/interval/cell_table.h"
#include "verify/interval/ordered_parallel.h"
#include "voxel/space/large_allocator.h"

namespace octotomy::verify {
namespace {

constexpr double voxel_mean = 1.0 / 12.0;
constexpr double chords = 0.2;
/// An isosurface chamfers edges, so the angle between its triangles is smaller than this.
constexpr double sharpest_rad = 1.2;

/// Curvature and area of one part of the surface.
struct Part {
  double area_mm2 = 0.0;
  double bent_mm2 = 0.0;       ///< integral of s H
  double bent_mm3 = 0.0;       ///< integral of s^2 H
  glm::dvec3 across_mm2{0.0};  ///< sum of the triangles' vector areas
  /// area of the triangles along the lattice, each times the spacing along its normal
  double flat_mm3 = 0.0;
};

/// Integrals over the surface, from which the intervals are computed. The letters are those of the text
/// above.
struct Shape {
  double area_mm2 = 0.0, volume_mm3 = 0.0;
  double bent_mm3 = 0.0, bent_without_sign_mm3 = 0.0;    ///< B
  double chord_mm3 = 0.0;                                ///< C
  double sharp_mm2 = 0.0;                                ///< E
  double sharp_mm3 = 0.0, sharp_without_sign_mm3 = 0.0;  ///< F
  double ripple_mm2 = 0.0;                               ///< R
  double curvature_mm = 0.0;                             ///< the absolute value of the integral of H
  double flat_mm3 = 0.0;  ///< area along the lattice, each part times the spacing along its normal
  /// Difference between the volume by counting samples and the volume of the triangles, along the axis where
  /// it is largest.
  double between_mm3 = 0.0;
};

class Measuring {
 public:
  Measuring(const brep::Solid& solid, const SampledFrom& from)
      : linked_(solid.linked()),
        triangles_(linked_.triangles),
        sample_at_mm_(from.sample_at_mm),
        has_cells_(from.along_lps_mm) {
    const glm::dmat3& edges = from.sample_edges;
    frame_.from_lps = glm::inverse(edges);
    // Vertices have integer coordinates in samples on two axes. The borders of parts lie off the integers, so
    // that rounding cannot move a vertex to the next part.
    frame_.origin_mm = from.sample_at_mm + edges * glm::dvec3(0.123, 0.147, 0.161);
    for (int axis = 0; axis < 3; ++axis) {
      frame_.spacing_mm[axis] = glm::length(edges[axis]);
      frame_.units[axis] = edges[axis] / frame_.spacing_mm[axis];
    }
    frame_.part_samples = 6.0;
    frame_.cell_mm = 3.0 * from.along_lps_mm.value_or(glm::dvec3(1.0));
    shape_.volume_mm3 = solid.size().volume_mm3;
    shape_.area_mm2 = solid.size().area_mm2;
  }

  Shape run() {
    add_faces();
    add_edges();
    const glm::dvec3& spacing_mm = frame_.spacing_mm;
    const double least_mm2 = 0.5 * std::pow(spacing_mm.x * spacing_mm.y * spacing_mm.z, 2.0 / 3.0);
    const double sample_mm = std::cbrt(spacing_mm.x * spacing_mm.y * spacing_mm.z);
    parts_.each([&](const Part& part) {
      const double bent = part.bent_mm2 / std::max(part.area_mm2, least_mm2);
      shape_.sharp_mm2 += part.bent_mm2 * bent;
      shape_.sharp_mm3 += part.bent_mm2 * bent * bent * sample_mm;
      shape_.sharp_without_sign_mm3 += std::abs(part.bent_mm2) * bent * bent * sample_mm;
      shape_.bent_without_sign_mm3 += std::abs(part.bent_mm3);
      shape_.flat_mm3 +=
          std::max(part.flat_mm3, flat_mm3(glm::length(part.across_mm2), part.across_mm2 * frame_.units));
    });
    cells_mm_.each([&](double cell_mm) { triangles_as_they_are_.curvature_mm += std::abs(cell_mm); });
    smooth();
    find_between();
    return shape_;
  }
  const AreaAndCurvature& triangles() const { return triangles_as_they_are_; }

 private:
  const std::array<std::uint32_t, 3>& corners(std::size_t face) const { return triangles_.faces[face]; }
  const glm::dvec3& point(std::uint32_t number) const { return triangles_.points_mm[number]; }

  /// Combines the indices of a lattice cell with the axis nearest to a direction, and the direction's sign,
  /// to a key. Precondition: the indices are at least -2^19 and below 2^19.
  static std::uint64_t numbered(const glm::dvec3& cell, const glm::dvec3& along) {
    int direction = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(along[axis]) > (1.0 + 1e-9) * std::abs(along[direction])) direction = axis;
    auto key = static_cast<std::uint64_t>(along[direction] < 0.0 ? direction : direction + 3);
    for (int axis = 0; axis < 3; ++axis)
      key = (key << 20) |
            (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis]) + (1 << 19)) & 0xFFFFFU);
    return key;
  }

  struct Face {
    double size = 0.0, flat_mm3 = 0.0;
    glm::dvec3 across{0.0};
    std::uint64_t part = 0;
  };
  void make_faces(std::size_t first, std::size_t end, Face* made) const {
    FaceBatch faces;
    for (; first != end; first += std::min(batch, end - first)) {
      const std::size_t count = std::min(batch, end - first);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) faces.corner[k].set(i, point(corners(first + i)[k]));
      measure_faces(faces, frame_, count);
      for (std::size_t i = 0; i < count; ++i, ++made) {
        *made = {faces.size[i], 0.0, faces.across.at(i), 0};
        if (!(made->size > 0.0)) continue;
        made->part = numbered(faces.part.at(i), faces.along.at(i));
        made->flat_mm3 = flat_mm3(made->size, faces.along.at(i));
      }
    }
  }
  void add_faces() {
    ordered_parallel_by_batch<Face>(
        triangles_.faces.size(),
        [&](std::size_t first, std::size_t end, Face* made) { make_faces(first, end, made); },
        [&](std::size_t, const Face& face) {
          triangles_as_they_are_.area_mm2 += face.size;
          if (!(face.size > 0.0)) return;
          Part& part = parts_.at(face.part);
          part.area_mm2 += face.size;
          part.across_mm2 += face.across;
          part.flat_mm3 += face.flat_mm3;
        });
  }

  /// Returns the size of an area times the spacing along its normal if the normal is along an axis of the
  /// lattice, and zero otherwise. `along` is the vector area in the lattice's directions.
  double flat_mm3(double size, const glm::dvec3& along) const {
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(along[axis]) > flat_cosine * size) return size * frame_.spacing_mm[axis];
    return 0.0;
  }

  /// The contribution of an edge. A bent edge adds to its part, a cut marks its points; both add to a cell.
  struct BentEdge {
    enum class Kind : std::uint8_t { None, Cut, Bent } kind = Kind::None;
    bool has_cell = false;
    std::uint32_t a = 0, b = 0;
    std::uint64_t part = 0, cell = 0;
    double mm = 0.0, spacing_mm = 0.0, inverse = 0.0;
  };
  /// Computes the edges of sides `first` to `end` - 1. The second side of an edge gets an empty BentEdge, so
  /// that each edge counts once.
  void make_edges(std::size_t first, std::size_t end, BentEdge* made) const {
    EdgeBatch edges;
    std::array<std::size_t, batch> sides;
    std::size_t count = 0;
    const auto flush = [&] {
      open_edges(edges, count);
      for (std::size_t i = 0; i < count; ++i) edges.angle[i] = std::atan2(edges.sine[i], edges.cosine[i]);
      bend_edges(edges, frame_, count);
      for (std::size_t i = 0; i < count; ++i) made[sides[i] - first] = edge_of(edges, i, sides[i]);
      count = 0;
    };
    for (std::size_t number = first; number != end; ++number) {
      const auto side = static_cast<std::uint32_t>(number);
      made[number - first] = {};
      if (!linked_.is_inner_edge(side)) continue;
      edges.from.set(count, point(linked_.from(side)));
      edges.to.set(count, point(linked_.to(side)));
      for (std::size_t k = 0; k < 3; ++k) {
        edges.here[k].set(count, point(corners(side / 3)[k]));
        edges.beyond[k].set(count, point(corners(linked_.opposite[side] / 3)[k]));
      }
      sides[count++] = number;
      if (count == batch) flush();
    }
    flush();
  }
  BentEdge edge_of(const EdgeBatch& edges, std::size_t i, std::size_t number) const {
    BentEdge made;
    const double angle = edges.angle[i];
    if (angle == 0.0) return made;
    const auto side = static_cast<std::uint32_t>(number);
    made.a = linked_.from(side);
    made.b = linked_.to(side);
    const bool is_cut = std::abs(angle) > sharpest_rad;
    if (is_cut) made.kind = BentEdge::Kind::Cut;
    if (!(edges.tangent[i] > 0.0)) return made;
    made.mm = edges.mm[i];
    made.has_cell = has_cells_;
    if (has_cells_) made.cell = numbered(edges.cell.at(i), edges.normal.at(i));
    if (is_cut) return made;
    made.kind = BentEdge::Kind::Bent;
    made.part = numbered(edges.part.at(i), edges.along.at(i));
    made.spacing_mm = edges.spacing_mm[i];
    made.inverse = edges.inverse[i];
    return made;
  }

  void add_edges() {
    cut_.assign(triangles_.points_mm.size(), 0);
    ordered_parallel_by_batch<BentEdge>(
        linked_.opposite.size(),
        [&](std::size_t first, std::size_t end, BentEdge* made) { make_edges(first, end, made); },
        [&](std::size_t, const BentEdge& edge) {
          if (edge.kind == BentEdge::Kind::Cut) cut_[edge.a] = cut_[edge.b] = 1;
          if (edge.has_cell) cells_mm_.at(edge.cell) += edge.mm;
          if (edge.kind != BentEdge::Kind::Bent) return;
          const double mm = edge.mm, s = edge.spacing_mm;
          Part& part = parts_.at(edge.part);
          part.bent_mm2 += mm * s;
          part.bent_mm3 += mm * s * s;
          shape_.bent_mm3 += mm * s * s;
          shape_.chord_mm3 += mm / (edge.inverse * edge.inverse);
          shape_.curvature_mm += mm;
        });
    shape_.curvature_mm = std::abs(shape_.curvature_mm);
  }

  /// Computes `between_mm3`. Counting samples puts each crossing into the middle of its lattice edge, so the
  /// difference is the sum of the crossings' distances from the middle.
  void find_between() {
    std::vector<glm::dvec3> across(triangles_.points_mm.size(), glm::dvec3(0.0));
    for (const auto& [a, b, c] : triangles_.faces) {
      const glm::dvec3 area = glm::cross(point(b) - point(a), point(c) - point(a));
      for (const std::uint32_t corner : {a, b, c}) across[corner] += area;
    }
    const glm::dvec3& spacing_mm = frame_.spacing_mm;
    const double sample_mm3 = spacing_mm.x * spacing_mm.y * spacing_mm.z;
    glm::dvec3 sum(0.0);
    for (std::size_t v = 0; v < across.size(); ++v) {
      const glm::dvec3 q = frame_.from_lps * (triangles_.points_mm[v] - sample_at_mm_);
      const glm::dvec3 off = glm::abs(q - glm::round(q));
      // Vertices are at least a thousandth of an edge away from samples, so a vertex on a lattice edge is
      // farther than this from its ends.
      constexpr double on_line = 2e-4;
      for (int axis = 0; axis < 3; ++axis) {
        if (off[axis] <= on_line || off[(axis + 1) % 3] > on_line || off[(axis + 2) % 3] > on_line) continue;
        const double part = q[axis] - std::floor(q[axis]) - 0.5;
        sum[axis] += std::copysign(part, part * glm::dot(across[v], frame_.units[axis])) * sample_mm3;
      }
    }
    sum = glm::abs(sum);
    shape_.between_mm3 = std::max({sum.x, sum.y, sum.z});
  }

  /// Computes the area that one step of smoothing removes (R). The step moves every point half-way to the
  /// mean of its neighbours; points of cuts stay. Each thread owns a range of points and reads all triangles,
  /// so that a point's sum is in the order of the triangles.
  void smooth() {
    const std::vector<glm::dvec3>& p = triangles_.points_mm;
    std::vector<glm::dvec3, voxel::LargeAllocator<glm::dvec3>> moved(p.size());
    const auto shares = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    tbb::parallel_for(std::size_t{0}, shares, [&](std::size_t share) {
      const std::size_t first = p.size() * share / shares, end = p.size() * (share + 1) / shares;
      std::fill(moved.begin() + static_cast<std::ptrdiff_t>(first),
                moved.begin() + static_cast<std::ptrdiff_t>(end), glm::dvec3(0.0));
      std::vector<std::uint32_t> count(end - first, 0);
      for (const auto& face : triangles_.faces)
        for (std::size_t i = 0; i < 3; ++i) {
          if (face[i] - first >= end - first) continue;
          moved[face[i]] += p[face[(i + 1) % 3]];
          ++count[face[i] - first];
        }
      for (std::size_t v = first; v < end; ++v) {
        const std::uint32_t neighbours = count[v - first];
        moved[v] =
            neighbours == 0 || cut_[v] ? p[v] : 0.5 * p[v] + 0.5 * moved[v] / static_cast<double>(neighbours);
      }
    });
    double area_mm2 = 0.0;
    ordered_parallel<double>(
        triangles_.faces.size(),
        [&](std::size_t face) {
          const auto& [a, b, c] = triangles_.faces[face];
          return 0.5 * glm::length(glm::cross(moved[b] - moved[a], moved[c] - moved[a]));
        },
        [&](std::size_t, double face_mm2) { area_mm2 += face_mm2; });
    shape_.ripple_mm2 = std::max(shape_.area_mm2 - area_mm2, 0.0);
  }

  /// The cosine of 2.5 degrees. A plane within that angle of the lattice deviates from it by about a quarter
  /// of a sample over six samples.
  static constexpr double flat_cosine = 0.99905;

  const brep::Linked& linked_;
  const brep::Triangles& triangles_;
  BendFrame frame_;
  glm::dvec3 sample_at_mm_;
  bool has_cells_;
  CellTable<Part> parts_;
  CellTable<double> cells_mm_;  ///< the curvature in cells of three samples along the LPS axes
  AreaAndCurvature triangles_as_they_are_;
  std::vector<std::uint8_t> cut_;  ///< 1 for the ends of edges that belong to a cut
  Shape shape_;
};

double normal_distribution(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Distance outside the surface beyond which blur has no effect, in samples.
constexpr double away = 2.5;

/// The mean step across a face: the mean difference between depths of up to one sample inside and the same
/// depths outside. `level` returns the value at a depth in samples. Over a whole sample the ripple of linear
/// interpolation cancels. At a face along the lattice the step would otherwise depend on the position of the
/// face between two samples.
template <typename Level>
double mean_step(const Level& level) {
  constexpr int parts = 4;
  double sum = 0.0;
  for (int part = 0; part < parts; ++part) {
    const double depth = (part + 0.5) / parts;
    sum += level(depth) - level(-depth);
  }
  return sum / parts;
}

/// The mean step at the face of a sheet that was blurred by a Gaussian, as a share of the difference between
/// the values at `depth` inside the face and at `away` outside it. `deviation` is that of the Gaussian. All
/// lengths are in samples.
double step_share(double deviation, double depth, double thickness) {
  const auto level = [&](double at) {
    return normal_distribution(at / deviation) - normal_distribution((at - thickness) / deviation);
  };
  return mean_step(level) / (level(depth) - level(-away));
}

Interval summed(double value, std::vector<DoubtSource> sources) {
  double biases = 0.0, squares = 0.0;
  for (const DoubtSource& source : sources)
    if (source.is_bias)
      biases += source.half_width;
    else
      squares += source.half_width * source.half_width;
  return {value, biases + std::sqrt(squares), std::move(sources)};
}

void add(double share, const Interval& part, Interval& whole) {
  whole.value += share * part.value;
  whole.half_width += share * part.half_width;
  for (const DoubtSource& source : part.sources) {
    const auto known = std::find_if(whole.sources.begin(), whole.sources.end(),
                                    [&](const DoubtSource& other) { return other.name == source.name; });
    if (known == whole.sources.end())
      whole.sources.push_back({source.name, source.formula, share * source.half_width, source.is_bias});
    else
      known->half_width += share * source.half_width;
  }
}

/// The volume that a sheet's half level loses on both sides because the blur of each side reaches the other.
double sheet_mm3(const Shape& shape, double blur_samples2, double sample_mm) {
  if (!(shape.area_mm2 > 0.0) || !(shape.volume_mm3 > 0.0)) return 0.0;
  const double deviation_mm = sample_mm * std::sqrt(blur_samples2 + voxel_mean);
  const double thickness_mm = 2.0 * shape.volume_mm3 / shape.area_mm2;
  return shape.area_mm2 * deviation_mm * std::sqrt(2.0 * std::numbers::pi) *
         normal_distribution(-thickness_mm / deviation_mm);
}

}  // namespace

SizeIntervals size_intervals(const brep::Solid& solid, const SampledFrom& from) {
  if (solid.empty()) return {};
  Measuring measuring(solid, from);
  const Shape shape = measuring.run();
  const double b2 = from.blur_samples2, lost = voxel_mean + chords;
  const double s_mm = std::cbrt(std::abs(glm::determinant(from.sample_edges)));
  std::vector<DoubtSource> volume{
      {"digitisation", "0.3 * 0.28 |B|", 0.3 * lost * shape.bent_without_sign_mm3},
      {"blur", "b^2 (|B + C| / 2 + 0.3 |B|)",
       b2 * (0.5 * std::abs(shape.bent_mm3 + shape.chord_mm3) + 0.3 * shape.bent_without_sign_mm3), true},
      {"flat", "0.2 s * area of parts along the lattice", 0.2 * shape.flat_mm3},
      {"edges", "0.35 |F|", 0.35 * shape.sharp_without_sign_mm3},
      {"sheet", "S d sqrt(pi / 2) (1 - Phi(2 V / S / d)), d the blur's deviation",
       0.5 * sheet_mm3(shape, b2, s_mm), true}};
  std::vector<DoubtSource> area{
      {"digitisation", "5.5 * 0.28^2 E", 5.5 * lost * lost * shape.sharp_mm2},
      {"blur", "7 b^2 E", 7.0 * b2 * shape.sharp_mm2},
      {"ripple", "3.2 R", 3.2 * shape.ripple_mm2},
      {"flat", "0.1 * area of parts along the lattice", 0.1 * shape.flat_mm3 / s_mm}};
  if (from.window_shift_mm) {
    const double shift_mm = std::abs(*from.window_shift_mm);
    volume.push_back({"window", "area * shift for ten sample units", shape.area_mm2 * shift_mm});
    area.push_back({"window", "2 M * shift for ten sample units", 2.0 * shape.curvature_mm * shift_mm});
  }
  const double lost_mm3 =
      std::abs(voxel_mean * shape.bent_mm3 + chords * shape.chord_mm3 + 0.15 * shape.sharp_mm3);
  volume.push_back({"interpolation", "largest of |B / 12 + 0.2 C + 0.15 F| and |V - samples counted|",
                    std::max(lost_mm3, shape.between_mm3), true});
  area.push_back({"interpolation", "0.28 E + 0.5 R", lost * shape.sharp_mm2 + 0.5 * shape.ripple_mm2, true});
  return {summed(shape.volume_mm3, std::move(volume)), summed(shape.area_mm2, std::move(area)),
          measuring.triangles()};
}

SizeIntervals nothing_found(const glm::dvec3& sample_mm) {
  const double mm3 = sample_mm.x * sample_mm.y * sample_mm.z, mm = std::cbrt(mm3);
  const double ball_mm3 = 4.0 / 3.0 * std::numbers::pi * mm3, ball_mm2 = 4.0 * std::numbers::pi * mm * mm;
  return {{0.0, ball_mm3, {{"unseen", "a ball two samples across", ball_mm3}}},
          {0.0, ball_mm2, {{"unseen", "a ball two samples across", ball_mm2}}},
          {}};
}

SizeIntervals weighed(const std::vector<SharedIntervals>& parts) {
  SizeIntervals whole;
  for (const auto& [share, intervals] : parts) {
    add(share, intervals.volume_mm3, whole.volume_mm3);
    add(share, intervals.area_mm2, whole.area_mm2);
    whole.triangles = intervals.triangles;
  }
  return whole;
}

double blur_of(const brep::Solid& solid, const glm::dmat3& sample_edges,
               const std::function<double(const glm::dvec3& p_mm)>& sample_at,
               double interpolation_samples2) {
  constexpr std::size_t most_points = 2000;
  const brep::Triangles& triangles = solid.triangles();
  const std::size_t stride = 1 + triangles.faces.size() / most_points;
  if (solid.empty()) return 0.0;
  const double half_thickness_mm = solid.size().volume_mm3 / solid.size().area_mm2;
  double contrast = 0.0, step = 0.0, depth = 0.0, thickness = 0.0;
  int points = 0;
  for (std::size_t face = 0; face < triangles.faces.size(); face += stride) {
    const auto& [a, b, c] = triangles.faces[face];
    const glm::dvec3 &p = triangles.points_mm[a], &q = triangles.points_mm[b], &r = triangles.points_mm[c];
    const glm::dvec3 normal = glm::cross(q - p, r - p);
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    // `one` is the way of one sample along the normal, in mm. No point of a sheet is deeper than half its
    // thickness, so the inside is read at this depth, but between 0.5 and `away` samples deep.
    const glm::dvec3 n = normal / length, one = n * glm::length(glm::transpose(sample_edges) * n);
    const glm::dvec3 at = (p + q + r) / 3.0;
    const double half_thickness = half_thickness_mm / glm::length(one);
    const double deep = std::clamp(half_thickness, 0.5, away);
    contrast += sample_at(at - deep * one) - sample_at(at + away * one);
    step += mean_step([&](double inwards) { return sample_at(at - inwards * one); });
    depth += deep;
    thickness += 2.0 * half_thickness;
    ++points;
  }
  if (!(contrast > 0.0) || !(step > 0.0)) return 0.0;
  const double found = step / contrast;
  double low = 0.05, high = 3.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (step_share(middle, depth / points, thickness / points) > found ? low : high) = middle;
  }
  return std::max(low * low - voxel_mean - interpolation_samples2, 0.0);
}

}  // namespace octotomy::verify
