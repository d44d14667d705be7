// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck.h"
#include "voxel/progress.h"
#include "voxel/scene.h"

namespace octotomy::convert {

/// Density in g/cm3 as a linear function of Hounsfield units, as a phantom scanned with the patient gives it.
struct DensityCalibration {
  double slope_g_cm3_per_hu = 0.0008;
  double intercept_g_cm3 = 0.0;
};

/// What a law's density is: apparent (wet mass by whole volume) or ash (mineral mass by whole volume).
enum class DensityKind { Apparent, Ash };

/// E = a + b rho^c in MPa of a density in g/cm3, in pieces.
struct StiffnessLaw {
  struct Piece {
    double from_g_cm3 = 0.0;  ///< up to the next piece's
    double a_mpa = 0.0;
    double b = 0.0;
    double c = 1.0;
  };
  std::string name;
  std::string source;
  DensityKind density = DensityKind::Apparent;
  std::vector<Piece> pieces;  ///< from_g_cm3 ascending, the first from 0
};

/// The published laws there are: morgan2003-femoral-neck, morgan2003-pooled, carter-hayes1977, keller1994,
/// keyak1998. Each names its source.
const std::vector<StiffnessLaw>& stiffness_laws();
/// Throws std::invalid_argument naming the laws there are.
const StiffnessLaw& stiffness_law(const std::string& name);
/// Young's modulus at a density. Precondition: rho >= 0.
double youngs_modulus_mpa(const StiffnessLaw& law, double rho_g_cm3);

struct MaterialOptions {
  std::string law = "morgan2003-femoral-neck";
  /// None: the scan is not calibrated; a default is taken and a finding says so.
  std::optional<DensityCalibration> calibration;
  int bins = 20;  ///< materials that elements are gathered into, by stiffness, 1..1000; more is finer
  double poisson_ratio = 0.3;
  /// The least Young's modulus that an element gets, MPa: marrow and what lies at the surface's edge would
  /// else have none, or less.
  double least_mpa = 1.0;
  /// Voxels at the surface hold bone and what is beside it. Points nearer to the surface than this have the
  /// scan's value at this depth, straight away from their nearest point of it, where that is larger; 0: their
  /// own. A voxel's diagonal goes below all such voxels; where bone is thinner than twice the depth, it may not
  /// reach its middle.
  double surface_depth_mm = 0.0;
  voxel::Progress progress{};  ///< of the elements; where it asks to stop, voxel::Stopped is thrown
};

/// Element by element what a scan says of a mesh, and the materials made of it.
struct ElementMaterials {
  std::vector<double> hu;             ///< mean over the element
  std::vector<double> density_g_cm3;  ///< never negative
  std::vector<double> youngs_modulus_mpa;
  std::vector<DeckMaterial> materials;  ///< bins that hold an element; each the mean of its own
  std::vector<std::uint32_t> material_of_tet;
  std::vector<std::string> findings;
};

/// Samples the scan over each element: the mean of the trilinear interpolant at points spread evenly over it,
/// half a voxel apart or less, at most 165 (elements up to five voxels large). Points outside the scan are
/// left out; an element with none inside gets the nearest sample to its middle, and a finding counts them.
/// Throws std::invalid_argument where an option is out of range, the law is not known, or there are no
/// elements. Parallel; same bits on any thread count. Cost: the points.
/// Source: Taddei et al., "The material mapping strategy influences the accuracy of CT-based finite element
/// models of bones", Med. Eng. Phys. 29, 2007: integration over elements instead of nodes or centroids.
ElementMaterials element_materials(const Tetrahedra& tetrahedra, const voxel::Scene& scan,
                                   const MaterialOptions& options = {});

}  // namespace octotomy::convert
