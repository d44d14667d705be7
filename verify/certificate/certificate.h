// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "verify/witness/line_count.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

using voxel::Verdict;

enum class Tier { Exact, Bounded, ClosedForm };

/// One kernel's answer and the computation that produced it.
struct Answer {
  std::string lineage;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;
  /// Names of all code that computed the answer or its operands, back to the scan: one clause each, in
  /// ascending order.
  std::vector<std::string> makers = {};
};
/// The makers that two answers share.
std::vector<std::string> shared_makers(const Answer& a, const Answer& b);

/// One source of difference that theory allows.
struct ToleranceTerm {
  std::string name;     ///< a key: "count", "flat", ...
  std::string cause;    ///< a sentence for people
  std::string formula;  ///< formula of value_mm3, for the report
  double value_mm3 = 0.0;
};

/// One quantity of both answers, with a verdict of its own.
struct Comparison {
  std::string quantity;  ///< "volume", "centroid", "euler", ...
  std::string unit;      ///< "mm3", "mm2", "mm", "mm5"; empty for a count
  /// Each kernel's value. None if the quantity itself is a difference, such as the distance between the
  /// answers' surfaces.
  std::optional<double> voxel = {}, mesh = {};
  double difference = 0.0;               ///< compared with the tolerance, not negative
  std::optional<double> tolerance = {};  ///< none: theory has no bound, and there is no verdict
  std::string formula = {};              ///< of the tolerance, or the reason why there is none
  /// First clause of the reason where the difference is too large; % stands for the difference: "The
  /// centroids are % apart". Empty: the reason quotes both answers.
  std::string statement = {};
  Verdict verdict = Verdict::Pass;
};

/// An object that is too small or too thin for its voxels. Its PASS proves little; its FAIL remains valid.
struct Unresolved {
  /// The smallest extent of the object's box, or the object's mean thickness. None: the object is unresolved
  /// for another reason.
  std::optional<double> extent_voxels;
  std::string reason;  ///< a clause: "the object's smallest extent is 2.4 voxels, six are needed"
};
/// A certificate that could pass with a wrong part larger than this share of the object's volume is no
/// evidence.
inline constexpr double evident_share = 0.1;

/// The place at which the two answers differ most.
struct WorstPlace {
  glm::dvec3 at_mm{0.0};
  double size_mm = 0.0;     ///< distance of the surfaces there, or extent of the differing part
  std::string what;         ///< a clause: "the mesh has a part there that the voxels lack"
  double volume_mm3 = 0.0;  ///< volume of the differing part; zero: unknown
};
inline constexpr const char* part_of_mesh_only = "the mesh has a part there that the voxels lack";
inline constexpr const char* part_of_voxels_only = "the voxels have a part there that the mesh lacks";

/// The smallest error that a certificate detects in this object, measured by injecting errors into it.
struct DetectionLimit {
  double volume_mm3 = 0.0;  ///< volume of one connected part that one kernel or both lose or add
  /// Shift of the whole object, in any direction. None: not even a shift of four voxels is detected.
  std::optional<double> shift_mm;
};

/// Both kernels' answers to one question, their difference, the difference that theory allows, and a verdict.
struct Certificate {
  std::string operation;
  Tier tier = Tier::Bounded;
  Answer voxel;
  Answer mesh;
  double difference_mm3 = 0.0;  ///< voxel minus mesh
  double tolerance_mm3 = 0.0;
  std::vector<ToleranceTerm> terms;
  double symmetric_difference_mm3 = 0.0;  ///< volume of the voxels that only one answer holds
  double symmetric_difference_tolerance_mm3 = 0.0;
  std::optional<double> centroid_distance_mm;
  std::optional<double> centroid_tolerance_mm;
  std::optional<double> hausdorff_mm;    ///< largest distance, both ways, between voxel faces and triangles
  std::optional<double> hausdorff95_mm;  ///< the larger of both directions' 95th percentiles by area
  std::optional<WorstPlace> worst;       ///< none: the answers are equal, or there is no mesh to compare
  std::optional<DetectionLimit> limit;   ///< none if no smallest detected error was determined
  std::vector<WorstPlace> bridges;       ///< parts beyond thin necks that one kernel alone has, largest first
  /// volume along lines through the scan, computed by code of neither kernel
  std::optional<LineCount> third;
  /// Inputs that both kernels share and neither computed: filtered samples, and values that a step measures once for
  /// both.
  std::vector<std::string> shared_values;
  std::vector<Comparison> comparisons;  ///< every quantity that was compared
  Verdict verdict = Verdict::Pass;
  std::vector<std::string> reasons;  ///< why the verdict is not PASS
  std::optional<Unresolved> unresolved;
  double milliseconds = 0.0;

  bool resolved() const { return !unresolved; }
  /// Whether the two answers have no maker in common.
  bool independent() const { return shared_makers(voxel, mesh).empty(); }
  /// Volume of the largest wrong part that could pass: the detection limit if there is one, else the
  /// tolerance.
  double unseen_mm3() const { return limit ? limit->volume_mm3 : tolerance_mm3; }
  /// The larger of the two volumes' absolute values.
  double larger_mm3() const;
};

/// Whether the verdict rests on evidence: the voxels resolve the object, or the detection limit is at most
/// evident_share of the object's volume.
bool is_evident(const Certificate& certificate);
/// Sets `unresolved` if a wrong part of more than evident_share of the object could pass, or if the volume's
/// tolerance exceeds that share of the object. Keeps an `unresolved` that is set already.
void judge_evidence(Certificate& certificate);
/// Lowers the verdict to WARN where both answers are empty, because nothing was compared. The reason states
/// `missed_mm3`, the volume of a part that could have been missed.
void judge_emptiness(Certificate& certificate, double missed_mm3);
/// Lowers the verdict to WARN where the answers share makers. The reason names them.
void judge_independence(Certificate& certificate);

/// Adds a comparison and sets its verdict: PASS up to the tolerance, WARN up to twice the tolerance, FAIL
/// beyond that and for a difference that is not a number; but never worse than `worst_verdict`. Lowers the
/// certificate's verdict to it and adds a reason.
void add_comparison(Certificate& certificate, Comparison comparison, Verdict worst_verdict = Verdict::Fail);
/// Adds the reason, and sets the certificate's verdict to `verdict` if that is worse.
void lower(Certificate& certificate, Verdict verdict, const std::string& reason);

/// Returns a sentence, for example: "The two surfaces differ by up to 6.04 mm near (12, -80, 44): the mesh
/// has a part there that the voxels lack."
std::string text_of(const WorstPlace& worst);

/// The largest ratio of difference to tolerance over all comparisons; up to 1 is PASS. With tolerance zero
/// the ratio is 0 without a difference and infinite with one.
double worst_share(const Certificate& certificate);

/// Whether a's verdict is worse than b's. Of equal verdicts, a resolved object's is worse than an unresolved one's.
/// If that is equal, too, the certificate with the larger worst_share() is worse.
bool is_worse(const Certificate& a, const Certificate& b);

/// A certificate with the two objects that it compares, for pictures of their difference.
struct Contested {
  Certificate certificate;
  voxel::Octree octree;
  std::optional<brep::Solid> solid;
};
/// Replaces `kept` by `found` if `found` is worse (is_worse()). Of equals the earlier one stays, so the
/// result depends only on the order of the calls.
void keep_worse(std::optional<Contested>& kept, const Contested& found);

std::string to_string(Tier tier);
std::string to_string(Verdict verdict);
/// Returns for example "FAIL", or "PASS, not resolved: the object's smallest extent is 2.4 voxels, six are
/// needed".
std::string verdict_text(const Certificate& certificate);

}  // namespace octotomy::verify
