// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "tests/voxel/scan/dicom_bytes.h"

namespace octotomy::tests {

struct DrawnStructure {
  int number = 1;
  std::string name;
  std::vector<std::vector<glm::dvec3>> contours_mm;
  std::string kind = "CLOSED_PLANAR";
  double slab_mm = 0.0;     ///< ContourSlabThickness; 0: not stated
  std::string offset = {};  ///< ContourOffsetVector; empty: not stated
};

/// The patient that a structure set states; empty: it states none.
struct StatedIdentity {
  std::string patient_id, study_uid, frame_uid;
  std::string series_uid = {};  ///< that it was drawn on; beside frame_uid
};

/// A DICOM structure set, explicit VR little-endian; long contours as UN, as pydicom writes them.
inline std::string structure_set(const std::vector<DrawnStructure>& structures,
                                 const StatedIdentity& identity = {}) {
  using D = DicomBytes;
  std::string names, drawn;
  for (const DrawnStructure& structure : structures) {
    names += D::item(D::element(0x30060022, "IS", std::to_string(structure.number)) +
                     D::element(0x30060026, "LO", structure.name));
    std::string contours;
    for (const auto& contour : structure.contours_mm) {
      std::string data;
      for (const glm::dvec3& p : contour)
        for (int axis = 0; axis < 3; ++axis)
          data += (data.empty() ? "" : "\\") + std::to_string(p[axis]).substr(0, 16);
      contours += D::item(
          D::element(0x30060042, "CS", structure.kind) +
          (structure.slab_mm > 0.0 ? D::element(0x30060044, "DS", std::to_string(structure.slab_mm)) : "") +
          (structure.offset.empty() ? "" : D::element(0x30060045, "DS", structure.offset)) +
          D::element(0x30060046, "IS", std::to_string(contour.size())) +
          D::element(0x30060050, data.size() > 60000 ? "UN" : "DS", data));
    }
    drawn += D::item(D::sequence(0x30060040, contours) +
                     D::element(0x30060084, "IS", std::to_string(structure.number)));
  }
  std::string stated;
  if (!identity.patient_id.empty()) stated += D::element(0x00100020, "LO", identity.patient_id);
  if (!identity.study_uid.empty()) stated += D::element(0x0020000d, "UI", identity.study_uid);
  const std::string referred = D::sequence(
      0x30060012,
      D::item(D::element(0x00081155, "UI", identity.study_uid) +
              D::sequence(0x30060014, D::item(D::element(0x0020000e, "UI", identity.series_uid)))));
  if (!identity.frame_uid.empty())
    stated += D::sequence(0x30060010, D::item(D::element(0x00200052, "UI", identity.frame_uid) +
                                              (identity.series_uid.empty() ? "" : referred)));
  return D::file("1.2.840.10008.1.2.1", D::element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.481.3") +
                                            D::element(0x00080060, "CS", "RTSTRUCT") + stated +
                                            D::sequence(0x30060020, names) + D::sequence(0x30060039, drawn));
}

/// A rectangle in the plane z.
inline std::vector<glm::dvec3> rectangle(const glm::dvec2& low, const glm::dvec2& high, double z) {
  return {{low.x, low.y, z}, {high.x, low.y, z}, {high.x, high.y, z}, {low.x, high.y, z}};
}

}  // namespace octotomy::tests
