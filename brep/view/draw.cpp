// SPDX-License-Identifier: AGPL-3.0-or-later
// A depth buffer for triangles, lines and sheets.
//
// Source: the polygon renderer of thesis 4.4.1.2.1 with its back surface cull and shadings; Gouraud, Continuous
// shading of curved surfaces, 1971; Phong, Illumination for computer generated pictures, 1975. Departures: a depth
// buffer in place of sorting back to front, which fails for triangles that cross each other; and each point's
// tone is computed once, after the visible triangle is known.
//
//   1 project(): triangles become facets of pixel positions; parts behind the observer are cut off.
//   2 Facets and pieces of lines are listed by bands of rows.
//   3 Each band finds the nearest item at points on a grid, and computes the points' tones: once at the pixels'
//     centres for depth and item, once at four points a pixel for colours.
//
// Invariant: a band reads only its lists, in the scene's order, so neither the bands' order nor the threads' number
// changes a bit.
#include "brep/view/draw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tbb/parallel_for.h>

#include "brep/view/corner_normals.h"

namespace octotomy::brep {
namespace {

constexpr int band_rows = 16;
constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();
/// Lines far from the observer keep this share of their colour.
constexpr double far_share = 0.45;

struct Corner {
  glm::dvec2 px{0.0};
  double depth_mm = 0.0;
  double scale = 1.0;      ///< magnification
  glm::vec3 normal{0.0f};  ///< in (right, up, look); zero: use the facet's normal
};

struct Facet {
  std::array<std::uint32_t, 3> corners{};
  glm::vec3 normal{0.0f};  ///< in (right, up, look), towards the observer
  bool is_turned = false;  ///< the triangle faces away, so its corners' normals are turned, too
  std::uint32_t item = 0;
};

struct Piece {
  std::array<Corner, 2> ends;
  double radius_px = 0.5;
  std::uint32_t item = 0;
};

/// Twice the signed area of the triangle a, b, p; exactly negated if a and b are exchanged.
double side_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  const bool is_first = a.x < b.x || (a.x == b.x && a.y < b.y);
  const glm::dvec2& low = is_first ? a : b;
  const glm::dvec2& high = is_first ? b : a;
  const double area = (high.x - low.x) * (p.y - low.y) - (high.y - low.y) * (p.x - low.x);
  return is_first ? area : -area;
}

/// Whether a triangle that runs along an edge from a to b owns the edge's points; true for exactly one
/// direction.
bool owns_edge(const glm::dvec2& a, const glm::dvec2& b) {
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

/// Weights of a facet's corners at a position; none outside.
std::optional<glm::dvec3> weights_at(const std::array<glm::dvec2, 3>& px, const glm::dvec2& p) {
  glm::dvec3 weights;
  const double area = side_of(px[0], px[1], px[2]);
  const double sign = area < 0.0 ? -1.0 : 1.0;
  for (int k = 0; k < 3; ++k) {
    const auto from = static_cast<std::size_t>((k + 1) % 3), to = static_cast<std::size_t>((k + 2) % 3);
    weights[k] = sign * side_of(px[from], px[to], p);
    const bool is_owner = sign > 0.0 ? owns_edge(px[from], px[to]) : owns_edge(px[to], px[from]);
    if (weights[k] < 0.0 || (weights[k] == 0.0 && !is_owner)) return std::nullopt;
  }
  const double sum = weights.x + weights.y + weights.z;
  if (!(sum > 0.0)) return std::nullopt;
  return weights / sum;
}

class Painter {
 public:
  Painter(const DrawnScene& scene, const DrawOptions& options)
      : scene_(scene),
        options_(options),
        camera_(options.camera),
        turn_(camera_.right, camera_.up, camera_.look) {
    const ViewExtent whole = extent(scene, camera_.right, camera_.up, camera_.look);
    depth_range_mm_ = std::max(0.0, whole.high_mm.z - camera_.nearest_mm);
    if (camera_.observer) nearest_mm_ = camera_.observer->depth_mm() + 0.01 * camera_.observer->distance_mm;
    background_ = linear_of_srgb(options.background);
    for (const DrawnSurface& surface : scene.surfaces) colours_.push_back(linear_of_srgb(surface.colour));
    for (const DrawnLines& lines : scene.lines) colours_.push_back(linear_of_srgb(lines.colour));
  }

  DrawnPicture paint(const Progress& progress) {
    DrawnPicture picture;
    picture.culled.assign(scene_.surfaces.size(), 0);
    project(picture.culled);
    progress.at(0.3);
    list_by_band();
    const std::size_t pixels =
        static_cast<std::size_t>(camera_.size_px.x) * static_cast<std::size_t>(camera_.size_px.y);
    picture.rgb.resize(3 * pixels);
    picture.depth_mm.assign(pixels, std::numeric_limits<float>::infinity());
    picture.item.assign(pixels, -1);
    std::vector<std::uint64_t> lit(facets_by_band_.size(), 0);
    tbb::parallel_for(std::size_t{0}, facets_by_band_.size(), [&](std::size_t band) {
      if (!progress.stop.stop_requested()) lit[band] = paint_band(static_cast<int>(band), picture);
    });
    for (const std::uint64_t count : lit) picture.lit_pixels += count;
    progress.at(1.0);
    return picture;
  }

 private:
  struct Grid {
    int first_row = 0, rows = 0;  ///< rows of points
    int points_per_px = 1;        ///< along each axis
    int columns = 0;

    glm::dvec2 at(int column, int row) const {
      return (glm::dvec2(column, row + first_row) + 0.5) / static_cast<double>(points_per_px);
    }
    /// The number of the first sample point at or beyond a position along an axis.
    int from(double px) const {
      return static_cast<int>(std::ceil(std::clamp(px * points_per_px - 0.5, -1e9, 1e9)));
    }
    int past(double px) const {
      return static_cast<int>(std::floor(std::clamp(px * points_per_px - 0.5, -1e9, 1e9))) + 1;
    }
  };
  struct Points {
    std::vector<double> depth_mm;
    std::vector<std::uint32_t> id;
  };

  Corner corner_of(const glm::dvec3& p_mm, const glm::vec3& normal) const {
    Corner corner;
    corner.depth_mm = camera_.depth_mm(p_mm);
    corner.scale = 1.0 / camera_.spread(corner.depth_mm);
    corner.px = camera_.position_px(p_mm);
    corner.normal = normal;
    return corner;
  }

  bool is_before_observer(const glm::dvec3& p_mm) const { return camera_.depth_mm(p_mm) < nearest_mm_; }

  void project(std::vector<std::uint64_t>& culled) {
    for (std::uint32_t item = 0; item < scene_.surfaces.size(); ++item) {
      const Triangles& triangles = *scene_.surfaces[item].triangles;
      if (options_.shading == FacetShading::Wire) add_edges(triangles, item);
      if (options_.shading != FacetShading::Wire || options_.hide) culled[item] = add_facets(triangles, item);
    }
    for (std::size_t l = 0; l < scene_.lines.size(); ++l) {
      const DrawnLines& lines = scene_.lines[l];
      const auto item = static_cast<std::uint32_t>(scene_.surfaces.size() + l);
      for (const auto& line : lines.lines_mm)
        for (std::size_t i = 0; i + 1 < line.size(); ++i)
          add_piece(line[i], line[i + 1], 0.5 * lines.width_px, item);
    }
  }

  /// Adds the facets of a surface. Returns the number of triangles that face away and were left out.
  std::uint64_t add_facets(const Triangles& triangles, std::uint32_t item) {
    const bool is_smooth =
        options_.shading == FacetShading::Gouraud || options_.shading == FacetShading::Phong;
    std::vector<glm::dvec3> normals;
    if (is_smooth) normals = corner_normals(triangles);
    const auto first = static_cast<std::uint32_t>(corners_.size());
    for (std::size_t v = 0; v < triangles.points_mm.size(); ++v)
      corners_.push_back(
          is_before_observer(triangles.points_mm[v])
              ? Corner{}
              : corner_of(triangles.points_mm[v], in_view(is_smooth ? normals[v] : glm::dvec3(0.0))));
    std::uint64_t culled = 0;
    for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
      Facet facet;
      facet.item = item;
      facet.normal = in_view(facet_normal(triangles, f));
      const auto& face = triangles.faces[f];
      const glm::dvec3 sight = sight_at(triangles.points_mm[face[0]]);
      facet.is_turned = glm::dot(facet_normal(triangles, f), sight) > 0.0;
      if (facet.is_turned) facet.normal = -facet.normal;
      if (facet.is_turned && options_.cull) {
        ++culled;
        continue;
      }
      if (std::none_of(face.begin(), face.end(),
                       [&](std::uint32_t v) { return is_before_observer(triangles.points_mm[v]); })) {
        facet.corners = {first + face[0], first + face[1], first + face[2]};
        facets_.push_back(facet);
      } else {
        add_clipped(triangles, face, normals, facet);
      }
    }
    return culled;
  }

  /// Adds the part of a triangle beyond the nearest depth: a polygon of three or four corners.
  void add_clipped(const Triangles& triangles, const std::array<std::uint32_t, 3>& face,
                   const std::vector<glm::dvec3>& normals, Facet facet) {
    std::vector<std::uint32_t> polygon;
    const auto normal_of = [&](std::uint32_t v) { return normals.empty() ? glm::dvec3(0.0) : normals[v]; };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t here = face[k], next = face[(k + 1) % 3];
      const glm::dvec3& a = triangles.points_mm[here];
      const glm::dvec3& b = triangles.points_mm[next];
      const bool is_here = !is_before_observer(a), is_next = !is_before_observer(b);
      if (is_here) {
        polygon.push_back(static_cast<std::uint32_t>(corners_.size()));
        corners_.push_back(corner_of(a, in_view(normal_of(here))));
      }
      if (is_here == is_next) continue;
      const double t = (nearest_mm_ - camera_.depth_mm(a)) / (camera_.depth_mm(b) - camera_.depth_mm(a));
      polygon.push_back(static_cast<std::uint32_t>(corners_.size()));
      corners_.push_back(
          corner_of(glm::mix(a, b, t), in_view(glm::mix(normal_of(here), normal_of(next), t))));
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      facet.corners = {polygon[0], polygon[k - 1], polygon[k]};
      facets_.push_back(facet);
    }
  }

  void add_edges(const Triangles& triangles, std::uint32_t item) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const auto& face : triangles.faces)
      for (std::size_t k = 0; k < 3; ++k)
        edges.push_back({std::min(face[k], face[(k + 1) % 3]), std::max(face[k], face[(k + 1) % 3])});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& [a, b] : edges)
      add_piece(triangles.points_mm[a], triangles.points_mm[b], 0.5 * options_.wire_px, item);
  }

  void add_piece(glm::dvec3 a, glm::dvec3 b, double radius_px, std::uint32_t item) {
    if (is_before_observer(a) && is_before_observer(b)) return;
    if (is_before_observer(a)) std::swap(a, b);
    if (is_before_observer(b))
      b = glm::mix(a, b, (nearest_mm_ - camera_.depth_mm(a)) / (camera_.depth_mm(b) - camera_.depth_mm(a)));
    pieces_.push_back({{corner_of(a, {}), corner_of(b, {})}, radius_px, item});
  }

  glm::vec3 in_view(const glm::dvec3& v) const { return glm::vec3(v * turn_); }

  /// The direction in which a point is seen; any length.
  glm::dvec3 sight_at(const glm::dvec3& p_mm) const {
    if (!camera_.observer) return camera_.look;
    const glm::dvec3 eye = camera_.right * camera_.centre_mm.x + camera_.up * camera_.centre_mm.y +
                           camera_.look * (camera_.nearest_mm + camera_.observer->depth_mm());
    return p_mm - eye;
  }

  void list_by_band() {
    const auto bands = static_cast<std::size_t>((camera_.size_px.y + band_rows - 1) / band_rows);
    facets_by_band_.resize(bands);
    pieces_by_band_.resize(bands);
    const auto list = [&](std::vector<std::vector<std::uint32_t>>& by_band, std::size_t number, double low,
                          double high) {
      if (!(high >= 0.0) || !(low < camera_.size_px.y)) return;
      const auto from = static_cast<std::size_t>(std::max(0.0, low) / band_rows);
      const auto to = static_cast<std::size_t>(std::min(high, camera_.size_px.y - 1.0) / band_rows);
      for (std::size_t band = from; band <= to && band < bands; ++band)
        by_band[band].push_back(static_cast<std::uint32_t>(number));
    };
    for (std::size_t f = 0; f < facets_.size(); ++f) {
      const auto& c = facets_[f].corners;
      const auto [low, high] = std::minmax({corners_[c[0]].px.y, corners_[c[1]].px.y, corners_[c[2]].px.y});
      list(facets_by_band_, f, low, high);
    }
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      const auto [low, high] = std::minmax(pieces_[p].ends[0].px.y, pieces_[p].ends[1].px.y);
      list(pieces_by_band_, p, low - pieces_[p].radius_px, high + pieces_[p].radius_px);
    }
  }

  /// Draws a band of rows. Returns the number of lit pixels.
  std::uint64_t paint_band(int band, DrawnPicture& picture) const {
    const int first = band * band_rows, rows = std::min(band_rows, camera_.size_px.y - first);
    const auto width = static_cast<std::size_t>(camera_.size_px.x);
    const Grid centres{first, rows, 1, camera_.size_px.x};
    const Points nearest = nearest_at(centres, band);
    std::uint64_t lit = 0;
    for (std::size_t i = 0; i < nearest.id.size(); ++i) {
      if (nearest.id[i] == nothing) continue;
      const std::size_t pixel = static_cast<std::size_t>(first) * width + i;
      picture.item[pixel] = static_cast<std::int32_t>(item_of(nearest.id[i]));
      picture.depth_mm[pixel] = static_cast<float>(nearest.depth_mm[i] + lead_mm(nearest.id[i]));
      ++lit;
    }
    const Grid parts{2 * first, 2 * rows, 2, 2 * camera_.size_px.x};
    const Points seen = nearest_at(parts, band);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < camera_.size_px.x; ++column) {
        glm::vec3 sum(0.0f);
        for (int part = 0; part < 4; ++part) {
          const int x = 2 * column + part % 2, y = 2 * row + part / 2;
          const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(parts.columns) +
                         static_cast<std::size_t>(x);
          sum += tone(seen.id[i], seen.depth_mm[i], parts.at(x, y));
        }
        const glm::vec3 srgb = srgb_of_linear(glm::clamp(sum * 0.25f, 0.0f, 1.0f));
        const std::size_t pixel =
            static_cast<std::size_t>(first + row) * width + static_cast<std::size_t>(column);
        for (int k = 0; k < 3; ++k)
          picture.rgb[3 * pixel + static_cast<std::size_t>(k)] =
              static_cast<std::uint8_t>(std::lround(255.0f * srgb[k]));
      }
    return lit;
  }

  Points nearest_at(const Grid& grid, int band) const {
    const auto count = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
    Points points{std::vector<double>(count, std::numeric_limits<double>::infinity()),
                  std::vector<std::uint32_t>(count, nothing)};
    const auto number = static_cast<std::size_t>(band);
    for (const std::uint32_t f : facets_by_band_[number]) put_facet(f, grid, points);
    for (std::size_t s = 0; s < scene_.sheets.size(); ++s) put_sheet(s, grid, points);
    for (const std::uint32_t p : pieces_by_band_[number]) put_piece(p, grid, points);
    return points;
  }

  static void put(Points& points, std::size_t i, double depth_mm, std::uint32_t id) {
    if (!(depth_mm < points.depth_mm[i])) return;
    points.depth_mm[i] = depth_mm;
    points.id[i] = id;
  }

  void put_facet(std::uint32_t number, const Grid& grid, Points& points) const {
    const Facet& facet = facets_[number];
    const std::array<glm::dvec2, 3> px = positions(facet);
    const auto [left, right] = std::minmax({px[0].x, px[1].x, px[2].x});
    const auto [top, bottom] = std::minmax({px[0].y, px[1].y, px[2].y});
    const int x_end = std::min(grid.columns, grid.past(right));
    const int y_end = std::min(grid.rows, grid.past(bottom) - grid.first_row);
    const std::uint32_t id = options_.shading == FacetShading::Wire ? nothing : number;
    for (int y = std::max(0, grid.from(top) - grid.first_row); y < y_end; ++y)
      for (int x = std::max(0, grid.from(left)); x < x_end; ++x)
        if (const auto weights = weights_at(px, grid.at(x, y)))
          put(points, index(grid, x, y), depth_at(facet, *weights), id);
  }

  static std::size_t index(const Grid& grid, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(x);
  }

  std::array<glm::dvec2, 3> positions(const Facet& facet) const {
    return {corners_[facet.corners[0]].px, corners_[facet.corners[1]].px, corners_[facet.corners[2]].px};
  }

  /// Converts weights in the picture to weights in space: each is scaled by its corner's magnification.
  glm::dvec3 in_space(const Facet& facet, glm::dvec3 weights) const {
    for (int k = 0; k < 3; ++k) weights[k] *= corners_[facet.corners[static_cast<std::size_t>(k)]].scale;
    return weights / (weights.x + weights.y + weights.z);
  }

  double depth_at(const Facet& facet, const glm::dvec3& weights) const {
    const glm::dvec3 w = in_space(facet, weights);
    double depth_mm = 0.0;
    for (int k = 0; k < 3; ++k)
      depth_mm += w[k] * corners_[facet.corners[static_cast<std::size_t>(k)]].depth_mm;
    return depth_mm;
  }

  void put_piece(std::uint32_t number, const Grid& grid, Points& points) const {
    const Piece& piece = pieces_[number];
    const glm::dvec2 a = piece.ends[0].px, along = piece.ends[1].px - a;
    const double length2 = glm::dot(along, along), radius = piece.radius_px;
    const auto id = static_cast<std::uint32_t>(facets_.size() + number);
    const double lead = lead_mm(id);
    const int y_end = std::min(grid.rows, grid.past(std::max(a.y, a.y + along.y) + radius) - grid.first_row);
    for (int y = std::max(0, grid.from(std::min(a.y, a.y + along.y) - radius) - grid.first_row); y < y_end;
         ++y) {
      // The columns are bounded by the part of the piece that lies within a radius of the row.
      double t0 = 0.0, t1 = 1.0;
      if (along.y != 0.0) {
        const double at = grid.at(0, y).y;
        const double u = (at - radius - a.y) / along.y, v = (at + radius - a.y) / along.y;
        t0 = std::clamp(std::min(u, v), 0.0, 1.0);
        t1 = std::clamp(std::max(u, v), 0.0, 1.0);
      }
      const auto [left, right] = std::minmax({a.x + t0 * along.x, a.x + t1 * along.x});
      const int x_end = std::min(grid.columns, grid.past(right + radius));
      for (int x = std::max(0, grid.from(left - radius)); x < x_end; ++x) {
        const glm::dvec2 p = grid.at(x, y);
        const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
        if (glm::length(p - a - t * along) > radius) continue;
        const double w0 = (1.0 - t) * piece.ends[0].scale, w1 = t * piece.ends[1].scale;
        const double depth_mm = (w0 * piece.ends[0].depth_mm + w1 * piece.ends[1].depth_mm) / (w0 + w1);
        put(points, index(grid, x, y), depth_mm - lead, id);
      }
    }
  }

  /// The length by which a line counts as nearer: its width. A surface at up to 63 degrees to the picture's
  /// plane rises by at most twice the radius beside the line, so it does not hide an outline that lies on it.
  double lead_mm(std::uint32_t id) const {
    if (id < facets_.size() || id >= facets_.size() + pieces_.size()) return 0.0;
    return 2.0 * pieces_[id - facets_.size()].radius_px * camera_.pixel_mm;
  }

  struct SheetHit {
    double depth_mm = 0.0;
    std::size_t pixel = 0;
  };
  std::optional<SheetHit> hit_of(const DrawnSheet& sheet, const glm::dvec2& p_px) const {
    const glm::dvec3 normal = glm::cross(sheet.per_column, sheet.per_row);
    const glm::dvec3 start = camera_.lps_mm(p_px, 0.0), per_mm = camera_.lps_mm(p_px, 1.0) - start;
    const double fall = glm::dot(normal, per_mm);
    // A sheet seen on edge shows no area.
    if (std::abs(fall) < 1e-9 * glm::length(normal) * glm::length(per_mm)) return std::nullopt;
    const double depth_mm = glm::dot(normal, sheet.first_mm - start) / fall;
    if (depth_mm < nearest_mm_) return std::nullopt;
    const glm::dvec3 from_first = start + depth_mm * per_mm - sheet.first_mm;
    const double column = std::floor(
        glm::dot(from_first, sheet.per_column) / glm::dot(sheet.per_column, sheet.per_column) + 0.5);
    const double row =
        std::floor(glm::dot(from_first, sheet.per_row) / glm::dot(sheet.per_row, sheet.per_row) + 0.5);
    if (!(column >= 0.0 && row >= 0.0 && column < sheet.size_px.x && row < sheet.size_px.y))
      return std::nullopt;
    const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(sheet.size_px.x) +
                              static_cast<std::size_t>(column);
    if (sheet.is_shown[pixel] == 0) return std::nullopt;
    return SheetHit{depth_mm, pixel};
  }

  void put_sheet(std::size_t number, const Grid& grid, Points& points) const {
    const auto id = static_cast<std::uint32_t>(facets_.size() + pieces_.size() + number);
    for (int y = 0; y < grid.rows; ++y)
      for (int x = 0; x < grid.columns; ++x)
        if (const auto hit = hit_of(scene_.sheets[number], grid.at(x, y)))
          put(points, index(grid, x, y), hit->depth_mm, id);
  }

  std::size_t item_of(std::uint32_t id) const {
    if (id < facets_.size()) return facets_[id].item;
    if (id < facets_.size() + pieces_.size()) return pieces_[id - facets_.size()].item;
    return scene_.surfaces.size() + scene_.lines.size() + (id - facets_.size() - pieces_.size());
  }

  /// Linear light of a point.
  glm::vec3 tone(std::uint32_t id, double depth_mm, const glm::dvec2& p_px) const {
    if (id == nothing) return background_;
    if (id < facets_.size()) return facet_tone(facets_[id], p_px);
    if (id < facets_.size() + pieces_.size()) {
      const double part =
          depth_range_mm_ > 0.0 ? std::clamp((depth_mm + lead_mm(id)) / depth_range_mm_, 0.0, 1.0) : 0.0;
      return glm::mix(background_, colours_[item_of(id)], static_cast<float>(1.0 - (1.0 - far_share) * part));
    }
    const DrawnSheet& sheet = scene_.sheets[id - facets_.size() - pieces_.size()];
    const auto hit = hit_of(sheet, p_px);
    const std::uint8_t* rgb = &sheet.rgb[3 * hit->pixel];
    return linear_of_srgb(glm::vec3(rgb[0], rgb[1], rgb[2]) / 255.0f);
  }

  glm::vec3 corner_normal(const Facet& facet, std::size_t k) const {
    const glm::vec3& normal = corners_[facet.corners[k]].normal;
    if (glm::dot(normal, normal) == 0.0f) return facet.normal;
    return facet.is_turned ? -normal : normal;
  }

  glm::vec3 facet_tone(const Facet& facet, const glm::dvec2& p_px) const {
    const glm::vec3& colour = colours_[facet.item];
    if (options_.shading == FacetShading::Flat) return lit(colour, facet.normal, options_.lighting);
    const glm::vec3 w(in_space(facet, *weights_at(positions(facet), p_px)));
    glm::vec3 mean(0.0f);
    const bool is_gouraud = options_.shading == FacetShading::Gouraud;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 normal = corner_normal(facet, k);
      mean += w[static_cast<int>(k)] * (is_gouraud ? lit(colour, normal, options_.lighting) : normal);
    }
    if (is_gouraud) return mean;
    const float length = glm::length(mean);
    return lit(colour, length > 0.0f ? mean / length : facet.normal, options_.lighting);
  }

  const DrawnScene& scene_;
  const DrawOptions& options_;
  const Camera& camera_;
  glm::dmat3 turn_;  ///< columns right, up, look
  double nearest_mm_ = -std::numeric_limits<double>::infinity();
  double depth_range_mm_ = 0.0;
  glm::vec3 background_{1.0f};
  std::vector<glm::vec3> colours_;  ///< of surfaces and lines, linear light
  std::vector<Corner> corners_;
  std::vector<Facet> facets_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<std::uint32_t>> facets_by_band_, pieces_by_band_;
};

}  // namespace

ViewExtent extent(const DrawnScene& scene, const glm::dvec3& right, const glm::dvec3& up,
                  const glm::dvec3& look) {
  ViewExtent whole;
  const auto add = [&](const glm::dvec3& p_mm) {
    const glm::dvec3 p(glm::dot(p_mm, right), glm::dot(p_mm, up), glm::dot(p_mm, look));
    whole.low_mm = glm::min(whole.low_mm, p);
    whole.high_mm = glm::max(whole.high_mm, p);
  };
  for (const DrawnSurface& surface : scene.surfaces)
    for (const auto& face : surface.triangles->faces)
      for (const std::uint32_t v : face) add(surface.triangles->points_mm[v]);
  for (const DrawnLines& lines : scene.lines)
    for (const auto& line : lines.lines_mm)
      for (const glm::dvec3& p_mm : line) add(p_mm);
  for (const DrawnSheet& sheet : scene.sheets)
    for (const int x : {0, sheet.size_px.x})
      for (const int y : {0, sheet.size_px.y})
        add(sheet.first_mm + sheet.per_column * (x - 0.5) + sheet.per_row * (y - 0.5));
  return whole;
}

DrawnPicture draw(const DrawnScene& scene, const DrawOptions& options, const Progress& progress) {
  const Camera& camera = options.camera;
  if (camera.size_px.x < 1 || camera.size_px.y < 1 || !(camera.pixel_mm > 0.0) ||
      !std::isfinite(camera.pixel_mm))
    throw InvalidInput("a picture needs at least one pixel, and pixels of a positive length");
  return Painter(scene, options).paint(progress);
}

}  // namespace octotomy::brep
