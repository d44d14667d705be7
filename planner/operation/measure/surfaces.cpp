// SPDX-License-Identifier: AGPL-3.0-or-later
// All labels of a label map as one set of surfaces that share their common faces.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "brep/mesh/error.h"
#include "convert/surface/label_surfaces.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "planner/operation/table/record.h"
#include "voxel/filter/label_map.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

struct Surfaces {
  ScanName scan;
  fs::path path;
  std::vector<int> labels;
  int smooth = convert::LabelSurfaceOptions{}.smooth_voxels;
  // Only the verb has the following options.
  fs::path out, names;
};

constexpr const char* name_mark = "{name}";

void check(const Surfaces& surfaces, const FieldLocation& place) {
  if (place.scope != nullptr) check_output_path(surfaces.path, {".vtp", ".obj", ".glb"}, place.at("path"));
  for (const int label : surfaces.labels)
    if (label < 1 || label > voxel::most_label)
      place.at("labels").refuse("a label must be from 1 to " + std::to_string(voxel::most_label));
}

/// Names of labels.
using Names = std::map<int, std::string>;

/// Calls `work` with a scene. Throws std::runtime_error that names the path if the scene is not a label map.
template <typename Work>
auto of_label_map(const voxel::Scene& scene, const Work& work) {
  try {
    return work();
  } catch (const voxel::InvalidInput& error) {
    throw std::runtime_error(scene.source + ": is not a label map: " + error.what());
  }
}

/// The names of the labels with a surface; a label without a name gets one such as "label 5".
Names names_of(const Surfaces& asked, const voxel::Scene& scene, const LabelTable& table) {
  const std::set<int> wanted(asked.labels.begin(), asked.labels.end());
  Names names;
  for (const voxel::Label& label : of_label_map(scene, [&] { return voxel::labels(scene); })) {
    if (!wanted.empty() && !wanted.contains(label.number)) continue;
    const auto known = table.names.find(label.number);
    names[label.number] =
        known == table.names.end() ? "label " + std::to_string(label.number) : known->second;
  }
  return names;
}

/// The table of --names if it is stated, else the label map's own table.
LabelTable table_of(const Surfaces& asked, const fs::path& label_map, const voxel::Scene& scene) {
  if (!asked.names.empty()) return read_label_table(asked.names);
  std::set<int> occurring;
  for (const voxel::Label& label : of_label_map(scene, [&] { return voxel::labels(scene); }))
    occurring.insert(label.number);
  return label_table_of(label_map, occurring);
}

brep::PartedSurface surfaces_of(const Surfaces& asked, const voxel::Scene& scene, const Names& names,
                                const voxel::Progress& progress) {
  brep::PartedSurface made = of_label_map(scene, [&] {
    return convert::label_surfaces(scene,
                                   {{asked.labels.begin(), asked.labels.end()}, asked.smooth, progress});
  });
  made.names = names;
  return made;
}

/// The numbers of the labels, and the areas of the contacts between their parts.
struct Sizes {
  struct Part {
    std::size_t faces = 0;
    double volume_mm3 = 0.0, area_mm2 = 0.0;
  };
  std::map<int, Part> parts;
  std::map<std::pair<int, int>, double> contacts_mm2;
};

Sizes sizes_of(const brep::PartedSurface& parted) {
  Sizes sizes;
  for (std::size_t f = 0; f < parted.sides.size(); ++f) {
    const auto& [a, b, c] = parted.triangles.faces[f];
    // Sums are relative to the first point, because volumes far from the origin lose digits.
    const glm::dvec3 &origin = parted.triangles.points_mm[0], p = parted.triangles.points_mm[a] - origin,
                     q = parted.triangles.points_mm[b] - origin, r = parted.triangles.points_mm[c] - origin;
    const double volume_mm3 = glm::dot(glm::cross(p, q), r) / 6.0,
                 area_mm2 = 0.5 * glm::length(glm::cross(q - p, r - p));
    const auto& [behind, front] = parted.sides[f];
    for (const auto& [part, sign] : {std::pair{behind, 1.0}, std::pair{front, -1.0}}) {
      if (part == 0) continue;
      Sizes::Part& size = sizes.parts[part];
      ++size.faces;
      size.volume_mm3 += sign * volume_mm3;
      size.area_mm2 += area_mm2;
    }
    if (behind != 0 && front != 0) sizes.contacts_mm2[{behind, front}] += area_mm2;
  }
  return sizes;
}

struct PartSize {
  int label = 0;
  std::string name;
  std::uint64_t faces = 0;
  double volume_mm3 = 0.0, volume_samples_mm3 = 0.0, area_mm2 = 0.0;
};
constexpr auto members_of(const PartSize&) {
  using P = PartSize;
  return std::tuple(member("label", &P::label), member("name", &P::name), member("faces", &P::faces),
                    member("volume_mm3", &P::volume_mm3),
                    member("volume_samples_mm3", &P::volume_samples_mm3), member("area_mm2", &P::area_mm2));
}

/// The surface that two parts share.
struct PartContact {
  std::vector<int> between;  ///< two labels
  double area_mm2 = 0.0;
};
constexpr auto members_of(const PartContact&) {
  return std::tuple(member("between", &PartContact::between), member("area_mm2", &PartContact::area_mm2));
}

struct PartedSize {
  std::uint64_t faces = 0, vertices = 0;
  std::vector<PartSize> parts;
  std::vector<PartContact> contacts;
};
constexpr auto members_of(const PartedSize&) {
  using P = PartedSize;
  return std::tuple(member("faces", &P::faces), member("vertices", &P::vertices), member("parts", &P::parts),
                    member("contacts", &P::contacts));
}

PartedSize parted_size(const brep::PartedSurface& surface, const voxel::Scene& scene) {
  const Sizes sizes = sizes_of(surface);
  PartedSize made{surface.triangles.faces.size(), surface.triangles.points_mm.size(), {}, {}};
  for (const voxel::Label& label : voxel::labels(scene))
    if (const auto size = sizes.parts.find(label.number); size != sizes.parts.end())
      made.parts.push_back({label.number, surface.names.at(label.number),
                            static_cast<std::uint64_t>(size->second.faces), size->second.volume_mm3,
                            static_cast<double>(label.samples) * scene.lattice.voxel_mm3(),
                            size->second.area_mm2});
  for (const auto& [between, area_mm2] : sizes.contacts_mm2)
    made.contacts.push_back({{between.first, between.second}, area_mm2});
  return made;
}

/// Findings on files that are no table of names, on labels that are stored as fractions, and on parts whose
/// surface encloses another volume than their samples, such as thin layers between other parts.
std::vector<std::string> findings_of(const PartedSize& parted, const LabelTable& table,
                                     const voxel::Scene& scene) {
  constexpr double told_share = 0.1;
  constexpr std::size_t most_told = 8;
  std::vector<std::string> findings = table.passed_over;
  for (std::string& finding : findings_of_labels(voxel::labels(scene)))
    findings.push_back(std::move(finding));
  std::size_t more = 0;
  for (const PartSize& part : parted.parts) {
    const double surface = part.volume_mm3, samples = part.volume_samples_mm3;
    if (!(std::abs(surface - samples) > told_share * samples)) continue;
    if (findings.size() == most_told)
      ++more;
    else
      findings.push_back(
          part.name + ": the surface holds " + grouped(surface, 0) + " mm\u00b3, its samples " +
          grouped(samples, 0) +
          " mm\u00b3, because it is thin and smoothing changed it: --smooth 0 changes it less");
  }
  if (more > 0) findings.push_back(std::to_string(more) + " more surfaces differ from their samples as much");
  return findings;
}

/// A name as part of a file's name: only letters of any script, digits, dots and dashes.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char letter : name) {
    const auto code = static_cast<unsigned char>(letter);
    word += code >= 0x80 || std::isalnum(code) != 0 || letter == '-' || letter == '.' ? letter : '_';
  }
  return word;
}

/// The paths of the files, one for each part: `out` with the part's name in place of {name}. If several parts
/// have the same name, the number is added.
std::map<int, fs::path> files_of_parts(const Names& names, const fs::path& out) {
  std::map<int, fs::path> files;
  std::set<std::string> used;
  for (const auto& [part, name] : names) {
    std::string file = out.filename().string();
    std::string word = file_word(name);
    while (!used.insert(word).second) word += "_" + std::to_string(part);
    file.replace(file.find(name_mark), std::string(name_mark).size(), word);
    files[part] = out.parent_path() / file;
  }
  return files;
}

bool is_of_parts(const fs::path& out) {
  return out.filename().string().find(name_mark) != std::string::npos;
}

/// The paths of the files that the verb writes. Throws if a generated name cannot be written.
std::vector<fs::path> need_files(const Surfaces& asked, const Names& names) {
  if (!is_of_parts(asked.out)) return {asked.out};
  std::vector<fs::path> files;
  for (const auto& [part, file] : files_of_parts(names, asked.out)) {
    need_untyped_surface(file, {asked.scan.name, asked.names});
    files.push_back(file);
  }
  return files;
}

void need_disk_of(const brep::PartedSurface& made, const fs::path& out) {
  voxel::need_disk(out,
                   brep::least_mesh_bytes(made.triangles.points_mm.size(), made.triangles.faces.size(), out));
}

void write_one(const brep::PartedSurface& made, const fs::path& out, Timings& timings) {
  const Stopwatch watch(timings, "write");
  need_disk_of(made, out);
  Outputs outputs;
  outputs.write(out, [&](const fs::path& file) { brep::write_parts(made, file); });
  outputs.commit();
}

void write_each(const brep::PartedSurface& made, const fs::path& out, Timings& timings) {
  const Stopwatch watch(timings, "write");
  need_disk_of(made, out);
  Outputs outputs;
  for (const auto& [part, path] : files_of_parts(made.names, out)) {
    const brep::Triangles surface = brep::surface_of_part(made, part);
    outputs.write(path, [&](const fs::path& file) { brep::write_mesh(surface, file); });
  }
  outputs.commit();
}

void write(const Surfaces& asked, const AnswerBench& bench, Exported& made) {
  made.path = output_path(asked.path).generic_string();
  const voxel::Scene& scene = bench.samples(asked.scan.name);
  const LabelTable table = table_of(asked, scene.source, scene);
  const brep::PartedSurface parted = surfaces_of(asked, scene, names_of(asked, scene, table),
                                                 bench.progress("surfaces of " + asked.scan.name));
  if (parted.triangles.faces.empty())
    return made.findings.push_back("not written: '" + asked.scan.name + "' has no labels");
  write_one(parted, output_file(bench.folder, made.path), bench.timings);
  made.written = true;
  made.content = grouped(static_cast<double>(parted.names.size()), 0) + " labels, " +
                 grouped(static_cast<double>(parted.triangles.faces.size()), 0) + " triangles";
  const PartedSize size = parted_size(parted, scene);
  made.details = print_record(size);
  made.findings = findings_of(size, table, scene);
}

FileAnswer on_files(const Surfaces& asked, const FileBench& bench) {
  if (!is_of_parts(asked.out) && !brep::is_parts_file(asked.out))
    throw std::runtime_error(
        asked.out.string() +
        ": all surfaces can be written only to one .vtp, .obj or .glb file, or to one file per label: put " +
        name_mark + " into its name");
  need_mesh_extension(asked.out);
  need_folder_of(asked.out);
  const fs::path file = asked.scan.name;
  const voxel::Scene scene = bench.read_scan(file);
  const LabelTable table = table_of(asked, file, scene);
  const Names names = names_of(asked, scene, table);
  const std::vector<fs::path> files = need_files(asked, names);
  brep::PartedSurface made;
  {
    const Stopwatch watch(bench.timings, "surfaces");
    made = surfaces_of(asked, scene, names, bench.progress("surfaces"));
  }
  if (made.triangles.faces.empty())
    throw std::runtime_error(file.string() + ": contains no labels, because every sample is 0");
  is_of_parts(asked.out) ? write_each(made, asked.out, bench.timings)
                         : write_one(made, asked.out, bench.timings);
  std::vector<std::string> paths;
  for (const fs::path& each : files) paths.push_back(each.string());
  FileAnswer answer{{{"kind", "surfaces of labels"}, {"path", asked.out.string()}, {"files", paths}}};
  const PartedSize size = parted_size(made, scene);
  answer.json.update(print_record(size));
  answer.findings = findings_of(size, table, scene);
  if (!answer.findings.empty()) answer.json.update({{"findings", answer.findings}});
  answer.rows.emplace_back("written",
                           files.size() == 1 ? files[0].string() : std::to_string(files.size()) + " files");
  for (const PartSize& part : size.parts)
    answer.rows.emplace_back(part.name, grouped(part.volume_mm3, 1) + " mm\u00b3, " +
                                            grouped(static_cast<double>(part.faces), 0) + " triangles");
  return answer;
}

}  // namespace

Operation surfaces_operation() {
  return Describe<Surfaces>("surfaces",
                            "Writes the surfaces of all labels of a label map. Neighbouring surfaces share "
                            "their common faces.",
                            Makes::File)
      .takes(field("scan", &Surfaces::scan, "The label map.").required().positional("file"))
      .takes(
          field("path", &Surfaces::path, "Path of the file within the result's folder: .vtp, .obj or .glb.")
              .in_plans_only())
      .takes(
          field("labels", &Surfaces::labels, "Only these labels. Default: all but 0.").for_example("[1, 2]"))
      .takes(field("smooth", &Surfaces::smooth,
                   "Width of the smoothing in voxels; 0 leaves the surfaces half-way between voxels.")
                 .from(0)
                 .to(4))
      .verb_takes(field("out", &Surfaces::out,
                        "One .vtp, .obj or .glb file for all labels; or, with {name} in the path, one file "
                        "for each label, which only replaces a file that Octotomy wrote.")
                      .required())
      .verb_takes(field("names", &Surfaces::names,
                        "A table of names to use instead of the label map's own: .json, .csv, .tsv, "
                        "ITK-SNAP's .txt, 3D Slicer's .ctbl.")
                      .a_file())
      .reads_scans()
      .example(R"({"id": "organs", "do": "surfaces", "scan": "ct", "path": "organs.vtp"})")
      .on_files(
          "octotomy surfaces organs.nii.gz -o organs.vtp\n"
          "  octotomy surfaces organs.nii.gz --names organs.json -o \"parts/{name}.stl\"",
          on_files)
      .check(check)
      .write(write);
}

}  // namespace octotomy::planner
