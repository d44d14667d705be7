// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Why the surfaces are manifold: each occurrence of a leaf is a set of its own in general position, so every
// surface occurs once in an expression of intersections, unions, differences and complements. At the line
// along which two surfaces cross, such an expression equals their intersection or union, or it does not
// depend on them. In neither case do two wedges meet only at the line. With an exclusive or they do. Its
// answer is therefore two solids with disjoint insides, a - b and b - a, and later operators combine the
// pieces one by one: see SolidOrComplement and Sides.
#include "verify/certificate/exact_agreement.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "convert/voxel/voxelise.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/term_walk.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

using voxel::Expression;
using Term = Expression::Term;

/// The largest rounding error of an integer coordinate after corefinement: a few roundings of coordinates up
/// to `reach`. Other coordinates are fractions with denominators below the third power of the lattice's side.
/// On a lattice of up to 512 voxels a side they are at least a thousand times farther from an integer.
double whole_within(double reach) {
  return 64.0 * std::numeric_limits<double>::epsilon() * std::max(reach, 1.0);
}

double reach_of(const brep::Mesh& mesh) {
  double reach = 0.0;
  for (const auto v : mesh.vertices())
    for (unsigned axis = 0; axis < 3; ++axis) reach = std::max(reach, std::abs(mesh.point(v)[axis]));
  return reach;
}

/// Rounds coordinates that differ from integers by rounding errors only, so that faces lie exactly in their
/// planes.
brep::Mesh with_whole_numbers(brep::Mesh mesh) {
  const double tolerance = whole_within(reach_of(mesh));
  for (const auto v : mesh.vertices()) {
    brep::Mesh::Point p = mesh.point(v);
    for (unsigned axis = 0; axis < 3; ++axis)
      if (std::abs(p[axis] - std::round(p[axis])) <= tolerance) p[axis] = std::round(p[axis]);
    mesh.set_point(v, p);
  }
  return mesh;
}

/// A set of points: the inside of a solid, or its outside if `complement` is set.
struct SolidOrComplement {
  brep::Solid solid;
  bool complement = false;
};

/// Returns the leaves of an expression from left to right. Throws for a leaf that is no octree.
std::vector<voxel::Octree> leaves_of(const Expression& expression) {
  std::vector<voxel::Octree> sets;
  voxel::for_each_term(expression, [&](const voxel::MetTerm& met) {
    if (!met.term.leaf) return;
    const auto* octree = std::get_if<voxel::Octree>(&*met.term.leaf);
    if (octree == nullptr)
      throw voxel::InvalidInput("exact agreement: leaf " + std::to_string(sets.size() + 1) +
                                " is no octree; only sets of voxels are the same in both kernels");
    sets.push_back(*octree);
  });
  return sets;
}

/// Converts the motion of a term to the refined lattice. Throws unless it is a translation by whole voxels.
glm::dmat4 refined_motion(const Term& term, const voxel::Universe& own, int refinement) {
  const glm::dmat4 voxels = glm::inverse(own.lps_from_voxel) * term.moved_from_still * own.lps_from_voxel;
  const glm::dvec3 by = glm::round(glm::dvec3(voxels[3]));
  glm::dmat4 whole(1.0);
  whole[3] = glm::dvec4(by, 1.0);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      if (std::abs(voxels[column][row] - whole[column][row]) > whole_within(own.side()))
        throw voxel::InvalidInput("exact agreement: a motion is no translation by whole voxels");
  whole[3] = glm::dvec4(by * static_cast<double>(refinement), 1.0);
  return whole;
}

/// Evaluates one expression, over operands in general position, by octrees and by meshes.
class Evaluation {
 public:
  Evaluation(const voxel::Universe& own, const GeneralPosition& position, const voxel::Progress& progress)
      : own_(own), position_(position), progress_(progress) {}

  /// Replaces the leaves by the octrees of the operands.
  Expression on_octrees(const Expression& expression) {
    std::size_t next = 0;
    return voxel::evaluate_terms<Expression>(
        expression, [&](const Term&) { return Expression(position_.operands[next++].octree); },
        [&](const Term& term, const Expression& part) {
          if (term.kind == Expression::Kind::Not) return ~part;
          return moved(part, refined_motion(term, own_, position_.refinement));
        },
        [](const Term& term, const Expression& left, const Expression& right) {
          switch (term.kind) {
            case Expression::Kind::And:
              return left & right;
            case Expression::Kind::Or:
              return left | right;
            case Expression::Kind::Minus:
              return left - right;
            default:
              return left ^ right;
          }
        });
  }

  /// The inside and the outside of an expression, each as pieces whose insides are disjoint.
  struct Sides {
    std::vector<SolidOrComplement> in, out;
    bool single() const { return in.size() == 1 && out.size() == 1; }
  };
  Sides on_meshes(const Expression& expression) {
    std::size_t next = 0;
    return voxel::evaluate_terms<Sides>(
        expression,
        [&](const Term&) {
          return both({position_.operands[next++].solid, false});
        },
        [&](const Term& term, Sides part) {
          if (term.kind == Expression::Kind::Not) return other(std::move(part));
          const glm::dmat4 motion = refined_motion(term, own_, position_.refinement);
          for (std::vector<SolidOrComplement>* side : {&part.in, &part.out})
            for (SolidOrComplement& piece : *side)
              if (!piece.solid.empty()) piece.solid = brep::moved(piece.solid, motion);
          return part;
        },
        [&](const Term& term, const Sides& left, const Sides& right) { return joined(term, left, right); });
  }

  bool areas_add_up() const { return areas_add_up_; }
  double shift_mm() const { return shift_mm_; }
  std::vector<std::string> findings() { return std::move(findings_); }

  /// Cuts off a piece at the universe's border.
  brep::Solid within_universe(const SolidOrComplement& piece) {
    const double side = position_.universe.side();
    const SolidOrComplement world{
        brep::solid_of(brep::Prism{{0, 1, 0},
                                   {0, 0, 1},
                                   {1, 0, 0},
                                   {{{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}}},
                                   0.0,
                                   side}),
        false};
    if (!piece.complement) {
      const brep::Size& size = piece.solid.size();
      if (glm::all(glm::greaterThan(size.low_mm, glm::dvec3(0.0))) &&
          glm::all(glm::lessThan(size.high_mm, glm::dvec3(side))))
        return piece.solid;
    }
    return intersection(world, piece).solid;
  }

 private:
  Sides joined(const Term& term, const Sides& left, const Sides& right) {
    switch (term.kind) {
      case Expression::Kind::And:
        return intersection(left, right);
      case Expression::Kind::Or:
        return other(intersection(other(left), other(right)));
      case Expression::Kind::Minus:
        return intersection(left, other(right));
      default:
        areas_add_up_ = areas_add_up_ && left.single() && right.single();
        return {joined(pairs(left.in, right.out), pairs(left.out, right.in)),
                joined(pairs(left.in, right.in), pairs(left.out, right.out))};
    }
  }
  static Sides both(const SolidOrComplement& piece) { return {{piece}, {{piece.solid, !piece.complement}}}; }
  static Sides other(Sides sides) {
    std::swap(sides.in, sides.out);
    return sides;
  }
  static std::vector<SolidOrComplement> joined(std::vector<SolidOrComplement> a,
                                               const std::vector<SolidOrComplement>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }
  std::vector<SolidOrComplement> pairs(const std::vector<SolidOrComplement>& a,
                                       const std::vector<SolidOrComplement>& b) {
    std::vector<SolidOrComplement> pieces;
    for (const SolidOrComplement& left : a)
      for (const SolidOrComplement& right : b) {
        SolidOrComplement piece = intersection(left, right);
        if (piece.complement || !piece.solid.empty()) pieces.push_back(std::move(piece));
      }
    return pieces;
  }
  Sides intersection(const Sides& left, const Sides& right) {
    if (left.single() && right.single()) return both(intersection(left.in.front(), right.in.front()));
    // The outside of the intersection consists of the outside of `left`, and of the inside of `left` without
    // `right`. These two parts share faces.
    areas_add_up_ = false;
    return {pairs(left.in, right.in), joined(left.out, pairs(left.in, right.out))};
  }
  SolidOrComplement intersection(const SolidOrComplement& a, const SolidOrComplement& b) {
    using brep::Operation;
    if (a.complement && b.complement) return {boolean(a.solid, Operation::Union, b.solid), true};
    if (a.complement) return {boolean(b.solid, Operation::Difference, a.solid), false};
    if (b.complement) return {boolean(a.solid, Operation::Difference, b.solid), false};
    return {boolean(a.solid, Operation::Intersection, b.solid), false};
  }
  brep::Solid boolean(const brep::Solid& a, brep::Operation operation, const brep::Solid& b) {
    ++corefined_;
    progress_.at(static_cast<double>(corefined_) /
                 static_cast<double>(corefined_ + position_.operands.size()));
    brep::BooleanResult result;
    try {
      result = brep::boolean(a, operation, b, progress_.stop);
    } catch (const brep::Stopped& stopped) {
      throw voxel::Stopped(stopped.what());
    }
    shift_mm_ += result.shift_mm;
    findings_.insert(findings_.end(), result.findings.begin(), result.findings.end());
    return brep::trusted_solid(with_whole_numbers(result.solid), brep::Proof::Rounded);
  }

  const voxel::Universe& own_;
  const GeneralPosition& position_;
  const voxel::Progress& progress_;
  std::size_t corefined_ = 0;
  bool areas_add_up_ = true;
  double shift_mm_ = 0.0;
  std::vector<std::string> findings_;
};

/// Prints an expression with its leaves named a, b, c, ... from left to right.
std::string text_of(const Expression& expression) {
  std::size_t leaves = 0;
  voxel::Labels labels;
  labels.object = [&](const Expression::Leaf&) {
    const std::size_t i = leaves++;
    std::string name(1, static_cast<char>('a' + i % 26));
    if (i >= 26) name += std::to_string(i / 26);
    return name;
  };
  labels.motion = [](const glm::dmat4&) { return std::string("whole_voxels"); };
  return voxel::print_expression(expression, labels);
}

/// The place of the differing voxel that is nearest to the middle of the box of all differing voxels. Its
/// size is the longest side of this box.
WorstPlace worst_of(const ExactAnswers& answers, const voxel::Octree& differing) {
  const voxel::VoxelRange range = voxel::range_of(differing);
  glm::ivec3 found = range.low;
  int nearest = std::numeric_limits<int>::max();
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x) {
        const glm::ivec3 off = glm::abs(2 * glm::ivec3(x, y, z) - range.low - range.high);
        const int distance = off.x + off.y + off.z;
        if (distance >= nearest || !differing.contains({x, y, z})) continue;
        nearest = distance;
        found = {x, y, z};
      }
  const glm::ivec3 dims = range.dims();
  return {answers.lps_from_unit * glm::dvec4(glm::dvec3(found) + 0.5, 1.0),
          std::max({dims.x, dims.y, dims.z}) * std::cbrt(answers.unit_mm3),
          answers.octree.contains(found) ? part_of_voxels_only : part_of_mesh_only};
}

}  // namespace

ExactAnswers exact_answers(const Expression& expression, const voxel::Progress& progress) {
  const std::vector<voxel::Octree> sets = leaves_of(expression);
  const voxel::Universe own = sets.front().universe();
  const GeneralPosition position = general_position(sets, voxel::part_of(progress, 0.0, 0.5));
  const voxel::Progress evaluating = voxel::part_of(progress, 0.5, 1.0);
  Evaluation evaluation(own, position, evaluating);
  ExactAnswers answers{
      voxel::combine(position.universe, evaluation.on_octrees(expression)),
      {},
      text_of(expression),
      own.lattice().voxel_mm3() / std::pow(position.refinement, 3),
      glm::scale(glm::translate(own.lps_from_voxel, glm::dvec3(-0.5)), glm::dvec3(1.0 / position.refinement)),
      true,
      0.0,
      {}};
  for (const SolidOrComplement& piece : evaluation.on_meshes(expression).in) {
    const brep::Solid solid = evaluation.within_universe(piece);
    if (!solid.empty()) answers.solids.push_back(solid);
  }
  answers.areas_add_up = evaluation.areas_add_up();
  answers.shift_mm = evaluation.shift_mm();
  answers.findings = evaluation.findings();
  return answers;
}

std::optional<std::int64_t> whole_volume(const std::vector<brep::Mesh>& solids) {
  using Whole = glm::vec<3, std::int64_t>;
  std::int64_t six = 0;
  // A long double has 64 bits of mantissa: a sum of n terms below r^3 is off by less than n^2 r^3 2^-64 / 2.
  // Rounding the points moves n triangles with areas below r^2 by r 2^-53 each.
  long double rest = 0.0;
  for (const brep::Mesh& solid : solids)
    for (const auto face : solid.faces()) {
      glm::vec<3, long double> p[3];
      bool whole = true;
      int corner = 0;
      for (const auto v : face.vertices()) {
        const auto& point = solid.point(v);
        p[corner++] = {point[0], point[1], point[2]};
        for (unsigned axis = 0; axis < 3; ++axis) whole = whole && point[axis] == std::round(point[axis]);
      }
      if (whole) {
        const Whole a(p[0]), b(p[1]), c(p[2]);
        six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
      } else {
        rest += glm::dot(p[0], glm::cross(p[1], p[2]));
      }
    }
  const long double total = static_cast<long double>(six) + rest;
  const auto volume = static_cast<std::int64_t>(std::llround(total / 6.0L));
  // The sum is six times the volume. A wrong answer is off by six for each voxel; the rounding of a right
  // answer is far below a hundredth.
  if (std::abs(total - 6.0L * static_cast<long double>(volume)) > 0.01L) return std::nullopt;
  return volume;
}

Certificate certify_exact(const ExactAnswers& answers) {
  const auto start = std::chrono::steady_clock::now();
  Certificate certificate;
  certificate.operation = answers.operation;
  certificate.tier = Tier::Exact;
  const auto fail = [&](const std::string& reason) { lower(certificate, Verdict::Fail, reason); };
  const double unit_mm2 = std::pow(answers.unit_mm3, 2.0 / 3.0);
  const auto voxels = static_cast<std::int64_t>(answers.octree.voxel_count());
  const auto faces = static_cast<double>(voxel::cuberille_faces(answers.octree).face_count());
  certificate.voxel = {
      "Boolean of octrees in one walk, on refined sets whose voxels do not touch at edges or corners",
      static_cast<double>(voxels) * answers.unit_mm3, faces * unit_mm2, std::nullopt};
  certificate.mesh = {"corefinement of the same sets' cuberilles", 0.0, 0.0, std::nullopt};

  double area = 0.0, float_volume = 0.0;
  std::uint64_t filled = 0;
  Expression either = voxel::Octree::empty(answers.octree.universe());
  for (const brep::Mesh& solid : answers.solids) {
    const brep::Health health = brep::health(solid, {.self_intersections = false});
    if (!health.closed || !health.oriented) {
      fail("A solid of the mesh kernel is not closed and oriented" +
           (health.findings.empty() ? "." : ": " + health.findings.front()));
      if (!health.closed) continue;
    }
    area += brep::measure(solid).area_mm2;
    float_volume += brep::volume_mm3(solid);
    const voxel::Octree part = convert::voxelise(answers.octree.universe(), brep::linked_of(solid));
    filled += part.voxel_count();
    either = either | Expression(part);
  }
  const voxel::Octree united = voxel::combine(answers.octree.universe(), either);
  const std::optional<std::int64_t> volume = whole_volume(answers.solids);
  certificate.mesh.volume_mm3 = (volume ? static_cast<double>(*volume) : float_volume) * answers.unit_mm3;
  certificate.mesh.area_mm2 = area * unit_mm2;
  certificate.difference_mm3 = certificate.voxel.volume_mm3 - certificate.mesh.volume_mm3;
  const voxel::Octree differing =
      voxel::combine(answers.octree.universe(), Expression(answers.octree) ^ Expression(united));
  certificate.symmetric_difference_mm3 = static_cast<double>(differing.voxel_count()) * answers.unit_mm3;

  if (!volume) fail("The mesh kernel's volume is not a whole number of voxels.");
  if (volume && *volume != voxels)
    fail("The mesh kernel's volume is " + std::to_string(*volume) + " refined voxels, the voxel kernel's " +
         std::to_string(voxels) + ".");
  if (!differing.is_empty()) {
    certificate.worst = worst_of(answers, differing);
    fail("Voxels with a total volume of " + voxel::rounded(certificate.symmetric_difference_mm3) +
         " mm3 are inside for one kernel only; they extend " + voxel::rounded(certificate.worst->size_mm) +
         " mm, near " + voxel::rounded(certificate.worst->at_mm) + ": " + certificate.worst->what + ".");
  }
  if (filled != united.voxel_count()) fail("Solids of the mesh kernel overlap that should only touch.");
  // Areas are whole numbers, too. They are sums of square roots with an error of one unit in the last place
  // each.
  if (answers.areas_add_up && std::abs(area - faces) > 1e-9 * (faces + 1.0))
    fail("The mesh kernel's area differs from the voxel kernel's by " + voxel::rounded(area - faces) +
         " faces of refined voxels.");
  if (answers.shift_mm > 0.0)
    fail("Corefinement moved operands that are in general position, by " + voxel::rounded(answers.shift_mm) +
         " refined voxels.");
  certificate.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

}  // namespace octotomy::verify
