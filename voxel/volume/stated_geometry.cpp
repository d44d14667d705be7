// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/stated_geometry.h"

namespace octotomy::voxel {
namespace {

/// The directions of a frame's axes in words: "left, back and head".
std::string directions_of(const PatientFrame& frame) {
  std::string text;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char letter = frame.name[axis];
    text += axis == 0 ? "" : axis == 1 ? ", " : " and ";
    text += letter == 'L'   ? "left"
            : letter == 'R' ? "right"
            : letter == 'P' ? "back"
            : letter == 'A' ? "front"
            : letter == 'S' ? "head"
                            : "feet";
  }
  return text;
}

Finding frame_line(const StatedGeometry& stated, const std::optional<PatientFrame>& asked) {
  const std::string says = stated.frame_says.empty() ? "" : " (" + stated.frame_says + ")";
  if (asked && stated.frame && asked->name != stated.frame->name)
    return {"orientation", Verdict::Warn,
            "the file names its patient frame, " + stated.frame->name + says + "; " + asked->name +
                " was taken instead, as --frame demands"};
  if (asked && !stated.frame)
    return {"orientation", Verdict::Pass,
            "the file names no patient frame" + says + "; " + asked->name + " was taken, as --frame demands"};
  if (stated.frame)
    return {"orientation", Verdict::Pass, "the file names its patient frame: " + stated.frame->name + says};
  return {"orientation", Verdict::Warn,
          "the file names no patient frame" + says + ": its axes are assumed to run to the patient's " +
              directions_of(stated.assumed_frame) +
              "; check that left and right are not exchanged; --frame names another frame"};
}

Finding unit_line(const StatedGeometry& stated, const std::optional<LengthUnit>& asked) {
  const auto is_asked = [&](double mm) { return mm == asked->mm; };
  if (asked && stated.unit_says &&
      !(is_asked(stated.mm_per_unit.x) && is_asked(stated.mm_per_unit.y) && is_asked(stated.mm_per_unit.z)))
    return {
        "length_unit", Verdict::Warn,
        "lengths are in " + *stated.unit_says + "; " + asked->name + " was taken instead, as --unit demands"};
  if (asked && !stated.unit_says)
    return {"length_unit", Verdict::Pass,
            "the file states no unit of length; " + asked->name + " was taken, as --unit demands"};
  if (stated.unit_says)
    return {"length_unit", Verdict::Pass,
            "lengths are in " + *stated.unit_says + ": spacing and positions follow it"};
  return {"length_unit", Verdict::Warn,
          "the file states no unit of length: millimetres are assumed; --unit names another one"};
}

}  // namespace

Lattice placed(const StatedGeometry& stated, const std::optional<PatientFrame>& asked_frame,
               const std::optional<LengthUnit>& asked_unit, std::vector<Finding>& audit) {
  const PatientFrame frame = asked_frame.value_or(stated.frame.value_or(stated.assumed_frame));
  const glm::dvec3 mm = asked_unit ? glm::dvec3(asked_unit->mm) : stated.mm_per_unit;
  Lattice lattice{stated.dims, glm::dmat4(1.0)};
  // Adding zero turns -0, a result of turned axes, into 0.
  for (int column = 0; column < 4; ++column)
    lattice.lps_from_voxel[column] =
        glm::dvec4(frame.lps_from_frame * (mm * glm::dvec3(stated.file_from_voxel[column])) + 0.0,
                   column == 3 ? 1.0 : 0.0);
  audit.push_back(frame_line(stated, asked_frame));
  audit.push_back(unit_line(stated, asked_unit));
  return lattice;
}

}  // namespace octotomy::voxel
