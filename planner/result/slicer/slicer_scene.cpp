// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/slicer/slicer_scene.h"

#include <array>
#include <cctype>
#include <set>
#include <vector>

#include "brep/io/write_mesh.h"
#include "planner/operation/file/itk_transform.h"
#include "planner/operation/table/json_file.h"
#include "planner/result/pack/zip_writer.h"
#include "planner/result/slicer/scene_markups.h"
#include "planner/result/slicer/scene_nodes.h"
#include "voxel/archive/write_segmentation.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/unfinished_folder.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The colour of the object with this number. People with any colour vision can distinguish them (Okabe and
/// Ito 2008); they repeat after the last.
glm::vec3 colour_of(std::size_t index) {
  constexpr std::array<glm::vec3, 7> colours{{{0.90f, 0.87f, 0.79f},
                                              {0.90f, 0.62f, 0.00f},
                                              {0.34f, 0.71f, 0.91f},
                                              {0.00f, 0.62f, 0.45f},
                                              {0.94f, 0.89f, 0.26f},
                                              {0.84f, 0.37f, 0.00f},
                                              {0.80f, 0.47f, 0.65f}}};
  return colours[index % colours.size()];
}

/// Makes file names from the names of objects and scans. Letters, digits, '_' and '-' stay; different names
/// become different file names.
class FileNames {
 public:
  std::string of(const std::string& name, const std::string& extension) {
    std::string plain;
    for (const char c : name)
      plain += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ? c : '_';
    std::string file = plain + extension;
    for (int i = 2; !taken_.insert(file).second; ++i) file = plain + "_" + std::to_string(i) + extension;
    return file;
  }

 private:
  std::set<std::string> taken_;
};

/// Writes the files of a scene into a folder and collects its nodes.
class SceneFolder {
 public:
  SceneFolder(const Plan& plan, const Evaluation& evaluation, fs::path folder, TransformFormat transforms,
              const std::stop_token& stop)
      : plan_(plan),
        evaluation_(evaluation),
        folder_(std::move(folder)),
        transforms_(transforms),
        stop_(stop) {
    fs::create_directory(folder_ / "Data");
  }

  Json write() {
    for (const ScanRecord& scan : evaluation_.scans) write_scan(scan.name);
    write_segments();
    for (std::size_t i = 0; i < evaluation_.objects.size(); ++i) write_model(evaluation_.objects[i], i);
    for (const SceneMarkup& markup : scene_markups(plan_, evaluation_)) write_markup(markup);
    voxel::write_file(folder_ / "scene.mrml", nodes_.text());
    return written_;
  }

 private:
  void need_no_stop() const {
    if (stop_.stop_requested()) throw Stopped("stopped before the scene was written");
  }

  void write_scan(const std::string& name) {
    const auto found = evaluation_.loaded.find(name);
    if (found == evaluation_.loaded.end()) return;
    need_no_stop();
    const std::string file = names_.of(name, ".nrrd");
    voxel::write_scene(found->second->scene(), folder_ / "Data" / file);
    nodes_.add_volume(name, file);
    written_["scans"].push_back(name);
  }

  void write_segments() {
    std::vector<voxel::WrittenSegment> segments;
    for (std::size_t i = 0; i < evaluation_.objects.size(); ++i) {
      const Object& object = evaluation_.objects[i];
      if (object.is_tool || object.voxel.octree.is_empty()) continue;
      segments.push_back({object.id, colour_of(i), object.voxel.octree});
      written_["segments"].push_back(object.id);
    }
    if (segments.empty()) return;
    need_no_stop();
    voxel::write_segmentation(segments, folder_ / "Data/objects.seg.nrrd");
    nodes_.add_segmentation("objects", "objects.seg.nrrd");
  }

  void write_markup(const SceneMarkup& markup) {
    const std::string file = names_.of(markup.name, ".mrk.json");
    voxel::write_file(folder_ / "Data" / file, json_text(markup.json, 1) + "\n");
    nodes_.add_markups(markup.type, markup.name, file);
    if (markup.type == "Fiducial")
      for (const NamedPoint& landmark : plan_.landmarks) written_["landmarks"].push_back(landmark.name);
    else
      written_[markup.type == "Plane"  ? "planes"
               : markup.type == "Line" ? "lines"
                                       : "curves"]
          .push_back(file);
  }

  void write_model(const Object& object, std::size_t index) {
    if (object.is_tool || !object.mesh.whole || object.mesh.whole->empty()) return;
    need_no_stop();
    const Object* still = object.image ? &evaluation_.object(object.image->object) : nullptr;
    const bool is_moved =
        still != nullptr && still->mesh.whole && glm::determinant(object.image->image_from_object) > 0.0;
    const std::string file = names_.of(object.id, ".vtp");
    brep::write_mesh((is_moved ? still : &object)->mesh.whole->triangles(), folder_ / "Data" / file);
    std::string transform;
    if (is_moved) {
      const bool is_text = transforms_ == TransformFormat::Text;
      const std::string motion = names_.of(object.id + "_motion", is_text ? ".tfm" : ".h5");
      const glm::dmat4& matrix = object.image->image_from_object;
      voxel::write_file(folder_ / "Data" / motion,
                        is_text ? itk_transform_text(matrix) : itk_transform_hdf5(matrix));
      transform = nodes_.add_transform(object.id + " motion", motion);
      written_["transforms"].push_back(object.id);
    }
    nodes_.add_model(object.id, file, colour_of(index), transform);
    written_["models"].push_back(object.id);
  }

  const Plan& plan_;
  const Evaluation& evaluation_;
  fs::path folder_;
  TransformFormat transforms_;
  std::stop_token stop_;
  FileNames names_;
  SceneNodes nodes_;
  Json written_{{"scans", Json::array()},      {"segments", Json::array()},  {"models", Json::array()},
                {"transforms", Json::array()}, {"landmarks", Json::array()}, {"planes", Json::array()},
                {"curves", Json::array()},     {"lines", Json::array()}};
};

/// Writes a folder as a zip archive, in which a folder with the archive's name contains all entries.
void write_bundle(const fs::path& folder, const fs::path& path) {
  std::set<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.insert(entry.path());
  voxel::StagedOutputs staged;
  ZipWriter zip(staged.beside(path));
  for (const fs::path& file : files) {
    zip.add((path.stem() / file.lexically_relative(folder)).generic_string(), voxel::file_bytes(file));
  }
  zip.close();
  staged.commit();
}

}  // namespace

Json write_slicer_scene(const Plan& plan, const Evaluation& evaluation, const fs::path& path,
                        TransformFormat transforms, const std::stop_token& stop) {
  const fs::path place = voxel::place_of(path);
  const bool is_bundle = place.extension() == ".mrb";
  if (!is_bundle && fs::exists(place) && !fs::is_empty(place))
    throw voxel::Error(
        voxel::ErrorCode::Input,
        path.string() + ": has files in it: choose a new folder for the scene, or a name that ends in .mrb");
  voxel::UnfinishedFolder work(place.parent_path(), ".octotomy-scene-");
  Json written = SceneFolder(plan, evaluation, work.path(), transforms, stop).write();
  if (is_bundle) {
    write_bundle(work.path(), place);
  } else {
    const fs::path made = work.keep();
    fs::permissions(made, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                              fs::perms::others_read | fs::perms::others_exec);
    fs::rename(made, place);
  }
  return written;
}

}  // namespace octotomy::planner
