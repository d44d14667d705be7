// SPDX-License-Identifier: AGPL-3.0-or-later
// Booleans, measures and fewer triangles of meshes, and the same work in CGAL and OpenMesh called plainly and
// in Manifold.
#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "brep/measure/gap.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/measure.h"
#include "brep/shape/decimate.h"
#include "brep/shape/offset.h"
#include "convert/surface/isosurface.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/manifold_peer.h"
#include "tests/bench/subjects.h"
#include "tests/brep/shape/plain_decimation.h"
#include "tests/brep/shapes.h"
#if defined(OCTOTOMY_HAS_CGAL)
#include "tests/bench/cgal_peer.h"
#endif

namespace octotomy::bench {
namespace {

struct Pair {
  brep::Triangles a, b;
  brep::Operation operation = brep::Operation::Union;
};

/// A ball of unit radius with 2 * rings * (rings - 1) triangles, turned so that no part of it lies along an
/// axis.
brep::Triangles ball(const glm::dvec3& centre, std::uint32_t rings) {
  brep::Triangles t;
  const glm::dvec3 pole = glm::normalize(glm::dvec3(0.3, 0.5, 0.8));
  const glm::dvec3 side = glm::normalize(glm::cross(pole, glm::dvec3(1, 0, 0))),
                   third = glm::cross(pole, side);
  t.points_mm = {centre + pole, centre - pole};
  for (std::uint32_t ring = 1; ring < rings; ++ring)
    for (std::uint32_t i = 0; i < rings; ++i) {
      const double polar = M_PI * ring / rings, around = 2.0 * M_PI * (i + 0.5 * ring) / rings;
      t.points_mm.push_back(centre + std::cos(polar) * pole +
                            std::sin(polar) * (std::cos(around) * side + std::sin(around) * third));
    }
  const auto point = [&](std::uint32_t ring, std::uint32_t i) { return 2 + (ring - 1) * rings + i % rings; };
  for (std::uint32_t i = 0; i < rings; ++i) {
    t.faces.push_back({0, point(1, i), point(1, i + 1)});
    for (std::uint32_t ring = 1; ring + 1 < rings; ++ring) {
      t.faces.push_back({point(ring, i), point(ring + 1, i), point(ring, i + 1)});
      t.faces.push_back({point(ring, i + 1), point(ring + 1, i), point(ring + 1, i + 1)});
    }
    t.faces.push_back({1, point(rings - 1, i + 1), point(rings - 1, i)});
  }
  return t;
}

/// Two balls, each cut by the other along a circle; `rings` squared times two triangles each.
Pair balls(std::uint32_t rings) {
  return {ball({0, 0, 0}, rings), ball({0.71, 0.33, 0.27}, rings), brep::Operation::Union};
}

/// The head phantom's bone minus a box that contains a piece of its brow.
Pair bone_box(int side) {
  return {convert::isosurface(grey_skull(side), 300.0, std::numeric_limits<double>::infinity()),
          brep::shapes::box({-13.3, -120.1, 11.7}, {31.9, -60.2, 42.3}), brep::Operation::Difference};
}

/// Two balls that almost coincide: every triangle meets some triangles of the other ball.
Pair twins(std::uint32_t rings) {
  return {ball({0, 0, 0}, rings), ball({0.3 / rings, 0.2 / rings, 0.4 / rings}, rings),
          brep::Operation::Union};
}

void run_ours(benchmark::State& state, const Pair& pair) {
  const brep::Solid a = brep::solid_of(pair.a), b = brep::solid_of(pair.b);
  std::size_t faces = 0;
  for (auto _ : state) faces = brep::boolean(a, pair.operation, b).solid.mesh().n_faces();
  state.counters["triangles_in"] = static_cast<double>(a.mesh().n_faces() + b.mesh().n_faces());
  state.counters["triangles_out"] = static_cast<double>(faces);
}

void run_size(benchmark::State& state, const brep::Triangles& triangles) {
  const brep::Mesh mesh = brep::mesh_of(triangles);
  for (auto _ : state) benchmark::DoNotOptimize(brep::size_of(mesh).volume_mm3);
  state.counters["triangles"] = static_cast<double>(mesh.n_faces());
}

void run_gap(benchmark::State& state, const brep::Triangles& a, const brep::Triangles& b) {
  double gap_mm = 0.0;
  for (auto _ : state) gap_mm = brep::gap(a, b).distance_mm;
  state.counters["gap_mm"] = gap_mm;
}

/// The distances of all corners in one direction, as a lower bound for the comparison.
void run_corners(benchmark::State& state, const brep::Triangles& a, const brep::Triangles& b) {
  double gap_mm = 0.0;
  for (auto _ : state) {
    const std::vector<double> distances_mm = brep::SurfaceTree(b).distances_mm(a.points_mm);
    gap_mm = *std::min_element(distances_mm.begin(), distances_mm.end());
  }
  state.counters["gap_mm"] = gap_mm;
}

/// Removes triangles from a ball of unit radius.
template <typename Decimate>
void run_decimate(benchmark::State& state, const Decimate& decimate) {
  const brep::Mesh mesh = brep::mesh_of(ball({0, 0, 0}, 224));
  brep::DecimateOptions options;
  options.max_error_mm = 3e-4;
  options.max_normal_deviation_deg = 15.0;
  for (auto _ : state)
    state.counters["triangles_out"] = static_cast<double>(decimate(mesh, options).n_faces());
}

brep::OffsetOptions half_a_cell_out() {
  return {.by_mm = 0.02, .cell_mm = 0.04};
}

void run_offset(benchmark::State& state, const brep::Triangles& surface) {
  const brep::Solid solid = brep::solid_of(surface);
  solid.tree();
  for (auto _ : state)
    state.counters["triangles_out"] =
        static_cast<double>(brep::offset(solid, half_a_cell_out()).triangles().faces.size());
}

/// The signed distances at the offset's points, computed once: no offset can take less time.
void run_offset_points(benchmark::State& state, const brep::Triangles& surface) {
  const brep::Solid solid = brep::solid_of(surface);
  const std::vector<glm::dvec3> points_mm = brep::offset(solid, half_a_cell_out()).triangles().points_mm;
  for (auto _ : state) {
    std::vector<std::uint32_t> nearest(points_mm.size(), brep::SurfaceTree::unknown_triangle);
    benchmark::DoNotOptimize(solid.tree().signed_distances_mm(points_mm, nearest));
  }
}

#if defined(OCTOTOMY_HAS_CGAL)
void run_cgal(benchmark::State& state, const Pair& pair) {
  const CgalSurface a(pair.a), b(pair.b);
  const auto operation = pair.operation == brep::Operation::Union ? CgalSurface::Operation::Union
                                                                  : CgalSurface::Operation::Difference;
  std::size_t faces = 0;
  for (auto _ : state) {
    state.PauseTiming();
    CgalSurface copy_a = a.copy(), copy_b = b.copy();
    state.ResumeTiming();
    faces = CgalSurface::boolean(copy_a, copy_b, operation);
  }
  state.counters["triangles_out"] = static_cast<double>(faces);
}

void run_cgal_size(benchmark::State& state, const brep::Triangles& triangles) {
  const CgalSurface surface(triangles);
  for (auto _ : state) benchmark::DoNotOptimize(surface.volume_and_area());
}

/// Short segments around a ball's surface, like those that a mesher tests.
void run_segments(benchmark::State& state, std::size_t (SegmentQuestions::*met)(const Segments&) const) {
  const brep::Triangles surface = ball({0, 0, 0}, 224);
  const SegmentQuestions questions(surface);
  Segments segments;
  for (std::size_t i = 0; i < surface.points_mm.size(); ++i) {
    const glm::dvec3 from = surface.points_mm[i] * (0.97 + 0.06 * static_cast<double>(i % 64) / 63.0);
    const auto turn = static_cast<double>(i + 1);
    const glm::dvec3 way(std::sin(turn), std::sin(2.0 * turn), std::sin(3.0 * turn));
    segments.emplace_back(from, from + 0.03 * glm::normalize(way));
  }
  std::size_t count = 0;
  for (auto _ : state) count = (questions.*met)(segments);
  state.counters["met"] = static_cast<double>(count);
  state.counters["segments"] = static_cast<double>(segments.size());
}
#endif

void run_manifold(benchmark::State& state, const Pair& pair) {
  for (auto _ : state) {
    const ManifoldAnswer answer = manifold_boolean(pair.a, pair.b, pair.operation == brep::Operation::Union);
    state.SetIterationTime(answer.seconds);
    state.counters["triangles_out"] = static_cast<double>(answer.triangles);
  }
}

/// Compares only with Manifold, because CGAL would take minutes.
template <typename Make>
void add_large_boolean(const std::string& name, const Make& make) {
  add(name, [=](benchmark::State& state) { run_ours(state, make()); });
  if (manifold_folder().empty()) return;
  benchmark::RegisterBenchmark(("peer/manifold/" + name).c_str(),
                               [=](benchmark::State& state) { run_manifold(state, make()); })
      ->Unit(benchmark::kMicrosecond)
      ->UseManualTime()
      ->Iterations(1);
}

template <typename Make>
void add_boolean(const std::string& name, const Make& make) {
  add_large_boolean(name, make);
#if defined(OCTOTOMY_HAS_CGAL)
  add("peer/cgal/" + name, [=](benchmark::State& state) { run_cgal(state, make()); });
#endif
}

}  // namespace

void register_mesh_boolean() {
  add_boolean("mesh_boolean/spheres/10k", [] { return balls(71); });
  add_boolean("mesh_boolean/spheres/100k", [] { return balls(224); });
  add_large_boolean("mesh_boolean/spheres/1M", [] { return balls(708); });
  add_boolean("mesh_boolean/twin_spheres/10k", [] { return twins(71); });
  add_boolean("mesh_boolean/bone_box/100k", [] { return bone_box(128); });
  add_boolean("mesh_boolean/bone_box/500k", [] { return bone_box(256); });
  // Balls beside each other, and one within another, along which all of it runs.
  const auto scaled = [](brep::Triangles surface, double scale) {
    for (glm::dvec3& p : surface.points_mm) p *= scale;
    return surface;
  };
  add("mesh_measure/gap/beside/500k", [](benchmark::State& state) {
    run_gap(state, ball({0, 0, 0}, 500), ball({2.1, 0.2, 0.1}, 500));
  });
  add("mesh_measure/gap/within/500k", [=](benchmark::State& state) {
    run_gap(state, ball({0, 0, 0}, 500), scaled(ball({0, 0, 0}, 500), 1.02));
  });
  add("mesh_measure/corners/beside/500k", [](benchmark::State& state) {
    run_corners(state, ball({0, 0, 0}, 500), ball({2.1, 0.2, 0.1}, 500));
  });
  add("mesh_shape/decimate/ball/100k", [](benchmark::State& state) { run_decimate(state, brep::decimate); });
  add("peer/openmesh/mesh_shape/decimate/ball/100k",
      [](benchmark::State& state) { run_decimate(state, brep::plain_decimation); });
  add("mesh_shape/offset/ball/100k", [](benchmark::State& state) {
    run_offset(state, ball({0, 0, 0}, 224));
  });
  add("reference/distances/mesh_shape/offset/ball/100k", [](benchmark::State& state) {
    run_offset_points(state, ball({0, 0, 0}, 224));
  });
  add("mesh_measure/size/500k", [](benchmark::State& state) { run_size(state, ball({0, 0, 0}, 500)); });
#if defined(OCTOTOMY_HAS_CGAL)
  add("peer/cgal/mesh_measure/size/500k", [](benchmark::State& state) {
    run_cgal_size(state, ball({0, 0, 0}, 500));
  });
  add("mesh_measure/segments/100k",
      [](benchmark::State& state) { run_segments(state, &SegmentQuestions::met_by_ours); });
  add("peer/cgal/mesh_measure/segments/100k",
      [](benchmark::State& state) { run_segments(state, &SegmentQuestions::met_by_cgal); });
#endif
}

}  // namespace octotomy::bench
