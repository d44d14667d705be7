// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planner/operation/deck/stiffness.h"
#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// A deck of finite elements: tetrahedra that fill one object, or several objects as regions. It also names
/// the objects that hold and move the elements, and their materials. Moduli are in MPa.
struct Deck {
  /// Linear elastic.
  struct Material {
    double youngs_modulus_mpa = 0.0;
    double poisson_ratio = 0.0;
  };
  /// Requests elements of about a size at a point or along an object's surface.
  struct Finer {
    Site at;
    double size_mm = 1.0;
  };
  struct Plane {
    glm::dvec3 point_mm{0.0};
    glm::dvec3 normal{1, 0, 0};
  };

  ObjectName object;
  std::filesystem::path path;
  std::vector<ObjectName> moved;  ///< moved objects; elements on them move with them
  std::vector<ObjectName> fixed;
  std::optional<double> element_mm;  ///< edge of the smallest elements; none: that of the universe's voxels
  std::optional<Material> material;  ///< of an object that others hold
  bool fallback = false;
  int order = 1;
  std::vector<Finer> finer;
  std::optional<Plane> midline;
  std::vector<ObjectName> regions;  ///< beside the object
  std::optional<double> smooth_mm;
  std::string between = "shared";
  NamePairs sliding;
  std::vector<std::pair<std::string, Material>> materials;  ///< by region
  std::optional<Stiffness> stiffness;                       ///< for a filled object

  /// Whether other objects hold this object, as bone holds soft tissue.
  bool is_held() const { return !moved.empty() || !fixed.empty(); }
  bool has_contact() const { return between == "contact"; }
};

}  // namespace octotomy::planner
