// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/cli/verb/scan_in.h"
#include "voxel/archive/source_identity.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/dicom_source.h"
#include "voxel/scan/write_dicom_seg.h"
#include "voxel/tree/octree_file.h"

// The words of `octotomy convert`, and the series of images to which written DICOM refers.
namespace octotomy::planner::cli {

struct ConvertText {
  std::filesystem::path in, out, source;
  std::string label, as, planes = "images";
  ScanIn scan;
  bool dicom = false, other_identity = false;
  std::string identity = "keep";
  /// What source_of() changed in the source's identity.
  std::shared_ptr<std::vector<std::string>> changes = std::make_shared<std::vector<std::string>>();
  std::filesystem::path pictures;  ///< a plan's result folder

  bool keeps_identity() const { return identity == "keep"; }
};

/// The DICOM series to which the output refers, with the identity that --identity chooses; none if the input
/// was not made from a series. Refuses a series of another patient than the input's. Adds findings on values
/// that could not be compared and, for --source, each WARN and FAIL of its audit.
std::optional<voxel::DicomSource> source_of(const Program& program, const ConvertText& text, bool reads_dicom,
                                            const voxel::Identity& identity,
                                            std::vector<std::string>& findings);

/// Points in LPS millimetres whose convex hull contains an object, all objects or a lattice: the corners of
/// the smallest block of voxels, along the object's own axes, that contains it.
std::vector<glm::dvec3> corners_of(const std::vector<voxel::DicomSegment>& objects);
std::vector<glm::dvec3> corners_of(const voxel::Lattice& lattice);

/// Compares the output's points, in LPS millimetres, with the images of --source. Refuses points wholly outside
/// them, because the input was made from another scan or has a wrong frame, unless --other-identity allows
/// it. Adds a finding if they extend beyond the images. Does nothing if nothing is written.
void need_on_source(const ConvertText& text, const voxel::DicomSource& source,
                    const std::vector<glm::dvec3>& points_mm, std::vector<std::string>& findings);

/// Adds findings, and the changes of the identity, to the JSON; prints findings as warnings.
void tell(const ConvertText& text, const std::vector<std::string>& findings, Json& json);

/// The labels of a label map as objects on its own lattice, with their names.
struct LabelObjects {
  voxel::Scene scene;
  std::vector<voxel::Label> labels;
  std::vector<voxel::DicomSegment> objects;  ///< one for each label
};
/// Reads a label map; names are left out if --identity removes or replaces the identity, because they may
/// name the patient. Adds findings on its labels and names. Throws std::runtime_error if the file is not a
/// label map.
LabelObjects read_label_objects(const Program& program, const ConvertText& text, Timings& timings,
                                std::vector<std::string>& findings);

/// The binary octree of a file, with the name that --label gives, else with its own name unless --identity
/// removes it. Throws std::runtime_error if the file holds another kind of octree.
voxel::DicomSegment binary_object(const ConvertText& text, const voxel::OctreeFile& file);

/// Writes the objects of an .octree or a label map as a DICOM structure set.
int convert_structures(const Program& program, const ConvertText& text);
/// Writes the share that objects, a surface or samples from 0 to 1 fill of each voxel as a FRACTIONAL
/// segmentation.
int convert_fractions(const Program& program, const ConvertText& text);
/// Writes an STL or OBJ file as an encapsulated DICOM document.
int convert_model(const Program& program, const ConvertText& text);
/// Writes a PDF as an encapsulated DICOM document.
int convert_report(const Program& program, const ConvertText& text);
/// Writes a plan, and the views in the folder of --pictures, as DICOM objects of one study.
int convert_plan(const Program& program, const ConvertText& text);
/// Writes an archive's document as the original file, byte for byte, or an archive's picture from its pixels. None if
/// the input or the output is of another kind.
std::optional<int> unpack_archived(const Program& program, const ConvertText& text);
/// Describes an archive's document or picture; none if the file is another kind.
std::optional<int> info_of_archived(const Program& program, const std::filesystem::path& path);

}  // namespace octotomy::planner::cli
