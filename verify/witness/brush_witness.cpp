// SPDX-License-Identifier: AGPL-3.0-or-later
// A brush slides along a piece that starts at a and extends by the vector d. At the position t of the piece
// it covers a point p if n.(p - a) - t n.d <= h for each face of the brush. Each face limits t on one side,
// so the brush covers the point if an interval of t is left. For points of a line, each limit is a half-plane
// over the position on the line and t. These half-planes leave a polygon, whose extent along the first
// coordinate is the covered part of the line.
#include "verify/witness/brush_witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

/// Rounding of a vertex, relative to its coordinates. Other shapes of a plan have the same bound.
constexpr double on_hull = 1e-8;

/// A face of a brush whose centre is the origin: the points with normal . p <= reach_mm are inside.
struct Face {
  glm::dvec3 normal;
  double reach_mm;
};

/// Returns 32 faces: their normals are the directions of an icosahedron's corners and of the middles of its
/// faces.
std::vector<Face> faces_of_ball(double radius_mm) {
  constexpr double of_ball = 0.9675583399663303;
  std::vector<glm::dvec3> corners;
  const double low = std::sqrt(0.5 - std::sqrt(0.05)), high = std::sqrt(0.5 + std::sqrt(0.05));
  for (const double a : {low, -low})
    for (const double b : {high, -high}) {
      corners.emplace_back(0.0, a, b);
      corners.emplace_back(b, 0.0, a);
      corners.emplace_back(a, b, 0.0);
    }
  std::vector<Face> faces;
  for (const glm::dvec3& corner : corners) faces.push_back({corner, of_ball * radius_mm});
  // Corners of one face are 63.4 degrees apart; other pairs of corners at least 116.6.
  const auto are_beside = [&](std::size_t i, std::size_t j) {
    return glm::dot(corners[i], corners[j]) > 0.0;
  };
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = i + 1; j < corners.size(); ++j)
      for (std::size_t k = j + 1; k < corners.size(); ++k)
        if (are_beside(i, j) && are_beside(j, k) && are_beside(i, k))
          faces.push_back({glm::normalize(corners[i] + corners[j] + corners[k]), of_ball * radius_mm});
  return faces;
}

std::vector<Face> faces_of_disc(const DrawnBrush::Disc& disc, double radius_mm) {
  constexpr double sixteenth = std::numbers::pi / 8.0;
  const double of_disc = std::sqrt(0.5 * sixteenth / std::tan(0.5 * sixteenth));
  const glm::dvec3 aside = glm::cross(disc.normal, disc.across);
  std::vector<Face> faces{{disc.normal, 0.5 * disc.thickness_mm}, {-disc.normal, 0.5 * disc.thickness_mm}};
  for (int side = 0; side < 16; ++side) {
    const double angle = (side + 0.5) * sixteenth;
    faces.push_back({std::cos(angle) * disc.across + std::sin(angle) * aside, of_disc * radius_mm});
  }
  return faces;
}

/// A straight piece of a path, along which the brush slides.
class Piece {
 public:
  Piece(std::shared_ptr<const std::vector<Face>> faces, const glm::dvec3& from_mm, const glm::dvec3& to_mm)
      : faces_(std::move(faces)), from_mm_(from_mm), by_mm_(to_mm - from_mm) {
    double reach_mm = 0.0;
    for (const Face& face : *faces_) reach_mm = std::max(reach_mm, face.reach_mm);
    // The corners of both brushes are within 1.5 times the distance of the farthest face from the centre.
    box_ = {glm::min(from_mm, to_mm) - 1.5 * reach_mm, glm::max(from_mm, to_mm) + 1.5 * reach_mm};
  }

  const voxel::Box& box() const { return box_; }

  bool may_hold(const glm::dvec3& p_mm, double near_mm) const {
    for (int axis = 0; axis < 3; ++axis)
      if (p_mm[axis] < box_.low_mm[axis] - near_mm || p_mm[axis] > box_.high_mm[axis] + near_mm) return false;
    return true;
  }

  /// Whether the brush covers the point at some position on the piece. The brush is grown by `by_mm` at each
  /// face.
  bool covers(const glm::dvec3& p_mm, double by_mm) const {
    double first = 0.0, last = 1.0;
    for (const Face& face : *faces_) {
      const double slope = glm::dot(face.normal, by_mm_);
      const double beyond_mm = glm::dot(face.normal, p_mm - from_mm_) - face.reach_mm - by_mm;
      if (slope > 0.0)
        first = std::max(first, beyond_mm / slope);
      else if (slope < 0.0)
        last = std::min(last, beyond_mm / slope);
      else if (beyond_mm > 0.0)
        return false;
    }
    return first <= last;
  }

  /// Returns the number of the hull's faces within `near_mm` of a point on the hull's surface.
  int faces_near(const glm::dvec3& p_mm, double near_mm) const {
    // Finds the position on the piece at which the brush holds the point deepest: bisection by the slope of
    // the outermost face.
    double low = 0.0, high = 1.0;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      const Face* outermost = nullptr;
      double most_mm = -std::numeric_limits<double>::infinity();
      for (const Face& face : *faces_)
        if (const double mm = beyond_mm(face, p_mm, middle); mm > most_mm) most_mm = mm, outermost = &face;
      (glm::dot(outermost->normal, by_mm_) > 0.0 ? low : high) = middle;
    }
    const double length_mm = glm::length(by_mm_);
    const double at = 0.5 * (low + high);
    const bool is_within = at * length_mm > near_mm && (1.0 - at) * length_mm > near_mm;
    int count = 0;
    bool ahead = false, behind = false;
    for (const Face& face : *faces_)
      if (beyond_mm(face, p_mm, at) >= -2.0 * near_mm) {
        ++count;
        ahead = ahead || glm::dot(face.normal, by_mm_) > 0.0;
        behind = behind || glm::dot(face.normal, by_mm_) < 0.0;
      }
    // Beside the piece, one face of the hull stands for two faces of the brush.
    return std::max(1, is_within && ahead && behind ? count - 1 : count);
  }

  /// Returns the part of a line that the piece covers; none if that part is shorter than rounding.
  Span span_on(const Line& line, const Span& within) const {
    using Corner = glm::dvec2;  // position on the line in mm, position on the piece
    std::vector<Corner> polygon{
        {within.low_mm, 0.0}, {within.high_mm, 0.0}, {within.high_mm, 1.0}, {within.low_mm, 1.0}},
        kept;
    for (const Face& face : *faces_) {
      const Corner slope(glm::dot(face.normal, line.along), -glm::dot(face.normal, by_mm_));
      const double room_mm = face.reach_mm - glm::dot(face.normal, line.from_mm - from_mm_);
      kept.clear();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double in_a = room_mm - glm::dot(slope, a), in_b = room_mm - glm::dot(slope, b);
        if (in_a >= 0.0) kept.push_back(a);
        if ((in_a >= 0.0) != (in_b >= 0.0)) kept.push_back(a + (b - a) * (in_a / (in_a - in_b)));
      }
      polygon.swap(kept);
    }
    Span span{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Corner& corner : polygon) {
      span.low_mm = std::min(span.low_mm, corner.x);
      span.high_mm = std::max(span.high_mm, corner.x);
    }
    return span;
  }

 private:
  double beyond_mm(const Face& face, const glm::dvec3& p_mm, double at) const {
    return glm::dot(face.normal, p_mm - from_mm_ - at * by_mm_) - face.reach_mm;
  }

  std::shared_ptr<const std::vector<Face>> faces_;
  glm::dvec3 from_mm_, by_mm_;
  voxel::Box box_;
};

std::vector<Piece> pieces_of(const std::vector<DrawnBrush>& ways) {
  std::vector<Piece> pieces;
  for (const DrawnBrush& way : ways) {
    if (way.way_mm.empty()) throw voxel::InvalidInput("a path of the brush needs at least one point");
    const auto faces = std::make_shared<const std::vector<Face>>(
        way.disc ? faces_of_disc(*way.disc, way.radius_mm) : faces_of_ball(way.radius_mm));
    if (way.way_mm.size() == 1) pieces.emplace_back(faces, way.way_mm.front(), way.way_mm.front());
    for (std::size_t i = 0; i + 1 < way.way_mm.size(); ++i)
      pieces.emplace_back(faces, way.way_mm[i], way.way_mm[i + 1]);
  }
  if (pieces.empty()) throw voxel::InvalidInput("the brush needs at least one path");
  return pieces;
}

bool are_apart(const voxel::Box& a, const voxel::Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.low_mm[axis] > b.high_mm[axis] || b.low_mm[axis] > a.high_mm[axis]) return true;
  return false;
}

/// Returns the positions between which a line is inside a box. If the line misses the box, the span is
/// inverted.
Span in_box(const Line& line, const voxel::Box& box) {
  Span span{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    if (line.along[axis] == 0.0) {
      if (line.from_mm[axis] < box.low_mm[axis] || line.from_mm[axis] > box.high_mm[axis]) return {1.0, 0.0};
      continue;
    }
    const double a = (box.low_mm[axis] - line.from_mm[axis]) / line.along[axis],
                 b = (box.high_mm[axis] - line.from_mm[axis]) / line.along[axis];
    span = {std::max(span.low_mm, std::min(a, b)), std::min(span.high_mm, std::max(a, b))};
  }
  return span;
}

LineReading lines_of(const std::shared_ptr<const std::vector<Piece>>& pieces) {
  voxel::Box box = pieces->front().box();
  for (const Piece& piece : *pieces)
    box = {glm::min(box.low_mm, piece.box().low_mm), glm::max(box.high_mm, piece.box().high_mm)};
  const auto inside = [pieces](const Line& line, const Spans& within) {
    Spans found;
    for (const Piece& piece : *pieces) {
      // The piece's box also limits a line without ends.
      const Span boxed = in_box(line, piece.box());
      for (const Span& part : within) {
        const Span asked{std::max(part.low_mm, boxed.low_mm), std::min(part.high_mm, boxed.high_mm)};
        if (!(asked.high_mm > asked.low_mm)) continue;
        const Span span = piece.span_on(line, asked);
        if (span.high_mm > span.low_mm) found.push_back(span);
      }
    }
    std::sort(found.begin(), found.end(), [](const Span& a, const Span& b) { return a.low_mm < b.low_mm; });
    Spans made;
    for (const Span& span : found) {
      if (!made.empty() && span.low_mm <= made.back().high_mm)
        made.back().high_mm = std::max(made.back().high_mm, span.high_mm);
      else
        made.push_back(span);
    }
    return made;
  };
  const auto may_meet = [pieces](const voxel::Box& part) {
    return std::any_of(pieces->begin(), pieces->end(),
                       [&](const Piece& piece) { return !are_apart(piece.box(), part); });
  };
  // Testing boxes excludes most pieces.
  return {inside, may_meet, box, static_cast<double>(pieces->size())};
}

}  // namespace

Witness witness_of_brush(const std::vector<DrawnBrush>& ways) {
  const auto pieces = std::make_shared<const std::vector<Piece>>(pieces_of(ways));
  const auto read = [pieces](const glm::dvec3& p_mm, double slack_mm) {
    const double near_mm = on_hull * (1.0 + glm::length(p_mm)) + slack_mm;
    int faces = 0;
    for (const Piece& piece : *pieces) {
      if (!piece.may_hold(p_mm, near_mm) || !piece.covers(p_mm, near_mm)) continue;
      if (piece.covers(p_mm, -near_mm)) return Reading{certainly_in, certainly_in, 0};
      faces += piece.faces_near(p_mm, near_mm);
    }
    return faces > 0 ? Reading{on_surface, on_surface, faces} : Reading{certainly_out, certainly_out, 0};
  };
  return Witness(read).with_lines(lines_of(pieces));
}

}  // namespace octotomy::verify
