// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/label_surfaces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "voxel/filter/label_map.h"
#include "voxel/space/error.h"
#include "voxel/space/large_allocator.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/shared_progress.h"

// Source: Bloomenthal and Ferguson, "Polygonization of non-manifold implicit surfaces", SIGGRAPH 1995, for
// tetrahedra of several materials. Departures: a cell is cut into Kuhn's six tetrahedra, and points lie where
// the labels' shares are equal. The passes:
// 1 The labels are copied with a border of no label, so that surfaces close there.
// 2 Every cell whose corners differ is cut into six tetrahedra along its diagonal from the lowest to the
//   highest corner. All cells are cut in the same way, so neighbours share whole triangles. A tetrahedron's
//   triangles follow from which of its corners have equal labels. Triangles name their points by keys: a
//   point lies on an edge between two labels, on a face between three, or in a tetrahedron between four.
// 3 The keys of each plane of samples are marked, a bit each; the rank of a key is its point's number.
// 4 The points are placed. The cells are cut again, and keys replaced by numbers.
//
// Why the surfaces are sound. Up to where its points lie, a label's region is the union of the dual cells of
// its samples, which is a regular neighbourhood of the complex that they span, so its boundary is a closed
// manifold (Rourke and Sanderson, Introduction to Piecewise-Linear Topology, chapter 3). In a tetrahedron the
// triangles are a cone from a point, which sees every point of the boundary of a convex body once, so they
// never cross, wherever the points lie inside their edges and faces.

namespace octotomy::convert {
namespace {

using Key = std::uint64_t;

/// Codes of the points that have a given sample as their lowest one. 8 d + e: the face with the corners 0, d
/// and e, or the edge from 0 to e if d = 0, where corners are offsets x + 2y + 4z. From
/// first_tetrahedron_code on: the six tetrahedra.
constexpr std::uint32_t code_count = 128, first_tetrahedron_code = 64;

/// The codes that occur, in ascending order, and the place of each among them: 7 edges, 12 faces and 6
/// tetrahedra, so that a sample's points are the bits of one word.
struct Codes {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, code_count> place{};

  Codes() {
    for (std::uint32_t code = 1; code < first_tetrahedron_code + 6; ++code) {
      const std::uint32_t d = code / 8, e = code % 8;
      if (code < first_tetrahedron_code && (e == 0 || (d & e) != d || d == e)) continue;
      place[code] = static_cast<std::uint8_t>(all.size());
      all.push_back(static_cast<std::uint8_t>(code));
    }
  }
};
const Codes& codes() {
  static const Codes made;
  return made;
}

/// The points of a plane of samples: a word of marks per sample, and the number of points before it.
struct PlanePoints {
  std::vector<std::uint32_t> marks, before;

  std::uint32_t rank(std::size_t sample, std::uint8_t place) const {
    return before[sample] +
           static_cast<std::uint32_t>(std::popcount(marks[sample] & ((std::uint32_t{1} << place) - 1)));
  }
};
/// The least distance of a point from the ends of its edge, as a part of the edge.
constexpr double least_part = 0.1;

struct PointName {
  std::uint8_t corner = 0;  ///< corner of the cell: the point's lowest sample
  std::uint8_t code = 0;
};

/// A triangle of a tetrahedron, counter-clockwise seen from the side of the corner `front` of the cell.
struct CellTriangle {
  std::array<PointName, 3> points;
  std::uint8_t behind = 0, front = 0;
};
using CellTriangles = std::vector<CellTriangle>;

glm::dvec3 place_of(int corner) {
  return {corner & 1, (corner >> 1) & 1, corner >> 2};
}

/// A point of a tetrahedron, given by the corners between which it lies, in ascending order.
struct Between {
  std::vector<int> corners;
  PointName name(int tetrahedron) const {
    const auto lowest = static_cast<std::uint8_t>(corners.front());
    if (corners.size() == 4) return {lowest, static_cast<std::uint8_t>(first_tetrahedron_code + tetrahedron)};
    const int d = corners.size() == 3 ? corners[1] - corners[0] : 0;
    return {lowest, static_cast<std::uint8_t>(8 * d + corners.back() - corners.front())};
  }
  glm::dvec3 place() const {
    glm::dvec3 sum(0.0);
    for (const int corner : corners) sum += place_of(corner);
    return sum / static_cast<double>(corners.size());
  }
};

/// Derives the pieces of a tetrahedron whose corners have these labels.
class Derivation {
 public:
  Derivation(int tetrahedron, const std::array<int, 4>& corners, const std::array<int, 4>& labels)
      : tetrahedron_(tetrahedron), corners_(corners) {
    std::vector<std::vector<int>> classes;
    for (int i = 0; i < 4; ++i) {
      const auto same = std::find_if(classes.begin(), classes.end(), [&](const std::vector<int>& each) {
        return labels[each.front()] == labels[i];
      });
      if (same == classes.end())
        classes.push_back({i});
      else
        same->push_back(i);
    }
    std::stable_sort(classes.begin(), classes.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    if (classes.size() == 2 && classes[1].size() == 1) one_corner(classes[1][0], classes[0]);
    if (classes.size() == 2 && classes[1].size() == 2) two_corners(classes[0], classes[1]);
    if (classes.size() == 3) three_labels(classes[0], classes[1][0], classes[2][0]);
    if (classes.size() == 4) four_labels();
  }
  CellTriangles take() { return std::move(pieces_); }

 private:
  Between between(std::vector<int> numbers) const {
    for (int& number : numbers) number = corners_[number];
    std::sort(numbers.begin(), numbers.end());
    return {std::move(numbers)};
  }
  void add(int behind, int front, const Between& a, const Between& b, const Between& c) {
    const glm::dvec3 normal = glm::cross(b.place() - a.place(), c.place() - a.place());
    const bool faces_front = glm::dot(normal, place_of(corners_[front]) - place_of(corners_[behind])) > 0.0;
    pieces_.push_back({{a.name(tetrahedron_), (faces_front ? b : c).name(tetrahedron_),
                        (faces_front ? c : b).name(tetrahedron_)},
                       static_cast<std::uint8_t>(corners_[behind]),
                       static_cast<std::uint8_t>(corners_[front])});
  }

  void one_corner(int one, const std::vector<int>& rest) {
    add(one, rest[0], between({one, rest[0]}), between({one, rest[1]}), between({one, rest[2]}));
  }
  void two_corners(const std::vector<int>& a, const std::vector<int>& b) {
    const Between apex = between({a[0], b[0]}), across = between({a[1], b[1]});
    add(a[0], b[1], apex, between({a[0], b[1]}), across);
    add(a[1], b[0], apex, across, between({a[1], b[0]}));
  }
  /// Three labels, one of which the two corners in `same` have: a cone from the point on the face of same[1],
  /// b and c.
  void three_labels(const std::vector<int>& same, int b, int c) {
    const Between apex = between({same[1], b, c}), across = between({same[0], b, c});
    add(b, c, between({b, c}), across, apex);
    for (const int other : {b, c}) {
      add(same[0], other, between({same[0], other}), across, apex);
      add(same[1], other, between({same[1], other}), between({same[0], other}), apex);
    }
  }
  /// Four labels: a cone from the tetrahedron's own point.
  void four_labels() {
    const Between apex = between({0, 1, 2, 3});
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        for (int k = 0; k < 4; ++k)
          if (k != i && k != j) add(i, j, between({i, j}), between({i, j, k}), apex);
  }

  int tetrahedron_;
  std::array<int, 4> corners_;
  CellTriangles pieces_;
};

constexpr std::array<std::array<int, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

/// Which of four labels are equal, a bit a pair.
template <typename Label>
std::size_t pattern_of(const Label& a, const Label& b, const Label& c, const Label& d) {
  return static_cast<std::size_t>((a == b ? 1 : 0) | (a == c ? 2 : 0) | (a == d ? 4 : 0) | (b == c ? 8 : 0) |
                                  (b == d ? 16 : 0) | (c == d ? 32 : 0));
}

/// The pieces of each tetrahedron by the pattern of its labels.
const std::array<std::array<CellTriangles, 64>, 6>& pieces() {
  static const auto table = [] {
    std::array<std::array<CellTriangles, 64>, 6> made;
    for (std::size_t t = 0; t < 6; ++t)
      for (int labels = 0; labels < 256; ++labels) {
        const std::array<int, 4> four{labels & 3, (labels >> 2) & 3, (labels >> 4) & 3, labels >> 6};
        CellTriangles& here = made[t][pattern_of(four[0], four[1], four[2], four[3])];
        if (here.empty()) here = Derivation(static_cast<int>(t), tetrahedra[t], four).take();
      }
    return made;
  }();
  return table;
}

/// Extracts the surfaces of a scene whose samples are int16 and whose labels do not overlap.
class Extraction {
 public:
  Extraction(const voxel::Scene& scene, const LabelSurfaceOptions& options)
      : source_(scene.source), lattice_(scene.lattice), options_(options), size_(scene.lattice.dims + 2) {
    copy_labels(scene);
    for (int corner = 0; corner < 8; ++corner)
      step_[corner] = static_cast<std::size_t>(corner & 1) +
                      static_cast<std::size_t>(size_.x) *
                          (static_cast<std::size_t>((corner >> 1) & 1) +
                           static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(corner >> 2));
    fill_weights();
  }

  brep::PartedSurface run() {
    count_faces(voxel::part_of(options_.progress, 0.0, 0.1));
    number_points(voxel::part_of(options_.progress, 0.1, 0.4));
    place_points(voxel::part_of(options_.progress, 0.4, 0.7));
    write_faces(voxel::part_of(options_.progress, 0.7, 1.0));
    return std::move(made_);
  }

 private:
  void copy_labels(const voxel::Scene& scene) {
    std::vector<char> wanted(std::size_t{1} << 15, 0);
    for (const voxel::Label& label : voxel::labels(scene)) {
      if (!options_.labels.empty() && !options_.labels.contains(label.number)) continue;
      wanted[static_cast<std::size_t>(label.number)] = 1;
      made_.names[label.number];
    }
    for (const int label : options_.labels)
      if (!made_.names.contains(label))
        throw voxel::Error(voxel::ErrorCode::Input,
                           "no sample has label " + std::to_string(label) + ": choose among those there are");
    labels_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                   static_cast<std::size_t>(size_.z));
    tbb::parallel_for(0, size_.z, [&](int z) {
      for (int y = 0; y < size_.y; ++y) {
        std::int16_t* row = &labels_[at(0, y, z)];
        std::fill_n(row, size_.x, std::int16_t{0});
        if (z == 0 || z + 1 == size_.z || y == 0 || y + 1 == size_.y) continue;
        const std::int16_t* from = &std::get<voxel::Int16Samples>(
            scene.samples)[(static_cast<std::size_t>(z - 1) * static_cast<std::size_t>(lattice_.dims.y) +
                            static_cast<std::size_t>(y - 1)) *
                           static_cast<std::size_t>(lattice_.dims.x)];
        for (int x = 0; x < lattice_.dims.x; ++x)
          if (from[x] > 0 && wanted[static_cast<std::size_t>(from[x])] != 0) row[x + 1] = from[x];
      }
    });
  }

  /// The binomial weights along an axis. The weight of a neighbour is their product over the axes.
  void fill_weights() {
    weights_ = {1.0};
    for (int round = 0; round < 2 * options_.smooth_voxels; ++round) {
      weights_.push_back(0.0);
      for (std::size_t i = weights_.size() - 1; i > 0; --i) weights_[i] += weights_[i - 1];
    }
  }

  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(x);
  }
  glm::ivec3 sample_of(std::size_t index) const {
    const auto x = static_cast<std::size_t>(size_.x), y = static_cast<std::size_t>(size_.y);
    return {static_cast<int>(index % x), static_cast<int>(index / x % y), static_cast<int>(index / x / y)};
  }

  /// Calls visit(cell, labels of its corners, pieces of a tetrahedron) for the six tetrahedra of each cell of
  /// a layer in which labels differ.
  template <typename Visit>
  void visit_layer(std::size_t z, const Visit& visit) const {
    for (int y = 0; y + 1 < size_.y; ++y)
      for (int x = 0; x + 1 < size_.x; ++x) visit_cell(at(x, y, static_cast<int>(z)), visit);
  }

  template <typename Visit>
  void visit_cell(std::size_t cell, const Visit& visit) const {
    std::array<std::int16_t, 8> labels{};
    bool differ = false;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      labels[corner] = labels_[cell + step_[corner]];
      differ |= labels[corner] != labels[0];
    }
    if (!differ) return;
    for (std::size_t t = 0; t < 6; ++t) {
      const std::array<int, 4>& c = tetrahedra[t];
      visit(cell, labels, pieces()[t][pattern_of(labels[c[0]], labels[c[1]], labels[c[2]], labels[c[3]])]);
    }
  }

  /// Counts the triangles and throws, before they are allocated, if there are too many.
  void count_faces(const voxel::Progress& progress) {
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(size_.z - 1));
    voxel::SharedProgress done(progress, counts.size());
    tbb::parallel_for(std::size_t{0}, counts.size(), [&](std::size_t z) {
      done.one_more();
      visit_layer(z,
                  [&](std::size_t, const auto&, const CellTriangles& found) { counts[z] += found.size(); });
    });
    std::uint64_t count = 0;
    for (const std::uint64_t in_layer : counts) {
      first_face_.push_back(count);
      count += in_layer;
    }
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw voxel::Error(voxel::ErrorCode::Resource,
                         "the labels' surfaces would have " + std::to_string(count) +
                             " triangles, more than 32-bit numbers can name: crop or resample the label map");
    // There are about half as many points as triangles, and each point has a key.
    constexpr std::size_t face_bytes = sizeof(std::array<std::uint32_t, 3>) +
                                       sizeof(brep::PartedSurface::Sides) +
                                       (sizeof(glm::dvec3) + sizeof(Key)) / 2;
    voxel::need_memory(source_, count, face_bytes,
                       "the " + std::to_string(count) + " triangles between its labels");
    first_face_.push_back(count);
  }

  std::size_t plane_size() const {
    return static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y);
  }

  /// Lists the keys of each plane z, which the triangles of the cells above and below it name.
  void number_points(const voxel::Progress& progress) {
    keys_.resize(static_cast<std::size_t>(size_.z));
    voxel::SharedProgress done(progress, keys_.size());
    tbb::enumerable_thread_specific<std::vector<std::uint32_t>> scratch;
    tbb::parallel_for(std::size_t{0}, keys_.size(), [&](std::size_t z) {
      done.one_more();
      const std::size_t first = z * plane_size();
      std::vector<std::uint32_t>& marks = scratch.local();
      marks.assign(plane_size(), 0);
      for (std::size_t layer = z == 0 ? 0 : z - 1; layer <= z && layer + 1 < keys_.size(); ++layer)
        visit_layer(layer, [&](std::size_t cell, const auto&, const CellTriangles& found) {
          for (const CellTriangle& piece : found)
            for (const PointName& point : piece.points)
              if (const std::size_t sample = cell + step_[point.corner] - first; sample < marks.size())
                marks[sample] |= std::uint32_t{1} << codes().place[point.code];
        });
      std::size_t count = 0;
      for (const std::uint32_t mark : marks) count += static_cast<std::size_t>(std::popcount(mark));
      keys_[z].reserve(count);
      for (std::size_t sample = 0; sample < marks.size(); ++sample)
        for (std::uint32_t left = marks[sample]; left != 0; left &= left - 1)
          keys_[z].push_back((first + sample) * code_count +
                             codes().all[static_cast<std::size_t>(std::countr_zero(left))]);
    });
    std::uint64_t points = 0;  // no more than faces, because each point is a corner of at least three
    for (const std::vector<Key>& keys : keys_) {
      first_point_.push_back(points);
      points += keys.size();
    }
    tbb::parallel_invoke([&] { made_.triangles.points_mm.resize(points); },
                         [&] { made_.triangles.faces.resize(first_face_.back()); },
                         [&] { made_.sides.resize(first_face_.back()); });
  }

  void place_points(const voxel::Progress& progress) {
    voxel::SharedProgress done(progress, keys_.size());
    tbb::parallel_for(std::size_t{0}, keys_.size(), [&](std::size_t z) {
      done.one_more();
      for (std::size_t i = 0; i < keys_[z].size(); ++i)
        // The copy has a border, so its indices are one larger.
        made_.triangles.points_mm[first_point_[z] + i] = lattice_.lps_mm(point_of(keys_[z][i]) - 1.0);
    });
  }

  /// Triangles wind outward from their part; between two parts, outward from the part of lower number.
  void write_faces(const voxel::Progress& progress) {
    voxel::SharedProgress done(progress, keys_.size() - 1);
    tbb::enumerable_thread_specific<std::array<PlanePoints, 2>> scratch;
    tbb::parallel_for(std::size_t{0}, keys_.size() - 1, [&](std::size_t z) {
      done.one_more();
      std::array<PlanePoints, 2>& planes = scratch.local();
      for (std::size_t k = 0; k < 2; ++k) find_points(z + k, planes[k]);
      const std::size_t first = z * plane_size();
      std::size_t face = first_face_[z];
      visit_layer(z, [&](std::size_t cell, const auto& labels, const CellTriangles& found) {
        for (const CellTriangle& piece : found) {
          brep::PartedSurface::Sides sides{labels[piece.behind], labels[piece.front]};
          std::array<std::uint32_t, 3> corners{};
          for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t sample = cell + step_[piece.points[i].corner] - first;
            const std::size_t k = sample < plane_size() ? 0 : 1;
            corners[i] = static_cast<std::uint32_t>(
                first_point_[z + k] +
                planes[k].rank(sample - k * plane_size(), codes().place[piece.points[i].code]));
          }
          const bool turn = sides.behind == 0 || (sides.front != 0 && sides.front < sides.behind);
          if (turn) std::swap(sides.behind, sides.front);
          if (turn == lattice_.right_handed()) std::swap(corners[1], corners[2]);
          made_.triangles.faces[face] = corners;
          made_.sides[face++] = sides;
        }
      });
    });
  }

  void find_points(std::size_t z, PlanePoints& points) const {
    points.marks.assign(plane_size(), 0);
    points.before.resize(plane_size());
    for (const Key key : keys_[z])
      points.marks[static_cast<std::size_t>(key / code_count) - z * plane_size()] |=
          std::uint32_t{1} << codes().place[key % code_count];
    std::uint32_t count = 0;
    for (std::size_t sample = 0; sample < points.marks.size(); ++sample) {
      points.before[sample] = count;
      count += static_cast<std::uint32_t>(std::popcount(points.marks[sample]));
    }
  }

  glm::dvec3 point_of(Key key) const {
    const std::size_t low = key / code_count;
    const auto code = static_cast<std::size_t>(key % code_count);
    const auto corner = [&](std::size_t offset) { return low + step_[offset]; };
    if (code >= first_tetrahedron_code) {
      const std::array<int, 4>& c = tetrahedra[code - first_tetrahedron_code];
      glm::dvec3 sum(0.0);
      for (std::size_t i = 0; i < 4; ++i)
        sum += face_point(corner(c[i]), corner(c[(i + 1) % 4]), corner(c[(i + 2) % 4]));
      return sum / 4.0;
    }
    const std::size_t d = code / 8, e = code % 8;
    return d == 0 ? edge_point(low, corner(e)) : face_point(low, corner(d), corner(e));
  }
  /// A point inside the face, because it averages points inside its three sides.
  glm::dvec3 face_point(std::size_t a, std::size_t b, std::size_t c) const {
    return (edge_point(a, b) + edge_point(b, c) + edge_point(c, a)) / 3.0;
  }
  /// The point between samples a and b where the weighted shares of both labels are equal, by linear
  /// interpolation; half-way at the scan's border.
  glm::dvec3 edge_point(std::size_t a, std::size_t b) const {
    if (a > b) std::swap(a, b);  // the same bits from each tetrahedron
    const glm::ivec3 from = sample_of(a), to = sample_of(b);
    const double excess_a = excess(from, labels_[a], labels_[b]),
                 excess_b = excess(to, labels_[b], labels_[a]);
    double part = 0.5;
    if (!is_border(from) && !is_border(to))
      part = excess_a + excess_b > 0.0 ? excess_a / (excess_a + excess_b) : 0.5;
    part = std::clamp(part, least_part, 1.0 - least_part);
    return glm::dvec3(from) + part * glm::dvec3(to - from);
  }
  bool is_border(const glm::ivec3& p) const {
    return glm::any(glm::equal(p, glm::ivec3(0))) || glm::any(glm::equal(p, size_ - 1));
  }
  /// The weighted share of label `more` about a sample less that of label `less`, at least 0. Labels at the
  /// scan's border are repeated beyond it.
  double excess(const glm::ivec3& p, std::int16_t more, std::int16_t less) const {
    const int reach = options_.smooth_voxels;
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k)
      for (int j = -reach; j <= reach; ++j) {
        const glm::ivec3 row = glm::clamp(p + glm::ivec3(0, j, k), glm::ivec3(1), size_ - 2);
        const std::int16_t* labels = &labels_[at(0, row.y, row.z)];
        double in_row = 0.0;
        for (int i = -reach; i <= reach; ++i) {
          const std::int16_t label = labels[std::clamp(p.x + i, 1, size_.x - 2)];
          in_row += weights_[static_cast<std::size_t>(i + reach)] *
                    ((label == more ? 1.0 : 0.0) - (label == less ? 1.0 : 0.0));
        }
        sum += in_row * weights_[static_cast<std::size_t>(j + reach)] *
               weights_[static_cast<std::size_t>(k + reach)];
      }
    return std::max(0.0, sum);
  }

  std::filesystem::path source_;
  voxel::Lattice lattice_;
  LabelSurfaceOptions options_;
  glm::ivec3 size_;  ///< with the border
  std::vector<std::int16_t, voxel::LargeAllocator<std::int16_t>> labels_;
  std::array<std::size_t, 8> step_{};
  std::vector<double> weights_;
  std::vector<std::vector<Key>> keys_;                   ///< by the plane of the lowest sample
  std::vector<std::uint64_t> first_point_, first_face_;  ///< first number of each plane; of faces, the total
                                                         ///< at the end
  brep::PartedSurface made_;
};

/// Adds the surfaces of a layer. A part of `ranks` is the position of its label in the layer's labels, from 1;
/// 0 is no label.
void append(const voxel::LabelLayer& layer, brep::PartedSurface ranks, brep::PartedSurface& made) {
  const std::size_t first = made.triangles.points_mm.size();
  if (first + ranks.triangles.points_mm.size() > std::numeric_limits<std::uint32_t>::max())
    throw voxel::Error(voxel::ErrorCode::Resource,
                       "the labels' surfaces have more points than 32-bit numbers can name: crop or resample "
                       "the label map");
  const auto label_of = [&](std::int32_t rank) {
    return rank == 0 ? 0 : layer.labels[static_cast<std::size_t>(rank - 1)];
  };
  for (brep::PartedSurface::Sides& sides : ranks.sides)
    sides = {label_of(sides.behind), label_of(sides.front)};
  if (first == 0) {
    made.triangles = std::move(ranks.triangles);
    made.sides = std::move(ranks.sides);
  } else {
    for (std::array<std::uint32_t, 3>& face : ranks.triangles.faces)
      for (std::uint32_t& corner : face) corner += static_cast<std::uint32_t>(first);
    const auto add = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
    add(ranks.triangles.points_mm, made.triangles.points_mm);
    add(ranks.triangles.faces, made.triangles.faces);
    add(ranks.sides, made.sides);
  }
  for (const auto& [rank, name] : ranks.names) made.names[label_of(rank)] = name;
}

}  // namespace

brep::PartedSurface label_surfaces(const voxel::Scene& scene, const LabelSurfaceOptions& options) {
  voxel::check(scene);
  if (options.smooth_voxels < 0 || options.smooth_voxels > 4)
    throw voxel::InvalidInput("label surfaces: smooth_voxels must be from 0 to 4, not " +
                              std::to_string(options.smooth_voxels));
  if (scene.overlaps.empty() && std::holds_alternative<voxel::Int16Samples>(scene.samples))
    return Extraction(scene, options).run();
  std::set<int> left = options.labels;
  brep::PartedSurface made;
  const std::vector<voxel::LabelLayer> layers = voxel::label_layers(scene);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    LabelSurfaceOptions own = options;
    own.labels.clear();
    const auto count = static_cast<double>(layers.size());
    own.progress =
        voxel::part_of(options.progress, static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
    for (std::size_t rank = 1; rank <= layers[i].labels.size(); ++rank)
      if (left.erase(layers[i].labels[rank - 1]) > 0) own.labels.insert(static_cast<int>(rank));
    if (!options.labels.empty() && own.labels.empty()) continue;
    append(layers[i], Extraction(layers[i].ranks, own).run(), made);
  }
  if (!left.empty())
    throw voxel::Error(voxel::ErrorCode::Input, "no sample has label " + std::to_string(*left.begin()) +
                                                    ": choose among those there are");
  return made;
}

}  // namespace octotomy::convert
