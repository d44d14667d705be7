// SPDX-License-Identifier: AGPL-3.0-or-later
// octotomy-growth FILE.svg: how a Boolean's time grows with the resolution of the same objects, and what a
// pass over all voxels would do. Prints the table that it draws.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <vector>

#include "tests/bench/dense_bits.h"
#include "tests/bench/log_plot.h"
#include "tests/bench/subjects.h"
#include "voxel/solid/combine.h"

namespace {

using octotomy::bench::Curve;
using octotomy::voxel::Expression;
using octotomy::voxel::Octree;

// The median over so many runs that they take a fifth of a second, at least nine.
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

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("octotomy-growth FILE.svg\n", stderr);
    return 2;
  }
  try {
    draw(arguments[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "octotomy-growth: %s\n", error.what());
    return 2;
  }
}
