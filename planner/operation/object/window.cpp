// SPDX-License-Identifier: AGPL-3.0-or-later
// The samples of a scan from one value to another.
#include <algorithm>
#include <cmath>
#include <limits>

#include "convert/surface/isosurface.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

struct Window {
  ScanName scan;
  double low = 300.0;
  std::optional<double> high;
};

void check(const Window& window, const FieldLocation& place) {
  if (window.high && *window.high < window.low)
    place.at("high").refuse("is below 'low', so the window would be empty: exchange the two");
}

std::string unit_of(const voxel::Scene& scene) {
  return voxel::unit(scene) == "1" ? "" : " " + voxel::unit(scene);
}

bool has_samples_in(const voxel::Scene& scene, const Window& window) {
  const double low = voxel::above_padding(scene, window.low);
  const double high = window.high.value_or(std::numeric_limits<double>::infinity());
  return std::visit(
      [&](const auto& samples) {
        return std::any_of(samples.begin(), samples.end(),
                           [&](auto sample) { return sample >= low && sample <= high; });
      },
      scene.samples);
}

std::string definition(const Window& window, const Objects&) {
  return window.scan.name + " from " + plain(window.low) + (window.high ? " to " + plain(*window.high) : "");
}

void voxels(const Window& window, const VoxelBench& bench, VoxelSide& made) {
  const LoadedScan& scan = bench.loaded(window.scan.name);
  const voxel::Expression leaf(window_on(scan.grey, {window.low, window.high}));
  {
    const Stopwatch watch(bench.timings, "octree");
    made.octree = voxel::combine(bench.universe, leaf);
  }
  made.symbol = bench.within_universe(leaf);
  made.lineage = "window on a grey octree of the scan";
  if (!made.octree.is_empty()) return;
  if (has_samples_in(scan.scene(), window))
    throw std::runtime_error("no voxel of scan '" + window.scan.name +
                             "' is in the window, although samples are: voxels of " +
                             plain(bench.universe.lattice().spacing_mm().x) +
                             " mm miss them: choose smaller voxels by 'voxel_mm' of the universe");
  const voxel::Range range = voxel::range(scan.scene());
  throw std::runtime_error("no voxel of scan '" + window.scan.name +
                           "' is in the window; its samples are from " + plain(range.low) + " to " +
                           plain(range.high) + unit_of(scan.scene()) + ": choose within them");
}

void triangles(const Window& window, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "isosurface");
  const double high = window.high.value_or(std::numeric_limits<double>::infinity());
  made.whole = brep::trusted_solid(convert::isosurface(bench.samples(window.scan.name), window.low, high),
                                   brep::Proof::Construction);
  made.lineage = "isosurface of the scan's own samples";
}

void bound(const Window& window, const BoundBench& bench, Object& made) {
  const LoadedScan& scan = bench.scan(window.scan.name);
  made.definition += unit_of(scan.scene());
  const voxel::Lattice& lattice = scan.scene().lattice;
  made.bound.spacing_mm = lattice.spacing_mm();
  made.bound.scan_box_mm = voxel::bounds(lattice);
  made.bound.voxels_are_samples =
      on_samples(lattice, bench.universe.lattice()) &&
      !on_both_sides(scan.scene(), window.low, window.high.value_or(std::numeric_limits<double>::infinity()));
  // Pictures interpolate the depth where samples cross the lower bound, which would be wrong inside an object
  // with an upper bound.
  made.witness = verify::witness_of_window(scan.shared, window.low,
                                           window.high.value_or(std::numeric_limits<double>::infinity()),
                                           bench.universe, scan.grey.step());
  made.bound.windows = {{.grey = scan.grey,
                         .threshold = window.low,
                         .scan = window.scan.name,
                         .samples = scan.shared,
                         .high = window.high.value_or(std::numeric_limits<double>::infinity())}};
  if (!window.high) made.shown = made.bound.windows.front();
}

}  // namespace

Operation window_operation() {
  return Describe<Window>("window", "Makes an object of the samples of a scan that lie between two values.",
                          Makes::Object)
      .takes(field("scan", &Window::scan, "The scan.").required())
      .takes(field("low", &Window::low, "The lowest sample that belongs to the object, in the scan's unit.")
                 .required())
      .takes(field("high", &Window::high,
                   "The highest sample that belongs to the object. Default: no upper limit."))
      .example(R"({"id": "skull", "do": "window", "scan": "ct", "low": 300})")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
