// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 A subject is a scan; the question is (window - box) under a rigid motion. Making holds the parameters
//   with which a kernel answers. A misunderstanding is one kernel with a different Making.
// 2 Both kernels answer the clean question. For a misunderstanding one of them answers again. Faults of
//   execution change the clean mesh or octree.
// 3 Each pair is certified like any other pair.
// 4 Random alterations are applied to the same answers, and to answers for blocks of scans.
// The source is long because trials and alterations use the same subjects.
#include "verify/suite/fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/move.h"
#include "brep/mesh/triangles.h"
#include "brep/shape/prism.h"
#include "convert/surface/isosurface.h"
#include "verify/certificate/certificate.h"
#include "verify/certificate/certify_surface.h"
#include "verify/certificate/exact_agreement.h"
#include "verify/phantom/chance.h"
#include "verify/phantom/head_phantom.h"
#include "verify/phantom/implicit_solid.h"
#include "verify/question/random_expression.h"
#include "verify/witness/reading.h"
#include "verify/witness/witness.h"
#include "voxel/filter/crop.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"
#include "voxel/space/scene.h"
#include "voxel/space/shared_progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {
namespace {

/// The parameters with which one kernel answers the question.
struct Making {
  double low = 0.0;           ///< of the window
  double slices_apart = 1.0;  ///< slice distance, as a multiple of the true distance
  bool swapped = false;       ///< box - window instead of window - box
  glm::dvec3 box_shift_mm{0.0};
  bool pivot_forgotten = false;  ///< turned about the origin instead of the pivot
  bool not_moved = false;        ///< the motion is left out
};

struct Subject {
  std::string name;
  voxel::Scene scan;
  voxel::Universe universe;
  voxel::Box box;
  voxel::Motion motion;
  double low = 0.0;       ///< half way between outside and inside
  double contrast = 1.0;  ///< inside minus outside
};

/// Edge of the universe's voxels.
double edge_mm(const Subject& subject);

voxel::Octree voxel_answer(const Subject& subject, const Making& making);
brep::Triangles mesh_answer(const Subject& subject, const Making& making);
Witness witness_of(const Subject& subject, const Making& making);
/// The certificate of two answers. `fault` is the name of the fault in them, or empty.
Certificate certified(const Subject& subject, const std::string& fault, const voxel::Octree& octree,
                      const brep::Triangles& triangles, const Witness& witness);

/// An answer with a box added or removed.
voxel::Octree changed(const voxel::Octree& octree, const voxel::Box& box, brep::Operation operation);
brep::Triangles changed(const brep::Triangles& triangles, const voxel::Box& box, brep::Operation operation);
brep::Triangles shifted(brep::Triangles triangles, const glm::dvec3& by_mm);
/// The triangles together with those of another surface.
brep::Triangles with_shell_again(brep::Triangles triangles, const brep::Triangles& again);

/// Subjects without symmetry: off centre, oblique and cut. A symmetry would hide a mirrored axis or swapped
/// operands. The name is that of the ellipsoid or the ring.
Subject shape_subject(const std::string& name, int voxels);
Subject head_subject(int voxels);

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

/// A scan of a solid: each sample the share of its voxel that is inside, from -1000 to 1000.
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

}  // namespace

namespace {

using voxel::Expression;

brep::Triangles with_flipped_triangle(brep::Triangles triangles) {
  auto& face = triangles.faces[triangles.faces.size() / 2];
  std::swap(face[0], face[1]);
  return triangles;
}
brep::Triangles turned_inside_out(brep::Triangles triangles) {
  for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  return triangles;
}
brep::Triangles with_lost_triangle(brep::Triangles triangles) {
  triangles.faces.erase(triangles.faces.begin() + static_cast<std::ptrdiff_t>(triangles.faces.size() / 2));
  return triangles;
}
brep::Triangles with_shell_twice(brep::Triangles triangles) {
  const auto points = static_cast<std::uint32_t>(triangles.points_mm.size());
  const std::size_t faces = triangles.faces.size();
  triangles.points_mm.insert(triangles.points_mm.end(), triangles.points_mm.begin(),
                             triangles.points_mm.begin() + points);
  for (std::size_t i = 0; i < faces; ++i) {
    std::array<std::uint32_t, 3> face = triangles.faces[i];
    for (std::uint32_t& corner : face) corner += points;
    triangles.faces.push_back(face);
  }
  return triangles;
}
/// Mirrored in x about the universe's middle, with outward normals, as by a reader with a wrong axis.
brep::Triangles mirrored(brep::Triangles triangles, const voxel::Universe& universe) {
  const double middle_mm = universe.lattice().lps_mm(glm::dvec3(0.5 * (universe.side() - 1))).x;
  for (glm::dvec3& p : triangles.points_mm) p.x = 2.0 * middle_mm - p.x;
  return turned_inside_out(std::move(triangles));
}

/// The octree's voxels on another lattice, resampled in its own universe.
voxel::Octree on_lattice(const voxel::Octree& octree, const glm::dmat4& index_from_true_index) {
  voxel::Universe other = octree.universe();
  other.lps_from_voxel = other.lps_from_voxel * index_from_true_index;
  return voxel::combine(octree.universe(), voxel::Octree(other, voxel::Block::share(octree.root())));
}
voxel::Octree mirrored(const voxel::Octree& octree) {
  glm::dmat4 mirror(1.0);
  mirror[0].x = -1.0;
  mirror[3].x = octree.universe().side() - 1.0;
  return on_lattice(octree, mirror);
}

/// Names of faults.
constexpr const char* flipped_normal = "flipped normal";
constexpr const char* flipped_shell = "flipped shell";
constexpr const char* lost_triangle = "lost triangle";
constexpr const char* duplicated_shell = "duplicated shell";
constexpr const char* half_voxel = "shift by 1/2 voxel";
constexpr const char* quarter_voxel = "shift by 1/4 voxel";
constexpr const char* eighth_voxel = "shift by 1/8 voxel";
constexpr const char* mirrored_axis = "mirrored axis";
constexpr const char* swapped_operands = "swapped operands";
constexpr const char* slice_spacing = "off-by-one slice spacing";
constexpr const char* window_quarter = "window edge off by 1/4";
constexpr const char* window_eighth = "window edge off by 1/8";
constexpr const char* window_sixteenth = "window edge off by 1/16";
constexpr const char* stale_result = "stale result";
constexpr const char* stale_box = "stale box, two voxels off";
constexpr const char* wrong_pivot = "rotation about the wrong point";
constexpr const char* shell_thrice = "shell three times";
constexpr const char* both_empty = "both kernels empty";
constexpr const char* lost_by_both = "half lost by both kernels";

/// The clean answers to one question, and the faults that are applied to them.
class Trials {
 public:
  Trials(const Subject& subject, int voxels) : subject_(subject), voxels_(voxels) {
    clean_.low = subject.low;
    witness_ = witness_of(subject, clean_);
  }

  std::vector<FaultTrial> run() {
    octree_ = voxel_answer(subject_, clean_);
    triangles_ = mesh_answer(subject_, clean_);
    certify("", "", *octree_, triangles_);
    spoil_execution();
    for (const auto& [name, making] : misunderstandings()) {
      certify(name, "voxel", voxel_answer(subject_, making), triangles_);
      certify(name, "mesh", *octree_, mesh_answer(subject_, making));
    }
    return std::move(trials_);
  }

 private:
  void spoil_execution() {
    const double h = edge_mm(subject_);
    certify(flipped_normal, "mesh", *octree_, with_flipped_triangle(triangles_));
    certify(flipped_shell, "mesh", *octree_, turned_inside_out(triangles_));
    certify(lost_triangle, "mesh", *octree_, with_lost_triangle(triangles_));
    certify(duplicated_shell, "mesh", *octree_, with_shell_twice(triangles_));
    certify(shell_thrice, "mesh", *octree_, with_shell_again(with_shell_twice(triangles_), triangles_));
    certify(both_empty, "both", voxel::Octree::empty(subject_.universe), {});
    const voxel::Box world = voxel::bounds(subject_.universe.lattice());
    const voxel::Box half{
        world.low_mm - h,
        {0.5 * (world.low_mm.x + world.high_mm.x) + 0.3 * h, world.high_mm.y + h, world.high_mm.z + h}};
    certify(lost_by_both, "both", changed(*octree_, half, brep::Operation::Difference),
            changed(triangles_, half, brep::Operation::Difference));
    certify(half_voxel, "mesh", *octree_, shifted(triangles_, {0.5 * h, 0.0, 0.0}));
    certify(quarter_voxel, "mesh", *octree_, shifted(triangles_, {0.0, 0.25 * h, 0.0}));
    certify(eighth_voxel, "mesh", *octree_, shifted(triangles_, {0.0, 0.0, 0.125 * h}));
    certify(mirrored_axis, "mesh", *octree_, mirrored(triangles_, subject_.universe));
    certify(mirrored_axis, "voxel", mirrored(*octree_), triangles_);
  }

  std::vector<std::pair<std::string, Making>> misunderstandings() const {
    std::vector<std::pair<std::string, Making>> all;
    const auto with = [&](const std::string& name, const std::function<void(Making&)>& change) {
      Making making = clean_;
      change(making);
      all.emplace_back(name, making);
    };
    const double h = edge_mm(subject_);
    const double slices = subject_.scan.lattice.dims.z;
    with(swapped_operands, [](Making& m) { m.swapped = true; });
    with(slice_spacing, [&](Making& m) { m.slices_apart = (slices - 1.0) / slices; });
    with(window_quarter, [&](Making& m) { m.low += 0.25 * subject_.contrast; });
    with(window_eighth, [&](Making& m) { m.low -= 0.125 * subject_.contrast; });
    with(window_sixteenth, [&](Making& m) { m.low += 0.0625 * subject_.contrast; });
    with(stale_result, [&](Making& m) { m.not_moved = true; });
    with(stale_box, [&](Making& m) { m.box_shift_mm = 2.0 * h * glm::dvec3(-1.0, 1.0, -1.0); });
    with(wrong_pivot, [](Making& m) { m.pivot_forgotten = true; });
    return all;
  }

  void certify(const std::string& fault, const std::string& kernel, const voxel::Octree& octree,
               const brep::Triangles& triangles) {
    trials_.push_back({fault, kernel, subject_.name, voxels_, false,
                       certified(subject_, fault, octree, triangles, witness_)});
  }

  const Subject& subject_;
  int voxels_;
  Making clean_;
  Witness witness_;  ///< of the clean question
  std::optional<voxel::Octree> octree_;
  brep::Triangles triangles_;
  std::vector<FaultTrial> trials_;
};

/// Trials in tier Exact. Its answers have integer coordinates, so a shift is by one refined voxel.
std::vector<FaultTrial> exact_trials(int voxels) {
  voxel::Universe universe;
  while ((1 << universe.depth) > voxels) --universe.depth;
  Random random(static_cast<std::uint64_t>(voxels));
  // No noise, because its surface is as large as its volume. Each set must have voxels of its own and voxels
  // in common with the other.
  const auto drawn = [&] {
    RandomSet set = random_set(random, universe, std::min(voxels, largest_random_side));
    while (set.recipe.starts_with("noise") || set.recipe.starts_with("head"))
      set = random_set(random, universe, std::min(voxels, largest_random_side));
    return Expression(set.octree);
  };
  Expression a = drawn(), b = drawn();
  const auto is_empty = [&](const Expression& e) { return voxel::combine(universe, e).is_empty(); };
  while (is_empty(a - b) || is_empty(b - a) || is_empty(a & b)) {
    a = b;
    b = drawn();
  }
  const ExactAnswers clean = exact_answers(a - b), other = exact_answers(b - a);
  std::vector<FaultTrial> trials;
  const auto certify = [&](const std::string& fault, const std::string& kernel, const ExactAnswers& answers) {
    trials.push_back({fault, kernel, "voxel sets", voxels, false, certify_exact(answers)});
    trials.back().certificate.operation = "a - b" + (fault.empty() ? "" : ", " + fault);
  };
  certify("", "", clean);
  const auto spoil_mesh = [&](const char* fault,
                              const std::function<brep::Triangles(brep::Triangles)>& spoil) {
    ExactAnswers spoiled = clean;
    try {
      spoiled.solids[0] = brep::mesh_of(spoil(brep::triangles_of(clean.solids[0])));
      certify(fault, "mesh", spoiled);
    } catch (const voxel::Stopped&) {
      throw;
    } catch (const std::runtime_error& error) {
      certify(fault, "mesh", clean);
      lower(trials.back().certificate, Verdict::Fail,
            std::string("The spoiled mesh cannot be built: ") + error.what());
    }
  };
  spoil_mesh(flipped_normal, with_flipped_triangle);
  spoil_mesh(flipped_shell, turned_inside_out);
  spoil_mesh(lost_triangle, with_lost_triangle);
  spoil_mesh(duplicated_shell, with_shell_twice);
  spoil_mesh(half_voxel, [](brep::Triangles t) { return shifted(std::move(t), {1.0, 0.0, 0.0}); });
  spoil_mesh(mirrored_axis,
             [&](brep::Triangles t) { return mirrored(std::move(t), clean.octree.universe()); });
  ExactAnswers spoiled = clean;
  spoiled.octree = mirrored(clean.octree);
  certify(mirrored_axis, "voxel", spoiled);
  spoiled.octree = other.octree;
  certify(swapped_operands, "voxel", spoiled);
  spoiled = clean;
  spoiled.solids = other.solids;
  certify(swapped_operands, "mesh", spoiled);
  return trials;
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all{
      {flipped_normal, "one triangle of the mesh winds the other way", true},
      {flipped_shell, "all triangles of the mesh wind the other way", true},
      {lost_triangle, "one triangle of the mesh is missing", true},
      {duplicated_shell, "the mesh's surface is there twice", true},
      {half_voxel, "the mesh is moved along x; in the exact tier by one refined voxel", true},
      {quarter_voxel, "the mesh is moved along y", true},
      {eighth_voxel, "the mesh is moved along z", true},
      {mirrored_axis, "one answer is mirrored in x about the universe's middle", true},
      {swapped_operands, "one kernel takes b - a for a - b", true},
      {slice_spacing, "one kernel divides the scan's height by one slice too many", true},
      {window_quarter, "one kernel's window begins a quarter of the contrast higher", true},
      {window_eighth, "one kernel's window begins an eighth of the contrast lower", true},
      {window_sixteenth, "one kernel's window begins a sixteenth of the contrast higher", true},
      {stale_result, "one kernel has the object as it was before it was turned and moved", true},
      {stale_box, "one kernel has the box where it was before it moved by two voxels along each axis", true},
      {wrong_pivot, "one kernel turns about the origin instead of the given point", true},
      {shell_thrice, "the mesh's surface is there three times", true},
      {both_empty, "both kernels answer nothing", true},
      {lost_by_both, "both kernels have lost what lies in one half of the universe", true}};
  return all;
}

std::vector<FaultTrial> try_faults(const FaultOptions& options) {
  struct Work {
    std::string subject;
    int voxels;
  };
  std::vector<Work> work;
  for (const int voxels : options.sizes) {
    if (voxels < 8 || (voxels & (voxels - 1)) != 0)
      throw voxel::InvalidInput("faults are tried at powers of two from 8 on, not at " +
                                std::to_string(voxels));
    for (const char* subject : {"ellipsoid", "ring"}) work.push_back({subject, voxels});
    if (voxels >= resolved_size) work.push_back({"head", voxels});
    if (voxels <= resolved_size) work.push_back({"voxel sets", voxels});
  }
  std::vector<std::vector<FaultTrial>> parts(work.size());
  voxel::SharedProgress work_done(options.progress, work.size());
  // Large subjects start first, so that the last ones end at about the same time.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, work.size(), 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          work_done.one_more();
          const std::size_t number = work.size() - 1 - i;
          const auto& [subject, voxels] = work[number];
          if (subject == "voxel sets")
            parts[number] = exact_trials(voxels);
          else
            parts[number] =
                Trials(subject == "head" ? head_subject(voxels) : shape_subject(subject, voxels), voxels)
                    .run();
        }
      },
      tbb::simple_partitioner());
  std::map<std::string, bool> must;
  for (const Fault& fault : faults()) must[fault.name] = fault.must_be_caught;
  std::vector<FaultTrial> trials;
  for (std::vector<FaultTrial>& part : parts)
    for (FaultTrial& trial : part) {
      trial.must_be_caught = !trial.fault.empty() && must.at(trial.fault);
      trials.push_back(std::move(trial));
    }
  return trials;
}

std::vector<DetectionPower> detection_power(const std::vector<FaultTrial>& trials) {
  std::vector<DetectionPower> table;
  std::vector<std::string> names{""};
  for (const Fault& fault : faults()) names.push_back(fault.name);
  for (const std::string& name : names) {
    std::map<int, DetectionPower> by_size;
    for (const FaultTrial& trial : trials) {
      if (trial.fault != name) continue;
      DetectionPower& power = by_size[trial.voxels];
      power.fault = name.empty() ? "clean" : name;
      power.voxels = trial.voxels;
      ++power.trials;
      power.caught += trial.caught();
      power.doubted += trial.certificate.verdict == Verdict::Warn;
    }
    for (const auto& [voxels, power] : by_size) table.push_back(power);
  }
  return table;
}

bool detection_holds(const std::vector<FaultTrial>& trials) {
  return !trials.empty() && std::all_of(trials.begin(), trials.end(), [](const FaultTrial& trial) {
    if (trial.fault.empty())
      return trial.certificate.verdict == Verdict::Pass &&
             (trial.certificate.resolved() || trial.voxels < resolved_size);
    return !trial.must_be_caught || trial.voxels < resolved_size || trial.caught();
  });
}

namespace {

enum Kind {
  LostByVoxels,
  LostByMesh,
  LostByBoth,
  AddedToVoxels,
  AddedToMesh,
  AddedToBoth,
  ClippedByVoxels,
  ClippedByMesh,
  ClippedByBoth,
  SeveralTimes,
  PartLost,
  Shifted,
  BothEmpty,
  Unaltered,
  kind_count
};
constexpr std::array<const char*, kind_count> names{"box lost by the voxels",   "box lost by the mesh",
                                                    "box lost by both kernels", "box added to the voxels",
                                                    "box added to the mesh",    "box added to both kernels",
                                                    "clipped by the voxels",    "clipped by the mesh",
                                                    "clipped by both kernels",  "mesh several times",
                                                    "part lost by the mesh",    "mesh shifted",
                                                    "both kernels empty",       unaltered};

int whole_number(Chance& chance, int count) {
  return std::min(static_cast<int>(chance.between(0.0, count)), count - 1);
}

double volume_mm3(const voxel::Octree& octree) {
  return static_cast<double>(octree.voxel_count()) * octree.universe().lattice().voxel_mm3();
}
double volume_mm3(const brep::Triangles& triangles) {
  return triangles.faces.empty() ? 0.0
                                 : brep::trusted_solid(triangles, brep::Proof::Connection).size().volume_mm3;
}

/// The clean answers to one question, and random alterations of them.
class Alterations {
 public:
  explicit Alterations(const Subject& subject)
      : subject_(subject),
        voxels_(subject.universe.side()),
        witness_(witness_of(subject, {.low = subject.low})),
        octree_(voxel_answer(subject, {.low = subject.low})),
        triangles_(mesh_answer(subject, {.low = subject.low})) {}

  bool is_empty() const { return octree_.is_empty() || triangles_.faces.empty(); }

  std::vector<Alteration> drawn(int count, Chance& chance) const {
    const Certificate right = certified(subject_, "clean", octree_, triangles_, witness_);
    std::vector<Alteration> made;
    for (int i = 0; i < count; ++i) made.push_back(altered(right, chance));
    return made;
  }

 private:
  glm::dvec3 vertex_by_chance(Chance& chance) const {
    return triangles_.points_mm[static_cast<std::size_t>(
        whole_number(chance, static_cast<int>(triangles_.points_mm.size())))];
  }

  /// A box around a random vertex of the mesh, with sides from one voxel to a sixth of the universe's side.
  voxel::Box box_by_chance(Chance& chance) const {
    const glm::dvec3 middle_mm = vertex_by_chance(chance);
    glm::dvec3 half_mm;
    for (int axis = 0; axis < 3; ++axis)
      half_mm[axis] = 0.5 * edge_mm(subject_) * std::exp(chance.between(0.0, std::log(voxels_ / 6.0)));
    return {middle_mm - half_mm, middle_mm + half_mm};
  }

  /// The half of the universe beyond a random vertex of the mesh along a random axis.
  voxel::Box end_by_chance(Chance& chance) const {
    const voxel::Box world = voxel::bounds(subject_.universe.lattice());
    const glm::dvec3 at_mm = vertex_by_chance(chance);
    const int axis = whole_number(chance, 3);
    voxel::Box end{world.low_mm - edge_mm(subject_), world.high_mm + edge_mm(subject_)};
    (chance.even() < 0.0 ? end.low_mm : end.high_mm)[axis] = at_mm[axis] + 0.01 * edge_mm(subject_);
    return end;
  }

  Alteration altered(const Certificate& right, Chance& chance) const {
    const int kind = whole_number(chance, kind_count);
    Alteration made;
    made.kind = names[static_cast<std::size_t>(kind)];
    made.subject = subject_.name + ", " + std::to_string(voxels_) + " voxels a side";
    made.clean_verdict = right.verdict;
    voxel::Octree octree = octree_;
    brep::Triangles triangles = triangles_;
    if (kind <= ClippedByBoth) {
      const voxel::Box box = kind >= ClippedByVoxels ? end_by_chance(chance) : box_by_chance(chance);
      const bool is_added = kind >= AddedToVoxels && kind <= AddedToBoth;
      const auto operation = is_added ? brep::Operation::Union : brep::Operation::Difference;
      if (kind % 3 != LostByMesh) octree = changed(octree, box, operation);
      if (kind % 3 != LostByVoxels) triangles = changed(triangles, box, operation);
      const double of_voxels_mm3 = std::abs(volume_mm3(octree) - volume_mm3(octree_)),
                   of_mesh_mm3 = std::abs(volume_mm3(triangles) - volume_mm3(triangles_));
      made.altered_mm3 = kind % 3 == LostByVoxels ? of_voxels_mm3
                         : kind % 3 == LostByMesh ? of_mesh_mm3
                                                  : std::min(of_voxels_mm3, of_mesh_mm3);
    } else if (kind == SeveralTimes) {
      const int times = 1 + whole_number(chance, 3);
      for (int i = 0; i < times; ++i) triangles = with_shell_again(std::move(triangles), triangles_);
      made.altered_mm3 = volume_mm3(triangles_) * times;
    } else if (kind == PartLost) {
      const std::vector<brep::Component> parts =
          brep::trusted_solid(triangles_, brep::Proof::Connection).components();
      const brep::Component& lost =
          parts[static_cast<std::size_t>(whole_number(chance, static_cast<int>(parts.size())))];
      triangles.faces.clear();
      for (std::uint32_t face = 0; face < triangles_.faces.size(); ++face)
        if (!std::binary_search(lost.faces.begin(), lost.faces.end(), face))
          triangles.faces.push_back(triangles_.faces[face]);
      made.altered_mm3 = std::abs(lost.volume_mm3);
    } else if (kind == Shifted) {
      glm::dvec3 by_mm(0.0);
      const int axis = whole_number(chance, 3);
      by_mm[axis] = edge_mm(subject_) * chance.even() * 2.0;
      triangles = shifted(std::move(triangles), by_mm);
      made.is_over_limit =
          right.limit && right.limit->shift_mm && std::abs(by_mm[axis]) > *right.limit->shift_mm;
    } else if (kind == BothEmpty) {
      octree = voxel::Octree::empty(subject_.universe);
      triangles = {};
      made.altered_mm3 = volume_mm3(triangles_);
    }
    made.is_over_limit = made.is_over_limit || (right.limit && made.altered_mm3 > right.limit->volume_mm3);
    made.verdict = certified(subject_, made.kind, octree, triangles, witness_).verdict;
    return made;
  }

  const Subject& subject_;
  int voxels_;
  Witness witness_;  ///< of the clean question
  voxel::Octree octree_;
  brep::Triangles triangles_;
};

/// A random block of a scan that fits into `voxels` voxels a side, with a random box in it and a random
/// motion.
Subject block_subject(const ScanToAlter& from, int voxels, Chance& chance) {
  const voxel::Lattice& lattice = from.scan->lattice;
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double sample_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double voxel_mm = sample_mm * chance.between(1.0, 2.0);
  voxel::VoxelRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const int count =
        std::clamp(static_cast<int>(0.55 * voxels * voxel_mm / spacing_mm[axis]), 2, lattice.dims[axis]);
    range.low[axis] = whole_number(chance, lattice.dims[axis] - count + 1);
    range.high[axis] = range.low[axis] + count - 1;
  }
  Subject subject;
  subject.name = from.name;
  subject.scan = voxel::crop(*from.scan, range);
  subject.low = from.low;
  const voxel::Box bounds = voxel::bounds(subject.scan.lattice);
  const glm::dvec3 extent_mm = bounds.high_mm - bounds.low_mm,
                   middle_mm = 0.5 * (bounds.low_mm + bounds.high_mm);
  // Space around the block for the motion.
  subject.universe =
      voxel::universe_around({bounds.low_mm - 0.2 * extent_mm, bounds.high_mm + 0.2 * extent_mm}, voxel_mm);
  for (int axis = 0; axis < 3; ++axis) {
    subject.box.low_mm[axis] = middle_mm[axis] + extent_mm[axis] * chance.between(-0.4, 0.0);
    subject.box.high_mm[axis] = subject.box.low_mm[axis] + extent_mm[axis] * chance.between(0.1, 0.4);
  }
  subject.motion = {0.1 * extent_mm * glm::dvec3(chance.even(), chance.even(), chance.even()),
                    chance.between(-12.0, 12.0), glm::dvec3(chance.even(), chance.even(), 0.6), middle_mm};
  return subject;
}

/// Draws blocks until one has an object that is not only crumbs, and alters its answers.
std::vector<Alteration> altered_block(const ScanToAlter& from, int voxels, int count, Chance& chance) {
  constexpr int most_tries = 50;
  for (int tries = 0; tries < most_tries; ++tries) {
    const Subject subject = block_subject(from, voxels, chance);
    const voxel::Range range = voxel::range(subject.scan);
    if (range.high < from.low || range.low >= from.low) continue;
    const Alterations alterations(subject);
    if (!alterations.is_empty()) return alterations.drawn(count, chance);
  }
  throw voxel::InvalidInput(from.name + ": no part of it has an object from " + std::to_string(from.low) +
                            " on: alter another scan");
}

}  // namespace

std::vector<Alteration> try_alterations(const AlterationOptions& options) {
  constexpr std::array<const char*, 3> phantoms{"ellipsoid", "ring", "head"};
  const std::size_t subjects = options.scans.empty()
                                   ? phantoms.size()
                                   : options.scans.size() * static_cast<std::size_t>(options.objects_of_scan);
  const int count = (options.count + static_cast<int>(subjects) - 1) / static_cast<int>(subjects);
  std::vector<std::vector<Alteration>> parts(subjects);
  voxel::SharedProgress done(options.progress, subjects);
  tbb::parallel_for(std::size_t{0}, subjects, [&](std::size_t i) {
    done.one_more();
    Chance chance(options.seed * subjects + i);
    if (!options.scans.empty()) {
      parts[i] = altered_block(options.scans[i % options.scans.size()], options.voxels, count, chance);
      return;
    }
    const std::string name = phantoms[i];
    const Subject subject =
        name == "head" ? head_subject(options.voxels) : shape_subject(name, options.voxels);
    parts[i] = Alterations(subject).drawn(count, chance);
  });
  std::vector<Alteration> all;
  for (std::vector<Alteration>& part : parts)
    all.insert(all.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
  return all;
}

}  // namespace octotomy::verify
