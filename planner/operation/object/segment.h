// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/bench.h"
#include "voxel/filter/feature_classes.h"
#include "voxel/space/progress.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// An object of a scan. A window, a suggested threshold, a cluster, seeds or a label select its voxels; the
/// fields that follow then reduce or fill that selection, in their order.
struct Segment {
  ScanName scan;
  std::optional<SampleWindow> window;
  std::optional<int> otsu, clusters, otsu_class, label;
  std::optional<std::string> named;  ///< the label's name; `names` is the file with the table of names
  std::filesystem::path names;
  std::optional<double> tolerance;
  bool running_mean = false;      ///< the tolerance is from the mean of the region as it grows
  std::filesystem::path regions;  ///< contours on slices; `structure` is the name of the contoured structure
                                  ///< in a structure set
  std::string structure;
  bool other_identity = false;  ///< the structure set may be of another patient, study or frame of reference
  std::optional<double> open_mm;
  std::vector<glm::dvec3> seeds_mm;
  bool largest = false;
  std::optional<int> components;
  std::optional<double> at_least_mm3, close_mm;
  bool fill = false;
  int neighbours = 6;
  std::vector<glm::dvec3> keep_bridges_mm, cut_bridges_mm;  ///< as BridgeDecisions
  double bridge_mm = 5.0;
  std::vector<glm::dvec3> agreed_mm = {};  ///< as BridgeDecisions
  voxel::FeatureClasses classes = {};      ///< computed where `clusters` is given
  // Options of the verb, which makes an object for each window and octree.
  std::vector<std::string> windows, objects;
  std::filesystem::path out, contours;
  std::optional<double> voxel_mm;
  std::string identity = "keep";  ///< of a DICOM segmentation: voxel::IdentityChoice
};

/// The verb on files: an octree, a label map or a DICOM segmentation of the objects, and contours of the first
/// window. Throws std::runtime_error if the options contradict each other or an output cannot be written, and as
/// segmented().
FileAnswer segment_file(const Segment& segment, const FileBench& bench);
/// "bone, soft_tissue, ...".
std::string names_of_tissues();

/// What an object is segmented from.
struct SegmentSource {
  std::string name;  ///< of the scan, for refusals
  const voxel::Scene& scene;
  const voxel::Universe& universe;
  std::function<const voxel::GreyOctree&()> grey;  ///< the samples in the universe; not called for a label
  std::filesystem::path folder = {};               ///< paths of files are relative to it
  std::stop_token stop = {};
};

/// The voxels, and one entry per step with the volume that it left. `base` is the selection by window or
/// label, within the regions, before the further steps; growing from seeds has none.
struct Segmented {
  voxel::Octree octree;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  std::optional<voxel::Octree> base = std::nullopt;
  std::vector<std::string> findings = {};
};

/// The voxel kernel's answer. Precondition: `otsu` has been replaced by `window` (otsu_window()), and
/// `classes` is set if there are `clusters` (clusters_of()). Throws std::runtime_error if nothing is left
/// or a seed lies outside; Stopped between choices.
Segmented segmented(const Segment& segment, const SegmentSource& source);

/// The same object on the scan's own samples, in a universe whose first voxels are these samples. The voxels
/// of `made`, from segmented() in any universe, decide which parts belong to the object; the samples decide
/// where it ends. Precondition: `source` is on voxel::universe_on() of the scan. Throws Stopped. See
/// voxel::chosen_samples().
voxel::Octree on_own_samples(const Segment& segment, const SegmentSource& source, const Segmented& made);

/// The label with the requested name, by the given table or by the table of the label map `scene`. Adds to
/// `findings` the files that were passed over. Throws std::runtime_error that lists the known names.
int label_of_name(const Segment& segment, const std::filesystem::path& label_map, const voxel::Scene& scene,
                  const std::filesystem::path& folder, std::vector<std::string>& findings);

/// The window of one of Otsu's classes of least variance (1979), numbered from the darkest, 1; and the
/// thresholds, with the histogram that they divide.
struct OtsuWindow {
  SampleWindow window;
  nlohmann::ordered_json suggestion;
};
OtsuWindow otsu_window(const voxel::Scene& scene, int classes, int number);

/// The clusters of the samples' densities and gradients, and the same as JSON for the answer.
struct Clusters {
  voxel::FeatureClasses classes;
  nlohmann::ordered_json suggestion;
};
Clusters clusters_of(const voxel::Scene& scene, int classes, const voxel::Progress& progress);

}  // namespace octotomy::planner
