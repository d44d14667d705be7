// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 refuse inside-out operands; 2 sort the operands, so that the bits depend neither on the caller's order
// nor on addresses; 3 where faces lie on one plane but for rounding, go on in a frame in which they do
// exactly; 4 cut near the common lines only, or corefine the whole where that fails; 5 check the volumes
// against each other, and the places of all shells by lines through them; 6 where a wanted result is not
// manifold, a check of step 5 fails or triangles intersect, try cells between the planes, then operands that
// have the same triangles on planes in common; 7 where all of this fails, move the second operand by a
// negligible length, and report that.
#include "brep/boolean/boolean.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "brep/boolean/common_frame.h"
#include "brep/boolean/corefine.h"
#include "brep/boolean/corefine_batches.h"
#include "brep/boolean/imprint.h"
#include "brep/boolean/line_agreement.h"
#include "brep/boolean/near_boolean.h"
#include "brep/boolean/rectilinear.h"
#include "brep/boolean/settle.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/split_fans.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

/// The names of the caller's operands in messages.
struct Names {
  std::string first, second;
  std::string of(std::size_t result) const {
    return result == of_union          ? "the union"
           : result == of_intersection ? "the intersection"
           : result == of_a_minus_b    ? first + " - " + second
                                       : second + " - " + first;
  }
};

void check_operand(const Solid& solid, const std::string& name) {
  const double volume_mm3 = solid.size().volume_mm3;
  if (!std::isfinite(volume_mm3) || volume_mm3 < 0.0)
    throw InvalidInput("operand " + name + " has volume " + std::to_string(volume_mm3) +
                       " mm3: its triangles face inward; reverse them first");
}

double extent_mm(const Size& a, const Size& b) {
  return glm::length(glm::max(a.high_mm, b.high_mm) - glm::min(a.low_mm, b.low_mm));
}

/// The largest coordinate, which determines the last place of the points.
double reach_mm(const Size& a, const Size& b) {
  double reach = 0.0;
  for (const glm::dvec3& p : {a.low_mm, a.high_mm, b.low_mm, b.high_mm})
    reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return reach;
}

/// The largest error of a sum of volumes of correct results. Rounding moves a new point, and thus the
/// surface, by at most half a unit of the last place in each coordinate, and errors of either sign cancel. On
/// skulls of 600k triangles the sums are wrong by less than a hundredth of one unit times the whole area.
/// Slivers that cross at a small angle may be worse. 2^12 units leave room for slivers and are still far
/// below the volume of a lost triangle.
double volume_tolerance_mm3(const Size& a, const Size& b) {
  return 0x1p12 * std::numeric_limits<double>::epsilon() * reach_mm(a, b) * (a.area_mm2 + b.area_mm2);
}

/// The shift for a further attempt: 2^-18 of the extent at first, about 1 um for a head of 250 mm. Later
/// attempts shift in the opposite direction and farther. The shift is 2^34 times the last place, so that no
/// parts stay in contact, and far below a voxel. Its direction is unlikely to be parallel to any plane or
/// edge.
glm::dvec3 shift_mm(int attempt, double extent) {
  assert(attempt >= 0 && std::isfinite(extent));
  if (attempt == 0) return glm::dvec3(0.0);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1.0, std::cbrt(2.0), std::cbrt(4.0)));
  const double steps = attempt % 2 == 1 ? attempt : -attempt;
  return direction * (steps * 0x1p-18 * extent);
}
constexpr int attempt_count = 4;

/// The wanted results, and those that the check of volumes needs: always the intersection and, if no other
/// result is wanted, the difference whose minuend has fewer triangles.
Wanted with_witnesses(Wanted wanted, const Mesh& a, const Mesh& b) {
  assert(wanted[of_union] || wanted[of_intersection] || wanted[of_a_minus_b] || wanted[of_b_minus_a]);
  wanted[of_intersection] = true;
  if (!wanted[of_union] && !wanted[of_a_minus_b] && !wanted[of_b_minus_a])
    wanted[a.n_faces() < b.n_faces() ? of_a_minus_b : of_b_minus_a] = true;
  return wanted;
}

using Volumes = std::array<std::optional<double>, 4>;

/// The largest error of the identities between volumes, mm3; none if too few volumes are known.
std::optional<double> disagreement_mm3(const Volumes& volumes, double a_mm3, double b_mm3) {
  std::optional<double> worst;
  const auto compare = [&](double whole, const std::optional<double>& part,
                           const std::optional<double>& rest) {
    if (part && rest) worst = std::max(worst.value_or(0.0), std::abs(whole - (*part + *rest)));
  };
  compare(a_mm3 + b_mm3, volumes[of_union], volumes[of_intersection]);
  compare(a_mm3, volumes[of_a_minus_b], volumes[of_intersection]);
  compare(b_mm3, volumes[of_b_minus_a], volumes[of_intersection]);
  return worst;
}

/// The number of positions in a box at which several vertices lie. Where sheets of the surface touch,
/// corefinement creates a vertex for each sheet.
std::size_t shared_point_count(const Triangles& surface, const glm::dvec3& low, const glm::dvec3& high) {
  assert(!glm::any(glm::isnan(low)) && !glm::any(glm::isnan(high)));
  std::vector<glm::dvec3> points;
  for (const glm::dvec3& p : surface.points_mm)
    if (glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high))) points.push_back(p);
  std::sort(points.begin(), points.end(), [](const glm::dvec3& p, const glm::dvec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  });
  std::size_t count = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i] == points[i - 1] && (i == 1 || points[i] != points[i - 2])) ++count;
  return count;
}

std::string missing_of(const Results& results, const Wanted& wanted, const Names& names) {
  std::string missing;
  for (std::size_t r = 0; r < results.size(); ++r)
    if (wanted[r] && !results[r]) missing += (missing.empty() ? "" : ", ") + names.of(r);
  return missing;
}

/// The results of one attempt, with the facts that their checks need.
struct Attempt {
  Results results;
  Volumes volumes_mm3;
  std::optional<double> disagreement_mm3;
  std::vector<Corners> widest;  ///< triangles of the operands through which lines are tested; empty: not
                                ///< chosen yet
  std::array<std::size_t, 4> films{};
  std::size_t flat = 0;
  double shift_mm = 0.0;
  std::vector<std::string> findings;
  std::string failure;  ///< empty if all wanted results exist and add up
};

struct Question {
  const Solid& a;
  const Solid& b;
  Wanted wanted;
  Names names;
  const std::stop_token& stop;
};

/// The union of pieces that share whole triangles with opposite winding, such as both differences and the
/// intersection of two solids. Unlike corefinement, this works also where sheets touch along edges. None if
/// the remaining triangles are not closed.
std::optional<Triangles> union_of_pieces(const std::array<const Triangles*, 3>& pieces) {
  Triangles all;
  PointNumbers numbers(all.points_mm);
  using Face = std::array<std::uint32_t, 3>;
  const auto from_least = [](Face face) {
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    return face;
  };
  std::map<Face, int> times;
  for (const Triangles* piece : pieces)
    for (const Face& face : piece->faces) {
      Face own;
      for (std::size_t k = 0; k < 3; ++k) own[k] = numbers.number_of(piece->points_mm[face[k]]);
      const auto reverse = times.find(from_least({own[0], own[2], own[1]}));
      if (reverse == times.end() || reverse->second == 0)
        ++times[from_least(own)];
      else
        --reverse->second;
    }
  for (const auto& [face, count] : times)
    for (int k = 0; k < count; ++k) all.faces.push_back(face);
  const SplitFans split = split_fans(all);
  const Linked joined = linked(split.surface);
  if (!joined.is_closed() || !split.left_out.empty()) return std::nullopt;
  return in_coordinate_order(mesh_of(joined));
}

/// If the union is wanted and missing, computes the other results and unites them.
void add_union_of_pieces(const Question& question, const Solid& b, Corefined& corefined) {
  if (!question.wanted[of_union] || corefined.results[of_union] || !corefined.failure.empty()) return;
  Corefined pieces = corefine(question.a, b, {false, true, true, true}, question.stop);
  const auto &common = pieces.results[of_intersection], &of_a = pieces.results[of_a_minus_b],
             &of_b = pieces.results[of_b_minus_a];
  if (!common || !of_a || !of_b) return;
  corefined.results[of_union] = union_of_pieces({&*common, &*of_a, &*of_b});
  if (!corefined.results[of_intersection])
    corefined.results[of_intersection] = std::move(*pieces.results[of_intersection]);
}

/// Corefines all triangles.
Attempt whole_attempt(const Question& question, const Solid& b) {
  Attempt attempt;
  Corefined corefined = corefine_in_batches(
      question.a, b, with_witnesses(question.wanted, question.a, question.b), question.stop);
  add_union_of_pieces(question, b, corefined);
  attempt.failure = corefined.failure;
  for (std::size_t r = 0; r < corefined.results.size(); ++r)
    if (corefined.results[r]) attempt.volumes_mm3[r] = size_of(*corefined.results[r]).volume_mm3;
  attempt.results = std::move(corefined.results);
  attempt.films = corefined.films;
  attempt.flat = corefined.flat;
  if (corefined.meets_itself)
    attempt.findings.emplace_back(
        "an operand intersects itself where the other cuts it; the result's volumes add up, but check its "
        "health");
  return attempt;
}

Attempt near_attempt(const Question& question, const Solid& b) {
  Attempt attempt;
  NearBoolean answer = near_boolean(question.a, b, question.wanted, question.stop);
  attempt.failure = answer.obstacle;
  if (answer.meets_itself) attempt.failure = "an operand intersects itself where the other cuts it";
  attempt.results = std::move(answer.results);
  attempt.volumes_mm3 = answer.volumes_mm3;
  attempt.widest = std::move(answer.widest);
  attempt.flat = answer.flat;
  return attempt;
}

/// Records as failure: wanted results that are missing, volumes that do not add up, or a line through a shell
/// that disagrees.
void judge(const Question& question, const Solid& b, Attempt& attempt) {
  const std::string missing = missing_of(attempt.results, question.wanted, question.names);
  if (!missing.empty()) {
    if (attempt.failure.empty())
      attempt.failure = missing + " would not be manifold, because the surfaces only touch";
    return;
  }
  attempt.failure.clear();
  attempt.disagreement_mm3 =
      disagreement_mm3(attempt.volumes_mm3, volume_mm3(question.a), volume_mm3(question.b));
  const double tolerance = volume_tolerance_mm3(question.a.size(), question.b.size());
  if (!attempt.disagreement_mm3)
    attempt.findings.emplace_back("the volumes could not be checked, because too few results are manifold");
  else if (*attempt.disagreement_mm3 > tolerance)
    attempt.failure = "the results' volumes are " + std::to_string(*attempt.disagreement_mm3) +
                      " mm3 from adding up, " + std::to_string(tolerance) + " is allowed";
  if (!attempt.failure.empty()) return;
  // A check by volumes misses a surplus shell that is also in the other result of the identity. A check by
  // lines finds it.
  const auto wrong =
      attempt.widest.empty()
          ? disagreement_along_lines(question.a, b, attempt.results, question.wanted)
          : disagreement_along_lines(question.a, b, attempt.results, question.wanted, attempt.widest);
  if (wrong) attempt.failure = question.names.of(wrong->result) + text_of(*wrong);
}

Attempt best_attempt(const Question& question, const Solid& b) {
  Attempt near = near_attempt(question, b);
  if (near.failure.empty()) judge(question, b, near);
  if (near.failure.empty()) return near;
  Attempt whole = whole_attempt(question, b);
  judge(question, b, whole);
  return whole;
}

/// Computes the results from the cells between the planes of all faces, all of which must be square to the
/// axes. Used where corefinement fails: for surfaces that touch themselves, and for results that cross
/// themselves.
Attempt rectilinear_attempt(const Question& question, double tolerance_mm) {
  Attempt attempt;
  std::optional<Results> results =
      rectilinear_results(question.a.triangles(), question.b.triangles(),
                          with_witnesses(question.wanted, question.a, question.b), tolerance_mm);
  if (!results) {
    attempt.failure = "some faces are not square to the axes";
    return attempt;
  }
  for (std::size_t r = 0; r < results->size(); ++r)
    if ((*results)[r]) attempt.volumes_mm3[r] = size_of(*(*results)[r]).volume_mm3;
  attempt.results = *std::move(results);
  judge(question, question.b, attempt);
  return attempt;
}

Attempt shifted_attempt(const Question& question, const glm::dvec3& shift) {
  Mesh b = question.b.mesh();
  for (const auto v : b.vertices()) b.set_point(v, b.point(v) + Mesh::Point(shift.x, shift.y, shift.z));
  return best_attempt(question, trusted_solid(b, Proof::Rounded));
}

/// Reports positions at which sheets of a result touch. They can only lie where the boxes of both operands
/// overlap, so only this region is searched.
void tell_touching(const Question& question, Attempt& attempt) {
  const Size &a = question.a.size(), &b = question.b.size();
  const double margin = glm::length(shift_mm(attempt_count, extent_mm(a, b)));
  const glm::dvec3 low = glm::max(a.low_mm, b.low_mm) - margin;
  const glm::dvec3 high = glm::min(a.high_mm, b.high_mm) + margin;
  for (std::size_t r = 0; r < attempt.results.size(); ++r) {
    assert(!question.wanted[r] || attempt.results[r]);
    const std::size_t count = question.wanted[r] ? shared_point_count(*attempt.results[r], low, high) : 0;
    if (count > 0)
      attempt.findings.push_back(question.names.of(r) + " touches itself at " + std::to_string(count) +
                                 (count == 1 ? " point" : " points"));
  }
}

void tell_films(const Question& question, Attempt& attempt) {
  for (std::size_t r = 0; r < attempt.films.size(); ++r)
    if (question.wanted[r] && attempt.films[r] > 0)
      attempt.findings.push_back(
          question.names.of(r) + " is without " + std::to_string(attempt.films[r]) +
          (attempt.films[r] == 1 ? " film" : " films") +
          " thinner than the rounding of points, left where faces coincide except for their last digits");
}

void tell_flat(Attempt& attempt) {
  if (attempt.flat > 0)
    attempt.findings.push_back(
        "triangles without area were taken out of the operands by " + std::to_string(attempt.flat) +
        (attempt.flat == 1 ? " other diagonal" : " other diagonals") + "; their surfaces are unchanged");
}

/// Removes folds that rounding made, reports those that cannot be removed, and returns their number.
std::size_t settle(const Question& question, Attempt& attempt, SettleReach reach) {
  std::size_t unfit = 0;
  for (std::size_t r = 0; r < attempt.results.size(); ++r) {
    if (!question.wanted[r] || attempt.results[r]->faces.empty()) continue;
    Settled done =
        settled(std::move(*attempt.results[r]), {&question.a.triangles(), &question.b.triangles()}, reach);
    attempt.results[r] = std::move(done.surface);
    unfit += done.crossing + done.flat;
    if (done.crossing > 0)
      attempt.findings.push_back(question.names.of(r) + " crosses itself: " + std::to_string(done.crossing) +
                                 (done.crossing == 1 ? " pair" : " pairs") + " of triangles, first at (" +
                                 short_text(done.at_mm.x) + ", " + short_text(done.at_mm.y) + ", " +
                                 short_text(done.at_mm.z) + ") mm; repair the result before using it");
  }
  return unfit;
}

/// The wanted results as triangles, before they become solids.
struct Answer {
  Results results;
  std::optional<double> residual;
  double shift_mm = 0.0;
  std::vector<std::string> findings;
  std::size_t unfit = 0;  ///< pairs of triangles that intersect, and triangles without area
};

Answer answer_of(const Question& question, Attempt attempt, SettleReach reach = SettleReach::NewPoints) {
  assert(attempt.failure.empty());
  Answer answer;
  answer.unfit = settle(question, attempt, reach);
  tell_touching(question, attempt);
  tell_films(question, attempt);
  tell_flat(attempt);
  const double whole = volume_mm3(question.a) + volume_mm3(question.b);
  if (attempt.disagreement_mm3) answer.residual = whole > 0.0 ? *attempt.disagreement_mm3 / whole : 0.0;
  answer.results = std::move(attempt.results);
  answer.shift_mm = attempt.shift_mm;
  answer.findings = std::move(attempt.findings);
  return answer;
}

/// Reports that points were moved onto common planes. Moves within the rounding of doubles, which every new
/// point undergoes, are not reported.
void tell_coplanar(const Question& question, double moved_mm, Attempt& attempt) {
  const double area_mm2 = question.a.size().area_mm2 + question.b.size().area_mm2;
  if (moved_mm <= volume_tolerance_mm3(question.a.size(), question.b.size()) / area_mm2) return;
  attempt.findings.push_back("coplanar: faces of " + question.names.first + " and " + question.names.second +
                             " within " + short_text(moved_mm) +
                             " mm of one plane count as lying on it, because points are rounded to floats; "
                             "this changes a volume by at most " +
                             short_text(moved_mm * area_mm2) + " mm3");
}

/// The first answer without folds; if there is none, the answer with the fewest folds.
class Best {
 public:
  bool is_found() const { return best_ && best_->unfit == 0; }
  void add(const Question& question, Attempt attempt, SettleReach reach = SettleReach::NewPoints) {
    if (!attempt.failure.empty()) return;
    Answer answer = answer_of(question, std::move(attempt), reach);
    if (!best_ || answer.unfit < best_->unfit) best_ = std::move(answer);
  }
  std::optional<Answer>& answer() { return best_; }

 private:
  std::optional<Answer> best_;
};

/// Computes answers in a frame in which faces that lie on one plane, apart from rounding, lie on it exactly.
void answer_in_common_frame(const Question& question, Best& best) {
  const std::optional<CommonFrame> frame = common_frame(question.a, question.b);
  if (!frame) return;
  const Question turned{frame->a, frame->b, question.wanted, question.names, question.stop};
  for (const bool by_cells : {false, true}) {
    Attempt attempt =
        by_cells ? rectilinear_attempt(turned, frame->tolerance_mm) : best_attempt(turned, frame->b);
    if (!attempt.failure.empty()) continue;
    for (std::optional<Triangles>& result : attempt.results)
      if (result) result = frame->moved_back(*result);
    tell_coplanar(question, frame->moved_mm, attempt);
    best.add(question, std::move(attempt), SettleReach::CommonBox);
    if (best.is_found()) return;
  }
}

/// Computes an answer from operands that have the same triangles on their common planes. These planes may
/// have several directions.
void answer_of_imprinted(const Question& question, Best& best) {
  const std::optional<Imprinted> divided = imprinted(question.a, question.b);
  if (!divided) return;
  const Question both{divided->a, divided->b, question.wanted, question.names, question.stop};
  Attempt attempt = best_attempt(both, divided->b);
  tell_coplanar(question, divided->moved_mm, attempt);
  best.add(both, std::move(attempt), SettleReach::CommonBox);
}

Answer answer(const Question& question) {
  Best best;
  answer_in_common_frame(question, best);
  if (best.is_found()) return *std::move(best.answer());
  const bool has_frame = best.answer().has_value();
  std::string first_failure;
  if (!has_frame) {
    Attempt attempt = best_attempt(question, question.b);
    first_failure = attempt.failure;
    best.add(question, std::move(attempt));
    if (!best.is_found()) best.add(question, rectilinear_attempt(question, 0.0));
  }
  if (!best.is_found()) answer_of_imprinted(question, best);
  if (best.answer()) return *std::move(best.answer());
  const double extent = extent_mm(question.a.size(), question.b.size());
  for (int i = 1; i < attempt_count; ++i) {
    const glm::dvec3 shift = shift_mm(i, extent);
    Attempt attempt = shifted_attempt(question, shift);
    if (!attempt.failure.empty()) continue;
    attempt.shift_mm = glm::length(shift);
    attempt.findings.push_back(
        "shifted: " + question.names.second + " was moved by (" + short_text(shift.x) + ", " +
        short_text(shift.y) + ", " + short_text(shift.z) + ") mm, which changes a volume by at most " +
        short_text(attempt.shift_mm * question.b.size().area_mm2) + " mm3, as " + first_failure);
    return answer_of(question, std::move(attempt));
  }
  throw Error(ErrorCode::Geometry,
              "no Boolean: " + first_failure + ", and moving " + question.names.second + " by up to " +
                  short_text(glm::length(shift_mm(attempt_count - 1, extent))) +
                  " mm did not help; check the health of both operands and repair them, or move one");
}

/// Whether a comes after b in an order of meshes, which makes a result independent of the order of the
/// arguments.
bool comes_after(const Triangles& a, const Triangles& b) {
  if (a.faces.size() != b.faces.size()) return a.faces.size() > b.faces.size();
  const auto less = [](const glm::dvec3& p, const glm::dvec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  return std::lexicographical_compare(b.points_mm.begin(), b.points_mm.end(), a.points_mm.begin(),
                                      a.points_mm.end(), less);
}

Answer answer(const Solid& a, const Solid& b, const Wanted& wanted, const std::stop_token& stop) {
  if (stop.stop_requested()) throw BooleanStopped();
  check_operand(a, "a");
  check_operand(b, "b");
  if (!comes_after(a.triangles(), b.triangles())) return answer({a, b, wanted, {"a", "b"}, stop});
  Wanted turned = wanted;
  std::swap(turned[of_a_minus_b], turned[of_b_minus_a]);
  Answer answer_to_turned = answer({b, a, turned, {"b", "a"}, stop});
  std::swap(answer_to_turned.results[of_a_minus_b], answer_to_turned.results[of_b_minus_a]);
  return answer_to_turned;
}

}  // namespace

Booleans booleans(const Solid& a, const Solid& b, const BooleansWanted& wanted, const std::stop_token& stop) {
  Answer found = answer(a, b, {wanted.united, wanted.intersection, wanted.a_minus_b, wanted.b_minus_a}, stop);
  Booleans booleans;
  const auto make = [&](ResultPlace place, std::optional<Solid>& solid) {
    if (found.results[place]) solid = trusted_solid(std::move(*found.results[place]), Proof::Rounded);
  };
  make(of_union, booleans.united);
  make(of_intersection, booleans.intersection);
  make(of_a_minus_b, booleans.a_minus_b);
  make(of_b_minus_a, booleans.b_minus_a);
  booleans.residual = found.residual;
  booleans.shift_mm = found.shift_mm;
  booleans.findings = std::move(found.findings);
  return booleans;
}

BooleanResult boolean(const Solid& a, Operation operation, const Solid& b, const std::stop_token& stop) {
  const ResultPlace place = operation == Operation::Union          ? of_union
                            : operation == Operation::Intersection ? of_intersection
                                                                   : of_a_minus_b;
  Wanted wanted{};
  wanted[place] = true;
  Answer found = answer(a, b, wanted, stop);
  return {trusted_solid(std::move(found.results[place].value()), Proof::Rounded), found.residual,
          found.shift_mm, std::move(found.findings)};
}

BooleanResult boolean(const std::vector<Solid>& operands, Operation operation, const std::stop_token& stop) {
  if (operands.empty()) throw std::invalid_argument("a Boolean needs at least one operand");
  BooleanResult all;
  const auto combine = [&](const Solid& a, Operation step, const Solid& b) {
    BooleanResult result = boolean(a, step, b, stop);
    if (result.residual) all.residual = std::max(all.residual.value_or(0.0), *result.residual);
    all.shift_mm += result.shift_mm;
    all.findings.insert(all.findings.end(), result.findings.begin(), result.findings.end());
    return result.solid;
  };
  const auto in_pairs = [&](std::vector<Solid> solids, Operation step) {
    while (solids.size() > 1) {
      std::vector<Solid> half;
      for (std::size_t i = 0; i + 1 < solids.size(); i += 2)
        half.push_back(combine(solids[i], step, solids[i + 1]));
      if (solids.size() % 2 == 1) half.push_back(solids.back());
      solids = std::move(half);
    }
    return solids.front();
  };
  if (operation != Operation::Difference || operands.size() == 1) {
    all.solid = in_pairs(operands, operation);
  } else {
    const Solid others = in_pairs({operands.begin() + 1, operands.end()}, Operation::Union);
    all.solid = combine(operands.front(), Operation::Difference, others);
  }
  return all;
}

}  // namespace octotomy::brep
