// SPDX-License-Identifier: AGPL-3.0-or-later
// octotomy-growth VOXELS.svg [INPUTS.svg]: how a Boolean's time grows with the resolution of the same
// objects, and what a pass over all voxels would do; how the time of plans and meshes grows with their size.
// Prints the tables that it draws, and the inputs' fitted powers.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "brep/boolean/boolean.h"
#include "planner/plan/evaluate.h"
#include "tests/bench/dense_bits.h"
#include "tests/bench/log_plot.h"
#include "tests/bench/subjects.h"
#include "tests/brep/shapes.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"

namespace {

using octotomy::bench::Curve;
using octotomy::voxel::Expression;
using octotomy::voxel::Octree;

// The median time of a run, from as many runs as take a fifth of a second, at least nine.
double median_us(const std::function<void()>& run) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  const Clock::time_point start = Clock::now();
  while (times.size() < 9 || Clock::now() - start < std::chrono::milliseconds(200)) {
    const Clock::time_point before = Clock::now();
    run();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

struct Subject {
  const char* name;
  Octree (*first)(int side);
  Expression (*second)(int side);
};

Octree ball(int side) {
  return octotomy::voxel::combine(octotomy::bench::universe(side), octotomy::bench::sphere(side, -0.06));
}

Octree created(const Expression& expression, int side) {
  return octotomy::voxel::combine(octotomy::bench::universe(side), expression);
}

const Subject subjects[] = {
    {"ball - ball", ball,
     [](int side) -> Expression { return created(octotomy::bench::sphere(side, 0.06), side); }},
    {"skull - half-space", octotomy::bench::skull,
     [](int side) -> Expression { return created(octotomy::bench::oblique_half_space(side), side); }},
    {"ball turned by 5 degrees", ball,
     [](int side) -> Expression {
       octotomy::voxel::Motion motion;
       motion.degrees = 5.0;
       motion.axis = {1, 0.2, 0.1};
       return ~moved(ball(side), moved_from_still(motion));
     }},
};

void draw(const char* path) {
  octotomy::bench::LogPlot plot{"Cost of a Boolean: powers up to 2 follow the surface, 3 the volume",
                                "voxels a side of the universe",
                                "microseconds",
                                {}};
  for (const Subject& subject : subjects) {
    Curve curve{subject.name, {}};
    for (const int side : {64, 128, 256, 512}) {
      const Octree first = subject.first(side);
      const Expression expression = first - subject.second(side);
      const double us =
          median_us([&] { (void)octotomy::voxel::combine(first.universe(), expression).voxel_count(); });
      curve.points.emplace_back(side, us);
      std::printf("%-28s %5d %12.2f us\n", subject.name, side, us);
    }
    plot.curves.push_back(curve);
  }
  Curve dense{"all voxels as bits", {}};
  for (const int side : {64, 128, 256, 512}) {
    const octotomy::bench::DenseBits bits = octotomy::bench::dense_bits_of(ball(side));
    std::vector<std::uint64_t> result(bits.words.size());
    const double us = median_us([&] {
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = bits.words[i] & ~bits.words[result.size() - 1 - i];
    });
    dense.points.emplace_back(side, us);
    std::printf("%-28s %5d %12.2f us\n", dense.name.c_str(), side, us);
  }
  plot.curves.push_back(dense);
  octotomy::bench::write_svg(plot, path);
}

/// A folder with a scan of a ball, removed at the end.
class BallScan {
 public:
  BallScan() {
    std::string name = (std::filesystem::temp_directory_path() / "octotomy-growth-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be made");
    folder_ = name;
    octotomy::voxel::Scene scene;
    constexpr int side = 64;
    scene.lattice =
        octotomy::voxel::axis_aligned_lattice(glm::ivec3(side), glm::dvec3(2.0), glm::dvec3(-63.0));
    octotomy::voxel::Int16Samples samples;
    for (int i = 0; i < side * side * side; ++i) {
      const glm::dvec3 p = scene.lattice.lps_mm({i % side, i / side % side, i / side / side});
      samples.push_back(static_cast<std::int16_t>(std::lround(40.0 * (45.0 - glm::length(p)))));
    }
    scene.samples = std::move(samples);
    scene.meaning = octotomy::voxel::Meaning::Hounsfield;
    octotomy::voxel::write_scene(scene, folder_ / "ball.nrrd");
  }
  BallScan(const BallScan&) = delete;
  BallScan& operator=(const BallScan&) = delete;
  ~BallScan() { std::filesystem::remove_all(folder_); }

  /// Microseconds to read and evaluate, in voxels alone, a plan of these steps after "a", the ball.
  double us_of(const std::string& steps) const {
    const std::string text = R"({"octotomy_plan": 1, "name": "growth", "scans": {"ct": {"path": "ball.nrrd"}},
        "universe": {"voxel_mm": 2.0}, "steps": [{"id": "a", "do": "window", "scan": "ct", "low": 0})" +
                             steps + "]}";
    octotomy::planner::EvaluateOptions options;
    options.meshes = options.certify = false;
    return median_us([&] {
      (void)octotomy::planner::evaluate(octotomy::planner::parse_plan(text, folder_), options).objects.size();
    });
  }

 private:
  std::filesystem::path folder_;
};

/// A mask with an outline of this number of vertices, a circle in waves.
std::string polygon(int vertices) {
  std::string points;
  for (int i = 0; i < vertices; ++i) {
    const double turn = 2.0 * M_PI * i / vertices, reach = 40.0 + 2.0 * std::cos(24.0 * turn);
    points += (i == 0 ? "[" : ",[") + std::to_string(reach * std::cos(turn)) + "," +
              std::to_string(reach * std::sin(turn)) + "]";
  }
  return R"(,{"id": "m", "do": "mask", "regions": [{"view": "left", "polygons_mm": [[)" + points +
         R"(]]}]},{"id": "cut", "do": "combine", "expression": "a & m"})";
}

/// An expression with this number of operands.
std::string operands(int count) {
  std::string expression = "a";
  for (int i = 1; i < count; ++i) expression += i % 2 == 0 ? " | b" : " - b";
  return R"(,{"id": "b", "do": "move", "object": "a", "translate_mm": [20, 0, 0]})"
         R"(,{"id": "c", "do": "combine", "expression": ")" +
         expression + "\"}";
}

/// A chain of this number of moves.
std::string moves(int count) {
  std::string steps;
  for (int i = 0; i < count; ++i)
    steps += R"(,{"id": "m)" + std::to_string(i) + R"(", "do": "move", "object": ")" +
             (i == 0 ? std::string("a") : "m" + std::to_string(i - 1)) +
             R"(", "translate_mm": [0.01, 0, 0]})";
  return steps;
}

/// Microseconds of the union of two balls, and their triangles.
std::pair<double, double> mesh_boolean(int divisions) {
  using namespace octotomy::brep;
  const Solid a = solid_of(shapes::sphere({0, 0, 0}, 10.0, divisions)),
              b = solid_of(shapes::sphere({7.1, 3.3, 2.7}, 10.0, divisions));
  (void)boolean(a, Operation::Union, b).solid.size();  // search trees, once
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  for (int run = 0; run < 3; ++run) {
    const Clock::time_point before = Clock::now();
    const Solid one = solid_of(a.triangles()), other = solid_of(b.triangles());
    (void)boolean(one, Operation::Union, other).solid.size();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
  }
  return {static_cast<double>(a.triangles().faces.size() + b.triangles().faces.size()),
          *std::min_element(times.begin(), times.end())};
}

void draw_inputs(const char* path) {
  octotomy::bench::LogPlot plot{"Cost of larger inputs: power 1 is in proportion",
                                "vertices, operands, steps, triangles",
                                "microseconds",
                                {}};
  const auto add = [&](Curve curve) {
    for (const auto& [count, us] : curve.points)
      std::printf("%-28s %9.0f %14.0f us\n", curve.name.c_str(), count, us);
    std::printf("%-28s power %.2f\n", curve.name.c_str(), octotomy::bench::fitted_power(curve));
    plot.curves.push_back(std::move(curve));
  };
  const BallScan scan;
  const auto of_plans = [&](const char* name, std::string (*steps)(int), std::initializer_list<int> counts) {
    Curve curve{name, {}};
    for (const int count : counts) curve.points.emplace_back(count, scan.us_of(steps(count)));
    add(std::move(curve));
  };
  of_plans("vertices of a region", polygon, {1000, 10000, 100000});
  of_plans("operands of an expression", operands, {100, 1000, 10000, 50000});
  of_plans("steps of a plan", moves, {10, 100, 1000});
  Curve curve{"triangles of a mesh Boolean", {}};
  for (const int divisions : {4, 5, 6, 7, 8}) curve.points.push_back(mesh_boolean(divisions));
  add(std::move(curve));
  octotomy::bench::write_svg(plot, path);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2 && count != 3) {
    std::fputs("octotomy-growth VOXELS.svg [INPUTS.svg]; - leaves the first out\n", stderr);
    return 2;
  }
  try {
    if (std::string_view(arguments[1]) != "-") draw(arguments[1]);
    if (count == 3) draw_inputs(arguments[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "octotomy-growth: %s\n", error.what());
    return 2;
  }
}
