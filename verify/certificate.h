// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh.h"
#include "voxel/octree.h"

namespace octotomy::verify {

enum class Tier { Exact, Bounded, ClosedForm };
/// BelowResolution: the object's smallest extent is under six voxels, agreement proves nothing.
enum class Agreement { Pass, Warn, Fail, BelowResolution };

/// One kernel's answer and where it comes from.
struct Answer {
  std::string lineage;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;
};

/// One source of difference that theory allows, with its formula.
struct ToleranceTerm {
  std::string name;
  std::string formula;
  double value_mm3 = 0.0;
};

/// One quantity of both answers, with a verdict of its own.
struct Comparison {
  std::string quantity;  ///< "volume", "centroid", "euler", ...
  std::string unit;      ///< "mm3", "mm2", "mm", "mm5"; empty for a count
  /// Both answers, where the quantity is a number of each; a distance between them has neither.
  std::optional<double> voxel = {}, mesh = {};
  double difference = 0.0;               ///< what is held against the tolerance, not negative
  std::optional<double> tolerance = {};  ///< none: theory gives no bound, the numbers are told and not judged
  std::string formula = {};              ///< the tolerance's, or why there is none
  Agreement agreement = Agreement::Pass;
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
  std::vector<Comparison> comparisons;   ///< every quantity that was looked at
  Agreement agreement = Agreement::Pass;
  std::vector<std::string> reasons;  ///< why not PASS
  double milliseconds = 0.0;
};

/// Adds a comparison and sets its verdict: PASS up to the tolerance, WARN up to twice that, FAIL beyond and
/// where the difference is no number. The certificate's verdict becomes the worse of the two, with a reason.
void add_comparison(Certificate& certificate, Comparison comparison);
/// Lowers the certificate's verdict, never raises it, and says why.
void lower(Certificate& certificate, Agreement agreement, const std::string& reason);

/// What the bound is made of beyond what the two objects show themselves.
struct BoundInputs {
  std::string operation;
  std::string voxel_lineage;
  std::string mesh_lineage;
  glm::dvec3 scan_spacing_mm{1.0};  ///< of the samples that the isosurface was made from
  /// Area of flat cuts by direction of their normal (x, y, z): only what lies along the universe's planes.
  glm::dvec3 flat_cut_mm2{0.0};
  /// What the scan's voxels fill, where the solid may end with the scan.
  std::optional<voxel::Box> scan_box_mm = {};
  /// Every voxel's centre is a sample, and the object is one window of them: topology must agree then.
  bool voxels_are_samples = false;
};

/// Compares an octree with a solid that has another lineage (tier Bounded). Derivation of the terms is in the
/// source. An empty mesh has no faces.
Certificate certify_bounded(const voxel::Octree& octree, const brep::Mesh& solid, const BoundInputs& inputs);

/// The largest share of its tolerance that a quantity takes up: 1 and less is PASS. Where nothing is allowed,
/// 0 without a difference and infinity with one.
double worst_share(const Certificate& certificate);

/// Whether the verdict is worse or, of the same verdict, the share larger. What is below resolution proves
/// nothing and is never worse than what is not.
bool is_worse(const Certificate& a, const Certificate& b);

/// A certificate's objects, kept for pictures.
struct Contested {
  Certificate certificate;
  voxel::Octree octree;
  std::shared_ptr<const brep::Mesh> mesh;
};
/// Keeps the worse one, the first of equals, so that the order alone decides.
void keep_worse(std::optional<Contested>& kept, const Contested& found);

std::string to_string(Tier tier);
std::string to_string(Agreement agreement);

}  // namespace octotomy::verify
