// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/solid_phantom.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "voxel/solid/combine.h"
#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

using std::numbers::pi;

constexpr int chequers = 8;  // cells along a side: the nodes of level 3 (thesis 3.3.3)

/// Size and position of a solid, passed to the function that builds its kind.
struct SolidFrame {
  double radius_mm;
  glm::dvec3 centre_mm;
  glm::dmat3 lps_from_axes;
  const voxel::Universe& universe;

  glm::dvec3 at(const glm::dvec3& own_mm) const { return centre_mm + lps_from_axes * own_mm; }
};

double ball_mm3(double radius_mm) {
  return 4.0 / 3.0 * pi * radius_mm * radius_mm * radius_mm;
}
double sphere_mm2(double radius_mm) {
  return 4.0 * pi * radius_mm * radius_mm;
}
/// The volume and the curved area of a ball's cap of this height.
double cap_mm3(double radius_mm, double height_mm) {
  return pi * height_mm * height_mm * (radius_mm - height_mm / 3.0);
}
double cap_mm2(double radius_mm, double height_mm) {
  return 2.0 * pi * radius_mm * height_mm;
}

/// Area of an ellipsoid: 2 pi c^2 + 2 pi a b / sin(phi) (E(phi, k) sin^2(phi) + F(phi, k) cos^2(phi)) for a
/// >= b >= c, cos(phi) = c / a. The two elliptic integrals are computed by Gauss-Legendre in 64 panels of 3
/// points. Their integrands are analytic and smooth on [0, phi] for axes within a factor of ten, and the
/// error falls with the sixth power of the panel's width.
double ellipsoid_mm2(glm::dvec3 radii_mm) {
  std::array<double, 3> axes{radii_mm.x, radii_mm.y, radii_mm.z};
  std::sort(axes.rbegin(), axes.rend());
  const auto [a, b, c] = axes;
  if (a == c) return sphere_mm2(a);
  const double phi = std::acos(c / a);
  const double k2 = (a * a * (b * b - c * c)) / (b * b * (a * a - c * c));
  double first = 0.0;
  double second = 0.0;
  constexpr int panels = 64;
  constexpr std::array<double, 3> place{-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> weight{5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  const double half = 0.5 * phi / panels;
  for (int panel = 0; panel < panels; ++panel)
    for (std::size_t i = 0; i < 3; ++i) {
      const double s = std::sin((2 * panel + 1 + place[i]) * half);
      const double root = std::sqrt(1.0 - k2 * s * s);
      first += half * weight[i] / root;
      second += half * weight[i] * root;
    }
  const double sine = std::sin(phi);
  const double cosine = std::cos(phi);
  return 2.0 * pi * c * c + 2.0 * pi * a * b / sine * (second * sine * sine + first * cosine * cosine);
}

using Builder = SolidPhantom (*)(const SolidFrame&);

SolidPhantom sphere(const SolidFrame& place) {
  return {place.universe, voxel::Sphere{place.centre_mm, place.radius_mm}, ball_mm3(place.radius_mm),
          sphere_mm2(place.radius_mm), place.centre_mm};
}

SolidPhantom ellipsoid(const SolidFrame& place) {
  const glm::dvec3 radii_mm = place.radius_mm * glm::dvec3(1.0, 0.75, 0.5);
  return {place.universe, voxel::Ellipsoid{place.centre_mm, radii_mm, place.lps_from_axes},
          4.0 / 3.0 * pi * radii_mm.x * radii_mm.y * radii_mm.z, ellipsoid_mm2(radii_mm), place.centre_mm};
}

SolidPhantom cuboid(const SolidFrame& place, const glm::dvec3& half_mm) {
  return {place.universe, voxel::OrientedBox{place.centre_mm, half_mm, place.lps_from_axes},
          8.0 * half_mm.x * half_mm.y * half_mm.z,
          8.0 * (half_mm.x * half_mm.y + half_mm.y * half_mm.z + half_mm.z * half_mm.x), place.centre_mm};
}

SolidPhantom box(const SolidFrame& place) {
  return cuboid(place, place.radius_mm * glm::dvec3(1.0, 0.75, 0.5));
}

SolidPhantom plate(const SolidFrame& place) {
  const glm::dvec3 spacing_mm = place.universe.lattice().spacing_mm();
  const double voxel_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  return cuboid(place, {place.radius_mm, 0.75 * place.radius_mm, voxel_mm});
}

SolidPhantom cylinder(const SolidFrame& place) {
  const double r = 0.5 * place.radius_mm;
  const double height = 2.0 * place.radius_mm;
  return {place.universe, voxel::Cylinder{place.at({0, 0, -0.5 * height}), place.at({0, 0, 0.5 * height}), r},
          pi * r * r * height, 2.0 * pi * r * (r + height), place.centre_mm};
}

SolidPhantom torus(const SolidFrame& place) {
  const double ring = place.radius_mm;
  const double tube = place.radius_mm / 3.0;
  return {place.universe, voxel::Torus{place.centre_mm, place.lps_from_axes[2], ring, tube},
          2.0 * pi * pi * ring * tube * tube, 4.0 * pi * pi * ring * tube, place.centre_mm};
}

SolidPhantom shell(const SolidFrame& place) {
  const double inner = 0.75 * place.radius_mm;
  return {place.universe,
          voxel::Expression(voxel::Sphere{place.centre_mm, place.radius_mm}) -
              voxel::Sphere{place.centre_mm, inner},
          ball_mm3(place.radius_mm) - ball_mm3(inner), sphere_mm2(place.radius_mm) + sphere_mm2(inner),
          place.centre_mm};
}

SolidPhantom lens(const SolidFrame& place) {
  const double r = place.radius_mm;
  const glm::dvec3 aside = place.lps_from_axes * glm::dvec3(0.5 * r, 0, 0);
  return {place.universe,
          voxel::Expression(voxel::Sphere{place.centre_mm - aside, r}) &
              voxel::Sphere{place.centre_mm + aside, r},
          2.0 * cap_mm3(r, 0.5 * r), 2.0 * cap_mm2(r, 0.5 * r), place.centre_mm};
}

SolidPhantom cut_sphere(const SolidFrame& place) {
  const double r = place.radius_mm;
  const double height = r / 3.0;  // of the cap that is cut away
  const glm::dvec3 normal = place.lps_from_axes[2];
  const double volume = ball_mm3(r) - cap_mm3(r, height);
  // The distance of the cap's centroid from the ball's centre is 3 (2 r - h)^2 / (4 (3 r - h)).
  const double cap_centre = 0.75 * (2 * r - height) * (2 * r - height) / (3 * r - height);
  return {place.universe,
          voxel::Expression(voxel::Sphere{place.centre_mm, r}) &
              voxel::HalfSpace{normal, glm::dot(normal, place.centre_mm) + r - height},
          volume, sphere_mm2(r) - cap_mm2(r, height) + pi * height * (2 * r - height),
          place.centre_mm - normal * (cap_centre * cap_mm3(r, height) / volume)};
}

/// The cells of a chequerboard: those for which an odd number of the three indices is even.
voxel::Octree chequerboard(const voxel::Universe& universe) {
  const voxel::Box bounds = voxel::bounds(universe.lattice());
  const glm::dvec3 cell_mm = (bounds.high_mm - bounds.low_mm) / static_cast<double>(chequers);
  std::optional<voxel::Expression> board;
  for (int axis = 0; axis < 3; ++axis)
    for (int slab = 0; slab < chequers; slab += 2) {
      voxel::Box box = bounds;
      box.low_mm[axis] += slab * cell_mm[axis];
      box.high_mm[axis] = box.low_mm[axis] + cell_mm[axis];
      board = board ? *board ^ box : voxel::Expression(box);
    }
  return voxel::combine(universe, *board);
}

/// A reflection in any axis swaps the board's cells and the remaining ones, and maps the ball to itself. So
/// half of the ball's volume and of the sphere's area belongs to the solid. Of two cells with a common wall
/// exactly one belongs to the solid, so every disc of the ball in a plane between cells is boundary. Two
/// reflections map the board to itself, so the centroid is the middle.
SolidPhantom chequered_sphere(const SolidFrame& place) {
  if (place.universe.side() < chequers)
    throw voxel::InvalidInput(
        "a chequered sphere needs at least 8 voxels a side, one for each of the 8 cells along a side");
  SolidPhantom solid = sphere(place);
  solid.shape = solid.shape & chequerboard(place.universe);
  solid.volume_mm3 *= 0.5;
  solid.area_mm2 *= 0.5;
  const voxel::Box bounds = voxel::bounds(place.universe.lattice());
  for (int axis = 0; axis < 3; ++axis)
    for (int wall = 1; wall < chequers; ++wall) {
      const double at = bounds.low_mm[axis] + (bounds.high_mm[axis] - bounds.low_mm[axis]) * wall / chequers;
      const double square = place.radius_mm * place.radius_mm - at * at;
      if (square > 0.0) solid.area_mm2 += pi * square;
    }
  return solid;
}

/// The runs of ones that section 3.2.3 prints for the array of 4 x 4 x 4 voxels in figure 3.1. In a larger
/// universe each voxel of the figure becomes a cube of voxels.
SolidPhantom figure_3_1(const SolidFrame& place) {
  constexpr std::array<int, 13> ones{8, 9, 12, 13, 23, 24, 25, 26, 28, 29, 41, 44, 57};
  const voxel::Box bounds = voxel::bounds(place.universe.lattice());
  const glm::dvec3 cell_mm = (bounds.high_mm - bounds.low_mm) / 4.0;
  std::optional<voxel::Expression> cells;
  std::array<bool, 64> in{};
  glm::dvec3 sum(0.0);
  for (const int one : ones) {
    const glm::dvec3 index(one & 3, (one >> 2) & 3, one >> 4);
    const voxel::Box cell{bounds.low_mm + index * cell_mm, bounds.low_mm + (index + 1.0) * cell_mm};
    cells = cells ? *cells | cell : voxel::Expression(cell);
    in[static_cast<std::size_t>(one)] = true;
    sum += 0.5 * (cell.low_mm + cell.high_mm);
  }
  SolidPhantom solid{place.universe, voxel::combine(place.universe, *cells),
                     static_cast<double>(ones.size()) * cell_mm.x * cell_mm.y * cell_mm.z, 0.0,
                     sum / static_cast<double>(ones.size())};
  for (int axis = 0; axis < 3; ++axis) {
    const int stride = 1 << (2 * axis);
    const double face_mm2 = cell_mm.x * cell_mm.y * cell_mm.z / cell_mm[axis];
    for (const int one : ones) {
      const int along = (one >> (2 * axis)) & 3;
      if (along == 0 || !in[static_cast<std::size_t>(one - stride)]) solid.area_mm2 += face_mm2;
      if (along == 3 || !in[static_cast<std::size_t>(one + stride)]) solid.area_mm2 += face_mm2;
    }
  }
  return solid;
}

struct BuiltKind {
  SolidPhantomKind said;
  Builder build;
  double reach;  ///< largest distance from the centre in radii; 0: fills its universe
  bool on_lattice = false;
};

const std::vector<BuiltKind>& built_kinds() {
  static const std::vector<BuiltKind> all{
      {{"sphere", "a ball of radius R"}, sphere, 1.0},
      {{"chequered_sphere", "the ball in every other cell of 8 x 8 x 8"}, chequered_sphere, 1.0, true},
      {{"figure_3_1", "the thesis's 13 cells of 4 x 4 x 4"}, figure_3_1, 0.0, true},
      {{"box", "2 R x 1.5 R x R"}, box, std::sqrt(1.0 + 0.5625 + 0.25)},
      {{"ellipsoid", "radii R, 0.75 R, 0.5 R"}, ellipsoid, 1.0},
      {{"torus", "a ring of radius R, its tube R / 3"}, torus, 4.0 / 3.0},
      {{"cylinder", "radius R / 2, height 2 R"}, cylinder, std::sqrt(1.25)},
      {{"shell", "between radii R and 0.75 R"}, shell, 1.0},
      {{"lens", "the common part of two balls of radius R, R apart"}, lens, 1.0},
      {{"cut_sphere", "a ball of radius R less a cap of R / 3"}, cut_sphere, 1.0},
      {{"plate", "2 R x 1.5 R, two voxels thick"}, plate, 1.5},
  };
  return all;
}

voxel::Universe universe_of(const SolidPhantomOptions& options) {
  const auto side = static_cast<unsigned>(std::max(options.voxels, 0));
  if (!std::has_single_bit(side) || side < 4 || side > (1U << voxel::Universe::max_depth))
    throw voxel::InvalidInput("a universe has 4, 8, 16 ... 4096 voxels a side, not " +
                              std::to_string(options.voxels));
  voxel::Universe universe{std::countr_zero(side), glm::dmat4(1.0)};
  for (int axis = 0; axis < 3; ++axis) {
    if (!(options.spacing_mm[axis] > 0.0) || !std::isfinite(options.spacing_mm[axis]))
      throw voxel::InvalidInput("a voxel's edges must be positive lengths in mm");
    universe.lps_from_voxel[axis][axis] = options.spacing_mm[axis];
    universe.lps_from_voxel[3][axis] = -0.5 * (options.voxels - 1) * options.spacing_mm[axis];
  }
  return universe;
}

void check_fit(const BuiltKind& kind, const SolidFrame& place) {
  const voxel::Box bounds = voxel::bounds(place.universe.lattice());
  const double reach_mm = kind.reach * place.radius_mm;
  for (int axis = 0; axis < 3; ++axis)
    if (place.centre_mm[axis] - reach_mm < bounds.low_mm[axis] ||
        place.centre_mm[axis] + reach_mm > bounds.high_mm[axis])
      throw voxel::InvalidInput("a " + std::string(kind.said.name) + " of radius " +
                                std::to_string(place.radius_mm) +
                                " mm does not fit its universe: make the radius smaller");
}

}  // namespace

const std::vector<SolidPhantomKind>& solid_phantom_kinds() {
  static const std::vector<SolidPhantomKind> said = [] {
    std::vector<SolidPhantomKind> all;
    for (const BuiltKind& kind : built_kinds()) all.push_back(kind.said);
    return all;
  }();
  return said;
}

SolidPhantom solid_phantom(std::string_view kind, const SolidPhantomOptions& options) {
  const auto found = std::find_if(built_kinds().begin(), built_kinds().end(),
                                  [&](const BuiltKind& k) { return k.said.name == kind; });
  if (found == built_kinds().end())
    throw voxel::InvalidInput("there is no solid called " + std::string(kind));
  const voxel::Universe universe = universe_of(options);
  const double radius_voxels = options.radius_voxels.value_or(0.25 * options.voxels);
  if (!(radius_voxels > 0.0) || !std::isfinite(radius_voxels))
    throw voxel::InvalidInput("a solid's radius must be a positive number of voxels");
  if (found->on_lattice && (options.centre_mm != glm::dvec3(0.0) || options.lps_from_axes != glm::dmat3(1.0)))
    throw voxel::InvalidInput(std::string(kind) + " is fixed to the lattice: it cannot be turned or moved");
  if (found->reach == 0.0 && options.radius_voxels)
    throw voxel::InvalidInput(std::string(kind) + " fills its universe and has no radius");
  const double voxel_mm = std::min({options.spacing_mm.x, options.spacing_mm.y, options.spacing_mm.z});
  const SolidFrame place{radius_voxels * voxel_mm, options.centre_mm, options.lps_from_axes, universe};
  check_fit(*found, place);
  return found->build(place);
}

}  // namespace octotomy::verify
