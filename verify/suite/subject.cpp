// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/subject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>

#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "verify/certificate/certify_surface.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/implicit_solid.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;

voxel::Scene scan_of(const Subject& subject, const Making& making) {
  voxel::Scene scan = subject.scan;
  scan.lattice.lps_from_voxel[2] *= making.slices_apart;
  return scan;
}

glm::dmat4 motion_of(const Subject& subject, const Making& making) {
  if (making.not_moved) return glm::dmat4(1.0);
  voxel::Motion motion = subject.motion;
  if (making.pivot_forgotten) motion.about_mm = glm::dvec3(0.0);
  return voxel::moved_from_still(motion);
}

brep::Solid solid_of(const voxel::Box& box) {
  const glm::dvec3 a = box.low_mm, b = box.high_mm;
  return brep::solid_of(brep::Prism{
      {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {{{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}}}, a.y, b.y});
}

/// Scans a solid: each sample is the share of its voxel that lies inside the solid, scaled to -1000 to 1000.
voxel::Scene scan_of(const voxel::Universe& universe, const voxel::Expression& solid) {
  const voxel::PartialOctree partial = voxel::digitise_partial(universe, solid);
  const int side = universe.side();
  const auto at = [&](const glm::ivec3& v) {
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(side) * (static_cast<std::size_t>(v.y) +
                                             static_cast<std::size_t>(side) * static_cast<std::size_t>(v.z));
  };
  voxel::Int16Samples samples(static_cast<std::size_t>(side) * side * side, -1000);
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (partial.inside.contains({x, y, z})) samples[at({x, y, z})] = 1000;
  voxel::for_each_boundary_voxel(partial, [&](const glm::ivec3& v, std::uint16_t fraction) {
    samples[at(v)] =
        static_cast<std::int16_t>(std::lround(2000.0 * fraction / voxel::PartialOctree::whole - 1000.0));
  });
  voxel::Scene scan;
  scan.lattice = universe.lattice();
  scan.samples = std::move(samples);
  scan.source = "phantom";
  return scan;
}

}  // namespace

double edge_mm(const Subject& subject) {
  return subject.universe.lattice().spacing_mm().x;
}

voxel::Octree voxel_answer(const Subject& subject, const Making& making) {
  const auto scan = std::make_shared<const voxel::Scene>(scan_of(subject, making));
  const voxel::GreyOctree grey = voxel::grey_octree_of(subject.universe, *scan).with_scan(scan);
  const Expression window = voxel::Window{grey, making.low};
  const Expression box =
      voxel::Box{subject.box.low_mm + making.box_shift_mm, subject.box.high_mm + making.box_shift_mm};
  const Expression still = making.swapped ? box - window : window - box;
  return voxel::combine(subject.universe, voxel::moved(still, motion_of(subject, making)));
}

brep::Triangles mesh_answer(const Subject& subject, const Making& making) {
  const brep::Solid window = brep::trusted_solid(
      convert::isosurface(scan_of(subject, making), making.low, std::numeric_limits<double>::infinity()),
      brep::Proof::Construction);
  const brep::Solid box =
      solid_of({subject.box.low_mm + making.box_shift_mm, subject.box.high_mm + making.box_shift_mm});
  const brep::Solid still = making.swapped ? brep::boolean(box, brep::Operation::Difference, window).solid
                                           : brep::boolean(window, brep::Operation::Difference, box).solid;
  return brep::triangles_of(brep::moved(still, motion_of(subject, making)));
}

brep::Triangles with_shell_again(brep::Triangles triangles, const brep::Triangles& again) {
  const auto points = static_cast<std::uint32_t>(triangles.points_mm.size());
  triangles.points_mm.insert(triangles.points_mm.end(), again.points_mm.begin(), again.points_mm.end());
  for (const std::array<std::uint32_t, 3>& face : again.faces)
    triangles.faces.push_back({face[0] + points, face[1] + points, face[2] + points});
  return triangles;
}

voxel::Octree changed(const voxel::Octree& octree, const voxel::Box& box, brep::Operation operation) {
  const Expression all(octree), part(box);
  return voxel::combine(octree.universe(), operation == brep::Operation::Union ? all | part : all - part);
}

brep::Triangles changed(const brep::Triangles& triangles, const voxel::Box& box, brep::Operation operation) {
  const brep::Solid solid = brep::trusted_solid(triangles, brep::Proof::Connection);
  return brep::triangles_of(brep::boolean(solid, operation, solid_of(box)).solid);
}

brep::Triangles shifted(brep::Triangles triangles, const glm::dvec3& by_mm) {
  for (glm::dvec3& p : triangles.points_mm) p += by_mm;
  return triangles;
}

Subject shape_subject(const std::string& name, int voxels) {
  Subject subject;
  subject.name = name;
  const double n = voxels;
  while ((1 << subject.universe.depth) > voxels) --subject.universe.depth;
  const glm::dvec3 centre = n * glm::dvec3(0.46, 0.52, 0.49);
  const glm::dmat3 turn = turned({20, -35, 50});
  subject.scan = name == "ring" ? scan_of(subject.universe, voxel::Torus{centre, turn[2], 0.24 * n, 0.12 * n})
                                : scan_of(subject.universe,
                                          voxel::Ellipsoid{centre, n * glm::dvec3(0.33, 0.26, 0.21), turn});
  subject.box = {centre + n * glm::dvec3(0.051, -0.383, -0.029),
                 centre + n * glm::dvec3(0.437, 0.043, 0.377)};
  subject.motion = {
      n * glm::dvec3(0.021, -0.013, 0.017), 9.0, {0.3, 0.5, 0.8}, n * glm::dvec3(0.31, 0.62, 0.71)};
  subject.contrast = 2000.0;
  return subject;
}

Subject head_subject(int voxels) {
  Subject subject;
  subject.name = "head";
  HeadOptions options;
  const voxel::Box bounds = head_bounds();
  const glm::dvec3 extent_mm = bounds.high_mm - bounds.low_mm;
  options.voxel_mm = 1.02 * std::max({extent_mm.x, extent_mm.y, extent_mm.z}) / voxels;
  subject.scan = head_phantom(options);
  subject.universe = voxel::universe_around(voxel::bounds(subject.scan.lattice), options.voxel_mm);
  subject.box = {{-42.3, -95.1, -57.2}, {11.4, -31.7, -21.9}};
  subject.motion = {{2.3, -5.1, 1.7}, 7.0, {1.0, 0.2, 0.1}, {3.0, -60.0, -30.0}};
  subject.low = 0.5 * (options.tissues.soft + options.tissues.bone);
  subject.contrast = options.tissues.bone - options.tissues.soft;
  return subject;
}

Witness witness_of(const Subject& subject, const Making& making) {
  const Witness window = witness_of_window(std::make_shared<const voxel::Scene>(subject.scan), subject.low,
                                           std::numeric_limits<double>::infinity(), subject.universe);
  return both(carried(without(window, witness_of_box(subject.box)), motion_of(subject, making)),
              witness_of_box(voxel::bounds(subject.universe.lattice())));
}

Certificate certified(const Subject& subject, const std::string& fault, const voxel::Octree& octree,
                      const brep::Triangles& triangles, const Witness& witness) {
  BoundInputs inputs;
  inputs.operation = subject.name + ", (window - box) turned" + (fault.empty() ? "" : ", " + fault);
  inputs.voxel_lineage = "window on a grey octree of the scan, in one walk";
  inputs.mesh_lineage = "isosurface of the scan's own samples, corefinement";
  inputs.scan_spacing_mm = subject.scan.lattice.spacing_mm();
  inputs.witness = witness;
  return certify_surface(octree, triangles, inputs);
}

}  // namespace octotomy::verify
