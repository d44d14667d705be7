// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/brep/shapes.h"

// Meshes as other programs write them, each spoiled in one way, or in several ways that occur together.
namespace octotomy::brep::shapes {

struct BadMesh {
  std::string name;
  Triangles triangles;
  /// The volume of the intended solid, mm3; none if nothing is enclosed, and a solid must be refused.
  std::optional<double> volume_mm3;
  bool any_volume = false;  ///< no volume is meant, but closing the holes makes one
};

inline Triangles without(Triangles t, std::vector<std::size_t> faces) {
  std::sort(faces.rbegin(), faces.rend());
  for (const std::size_t f : faces) t.faces.erase(t.faces.begin() + static_cast<std::ptrdiff_t>(f));
  return t;
}

/// Each triangle with points of its own, as STL has them.
inline Triangles unwelded(const Triangles& t, double noise = 0.0) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-noise, noise);
  Triangles soup;
  for (const auto& face : t.faces) {
    const auto first = static_cast<std::uint32_t>(soup.points_mm.size());
    for (const std::uint32_t v : face)
      soup.points_mm.push_back(t.points_mm[v] + (noise > 0.0
                                                     ? glm::dvec3(any(random), any(random), any(random))
                                                     : glm::dvec3(0.0)));
    soup.faces.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// Merges points that coincide.
inline Triangles welded(Triangles t) {
  std::map<std::array<double, 3>, std::uint32_t> first;
  const auto place = [&](std::size_t v) -> std::array<double, 3> {
    return {t.points_mm[v].x, t.points_mm[v].y, t.points_mm[v].z};
  };
  for (std::size_t v = 0; v < t.points_mm.size(); ++v)
    first.try_emplace(place(v), static_cast<std::uint32_t>(v));
  for (auto& face : t.faces)
    for (std::uint32_t& v : face) v = first.at(place(v));
  return t;
}

inline Triangles moved(Triangles t, const glm::dvec3& by) {
  for (glm::dvec3& p : t.points_mm) p += by;
  return t;
}

inline Triangles scaled(Triangles t, const glm::dvec3& by) {
  for (glm::dvec3& p : t.points_mm) p *= by;
  return t;
}

/// A strip with one or several half turns.
inline Triangles strip(int half_turns, int around) {
  Triangles t;
  for (int i = 0; i < around; ++i) {
    const double u = 2 * std::numbers::pi * i / around, turn = 0.5 * half_turns * u;
    for (const double across : {-2.0, 2.0})
      t.points_mm.emplace_back((10 + across * std::cos(turn)) * std::cos(u),
                               (10 + across * std::cos(turn)) * std::sin(u), across * std::sin(turn));
  }
  for (int i = 0; i < around; ++i) {
    const bool last = i + 1 == around, crossed = last && half_turns % 2 == 1;
    const auto n = static_cast<std::uint32_t>(2 * i), next = static_cast<std::uint32_t>(last ? 0 : 2 * i + 2);
    const std::uint32_t low = next + (crossed ? 1 : 0), high = next + (crossed ? 0 : 1);
    t.faces.push_back({n, low, high});
    t.faces.push_back({n, high, n + 1});
  }
  return t;
}

/// A box whose top is cut into n by n squares, with a point moved.
inline Triangles sheet(int n, double side) {
  Triangles t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) t.points_mm.emplace_back(side * i / n, side * j / n, 0.0);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      t.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return t;
}

/// At least forty kinds.
inline std::vector<BadMesh> bad_meshes() {
  const Triangles ball = sphere({1, 2, 3}, 5, 3), small = sphere({1, 2, 3}, 2.5, 2),
                  ring = torus(10, 3, 48, 24);
  const Triangles cube = box({0, 0, 0}, {10, 10, 10}), far_ball = moved(ball, {20, 0, 0});
  const double v_ball = 4.0 / 3 * std::numbers::pi * 125, v_small = v_ball / 8;
  const double v_ring = 2 * std::numbers::pi * std::numbers::pi * 10 * 9;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<BadMesh> list;
  const auto add = [&](const std::string& name, Triangles t, std::optional<double> volume) {
    list.push_back({name, std::move(t), volume, false});
  };
  const auto with = [](Triangles t, const auto& spoil) {
    spoil(t);
    return t;
  };

  // Edges and points where too many triangles meet.
  add("fin",
      with(ball,
           [](Triangles& t) {
             t.points_mm.emplace_back(1, 2, 12);
             t.faces.push_back(
                 {t.faces[5][0], t.faces[5][1], static_cast<std::uint32_t>(t.points_mm.size() - 1)});
           }),
      v_ball);
  add("inner_wall",
      with(cube,
           [](Triangles& t) {
             t.faces.push_back({0, 3, 7});
             t.faces.push_back({0, 7, 4});
           }),
      1000.0);
  add("cubes_along_an_edge", welded(together(cube, box({10, 10, 0}, {20, 20, 10}))), 2000.0);
  add("cubes_at_a_corner", welded(together(cube, box({10, 10, 10}, {20, 20, 20}))), 2000.0);
  add("cubes_sharing_a_face", welded(together(cube, box({10, 0, 0}, {20, 10, 10}))), 2000.0);
  add("cubes_touching_unwelded", together(cube, box({10, 0, 0}, {20, 10, 10})), 2000.0);
  add("four_cubes_about_an_edge",
      welded(together(together(cube, box({10, 10, 0}, {20, 20, 10})), box({0, 10, 10}, {10, 20, 20}))),
      3000.0);
  add("vertex_of_two_fans",
      with(together(ball, moved(ball, {0, 0, 30})),
           [](Triangles& t) {
             const auto half = static_cast<std::uint32_t>(t.points_mm.size() / 2);
             for (auto& face : t.faces)
               for (std::uint32_t& v : face) v = v == half ? 0 : v;
             t.points_mm[0] = {1, 2, 18};
           }),
      std::nullopt);
  list.back().volume_mm3 = 2 * v_ball;
  add("pinched_ring",
      with(ring,
           [](Triangles& t) {
             for (std::uint32_t j = 0; j < 24; ++j) t.points_mm[j] = t.points_mm[0];
             t = welded(t);
           }),
      0.94 * v_ring);

  // Open ones.
  add("one_triangle_lost", without(ball, {17}), v_ball);
  add("many_triangles_lost", without(ball, {3, 90, 91, 200, 201, 333, 500, 720, 1000}), v_ball);
  add("large_hole",
      with(ball,
           [](Triangles& t) {
             std::erase_if(t.faces, [&](const auto& f) { return t.points_mm[f[0]].z > 6; });
           }),
      0.93 * v_ball);
  add("half_a_ball",
      with(ball,
           [](Triangles& t) {
             std::erase_if(t.faces, [&](const auto& f) { return t.points_mm[f[0]].z > 3; });
           }),
      0.6 * v_ball);
  add("box_without_lid", without(cube, {2, 3}), 1000.0);
  add("tube_without_ends",
      with(ring,
           [](Triangles& t) {
             std::erase_if(t.faces, [&](const auto& f) { return t.points_mm[f[0]].y < 0; });
           }),
      0.5 * v_ring);
  add("slit",
      with(ball,
           [](Triangles& t) {
             const std::uint32_t v = t.faces[7][0];
             t.points_mm.push_back(t.points_mm[v]);
             t.faces[7][0] = static_cast<std::uint32_t>(t.points_mm.size() - 1);
           }),
      v_ball);
  add("t_junctions",
      with(cube,
           [](Triangles& t) {
             t.points_mm.emplace_back(10, 5, 0);
             t.faces[1] = {0, 3, 8};  // of the bottom alone
             t.faces.push_back({0, 8, 1});
           }),
      1000.0);

  // Unwelded ones, duplicates and contrary ones.
  add("unwelded", unwelded(ball), v_ball);
  add("unwelded_with_noise", unwelded(ball, 1e-6), v_ball);
  add("half_unwelded",
      with(unwelded(ball),
           [](Triangles& t) {
             for (std::size_t f = 0; f < t.faces.size() / 2; ++f)
               for (std::uint32_t& v : t.faces[f])
                 for (std::uint32_t w = 0; w < v; ++w)
                   if (t.points_mm[w] == t.points_mm[v]) v = w;
           }),
      v_ball);
  add("a_triangle_twice", with(ball, [](Triangles& t) { t.faces.push_back(t.faces[9]); }), v_ball);
  add("all_triangles_twice",
      with(ball,
           [](Triangles& t) {
             const auto faces = t.faces;
             t.faces.insert(t.faces.end(), faces.begin(), faces.end());
           }),
      v_ball);
  add("a_triangle_and_its_reverse",
      with(ball,
           [](Triangles& t) {
             t.faces.push_back({t.faces[9][0], t.faces[9][2], t.faces[9][1]});
           }),
      v_ball);
  add("some_reversed",
      with(ball,
           [](Triangles& t) {
             for (std::size_t f = 0; f < t.faces.size(); f += 3) std::swap(t.faces[f][0], t.faces[f][1]);
           }),
      v_ball);
  add("unwelded_and_some_reversed",
      with(unwelded(ball),
           [](Triangles& t) {
             for (std::size_t f = 0; f < t.faces.size(); f += 3) std::swap(t.faces[f][0], t.faces[f][1]);
           }),
      v_ball);
  add("inside_out", inside_out(ball), v_ball);
  add("one_of_two_inside_out", together(inside_out(ball), far_ball), 2 * v_ball);

  // Shells in shells.
  add("cavity", together(ball, inside_out(small)), v_ball - v_small);
  // Where the outermost shells face outward, one within that faces outward too is a body: the winding says so.
  add("outward_within_outward", together(ball, small), v_ball);
  add("cavity_inside_out_whole", together(inside_out(ball), small), v_ball - v_small);
  add("three_outward", together(together(sphere({1, 2, 3}, 8, 3), ball), small), v_ball / 125 * 512);
  add("three_by_turns", together(together(sphere({1, 2, 3}, 8, 3), inside_out(ball)), small),
      v_ball / 125 * 512 - v_ball + v_small);
  add("cavity_that_touches", together(ball, inside_out(sphere({1, 2, 5.4}, 2.5, 2))), v_ball - v_small);
  add("same_shell_twice", together(ball, ball), v_ball);
  add("shell_and_its_reverse", together(ball, inside_out(ball)), v_ball);

  // Crossing ones.
  add("two_balls_crossing", together(ball, moved(ball, {6, 0.3, 0.2})), 952.0);
  add("ring_through_ring", together(ring, moved(torus(10, 3, 48, 24), {5, 0.1, 1})), 2900.0);
  add("folded_over",
      with(ball, [](Triangles& t) { t.points_mm[12] += 1.2 * (glm::dvec3(1, 2, 3) - t.points_mm[12]); }),
      0.985 * v_ball);
  add("spike_through_the_far_side",
      with(ball,
           [](Triangles& t) {
             t.points_mm[12] = 2.0 * glm::dvec3(1, 2, 3) - 1.3 * (t.points_mm[12] - glm::dvec3(1, 2, 3)) -
                               glm::dvec3(1, 2, 3);
           }),
      0.98 * v_ball);
  add(
      "many_balls_in_a_heap",
      [&] {
        Triangles heap;
        std::mt19937_64 random(4);
        std::uniform_real_distribution<double> any(-6, 6);
        for (int k = 0; k < 12; ++k)
          heap = together(heap, sphere({any(random), any(random), any(random)}, 4, 2));
        return heap;
      }(),
      2382.0);
  add("fused_with_a_wall", together(cube, moved(sheet(8, 12.0), {-1, -1, 5})), 1000.0);

  // Flat, thin, twisted and empty ones.
  add("moebius", strip(1, 40), std::nullopt);
  list.back().any_volume = true;
  add("twisted_strip", strip(2, 40), std::nullopt);
  list.back().any_volume = true;
  add("flat_sheet", sheet(10, 10), std::nullopt);
  add("sheet_and_its_reverse", welded(together(sheet(10, 10), inside_out(sheet(10, 10)))), std::nullopt);
  add("one_triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, std::nullopt);
  add("no_triangles", {{{0, 0, 0}, {1, 0, 0}}, {}}, std::nullopt);
  add("triangles_without_area", {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 2, 3}}},
      std::nullopt);
  add("slivers",
      with(ball,
           [](Triangles& t) {
             for (std::size_t f = 0; f < 40; ++f) {
               const auto face = t.faces[f];
               t.points_mm.push_back(0.5 * t.points_mm[face[0]] + 0.5 * t.points_mm[face[1]]);
               const auto m = static_cast<std::uint32_t>(t.points_mm.size() - 1);
               t.faces.push_back({face[0], face[1], m});
               t.faces[f] = {face[0], m, face[2]};
               t.faces.push_back({m, face[1], face[2]});
             }
           }),
      v_ball);
  add("triangle_with_a_point_twice", with(ball, [](Triangles& t) { t.faces.push_back({3, 3, 8}); }), v_ball);
  add("thin_plate", box({0, 0, 0}, {30, 30, 1e-4}), 30 * 30 * 1e-4);

  // Numbers.
  add("not_a_number", with(ball, [&](Triangles& t) { t.points_mm[12].y = nan; }), v_ball);
  add("infinite",
      with(ball, [](Triangles& t) { t.points_mm[12].x = std::numeric_limits<double>::infinity(); }), v_ball);
  add("isolated_points",
      with(ball,
           [](Triangles& t) {
             t.points_mm.insert(t.points_mm.end(), {{50, 0, 0}, {0, 1e9, 0}});
           }),
      v_ball);
  add("isolated_points_not_a_number",
      with(ball, [&](Triangles& t) { t.points_mm.emplace_back(nan, nan, nan); }), v_ball);
  add("far_from_the_origin", moved(without(ball, {5}), {1e7, -1e7, 1e7}), v_ball);
  add("huge", scaled(without(ball, {5}), glm::dvec3(1e6)), 1e18 * v_ball);
  add("tiny", scaled(without(ball, {5}), glm::dvec3(1e-6)), 1e-18 * v_ball);
  add("stretched", scaled(without(ball, {5}), {100, 1, 0.1}), 10 * v_ball);
  add("a_hair_beside_it", together(ball, {{{9, 9, 9}, {9, 9, 10}, {9.001, 9, 9}}, {{0, 1, 2}}}), v_ball);
  add("floating_sheet_beside_it", together(ball, moved(sheet(6, 4), {9, 9, 9})), v_ball);
  add("all_at_once",
      with(unwelded(together(ball, inside_out(far_ball))),
           [](Triangles& t) {
             t = without(t, {4, 700, 1500});
             t.faces.push_back(t.faces[80]);
             t.faces.push_back({t.faces[81][0], t.faces[81][2], t.faces[81][1]});
             std::swap(t.faces[300][0], t.faces[300][1]);
           }),
      2 * v_ball);
  return list;
}

}  // namespace octotomy::brep::shapes
