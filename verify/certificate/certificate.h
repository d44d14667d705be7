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

/// One kernel's answer and its lineage.
struct Answer {
  std::string lineage;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;
  /// The code that made the answer and its operands, down to the scan, a clause each, sorted.
  std::vector<std::string> makers = {};
};
/// The makers that two answers share.
std::vector<std::string> shared_makers(const Answer& a, const Answer& b);

/// One source of difference that theory allows.
struct ToleranceTerm {
  std::string name;     ///< a key: "count", "flat", ...
  std::string cause;    ///< a sentence for people
  std::string formula;  ///< its size, in symbols that the source explains
  double value_mm3 = 0.0;
};

/// One quantity of both answers, with a verdict of its own.
struct Comparison {
  std::string quantity;  ///< "volume", "centroid", "euler", ...
  std::string unit;      ///< "mm3", "mm2", "mm", "mm5"; empty for a count
  /// Both answers. None of a quantity that is a difference itself, such as a distance between the two.
  std::optional<double> voxel = {}, mesh = {};
  double difference = 0.0;               ///< compared with the tolerance, not negative
  std::optional<double> tolerance = {};  ///< none: theory gives no bound, and there is no verdict
  std::string formula = {};              ///< the tolerance's, or why there is none
  /// The reason's first clause if the difference is too large, with % for it: "The centroids are % apart".
  /// Empty: both answers are quoted.
  std::string statement = {};
  Verdict verdict = Verdict::Pass;
};

/// An object that is too small or too thin for its voxels: a PASS proves little, a FAIL stays one.
struct Unresolved {
  /// The smallest extent of its box, or its mean thickness; none: it is large enough, its bound too wide.
  std::optional<double> extent_voxels;
  std::string reason;  ///< a clause: "the object's smallest extent is 2.4 voxels, six are needed"
};
/// A certificate that would let pass a wrong part of more than this share of the object resolves nothing.
inline constexpr double evident_share = 0.1;

/// Where the two answers differ most.
struct WorstPlace {
  glm::dvec3 at_mm{0.0};
  double size_mm = 0.0;     ///< how far the surfaces are apart there, or how large the differing part is
  std::string what;         ///< a clause: "the mesh has a part there that the voxels lack"
  double volume_mm3 = 0.0;  ///< of the differing part; zero: unknown
};
inline constexpr const char* part_of_mesh_only = "the mesh has a part there that the voxels lack";
inline constexpr const char* part_of_voxels_only = "the voxels have a part there that the mesh lacks";

/// The smallest error that a certificate would have seen in this very object, found by making errors in it.
struct DetectionLimit {
  double volume_mm3 = 0.0;         ///< of a part that one kernel or both lose or add, in one place
  std::optional<double> shift_mm;  ///< of the whole, in any direction; none: not even four voxels
};

/// Both kernels' answers to one question, the difference, what theory allows, and a verdict.
struct Certificate {
  std::string operation;
  Tier tier = Tier::Bounded;
  Answer voxel;
  Answer mesh;
  double difference_mm3 = 0.0;  ///< voxel minus mesh
  double tolerance_mm3 = 0.0;
  std::vector<ToleranceTerm> terms;
  double symmetric_difference_mm3 = 0.0;  ///< volume of the voxels that only one of them holds
  double symmetric_difference_tolerance_mm3 = 0.0;
  std::optional<double> centroid_distance_mm;
  std::optional<double> centroid_tolerance_mm;
  std::optional<double> hausdorff_mm;    ///< largest, both directions, voxel faces to triangles and back
  std::optional<double> hausdorff95_mm;  ///< 95th percentile, as the definition in the report says
  std::optional<WorstPlace> worst;       ///< none: the answers are equal, or there is no mesh to compare
  std::optional<DetectionLimit> limit;   ///< where the places were judged
  std::vector<WorstPlace> bridges;       ///< parts of one kernel alone beyond thin necks, the largest first
  std::optional<LineCount> third;        ///< amounts by lines through the scan, by code of neither kernel
  /// What both kernels take from one place without its being an answer of either: values that a step finds,
  /// filters.
  std::vector<std::string> shared_values;
  std::vector<Comparison> comparisons;  ///< every quantity that was compared
  Verdict verdict = Verdict::Pass;
  std::vector<std::string> reasons;  ///< why not PASS
  std::optional<Unresolved> unresolved;
  double milliseconds = 0.0;

  bool resolved() const { return !unresolved; }
  /// Whether no code made both answers.
  bool independent() const { return shared_makers(voxel, mesh).empty(); }
  /// Volume of the largest wrong part that could pass: the limit, where places were judged, or the tolerance.
  double unseen_mm3() const { return limit ? limit->volume_mm3 : tolerance_mm3; }
  /// The larger of both answers.
  double larger_mm3() const;
};

/// Whether the verdict rests on evidence: voxels resolve the object, or the limit is within evident_share of
/// a thin one.
bool is_evident(const Certificate& certificate);
/// Sets `unresolved`, unless it is set, where more than evident_share of the object could be wrong unseen, or
/// its volume off within the tolerance.
void judge_evidence(Certificate& certificate);
/// Lowers the verdict to WARN where both answers are empty, which compares nothing, and says what could have
/// been missed.
void judge_emptiness(Certificate& certificate, double missed_mm3);
/// Lowers the verdict to WARN and names the makers where the answers share some.
void judge_independence(Certificate& certificate);

/// Adds a comparison and sets its verdict: PASS up to the tolerance, WARN up to twice that, FAIL beyond it
/// and if the difference is not a number, but no worse than `worst_verdict`. Lowers the certificate's verdict
/// to that, with a reason.
void add_comparison(Certificate& certificate, Comparison comparison, Verdict worst_verdict = Verdict::Fail);
/// Lowers the certificate's verdict, never raises it, and says why.
void lower(Certificate& certificate, Verdict verdict, const std::string& reason);

/// "The two surfaces differ by up to 6.04 mm near (12, -80, 44): the mesh has a part there that the voxels
/// lack."
std::string text_of(const WorstPlace& worst);

/// The largest share of its tolerance that a quantity takes up: up to 1 is PASS. With tolerance zero it is 0
/// without a difference and infinite with one.
double worst_share(const Certificate& certificate);

/// Whether the verdict is worse. Of equal verdicts a resolved object's counts as worse than an unresolved
/// one's, then the larger share.
bool is_worse(const Certificate& a, const Certificate& b);

/// A certificate's objects, kept for pictures.
struct Contested {
  Certificate certificate;
  voxel::Octree octree;
  std::optional<brep::Solid> solid;
};
/// Keeps the worse one, the first of equals, so that the order alone decides.
void keep_worse(std::optional<Contested>& kept, const Contested& found);

std::string to_string(Tier tier);
std::string to_string(Verdict verdict);
/// "FAIL", or "PASS, not resolved: the object's smallest extent is 2.4 voxels, six are needed".
std::string verdict_text(const Certificate& certificate);

}  // namespace octotomy::verify
