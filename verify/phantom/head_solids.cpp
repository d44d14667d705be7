// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The head, part by part, in LPS millimetres. Proportions follow the usual craniometric means of an adult
// (length 182, breadth 142, bizygomatic breadth 132, upper face 70, bigonial breadth 100 mm); the shapes are
// drawn, not measured. Only the patient's left (x > 0) is described, the right is its reflection.

#include "verify/phantom/head_solids.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "verify/phantom/head_phantom.h"

namespace octotomy::verify {
namespace {

using glm::dvec3;

ImplicitSolid both_sides(const ImplicitSolid& left) {
  return left | mirrored(left);
}

// --- cranium

ImplicitSolid vault(double inset_mm) {
  const ImplicitSolid frontal = ellipsoid({0, -26, 42}, dvec3(54, 61, 55) - inset_mm);
  const ImplicitSolid parietal = ellipsoid({0, 21, 41}, dvec3(71, 73, 66) - inset_mm);
  return blended(frontal, parietal, 26.0);
}

// An orbit is a cone about the line from its apex to the middle of its rim. It is wider than high.
ImplicitSolid orbit_left() {
  const ImplicitSolid cone = tapered_capsule({{13, -33, 12}, 5.0}, {{33.0, -82, 10}, 20.5}, {1.0, 1.0, 0.86});
  const ImplicitSolid opening =
      tapered_capsule({{33.0, -82, 10}, 20.5}, {{37, -100, 9}, 22.0}, {1.0, 1.0, 0.86});
  return cone | opening;
}

ImplicitSolid brain_case() {
  const ImplicitSolid orbits = both_sides(orbit_left());
  const ImplicitSolid petrous = both_sides(tapered_capsule({{56, 12, -8}, 10.0}, {{14, -4, -14}, 6.0}));
  const ImplicitSolid clivus = tapered_capsule({{0, -24, -8}, 11.0}, {{0, 14, -25}, 6.0}, {1.3, 1.0, 1.0});
  const ImplicitSolid inside = ((vault(6.5) - grown(orbits, 4.0)) - petrous) - clivus;
  const ImplicitSolid mastoid = tapered_capsule({{57, 14, -6}, 12.0}, {{51, 11, -32}, 6.5});
  const ImplicitSolid ear_canal = tapered_capsule({{75, 6, -8}, 3.6}, {{48, 6, -8}, 3.0});
  const ImplicitSolid sphenoid = ellipsoid({0, -22, -12}, {17, 20, 13});
  const ImplicitSolid condyle = ellipsoid({13, 22, -28}, {6, 10, 7});
  const ImplicitSolid temporal_line =
      tube({{{50, -64, 18}, 4.0}, {{48, -52, 36}, 2.5}, {{49, -34, 56}, 1.0}}, {0.8, 1, 1});
  const ImplicitSolid temporal_root = tapered_capsule({{62, 0, 0}, 4.0}, {{47, 6, 8}, 9.0});
  ImplicitSolid outside = blended(vault(0.0), both_sides(mastoid), 8.0);
  outside = blended(outside, both_sides(temporal_line | temporal_root), 8.0);
  outside = blended(outside, sphenoid | clivus | both_sides(condyle), 5.0);
  const ImplicitSolid foramen_magnum =
      tapered_capsule({{0, 33, -60}, 15.5}, {{0, 33, 5}, 15.5}, {1.0, 1.2, 1.0});
  return ((outside - inside) - foramen_magnum) - both_sides(ear_canal);
}

ImplicitSolid brow() {
  const ImplicitSolid ridge = tube({{{0, -82, 27}, 6.0},
                                    {{14, -83, 29}, 6.5},
                                    {{30, -79, 31}, 6.0},
                                    {{44, -73, 26}, 5.5},
                                    {{51, -67, 15}, 5.5}});
  return both_sides(ridge);
}

// --- face

ImplicitSolid orbital_rim_left() {
  return tube({{{51, -68, 15}, 5.5},
               {{52, -66, 4}, 5.5},
               {{47, -70, -6}, 5.5},
               {{36, -77, -11}, 4.8},
               {{24, -81, -10}, 4.5},
               {{15, -83, -3}, 4.5},
               {{11, -83, 10}, 4.8},
               {{9, -85, 22}, 6.0}});
}

// The walls of the orbit behind its rim.
ImplicitSolid orbital_cup_left() {
  return grown(orbit_left(), 3.0) & half_space(glm::normalize(dvec3(0.36, -0.93, 0.0)), 79.0);
}

ImplicitSolid zygoma_left() {
  const ImplicitSolid body = ellipsoid({47, -62, -13}, {11, 10, 12}, turned({0, 0, 35}));
  const ImplicitSolid buttress =
      tapered_capsule({{45, -60, -16}, 9.0}, {{31, -54, -34}, 7.0}, {1.0, 0.8, 1.0});
  const ImplicitSolid arch = tube({{{49, -58, -12}, 4.2},
                                   {{58, -46, -13}, 3.4},
                                   {{64, -28, -11}, 2.8},
                                   {{65, -12, -7}, 3.0},
                                   {{61, 2, 0}, 3.6}},
                                  {0.8, 0.8, 1.6});
  return blended(blended(body, buttress, 6.0), arch, 4.0);
}

ImplicitSolid nasal_bones() {
  const ImplicitSolid bridge = tube({{{2.8, -85, 22}, 5.0}, {{2.8, -89, 10}, 3.8}, {{3.0, -97, -4}, 3.0}});
  const ImplicitSolid side = tube({{{8, -83, 18}, 4.2}, {{8.5, -87, 6}, 3.8}, {{10, -90, -5}, 3.2}});
  const ImplicitSolid margin =
      tube({{{12, -87, -4}, 3.6}, {{15.5, -84, -16}, 3.8}, {{15, -83, -26}, 4.2}, {{8, -84, -33}, 3.8}});
  return both_sides(blended(blended(bridge, side, 3.0), margin, 2.0));
}

// Dental arches are parabolas y = front + x^2 / width; the last molar is 27 mm beside the middle.
constexpr double arch_width_mm = 17.5;

double arch_y(double front_mm, double x_mm) {
  return front_mm + x_mm * x_mm / arch_width_mm;
}

ImplicitSolid swept_arch_left(double front_mm, double z_mm, double radius_mm, double height,
                              double reach_mm) {
  std::vector<Station> stations;
  for (int i = 0; i <= 6; ++i) {
    const double x_mm = reach_mm * i / 6.0;
    stations.push_back({{x_mm, arch_y(front_mm, x_mm), z_mm}, radius_mm});
  }
  return tube(stations, {1.0, 1.0, height}, 2);
}

// The nasal cavity with its lining, which opens in front as the piriform aperture: narrow above, wide below.
// air() subtracts the lining.
ImplicitSolid piriform() {
  const ImplicitSolid upper = tapered_capsule({{0, -96, -9}, 5.0}, {{0, -90, -21}, 11.8}, {1.0, 1.4, 1.0});
  const ImplicitSolid lower = tapered_capsule({{0, -92, -21}, 11.8}, {{0, -30, -21}, 12.0}, {1.0, 1.0, 0.85});
  const ImplicitSolid above = tapered_capsule({{0, -78, -8}, 5.0}, {{0, -40, -8}, 7.0}, {1.0, 1.0, 1.4});
  return upper | lower | above;
}

ImplicitSolid septum() {
  return rounded_box({0, -56, -14}, {1.4, 23, 20}, 1.0);
}

ImplicitSolid sinus_left() {
  return ellipsoid({29, -57, -19}, {9.5, 14, 10.5}, turned({0, 0, 15}));
}

ImplicitSolid maxilla() {
  const ImplicitSolid body = ellipsoid({22, -60, -20}, {20, 22, 19}, turned({0, 0, 20}));
  const ImplicitSolid alveolus = swept_arch_left(-82.0, -37.5, 6.2, 1.45, 27.5);
  const ImplicitSolid canine_ridge = tapered_capsule({{16, -80, -18}, 3.5}, {{16.5, -69, -42}, 5.5});
  // The palate is inclined, as in life. If its flat faces lay along a scan's slices, their error would be
  // coherent: up to half a voxel times their area.
  const ImplicitSolid palate = rounded_box({0, -57, -33.5}, {24, 24, 2.2}, 2.0, turned({6, 0, 0}));
  const ImplicitSolid pterygoid =
      tapered_capsule({{15, -26, -14}, 5.0}, {{18, -31, -42}, 4.2}, {0.8, 1.3, 1.0});
  const ImplicitSolid spine = tapered_capsule({{0, -81, -33}, 3.6}, {{0, -87.5, -31.5}, 1.8});
  ImplicitSolid left = blended(blended(body, alveolus, 8.0), canine_ridge, 4.0);
  left = blended(left, pterygoid, 4.0) - sinus_left();
  return both_sides(left) | palate | spine;
}

// --- teeth

struct ToothShape {
  double width_mm;   // along the arch
  double depth_mm;   // across the arch, at the crown's middle
  double length_mm;  // of the root
};

// Crown widths after the usual tables of dental anatomy (Wheeler), central incisor to second molar.
constexpr std::array<ToothShape, 7> upper_teeth{{{8.6, 6.6, 13},
                                                 {6.8, 6.2, 13},
                                                 {7.6, 7.6, 16},
                                                 {7.0, 8.6, 13},
                                                 {6.8, 8.8, 13},
                                                 {10.2, 10.4, 12},
                                                 {9.4, 10.2, 11}}};
constexpr std::array<ToothShape, 7> lower_teeth{{{5.6, 6.0, 12},
                                                 {6.0, 6.2, 13},
                                                 {7.0, 7.4, 15},
                                                 {7.2, 7.8, 14},
                                                 {7.4, 8.2, 14},
                                                 {11.2, 9.8, 13},
                                                 {10.6, 9.6, 12}}};

// Teeth side by side from the median line; `up` is +1 if the roots point to the crown of the head. All
// crowns reach bite_mm, so that the rows are level and 2.4 mm apart: the jaws at rest.
ImplicitSolid tooth_row_left(const std::array<ToothShape, 7>& shapes, double front_mm, double bite_mm,
                             double up) {
  ImplicitSolid row;
  double x_mm = 0.0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ToothShape& shape = shapes[i];
    // Moves half a tooth's width along the arch; called before and after the tooth is added.
    const auto advance = [&] {
      const double slope = 2.0 * x_mm / arch_width_mm;
      x_mm += 0.5 * shape.width_mm / std::sqrt(1.0 + slope * slope);
    };
    advance();
    const double degrees = glm::degrees(std::atan(2.0 * x_mm / arch_width_mm));
    const bool molar = i >= 5;
    const double crown_mm = molar ? 9.5 : 11.0;
    const dvec3 foot(x_mm, arch_y(front_mm, x_mm), bite_mm + up * crown_mm);
    const dvec3 half(0.5 * shape.width_mm - 0.15, 0.5 * shape.depth_mm, 0.5 * crown_mm + 1.0);
    const dvec3 centre = foot - dvec3(0, 0, up * (half.z - 2.0));
    const double rounding_mm = std::min(half.x, half.y) - (molar ? 1.5 : 0.3);
    const ImplicitSolid crown =
        rounded_box(centre, half, std::min(rounding_mm, 2.6), turned({0, 0, degrees}));
    const double girth_mm = 0.42 * std::min(shape.width_mm, shape.depth_mm);
    const ImplicitSolid root = tapered_capsule(
        {foot, girth_mm}, {foot + dvec3(0, molar ? 1.0 : 2.0, up * (shape.length_mm - 2.0)), 1.9});
    row = std::move(row) | blended(crown, root, 2.0);
    advance();
  }
  return row;
}

ImplicitSolid upper_row() {
  return both_sides(tooth_row_left(upper_teeth, -82.5, -58.0, 1.0));
}
ImplicitSolid lower_row() {
  return both_sides(tooth_row_left(lower_teeth, -80.5, -60.4, -1.0));
}

// --- mandible

ImplicitSolid exostosis() {
  return ellipsoid({53.5, -17, -70}, {5.5, 7, 6});
}

ImplicitSolid jaw() {
  const ImplicitSolid condyle = ellipsoid({50, -4, -13.5}, {8.5, 4.8, 5}, turned({0, 0, -12}));
  const ImplicitSolid posterior =
      tube({{{50, -5, -16}, 4.0}, {{50.5, -9, -30}, 4.2}, {{49.5, -13, -54}, 4.6}, {{47.5, -21, -74}, 5.0}});
  const ImplicitSolid coronoid =
      tube({{{49, -36, -17}, 2.2}, {{48.5, -38, -32}, 3.6}, {{46, -44, -60}, 4.2}});
  const ImplicitSolid ramus = rounded_box({48.5, -26, -52}, {3.4, 14, 22}, 3.0, turned({-10, -3, 0}));
  const ImplicitSolid body = tube({{{48, -22, -69}, 4.8},
                                   {{44.5, -38, -74}, 5.4},
                                   {{38, -55, -80}, 5.4},
                                   {{27, -70, -84.5}, 5.6},
                                   {{13, -79, -86.5}, 6.0},
                                   {{0, -81, -87}, 6.0}},
                                  {1.0, 1.0, 2.2});
  const ImplicitSolid alveolus = swept_arch_left(-80.0, -78.0, 5.8, 1.5, 27.0);
  const ImplicitSolid chin = ellipsoid({0, -85, -95}, {15, 6.5, 7});
  const ImplicitSolid tubercle = ellipsoid({11, -84.5, -97}, {8, 6, 5});
  ImplicitSolid left = blended(blended(posterior, ramus, 5.0), coronoid, 5.0);
  left = blended(blended(left, condyle, 3.0), blended(body, alveolus, 6.0), 6.0);
  return blended(both_sides(left), chin | both_sides(tubercle), 6.0) | exostosis();
}

// --- neck

ImplicitSolid spine() {
  const ImplicitSolid lateral = ellipsoid({19, 24, -41}, {8, 8, 6});
  const ImplicitSolid ring = tube({{{0, 12, -41}, 4.0},
                                   {{12, 15, -41}, 4.0},
                                   {{21, 25, -41}, 5.0},
                                   {{15, 41, -42}, 3.6},
                                   {{0, 48, -43}, 4.2}});
  ImplicitSolid form = both_sides(lateral | ring) | tapered_capsule({{0, 20, -60}, 5.5}, {{0, 20, -40}, 3.6});
  for (int i = 0; i < 4; ++i) {
    const double z_mm = -59.0 - 17.5 * i;
    const double y_mm = 21.0 + i;
    const ImplicitSolid body = rounded_box({0, y_mm, z_mm}, {10, 8, 6.2}, 2.5);
    const ImplicitSolid arch = tube({{{8, y_mm + 3, z_mm}, 3.5},
                                     {{19, y_mm + 7, z_mm}, 4.5},
                                     {{15, y_mm + 20, z_mm - 2}, 3.0},
                                     {{0, y_mm + 29, z_mm - 5}, 3.5}});
    const ImplicitSolid process =
        tapered_capsule({{0, y_mm + 28, z_mm - 5}, 3.5}, {{0, y_mm + 40, z_mm - 9}, 3.0});
    form = std::move(form) | body | both_sides(arch) | process;
  }
  return form;
}

// --- soft tissue and air

ImplicitSolid ear_left() {
  const glm::dmat3 turn = turned({-12, 0, 22});
  const ImplicitSolid shell = ellipsoid({78, 10, -4}, {6.5, 18, 31}, turn);
  const ImplicitSolid hollow = ellipsoid({84, 6, -4}, {7, 12, 22}, turn);
  return carved(shell, hollow, 3.0) | ellipsoid({78, 3, -30}, {4.5, 7, 9}, turn);
}

ImplicitSolid nose() {
  const ImplicitSolid bridge =
      tube({{{0, -90, 20}, 8.0}, {{0, -98, 4}, 8.0}, {{0, -107, -14}, 8.0}, {{0, -110, -22}, 7.5}});
  const ImplicitSolid wing = ellipsoid({11.5, -98, -25}, {6, 10, 7.5});
  return blended(blended(bridge, both_sides(wing), 9.0), ellipsoid({0, -102, -28}, {6, 8, 5}), 6.0);
}

ImplicitSolid lips() {
  const ImplicitSolid upper =
      tube({{{0, -97, -54.5}, 4.2}, {{5, -97.5, -54}, 4.2}, {{14, -92, -56.5}, 3.6}, {{24, -83, -59}, 2.4}});
  const ImplicitSolid lower = tube(
      {{{0, -95.5, -63.5}, 4.8}, {{8, -94.5, -63.5}, 4.6}, {{16, -89.5, -62}, 3.6}, {{24, -83, -59}, 2.4}});
  return both_sides(upper | lower);
}

ImplicitSolid skin() {
  ImplicitSolid head =
      blended(ellipsoid({0, -26, 42}, {60, 67, 61}), ellipsoid({0, 21, 41}, {77, 79, 72}), 26.0);
  const ImplicitSolid midface = ellipsoid({0, -38, -16}, {71, 57, 50});
  const ImplicitSolid jaws = ellipsoid({0, -42, -62}, {58, 53, 42});
  const ImplicitSolid angle =
      tube({{{49, -16, -62}, 13.5}, {{40, -48, -82}, 11.0}, {{24, -72, -89}, 12.0}, {{0, -81, -91}, 14.0}});
  const ImplicitSolid chin = ellipsoid({0, -88, -93}, {15, 11, 13});
  const ImplicitSolid temple = ellipsoid({52, 2, -14}, {22, 36, 36});
  const ImplicitSolid neck = tapered_capsule({{0, 16, -30}, 54.0}, {{0, 24, -190}, 58.0}, {1.0, 0.98, 1.0});
  head = blended(blended(head, midface, 24.0), jaws, 20.0);
  head = blended(blended(head, both_sides(angle | temple), 22.0), chin, 12.0);
  head = blended(head, neck, 22.0);
  const ImplicitSolid brows =
      both_sides(tube({{{4, -86, 29}, 6.0}, {{24, -85, 33}, 6.0}, {{46, -73, 27}, 6.5}}));
  head = blended(head, brows, 16.0);
  head = carved(head, both_sides(ellipsoid({33, -99, 9}, {18, 12, 11})), 16.0);
  head = blended(head, both_sides(ellipsoid({32, -76.5, 9}, {15, 13.5, 12})), 6.0);
  head =
      carved(head, both_sides(tube({{{18, -86, 7}, 0.9}, {{32, -90.5, 5}, 0.9}, {{45, -84, 8}, 0.9}})), 1.5);
  head = blended(head, nose(), 12.0);
  head = blended(head, lips(), 5.0);
  head = blended(head, both_sides(ear_left()), 4.0);
  return head & half_space({0, 0, -1}, 132.0);
}

// The lining of the nasal cavity is 2 mm on every wall and more beside the septum and the conchae.
ImplicitSolid air() {
  const ImplicitSolid concha =
      tube({{{10.5, -72, -24}, 4.2}, {{9.5, -56, -25}, 4.6}, {{9.5, -38, -24}, 4.0}}, {0.7, 1.0, 1.1});
  ImplicitSolid nasal = grown(piriform(), -2.0) & half_space({0, -1, 0}, 92.0);
  nasal = (nasal - grown(septum(), 2.2)) - both_sides(concha);
  const ImplicitSolid nostril = tapered_capsule({{6.5, -102, -36}, 3.6}, {{6.5, -88, -22}, 4.0});
  const ImplicitSolid pharynx =
      tube({{{0, -28, -20}, 9.0}, {{0, -12, -34}, 8.0}, {{0, -6, -60}, 7.0}, {{0, -4, -118}, 7.5}},
           {1.3, 0.8, 1.0});
  return nasal | both_sides(nostril | grown(sinus_left(), -2.0)) | pharynx;
}

ImplicitSolid headrest() {
  const auto drum = [](double radius_mm) {
    return tapered_capsule({{0, 2, -420}, radius_mm}, {{0, 2, 480}, radius_mm});
  };
  return ((drum(112.0) - drum(104.0)) & half_space({0, -1, 0}, -60.0)) &
         rounded_box({0, 60, 20}, {96, 66, 84}, 6.0);
}

HeadSolids build() {
  HeadSolids head;
  head.air = air();
  head.skin = skin();
  // Bone keeps a distance from the outside and from the airways. A form's value never exceeds the distance to
  // its surface, so the soft tissue between them is at least as thick as the distance passed to `grown`.
  const ImplicitSolid lined = grown(head.skin, -3.0) - grown(head.air, 2.0);
  const ImplicitSolid orbits = both_sides(orbit_left());
  ImplicitSolid face = blended(brow(), both_sides(orbital_rim_left()), 3.0);
  face = blended(face, nasal_bones(), 3.0);
  face = blended(face, both_sides(zygoma_left()), 5.0);
  face = blended(face, maxilla(), 5.0);
  ImplicitSolid skull = blended(brain_case(), both_sides(orbital_cup_left()), 2.0);
  skull = blended(skull, face, 5.0);
  skull = ((std::move(skull) - orbits) - piriform()) | septum();
  head.teeth = (upper_row() | lower_row()) & lined;
  head.mandible = (jaw() | lower_row()) & lined;
  head.bone = (skull | upper_row() | jaw() | lower_row() | spine()) & lined;
  head.tooth_core = grown(head.teeth, -2.0);
  head.headrest = headrest();
  return head;
}

}  // namespace

signed char place(double value, double radius_mm) {
  if (std::abs(value) <= radius_mm * 1.000001) return -1;
  return value < 0.0 ? 1 : 0;
}

const HeadSolids& head_solids() {
  static const HeadSolids forms = build();
  return forms;
}

const HeadBricks& HeadBricks::instance() {
  static const HeadBricks bricks;
  return bricks;
}

HeadBricks::HeadBricks() {
  const HeadSolids& head = head_solids();
  whole_.places.fill(-1);
  whole_.steps = {head.skin.steps(),     head.bone.steps(),     head.tooth_core.steps(), head.air.steps(),
                  head.headrest.steps(), head.mandible.steps(), head.teeth.steps()};
  const voxel::Box box = head_bounds();
  low_mm_ = box.low_mm;
  dims_ = glm::ivec3(glm::ceil((box.high_mm - box.low_mm) / edge_mm));
  bricks_.resize(static_cast<std::size_t>(dims_.x) * static_cast<std::size_t>(dims_.y) *
                 static_cast<std::size_t>(dims_.z));
  const double radius_mm = 0.5 * edge_mm * std::sqrt(3.0) + margin_mm;
  tbb::parallel_for(std::size_t{0}, bricks_.size(), [&](std::size_t i) {
    const auto brick = static_cast<int>(i);
    const glm::ivec3 at(brick % dims_.x, brick / dims_.x % dims_.y, brick / (dims_.x * dims_.y));
    const dvec3 centre_mm = low_mm_ + (dvec3(at) + 0.5) * edge_mm;
    // Pruning reserves memory for all steps and leaves few of them, so a copy of the right size is stored.
    ImplicitSolid::Steps pruned;
    for (std::size_t field = 0; field < field_count; ++field) {
      bricks_[i].places[field] = place(prune(whole_.steps[field], centre_mm, radius_mm, pruned), radius_mm);
      bricks_[i].steps[field] = ImplicitSolid::Steps(pruned.begin(), pruned.end());
    }
  });
}

const HeadBricks::Brick& HeadBricks::at(const glm::dvec3& p_mm, double radius_mm) const {
  const dvec3 q = (p_mm - low_mm_) / edge_mm;
  if (radius_mm > margin_mm ||
      !(q.x >= 0.0 && q.y >= 0.0 && q.z >= 0.0 && q.x < dims_.x && q.y < dims_.y && q.z < dims_.z))
    return whole_;
  const glm::ivec3 at(q);
  const int brick = (at.z * dims_.y + at.y) * dims_.x + at.x;
  return bricks_[static_cast<std::size_t>(brick)];
}

}  // namespace octotomy::verify
