// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/stiffness.h"

#include <stdexcept>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {

std::vector<Field> stiffness_fields() {
  std::vector<std::string> laws;
  for (const convert::StiffnessLaw& law : convert::stiffness_laws()) laws.push_back(law.name);
  return {field("density", &Stiffness::density,
                "Slope and intercept of the density in g/cm3 (intercept + slope * HU), from the scan's "
                "calibration phantom.")
              .from(2)
              .to(2)
              .comma_separated()
              .for_example("[0.0009, 0.05]"),
          field("law", &Stiffness::law, "Stiffness of a density.").one_of(laws),
          field("bins", &Stiffness::bins, "Number of materials; elements are grouped into them by stiffness.")
              .from(1)
              .to(1000),
          field("surface_depth_mm", &Stiffness::surface_depth_mm,
                "Points nearer to the surface than this depth have the stiffness at this depth if that is "
                "larger, because voxels at the surface mix bone with its surroundings. 0: each point has the "
                "stiffness at its position.")
              .from(0.0)
              .to(20.0),
          field("poisson_ratio", &Stiffness::poisson_ratio, "Poisson's ratio of the materials.")
              .from(0.0)
              .to(0.499)
              .called("poisson")};
}

std::vector<std::string> add_stiffness(const Stiffness& stiffness, const convert::Tetrahedra& tetrahedra,
                                       const glm::dmat4& scan_from_deck, const voxel::Scene& scan,
                                       const voxel::Progress& progress, convert::DeckOptions& deck) {
  convert::MaterialOptions options;
  options.law = stiffness.law;
  options.bins = stiffness.bins;
  options.surface_depth_mm = stiffness.surface_depth_mm;
  options.poisson_ratio = stiffness.poisson_ratio;
  if (!stiffness.density.empty())
    options.calibration = convert::DensityCalibration{stiffness.density[0], stiffness.density[1]};
  options.progress = progress;
  convert::ElementMaterials made;
  if (scan_from_deck == glm::dmat4(1.0)) {
    made = convert::element_materials(tetrahedra, scan, options);
  } else {
    convert::Tetrahedra still = tetrahedra;
    for (glm::dvec3& p_mm : still.nodes_mm) p_mm = glm::dvec3(scan_from_deck * glm::dvec4(p_mm, 1.0));
    made = convert::element_materials(still, scan, options);
  }
  if (!made.outside.empty()) {
    glm::dvec3 middle_mm(0.0);
    for (const auto v : tetrahedra.tets[made.outside.front()]) middle_mm += 0.25 * tetrahedra.nodes_mm[v];
    throw std::runtime_error("the scan does not cover the solid: " + std::to_string(made.outside.size()) +
                             " of " + std::to_string(tetrahedra.tets.size()) +
                             " elements lie outside it, the first at (" + plain(middle_mm.x) + ", " +
                             plain(middle_mm.y) + ", " + plain(middle_mm.z) +
                             ") mm: name the scan from which the solid was made");
  }
  deck.notes.push_back("stiffness: " + std::to_string(made.materials.size()) +
                       " materials, each stiffer than the one before by the same ratio; an element's "
                       "measured stiffness differs from that of its material by a factor of at most " +
                       three_figures(made.worst_ratio));
  deck.materials = std::move(made.materials);
  deck.material_of_tet = std::move(made.material_of_tet);
  deck.fields = {{"HU", std::move(made.hu)},
                 {"density_g_cm3", std::move(made.density_g_cm3)},
                 {"E_MPa", std::move(made.youngs_modulus_mpa)}};
  deck.notes.push_back("stiffness: " + convert::stiffness_law(options.law).source);
  return made.findings;
}

}  // namespace octotomy::planner
