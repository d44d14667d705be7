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

// The command line of `octotomy convert`, and the DICOM series to which its output refers.
namespace octotomy::planner::cli {

struct ConvertText {
  std::filesystem::path in, out, source;
  std::string label, as, planes = "images";
  ScanIn scan;
  bool dicom = false, other_identity = false;
  std::string identity = "keep";
  /// The changes that source_of() has made to the patient's identity, one sentence each.
  std::shared_ptr<std::vector<std::string>> changes = std::make_shared<std::vector<std::string>>();
  std::filesystem::path pictures;  ///< a plan's result folder

  bool keeps_identity() const { return identity == "keep"; }
};

/// The DICOM series to which the output refers: --source, or the input if `reads_dicom`; none if there is
/// neither. Its identity is kept, removed or replaced as --identity states. Refuses a series of another
/// patient than `identity`. Adds findings on values that could not be compared and, for --source, each WARN
/// and FAIL of its audit.
std::optional<voxel::DicomSource> source_of(const Program& program, const ConvertText& text, bool reads_dicom,
                                            const voxel::Identity& identity,
                                            std::vector<std::string>& findings);

/// Points in LPS millimetres whose convex hull contains all objects, or a lattice: corners of the smallest
/// blocks of voxels that contain them, along their own axes.
std::vector<glm::dvec3> corners_of(const std::vector<voxel::DicomSegment>& objects);
std::vector<glm::dvec3> corners_of(const voxel::Lattice& lattice);

/// Compares points of the output, in LPS millimetres, with the images of --source. Refuses points that all
/// lie outside of the images, unless --other-identity is given: the input was made from another scan, or its
/// frame is wrong. Adds a finding if some points lie outside by more than a voxel.
void need_on_source(const ConvertText& text, const voxel::DicomSource& source,
                    const std::vector<glm::dvec3>& points_mm, std::vector<std::string>& findings);

/// Adds findings and changes of the identity to the JSON, and prints the findings as warnings.
void tell(const ConvertText& text, const std::vector<std::string>& findings, Json& json);

/// The labels of a label map, each as an object on the map's own lattice.
struct LabelObjects {
  voxel::Scene scene;
  std::vector<voxel::Label> labels;
  std::vector<voxel::DicomSegment> objects;  ///< one for each label
};
/// Reads a label map. Replaces the labels' names if --identity is not keep, because names may identify the
/// patient. Adds findings on labels and names. Throws std::runtime_error if the file is not a label map.
LabelObjects read_label_objects(const Program& program, const ConvertText& text, Timings& timings,
                                std::vector<std::string>& findings);

/// The object in a file with a binary octree. Its name is that of --label, or else the file's own, unless
/// --identity removes it. Throws std::runtime_error if the file contains another kind of octree.
voxel::DicomSegment binary_object(const ConvertText& text, const voxel::OctreeFile& file);

/// Writes the objects of an .octree or a label map as a DICOM structure set. Returns the exit status, like
/// all functions below.
int convert_structures(const Program& program, const ConvertText& text);
/// Writes a fractional DICOM segmentation: the share of each voxel that is filled by the objects or the
/// surface of the input. Samples from 0 to 1 are such shares.
int convert_fractions(const Program& program, const ConvertText& text);
/// Writes an STL or OBJ file as an encapsulated DICOM document.
int convert_model(const Program& program, const ConvertText& text);
/// Writes a PDF as an encapsulated DICOM document.
int convert_report(const Program& program, const ConvertText& text);
/// Writes a plan, and the views in the folder of --pictures, as DICOM objects of one study.
int convert_plan(const Program& program, const ConvertText& text);
/// Writes a document of an archive as the original file, byte for byte, or a picture of an archive from its
/// pixels. None if the input is no such object, or the output is of another kind.
std::optional<int> unpack_archived(const Program& program, const ConvertText& text);
/// Prints the facts of an archive's document or picture. None if the file is no such object.
std::optional<int> info_of_archived(const Program& program, const std::filesystem::path& path);

}  // namespace octotomy::planner::cli
