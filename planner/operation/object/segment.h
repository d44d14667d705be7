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

/// An object of a scan. A window, suggested threshold, cluster, label or growth from seeds selects its
/// voxels. The later fields reduce or fill this selection, in their order.
struct Segment {
  ScanName scan;
  std::optional<SampleWindow> window;
  std::optional<int> otsu, clusters, otsu_class, label;
  std::optional<std::string> named;  ///< name of the label; `names` is a file with the table of names
  std::filesystem::path names;
  std::optional<double> tolerance;
  bool running_mean = false;      ///< the tolerance is measured from the mean of the growing region
  std::filesystem::path regions;  ///< file of contours on slices; `structure` names the structure to use, if
                                  ///< it is a structure set
  std::string structure;
  bool other_identity = false;  ///< whether the structure set may state another patient, study or frame of
                                ///< reference
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
  voxel::FeatureClasses classes = {};      ///< computed if `clusters` is set
  // Only the verb has the following options. It makes an object for each window and octree.
  std::vector<std::string> windows, objects;
  std::filesystem::path out, contours;
  std::optional<double> voxel_mm;
  std::string identity = "keep";  ///< of a DICOM segmentation: voxel::IdentityChoice
};

/// Runs the verb: writes an octree, a label map or a DICOM segmentation of the objects, and the contours of
/// the first window. Throws std::runtime_error if options contradict each other or an output cannot be
/// written, and as segmented().
FileAnswer segment_file(const Segment& segment, const FileBench& bench);
/// "bone, soft_tissue, ...".
std::string names_of_tissues();

/// The data from which an object is segmented.
struct SegmentSource {
  std::string name;  ///< the scan's name, for errors
  const voxel::Scene& scene;
  const voxel::Universe& universe;
  std::function<const voxel::GreyOctree&()> grey;  ///< returns the samples in the universe; not called for a
                                                   ///< label
  std::filesystem::path folder = {};               ///< folder to which paths of files are relative
  std::stop_token stop = {};
};

/// A selection of voxels, and one entry for each step with the volume that remained. `base` is the selection
/// by window or label within the regions, before the refining steps; none for growth from seeds.
struct Segmented {
  voxel::Octree octree;
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  std::optional<voxel::Octree> base = std::nullopt;
  std::vector<std::string> findings = {};
};

/// Selects the object's voxels in the voxel kernel. Precondition: `otsu` has been replaced by `window`
/// (otsu_window()), and `classes` is set if there are `clusters` (clusters_of()). Throws std::runtime_error
/// if no voxel remains or a seed lies outside of the scan; Stopped between steps.
Segmented segmented(const Segment& segment, const SegmentSource& source);

/// The same object on the scan's own samples, in a universe whose first voxels are these samples. The voxels
/// of `made`, which segmented() returned for any universe, determine which parts belong to the object; the
/// samples determine where it ends. Precondition: `source` has the universe voxel::universe_on() of the scan.
/// Throws Stopped. See voxel::chosen_samples().
voxel::Octree on_own_samples(const Segment& segment, const SegmentSource& source, const Segmented& made);

/// The label with the requested name, from the stated table or else from the table of the label map `scene`.
/// Appends findings on files that are not used. Throws std::runtime_error that states the nearest known
/// names.
int label_of_name(const Segment& segment, const std::filesystem::path& label_map, const voxel::Scene& scene,
                  const std::filesystem::path& folder, std::vector<std::string>& findings);

/// The window of one of Otsu's classes of least variance (1979). Classes are numbered from 1, the darkest.
/// `suggestion` has the thresholds and the histogram that they divide.
struct OtsuWindow {
  SampleWindow window;
  nlohmann::ordered_json suggestion;
};
OtsuWindow otsu_window(const voxel::Scene& scene, int classes, int number);

/// The clusters of the samples by density and gradient; `suggestion` is their JSON for the answer.
struct Clusters {
  voxel::FeatureClasses classes;
  nlohmann::ordered_json suggestion;
};
Clusters clusters_of(const voxel::Scene& scene, int classes, const voxel::Progress& progress);

}  // namespace octotomy::planner
