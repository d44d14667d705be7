// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Both kernels answer the clean question of a subject. For a misunderstanding one of them answers again, with a
//   different Making. Faults of execution change the clean mesh or octree.
// 2 Each pair is certified like any other pair.
#include "verify/suite/fault.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "brep/mesh/triangles.h"
#include "verify/certificate/exact_agreement.h"
#include "verify/question/random_expression.h"
#include "verify/suite/subject.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
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
/// Mirrors a surface in x about the universe's middle and keeps its normals outward. A reader with a wrong
/// axis would return such a surface.
brep::Triangles mirrored(brep::Triangles triangles, const voxel::Universe& universe) {
  const double middle_mm = universe.lattice().lps_mm(glm::dvec3(0.5 * (universe.side() - 1))).x;
  for (glm::dvec3& p : triangles.points_mm) p.x = 2.0 * middle_mm - p.x;
  return turned_inside_out(std::move(triangles));
}

/// Resamples the octree's voxels as if they lay on another lattice, into the octree's own universe.
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

/// The clean answers to one question. Applies faults to them.
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

/// Returns trials in tier Exact. The answers have integer coordinates, so a shifted mesh moves by one refined
/// voxel.
std::vector<FaultTrial> exact_trials(int voxels) {
  voxel::Universe universe;
  while ((1 << universe.depth) > voxels) --universe.depth;
  Random random(static_cast<std::uint64_t>(voxels));
  // Noise is left out, because its surface grows as its volume does. Each set must have voxels that the other
  // lacks and voxels that the other has, too.
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
      {duplicated_shell, "the mesh contains its surface twice", true},
      {half_voxel, "the mesh is moved by half a voxel along x; in tier Exact by one refined voxel", true},
      {quarter_voxel, "the mesh is moved by a quarter of a voxel along y", true},
      {eighth_voxel, "the mesh is moved by an eighth of a voxel along z", true},
      {mirrored_axis, "one answer is mirrored in x about the universe's middle", true},
      {swapped_operands, "one kernel computes b - a instead of a - b", true},
      {slice_spacing, "one kernel divides the scan's height by one slice too many", true},
      {window_quarter, "one kernel's window begins a quarter of the contrast higher", true},
      {window_eighth, "one kernel's window begins an eighth of the contrast lower", true},
      {window_sixteenth, "one kernel's window begins a sixteenth of the contrast higher", true},
      {stale_result, "one kernel has the object as it was before it was turned and moved", true},
      {stale_box, "one kernel has the box where it was before it moved by two voxels along each axis", true},
      {wrong_pivot, "one kernel rotates about the origin instead of the given point", true},
      {shell_thrice, "the mesh contains its surface three times", true},
      {both_empty, "both kernels return an empty answer", true},
      {lost_by_both, "both kernels have lost the part in one half of the universe", true}};
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
      throw voxel::InvalidInput("faults are injected at sizes that are powers of two from 8 on, not at " +
                                std::to_string(voxels));
    for (const char* subject : {"ellipsoid", "ring"}) work.push_back({subject, voxels});
    if (voxels >= resolved_size) work.push_back({"head", voxels});
    if (voxels <= resolved_size) work.push_back({"voxel sets", voxels});
  }
  std::vector<std::vector<FaultTrial>> parts(work.size());
  voxel::SharedProgress work_done(options.progress, work.size());
  // Large subjects start first, so that no thread starts a long one at the end.
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

}  // namespace octotomy::verify
