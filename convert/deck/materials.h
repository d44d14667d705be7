// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::convert {

/// Density in g/cm3 as a linear function of Hounsfield units, from a phantom scanned with the patient.
struct DensityCalibration {
  double slope_g_cm3_per_hu = 0.0008;
  double intercept_g_cm3 = 0.0;
};

/// The kind of density in a law: apparent (wet mass per whole volume) or ash (mineral mass per whole volume).
enum class DensityKind { Apparent, Ash };

/// Piecewise E = a + b rho^c in MPa, rho in g/cm3.
struct StiffnessLaw {
  struct PowerLaw {
    double from_g_cm3 = 0.0;  ///< the piece ends where the next one begins
    double a_mpa = 0.0;
    double b = 0.0;
    double c = 1.0;
  };
  std::string name;
  std::string source;
  DensityKind density = DensityKind::Apparent;
  std::vector<PowerLaw> pieces;  ///< from_g_cm3 ascending, the first from 0
};

/// The published laws: morgan2003-femoral-neck, morgan2003-pooled, carter-hayes1977, keller1994, keyak1998.
/// Each names its source.
const std::vector<StiffnessLaw>& stiffness_laws();
/// Throws std::invalid_argument, which lists the laws, for an unknown name.
const StiffnessLaw& stiffness_law(const std::string& name);
/// Young's modulus at a density. Precondition: rho >= 0.
double youngs_modulus_mpa(const StiffnessLaw& law, double rho_g_cm3);

struct MaterialOptions {
  std::string law = "morgan2003-femoral-neck";
  /// None: the scan is not calibrated. Then a default applies, with a finding.
  std::optional<DensityCalibration> calibration;
  int bins = 20;  ///< number of materials, in steps of equal ratio of stiffness, 1..1000
  double poisson_ratio = 0.3;
  /// The smallest Young's modulus of an element, MPa: a law may yield zero or less for marrow and for
  /// elements at the surface.
  double least_mpa = 1.0;
  /// Voxels at the surface hold bone and its surroundings. A point nearer to the surface than this depth is
  /// moved to this depth, away from its nearest surface point, and gets the scan's value there if that value
  /// is larger. 0: every point keeps its own value. A depth of a voxel's diagonal avoids all voxels at the
  /// surface. Bone thinner than twice the depth has no point at this depth.
  double surface_depth_mm = 0.0;
  voxel::Progress progress{};  ///< of the elements
};

/// The scan's values and stiffness by element, and the materials made of them.
struct ElementMaterials {
  std::vector<double> hu;             ///< mean over the element
  std::vector<double> density_g_cm3;  ///< never negative
  std::vector<double> youngs_modulus_mpa;
  std::vector<DeckMaterial> materials;  ///< one for each bin that has elements, with their mean stiffness
  std::vector<std::uint32_t> material_of_tet;
  double worst_ratio = 1.0;  ///< largest ratio, over all elements, between an element's own stiffness and its
                             ///< material's, either way
  std::vector<std::uint32_t> outside;  ///< elements without a point in the scan, ascending
  std::vector<std::string> findings;
};

/// Samples the scan over each element: the mean of the trilinear interpolant at points spread evenly over it,
/// half a voxel apart or less; elements larger than about five voxels get 165 points. Points outside the scan
/// do not count. An element without a point in the scan gets the sample nearest to its middle, and a finding
/// counts such elements. Throws std::invalid_argument if an option is out of range, the law is unknown, or
/// there are no elements; voxel::Stopped. Parallel; same bits on any thread count. Cost: the points. Source:
/// Taddei et al., "The material mapping strategy influences the accuracy of CT-based finite element models of
/// bones", Med. Eng. Phys. 29, 2007: integration over elements instead of nodes or centroids.
ElementMaterials element_materials(const Tetrahedra& tetrahedra, const voxel::Scene& scan,
                                   const MaterialOptions& options = {});

}  // namespace octotomy::convert
