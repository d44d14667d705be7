// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Every class is a function whose absolute value is a lower bound of the distance to its surface (Hart,
// Sphere tracing, 1996). For prisms of polygons, boxes, balls, cones and tori it is the distance itself or
// the larger of two distances; minimum and maximum keep the bound. Scans: each voxel is divided into 3 x 3 x
// 3 or more cells. Where the surface may meet a cell, its filled share comes from 2 x 2 x 2 points. Along
// each axis in turn one pass blurs the cells and averages them to voxels: the weight of a cell is the
// Gaussian summed over the cells of the voxel.
#include "verify/phantom/drawn_solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "verify/phantom/implicit_solid.h"

namespace octotomy::verify {
namespace {

using glm::dvec2;
using glm::dvec3;
using Signed = std::function<double(const dvec3&)>;
constexpr double pi = std::numbers::pi;

double box_mm(const dvec3& p, const dvec3& half) {
  const dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, dvec3(0.0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}
double box_mm(const dvec3& p, const dvec3& low, const dvec3& high) {
  return box_mm(p - 0.5 * (low + high), 0.5 * (high - low));
}
double cylinder_mm(const dvec3& p, double radius, double half_length) {
  const dvec2 q(std::hypot(p.x, p.y) - radius, std::abs(p.z) - half_length);
  return glm::length(glm::max(q, dvec2(0.0))) + std::min(std::max(q.x, q.y), 0.0);
}

using Polygon = std::vector<dvec2>;
double polygon_mm(const dvec2& p, const Polygon& corners) {
  double nearest2 = glm::dot(p - corners[0], p - corners[0]);
  bool is_inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const dvec2 edge = corners[j] - corners[i], off = p - corners[i];
    const dvec2 across = off - edge * std::clamp(glm::dot(off, edge) / glm::dot(edge, edge), 0.0, 1.0);
    nearest2 = std::min(nearest2, glm::dot(across, across));
    if ((corners[i].y > p.y) != (corners[j].y > p.y) &&
        p.x < edge.x * (p.y - corners[i].y) / edge.y + corners[i].x)
      is_inside = !is_inside;
  }
  return is_inside ? -std::sqrt(nearest2) : std::sqrt(nearest2);
}
double area_of(const Polygon& corners) {
  double twice = 0.0;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
    twice += corners[j].x * corners[i].y - corners[i].x * corners[j].y;
  return std::abs(0.5 * twice);
}
double perimeter_of(const Polygon& corners) {
  double sum = 0.0;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
    sum += glm::distance(corners[j], corners[i]);
  return sum;
}

DrawnSolid prism(const Polygon& corners, double length) {
  double reach = 0.0;
  for (const dvec2& corner : corners) reach = std::max(reach, glm::length(corner));
  return {"",
          [=](const dvec3& p) {
            const dvec2 q(polygon_mm({p.x, p.y}, corners), std::abs(p.z) - 0.5 * length);
            return glm::length(glm::max(q, dvec2(0.0))) + std::min(std::max(q.x, q.y), 0.0);
          },
          std::hypot(reach, 0.5 * length), area_of(corners) * length,
          2.0 * area_of(corners) + perimeter_of(corners) * length};
}
DrawnSolid box(const dvec3& sides) {
  return {"", [=](const dvec3& p) { return box_mm(p, 0.5 * sides); }, 0.5 * glm::length(sides),
          sides.x * sides.y * sides.z, 2.0 * (sides.x * sides.y + sides.y * sides.z + sides.z * sides.x)};
}
double sphere_mm3(double r) {
  return 4.0 / 3.0 * pi * r * r * r;
}
double sphere_mm2(double r) {
  return 4.0 * pi * r * r;
}
DrawnSolid ball(double r) {
  return {"", [=](const dvec3& p) { return glm::length(p) - r; }, r, sphere_mm3(r), sphere_mm2(r)};
}

class Drawing {
 public:
  explicit Drawing(Chance& chance) : chance_(chance) {}

  /// A random size whose logarithm is uniform, so that small sizes are as likely as large ones.
  double size(double low, double high) { return low * std::exp(chance_.between(0.0, std::log(high / low))); }
  int count(int low, int high) {
    return std::min(high, low + static_cast<int>(chance_.between(0.0, high - low + 1.0)));
  }

  DrawnSolid balls() { return ball(size(3.0, 20.0)); }
  DrawnSolid small_ball() { return ball(size(0.8, 3.0)); }
  DrawnSolid shell() {
    const double outer = size(5.0, 20.0), t = size(0.6, 3.0), inner = outer - t;
    return {"", [=](const dvec3& p) { return std::abs(glm::length(p) - outer + 0.5 * t) - 0.5 * t; }, outer,
            sphere_mm3(outer) - sphere_mm3(inner), sphere_mm2(outer) + sphere_mm2(inner)};
  }
  DrawnSolid fractured_shell() {
    // The part of a spherical shell between two half-planes that end in a common axis.
    const double outer = size(6.0, 20.0), t = size(0.7, 3.0), inner = outer - t;
    const double share = chance_.between(0.25, 0.75), half = pi * share;
    return {"",
            [=](const dvec3& p) {
              const double wall = std::abs(glm::length(p) - outer + 0.5 * t) - 0.5 * t;
              const double wedge = std::abs(p.y) * std::cos(half) - p.x * std::sin(half);
              return std::max(wall, wedge);
            },
            outer, share * (sphere_mm3(outer) - sphere_mm3(inner)),
            share * (sphere_mm2(outer) + sphere_mm2(inner)) + pi * (outer * outer - inner * inner)};
  }
  DrawnSolid rod() {
    const double r = 0.5 * size(1.0, 4.0), length = size(8.0, 36.0);
    return {"", [=](const dvec3& p) { return cylinder_mm(p, r, 0.5 * length); }, std::hypot(r, 0.5 * length),
            pi * r * r * length, 2.0 * pi * r * (r + length)};
  }
  DrawnSolid plate() { return box({size(0.6, 4.0), size(8.0, 28.0), size(8.0, 28.0)}); }
  DrawnSolid wedge() {
    const double height = size(6.0, 24.0), angle = glm::radians(size(8.0, 45.0));
    return prism({{-0.5 * height, 0.0},
                  {0.5 * height, -height * std::tan(0.5 * angle)},
                  {0.5 * height, height * std::tan(0.5 * angle)}},
                 size(6.0, 24.0));
  }
  DrawnSolid block() { return box({size(2.0, 25.0), size(2.0, 25.0), size(2.0, 25.0)}); }
  DrawnSolid ball_less_octant() {
    const double r = size(2.0, 18.0);
    return {
        "",
        [=](const dvec3& p) { return std::max(glm::length(p) - r, -box_mm(p, dvec3(0.0), dvec3(2.0 * r))); },
        r, 0.875 * sphere_mm3(r), 0.875 * sphere_mm2(r) + 0.75 * pi * r * r};
  }
  DrawnSolid cone() {
    const double r = size(2.0, 14.0), h = size(4.0, 28.0), slant = std::hypot(r, h);
    return {"",
            [=](const dvec3& p) {
              const double side = ((p.z - 0.5 * h) * r + std::hypot(p.x, p.y) * h) / slant;
              return std::max(side, -0.5 * h - p.z);
            },
            std::hypot(r, 0.5 * h), pi * r * r * h / 3.0, pi * r * (r + slant)};
  }
  DrawnSolid torus() {
    const double r = size(0.8, 5.0), ring = r + size(2.0, 14.0);
    return {"", [=](const dvec3& p) { return std::hypot(std::hypot(p.x, p.y) - ring, p.z) - r; }, ring + r,
            2.0 * pi * pi * ring * r * r, 4.0 * pi * pi * ring * r};
  }
  DrawnSolid gear() {
    const int teeth = count(5, 14);
    const double outer = size(6.0, 18.0), inner = outer * chance_.between(0.6, 0.85);
    Polygon corners;
    for (int i = 0; i < 4 * teeth; ++i) {
      const double angle = 2.0 * pi * (i + 0.5 * (i % 2)) / (4.0 * teeth), r = i % 4 < 2 ? outer : inner;
      corners.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    return prism(corners, size(2.0, 12.0));
  }
  DrawnSolid stack() {
    // A stack of square plates of equal height, each smaller than the one below it.
    const int steps = count(2, 6);
    const double height = size(1.0, 4.0), side = size(8.0, 24.0);
    std::vector<double> half;
    double volume = 0.0, area = 2.0 * side * side;
    for (int i = 0; i < steps; ++i) {
      half.push_back(0.5 * side * (1.0 - static_cast<double>(i) / steps));
      volume += 4.0 * half[i] * half[i] * height;
      area += 8.0 * half[i] * height;
    }
    const double low = -0.5 * height * steps;
    return {"",
            [=](const dvec3& p) {
              double nearest = 1e9;
              for (int i = 0; i < steps; ++i)
                nearest = std::min(nearest, box_mm(p, {-half[i], -half[i], low},
                                                   {half[i], half[i], low + height * (i + 1)}));
              return nearest;
            },
            std::hypot(side * std::numbers::sqrt2 * 0.5, low), volume, area};
  }
  DrawnSolid bracket() {
    const double a = size(6.0, 22.0), b = size(6.0, 22.0), t = size(1.2, 5.0);
    return prism({{0, 0}, {a, 0}, {a, t}, {t, t}, {t, b}, {0, b}}, size(4.0, 22.0));
  }
  DrawnSolid lens() {
    const double r = size(5.0, 20.0), off = r * chance_.between(0.2, 0.85), h = r - off;
    return {"",
            [=](const dvec3& p) {
              return std::max(glm::length(p - dvec3(0, 0, off)), glm::length(p + dvec3(0, 0, off))) - r;
            },
            r, 2.0 * pi * h * h * (3.0 * r - h) / 3.0, 4.0 * pi * r * h};
  }
  DrawnSolid tube() {
    const double outer = size(2.5, 14.0), t = std::min(size(0.7, 4.0), 0.8 * outer), length = size(6.0, 28.0);
    const double inner = outer - t;
    return {"",
            [=](const dvec3& p) {
              return std::max(std::abs(std::hypot(p.x, p.y) - outer + 0.5 * t) - 0.5 * t,
                              std::abs(p.z) - 0.5 * length);
            },
            std::hypot(outer, 0.5 * length), pi * (outer * outer - inner * inner) * length,
            2.0 * pi * (outer + inner) * (length + t)};
  }
  DrawnSolid half_pipe() {
    const double outer = size(4.0, 16.0), t = size(0.7, 3.0), length = size(8.0, 26.0), inner = outer - t;
    return {"",
            [=](const dvec3& p) {
              return std::max({std::abs(std::hypot(p.x, p.y) - outer + 0.5 * t) - 0.5 * t,
                               std::abs(p.z) - 0.5 * length, -p.y});
            },
            std::hypot(outer, 0.5 * length), 0.5 * pi * (outer * outer - inner * inner) * length,
            pi * (outer + inner) * (length + t) + 2.0 * t * length};
  }
  DrawnSolid frame() {
    const double side = size(8.0, 26.0), t = std::min(size(1.0, 4.0), 0.3 * side), hole = side - 2.0 * t;
    return {"",
            [=](const dvec3& p) {
              const dvec3 q = glm::abs(p) - 0.5 * hole;
              const double tunnels = std::min({std::max(q.x, q.y), std::max(q.y, q.z), std::max(q.z, q.x)});
              return std::max(box_mm(p, dvec3(0.5 * side)), -tunnels);
            },
            0.5 * side * std::sqrt(3.0),
            side * side * side - 3.0 * hole * hole * side + 2.0 * hole * hole * hole,
            6.0 * (side * side - hole * hole) + 24.0 * hole * t};
  }
  DrawnSolid octahedron() {
    const double r = size(3.0, 20.0);
    return {
        "",
        [=](const dvec3& p) { return (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) - r) / std::sqrt(3.0); },
        r, 4.0 / 3.0 * r * r * r, 4.0 * std::sqrt(3.0) * r * r};
  }
  DrawnSolid gravel() {
    const double r = size(0.9, 3.0), apart = 2.0 * r + size(2.0, 6.0);
    const int side = count(2, 3);
    const double first = -0.5 * (side - 1) * apart;
    return {"",
            [=](const dvec3& p) {
              const dvec3 nearest =
                  glm::clamp(glm::round((p - first) / apart), dvec3(0.0), dvec3(side - 1.0)) * apart + first;
              return glm::distance(p, nearest) - r;
            },
            std::sqrt(3.0) * std::abs(first) + r, side * side * side * sphere_mm3(r),
            side * side * side * sphere_mm2(r)};
  }
  DrawnSolid hexagon() {
    Polygon corners;
    const double r = size(3.0, 16.0);
    for (int i = 0; i < 6; ++i) corners.emplace_back(r * std::cos(pi * i / 3.0), r * std::sin(pi * i / 3.0));
    return prism(corners, size(1.5, 20.0));
  }
  DrawnSolid capsule() {
    const double r = size(0.8, 5.0), length = size(4.0, 26.0);
    return {"",
            [=](const dvec3& p) {
              return glm::length(p - dvec3(0, 0, std::clamp(p.z, -0.5 * length, 0.5 * length))) - r;
            },
            0.5 * length + r, pi * r * r * length + sphere_mm3(r), 2.0 * pi * r * length + sphere_mm2(r)};
  }
  DrawnSolid cross() {
    const double length = size(8.0, 26.0), a = std::min(size(1.0, 6.0), 0.5 * length);
    return {
        "",
        [=](const dvec3& p) {
          const double l = 0.5 * length, h = 0.5 * a;
          return std::min({box_mm(p, dvec3(l, h, h)), box_mm(p, dvec3(h, l, h)), box_mm(p, dvec3(h, h, l))});
        },
        std::hypot(0.5 * length, a), 3.0 * a * a * length - 2.0 * a * a * a,
        6.0 * a * a + 12.0 * a * (length - a)};
  }
  DrawnSolid dome() {
    const double r = size(2.0, 18.0);
    return {"", [=](const dvec3& p) { return std::max(glm::length(p) - r, -p.z); }, r, 0.5 * sphere_mm3(r),
            3.0 * pi * r * r};
  }
  DrawnSolid ellipsoid() {
    const dvec3 a(size(1.0, 18.0), size(3.0, 18.0), size(3.0, 18.0));
    const double least = std::min({a.x, a.y, a.z});
    // The area of the ellipsoid, as an integral over the unit sphere by the midpoint rule: at direction n the
    // element is a.x a.y a.z |n / a| dOmega.
    double area = 0.0;
    constexpr int steps = 400;
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const double z = -1.0 + (2.0 * i + 1.0) / steps, angle = 2.0 * pi * (j + 0.5) / steps;
        const double s = std::sqrt(1.0 - z * z);
        area += glm::length(dvec3(s * std::cos(angle), s * std::sin(angle), z) / a);
      }
    area *= a.x * a.y * a.z * 4.0 * pi / (steps * steps);
    return {"", [=](const dvec3& p) { return (glm::length(p / a) - 1.0) * least; }, std::max({a.x, a.y, a.z}),
            4.0 / 3.0 * pi * a.x * a.y * a.z, area};
  }
  DrawnSolid gyroid() {
    const double r = size(6.0, 14.0), k = 2.0 * pi / size(7.0, 16.0), w = chance_.between(0.15, 0.7);
    return counted({"",
                    [=](const dvec3& p) {
                      const dvec3 s = glm::sin(k * p), c = glm::cos(k * p);
                      const double g = s.x * c.y + s.y * c.z + s.z * c.x;
                      return std::max((std::abs(g) - w) / (std::sqrt(3.0) * k), glm::length(p) - r);
                    },
                    r});
  }
  DrawnSolid csg() {
    const double r = size(4.0, 12.0);
    const dvec3 half(size(0.3, 1.1) * r, size(0.3, 1.1) * r, size(0.3, 1.1) * r);
    const dvec3 off(chance_.between(-0.8, 0.8) * r, chance_.between(-0.8, 0.8) * r, 0.0);
    const int kind = count(0, 3);
    const double bar = size(0.8, 3.0);
    return counted({"",
                    [=](const dvec3& p) {
                      const double a = glm::length(p) - r, b = box_mm(p - off, half);
                      const double c = cylinder_mm({p.x - off.y, p.y, p.z}, bar, 1.6 * r);
                      return kind == 0   ? std::min({a, b, c})
                             : kind == 1 ? std::max(a, -b)
                             : kind == 2 ? std::min(std::max(b, -a), c)
                                         : std::max(std::min(a, b), -c);
                    },
                    3.0 * r});
  }

 private:
  /// Computes volume and area with lines of evenly spread positions and directions (Cauchy and Crofton), from
  /// the mean length inside and the mean number of crossings of a line that meets the ball of radius
  /// `reach_mm`. Positions and directions follow an additive recurrence by the powers of the root of
  /// x^5 = x + 1 (Roberts 2018), which spreads them more evenly than random numbers.
  DrawnSolid counted(DrawnSolid solid) {
    constexpr int lines = 100000;
    constexpr double root = 1.1673039782614187;
    const double first = chance_.even() + 0.5;
    const auto spread = [first](int line, int power) {
      const double at = first + line / std::pow(root, power);
      return at - std::floor(at);
    };
    const double reach = solid.reach_mm, least = 1e-3;
    double within = 0.0;
    std::int64_t crossings = 0;
    for (int i = 0; i < lines; ++i) {
      const double z = 2.0 * spread(i, 1) - 1.0, angle = 2.0 * pi * spread(i, 2);
      const double s = std::sqrt(1.0 - z * z);
      const dvec3 along(s * std::cos(angle), s * std::sin(angle), z);
      const dvec3 u = glm::normalize(glm::cross(along, std::abs(z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0)));
      const double rho = reach * std::sqrt(spread(i, 3)), turn = 2.0 * pi * spread(i, 4);
      const dvec3 start = rho * (std::cos(turn) * u + std::sin(turn) * glm::cross(along, u));
      const double half = std::sqrt(reach * reach - rho * rho);
      bool was_inside = false;
      for (double at = -half; at < half;) {
        const double value = solid.signed_mm(start + at * along);
        const bool is_inside = value < 0.0;
        crossings += is_inside != was_inside ? 1 : 0;
        was_inside = is_inside;
        const double step = std::max(std::abs(value), least);
        if (is_inside) within += step;
        at += step;
      }
      crossings += was_inside ? 1 : 0;
    }
    const double ball_area = pi * reach * reach;
    solid.volume_mm3 = within / lines * ball_area;
    solid.area_mm2 = 2.0 * static_cast<double>(crossings) / lines * ball_area;
    return solid;
  }

  Chance& chance_;
};

struct Maker {
  const char* name;
  bool is_held_back;
  DrawnSolid (Drawing::*make)();
};
constexpr Maker makers[] = {
    {"ball", false, &Drawing::balls},
    {"small ball", true, &Drawing::small_ball},
    {"shell", false, &Drawing::shell},
    {"fractured shell", true, &Drawing::fractured_shell},
    {"rod", false, &Drawing::rod},
    {"capsule", true, &Drawing::capsule},
    {"plate", true, &Drawing::plate},
    {"half pipe", false, &Drawing::half_pipe},
    {"wedge", true, &Drawing::wedge},
    {"cone", false, &Drawing::cone},
    {"block", false, &Drawing::block},
    {"hexagon", true, &Drawing::hexagon},
    {"ball less octant", true, &Drawing::ball_less_octant},
    {"dome", false, &Drawing::dome},
    {"torus", true, &Drawing::torus},
    {"tube", false, &Drawing::tube},
    {"gear", true, &Drawing::gear},
    {"bracket", false, &Drawing::bracket},
    {"stack", true, &Drawing::stack},
    {"cross", false, &Drawing::cross},
    {"lens", false, &Drawing::lens},
    {"ellipsoid", true, &Drawing::ellipsoid},
    {"frame", true, &Drawing::frame},
    {"octahedron", false, &Drawing::octahedron},
    {"gravel", false, &Drawing::gravel},
    {"gyroid", true, &Drawing::gyroid},
    {"csg", true, &Drawing::csg},
};

/// Number of cells into which a voxel is divided along each axis.
glm::ivec3 cells_of(const dvec3& spacing_mm) {
  const double least = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  return glm::max(glm::ivec3(glm::round(3.0 * spacing_mm / least)), glm::ivec3(3));
}

/// The filled share of a cell; `value` is the solid's distance function at the cell's centre.
double share_of(const DrawnSolid& solid, double value, const dvec3& centre, const dvec3& cell_mm) {
  if (std::abs(value) >= 0.5 * glm::length(cell_mm)) return value < 0.0 ? 1.0 : 0.0;
  // Each of eight points represents an octant, whose filled share follows from the distance to the surface as
  // if the surface were a plane. For planes along the lattice the sum is exact.
  const double width = 0.5 * std::cbrt(cell_mm.x * cell_mm.y * cell_mm.z);
  double inside = 0.0;
  for (int i = 0; i < 8; ++i) {
    const dvec3 corner(i & 1, (i >> 1) & 1, i >> 2);
    inside += std::clamp(0.5 - solid.signed_mm(centre + (0.5 * corner - 0.25) * cell_mm) / width, 0.0, 1.0);
  }
  return inside / 8.0;
}

/// Values in x-fastest order.
struct Block {
  glm::ivec3 dims{0};
  std::vector<float> values;
  std::size_t at(const glm::ivec3& p) const {
    return static_cast<std::size_t>(p.x) +
           static_cast<std::size_t>(dims.x) *
               (static_cast<std::size_t>(p.y) +
                static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(p.z));
  }
};

/// Fills the cells from `low` to below `high`. If the surface is farther from the middle than the corners,
/// all cells get the same value; otherwise halves the block along its longest side.
void fill(const DrawnSolid& solid, const dvec3& cell_mm, const glm::ivec3& low, const glm::ivec3& high,
          Block& cells) {
  const dvec3 centre = 0.5 * (dvec3(low + high) - dvec3(cells.dims)) * cell_mm;
  const double value = solid.signed_mm(centre), reach = 0.5 * glm::length(dvec3(high - low) * cell_mm);
  const glm::ivec3 sides = high - low;
  if (sides == glm::ivec3(1)) {
    cells.values[cells.at(low)] = static_cast<float>(share_of(solid, value, centre, cell_mm));
    return;
  }
  if (std::abs(value) > reach) {
    if (value > 0.0) return;
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        std::fill_n(cells.values.begin() + static_cast<std::ptrdiff_t>(cells.at({low.x, y, z})), sides.x,
                    1.0F);
    return;
  }
  const dvec3 sides_mm = dvec3(sides) * cell_mm;
  int axis = 0;
  for (int other = 1; other < 3; ++other)
    if (sides[axis] == 1 || (sides[other] > 1 && sides_mm[other] > sides_mm[axis])) axis = other;
  glm::ivec3 middle_high = high, middle_low = low;
  middle_high[axis] = middle_low[axis] = low[axis] + sides[axis] / 2;
  fill(solid, cell_mm, low, middle_high, cells);
  fill(solid, cell_mm, middle_low, high, cells);
}

/// Blurs along one axis, and averages every `parts` cells to one. Beyond the ends, cells repeat the last
/// ones.
Block averaged(const Block& cells, int axis, int parts, double deviation) {
  const int reach = static_cast<int>(std::ceil(4.0 * deviation)), taps = parts + 2 * reach;
  std::vector<double> weights(static_cast<std::size_t>(taps), 0.0);
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double weight = std::exp(-0.5 * k * k / (deviation * deviation));
    for (int part = 0; part < parts; ++part) weights[static_cast<std::size_t>(part + k + reach)] += weight;
    sum += weight * parts;
  }
  for (double& weight : weights) weight /= sum;
  Block made;
  made.dims = cells.dims;
  made.dims[axis] /= parts;
  made.values.reserve(cells.values.size() / static_cast<std::size_t>(parts));
  glm::ivec3 step(0);
  step[axis] = 1;
  const std::size_t stride = cells.at(step);
  for (int z = 0; z < made.dims.z; ++z)
    for (int y = 0; y < made.dims.y; ++y)
      for (int x = 0; x < made.dims.x; ++x) {
        glm::ivec3 row(x, y, z);
        const int first = row[axis] * parts - reach, last = cells.dims[axis] - 1;
        row[axis] = 0;
        const std::size_t start = cells.at(row);
        double value = 0.0;
        for (int tap = 0; tap < taps; ++tap)
          value +=
              weights[static_cast<std::size_t>(tap)] *
              static_cast<double>(
                  cells.values[start + stride * static_cast<std::size_t>(std::clamp(first + tap, 0, last))]);
        made.values.push_back(static_cast<float>(value));
      }
  return made;
}

}  // namespace

const std::vector<DrawnGroup>& drawn_groups() {
  static const std::vector<DrawnGroup> groups = [] {
    std::vector<DrawnGroup> all;
    for (const Maker& maker : makers) all.push_back({maker.name, maker.is_held_back});
    return all;
  }();
  return groups;
}

DrawnSolid drawn_solid(const std::string& group, Chance& chance) {
  const auto* maker =
      std::find_if(std::begin(makers), std::end(makers), [&](const Maker& one) { return group == one.name; });
  if (maker == std::end(makers))
    throw std::invalid_argument("no class of drawn solids is called '" + group + "'");
  Drawing drawing(chance);
  DrawnSolid solid = (drawing.*maker->make)();
  solid.group = group;
  // One solid in five lies along the lattice, as machined parts do.
  const bool is_along = chance.between(0.0, 1.0) < 0.2;
  const glm::dmat3 turn =
      is_along ? glm::dmat3(1.0)
               : turned({chance.between(-180, 180), chance.between(-90, 90), chance.between(-180, 180)});
  const dvec3 at(chance.even(), chance.even(), chance.even());
  solid.signed_mm = [still = std::move(solid.signed_mm), back = glm::transpose(turn), at](const dvec3& p) {
    return still(back * (p - at));
  };
  solid.reach_mm += 1.0;
  return solid;
}

DrawnScan drawn_scan(Chance& chance) {
  constexpr double slices[] = {1.0, 1.0, 1.5, 2.0, 3.0, 5.0};
  DrawnScan how;
  how.spacing_mm.z = slices[static_cast<int>(chance.between(0.0, 5.999))];
  how.blur_voxels = chance.between(0.3, 1.2);
  how.noise = chance.between(10.0, 60.0);
  how.background = chance.even() < 0.0 ? 0.0 : -1000.0;
  return how;
}

voxel::Scene scan_of(const DrawnSolid& solid, const DrawnScan& how, Chance& chance) {
  const glm::ivec3 half(glm::ceil(solid.reach_mm / how.spacing_mm) + (how.third_from_mm ? 10.0 : 7.0)),
      dims = 2 * half + 1;
  const glm::ivec3 parts = cells_of(how.spacing_mm);
  Block cells{dims * parts, {}};
  cells.values.assign(cells.at({0, 0, cells.dims.z}), 0.0F);
  fill(solid, how.spacing_mm / dvec3(parts), glm::ivec3(0), cells.dims, cells);
  for (int axis = 0; axis < 3; ++axis)
    cells = averaged(cells, axis, parts[axis], how.blur_voxels * parts[axis]);
  voxel::Scene scan;
  scan.lattice = voxel::axis_aligned_lattice(dims, how.spacing_mm, -dvec3(half) * how.spacing_mm);
  scan.source = solid.group;
  voxel::Int16Samples samples;
  const double edge_mm = std::sqrt(2.0 / 12.0 + 2.0 * how.blur_voxels * how.blur_voxels) * how.spacing_mm.x;
  for (std::size_t i = 0; i < cells.values.size(); ++i) {
    double sample = how.background + how.contrast * static_cast<double>(cells.values[i]);
    if (how.third_from_mm) {
      const glm::ivec3 at(static_cast<int>(i) % dims.x, static_cast<int>(i) / dims.x % dims.y,
                          static_cast<int>(i) / (dims.x * dims.y));
      const double beyond_mm = solid.signed_mm(dvec3(at - half) * how.spacing_mm) - *how.third_from_mm;
      sample += (how.third - how.background) * 0.5 * std::erfc(-beyond_mm / edge_mm);
    }
    sample += how.noise * chance.normal();
    samples.push_back(static_cast<std::int16_t>(std::lround(std::clamp(sample, -32768.0, 32767.0))));
  }
  scan.samples = std::move(samples);
  return scan;
}

}  // namespace octotomy::verify
