// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/plan/octree_summary.h"
#include "planner/plan/representation.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

void write_content(const std::string& content, const fs::path& path) {
  voxel::StagedFiles staging(path.parent_path());
  const fs::path staged = staging.folder() / path.filename();
  std::FILE* const stream = std::fopen(staged.c_str(), "wb");
  bool written =
      stream != nullptr && std::fwrite(content.data(), 1, content.size(), stream) == content.size();
  if (stream != nullptr && std::fclose(stream) != 0) written = false;  // a full disk may show only here
  if (!written) throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
  staging.commit(path.filename());
}

struct OctreeText {
  fs::path in, out;
  std::string window, as, from;
  bool grey = false;
  std::optional<int> depth;
  std::optional<double> voxel_mm;
  ScanIn scan;
};

voxel::Octree windowed(const voxel::GreyOctree& grey, const WindowText& window) {
  return voxel::combine(grey.universe(), voxel::Expression(window_on(grey, window)));
}

std::string content_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string content(std::istreambuf_iterator<char>(stream), {});
  if (!stream && !stream.eof()) throw std::runtime_error(path.string() + ": cannot be read");
  return content;
}

voxel::OctreeFile from_representation(const OctreeText& text, Timings& timings) {
  if (!text.depth)
    throw CLI::ValidationError("--depth",
                               "a representation does not tell its universe: say --depth N, for 2^N "
                               "voxels a side");
  voxel::Universe universe;
  universe.depth = *text.depth;
  const double edge_mm = text.voxel_mm.value_or(1.0);
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis][axis] = edge_mm;
  std::string content;
  {
    const Stopwatch watch(timings, "read");
    content = content_of(text.in);
  }
  const Stopwatch watch(timings, "octree");
  try {
    return {octree_of_representation(universe, text.from, content), text.in.stem().string(), ""};
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(text.in.string() + ": " + error.what());
  }
}

voxel::OctreeFile from_octree(const OctreeText& text, Timings& timings) {
  voxel::OctreeFile file = read_timed(text.in, timings);
  if (text.window.empty()) return file;
  const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree);
  if (grey == nullptr)
    throw std::runtime_error(text.in.string() + ": holds no samples to take a --window of: leave it out");
  const Stopwatch watch(timings, "octree");
  return {windowed(*grey, parse_window(text.window)), file.name, file.metadata};
}

voxel::OctreeFile from_scan(const Program& program, const OctreeText& text, Timings& timings) {
  if (is_mesh(text.in))
    throw std::runtime_error(text.in.string() + ": is a mesh: octotomy voxelise makes an octree of one");
  if (text.window.empty() && !text.grey)
    throw std::runtime_error(text.in.string() +
                             ": is a scan, say what of it: --window LOW:HIGH for an object, for example "
                             "--window 300:, or --grey for all samples");
  std::optional<WindowText> window;
  if (!text.window.empty()) window = parse_window(text.window);
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  need_hounsfield(text.window, scene);
  const Stopwatch watch(timings, "octree");
  const voxel::Universe universe = universe_of(scene.lattice, text.voxel_mm);
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe, scene);
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
            {"scan", text.in.filename().string()},
            {"unit", voxel::unit(scene)},
            {"modality", scene.modality}};
  if (window) made["window"] = {window->low, window->high ? Json(*window->high) : Json(nullptr)};
  const std::string name = text.in.stem().string();
  if (!window) return {grey, name, made.dump()};
  return {windowed(grey, *window), name, made.dump()};
}

int export_as(const Program& program, const OctreeText& text, const voxel::OctreeFile& file,
              Timings& timings) {
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(text.in.string() + ": only a binary octree has the form " + text.as +
                             (std::holds_alternative<voxel::GreyOctree>(file.tree)
                                  ? ": choose an object of the samples with --window LOW:HIGH"
                                  : ": this one holds fractions, digitise it as centre or half"));
  std::string content;
  {
    const Stopwatch watch(timings, "represent");
    content = represented(*octree, text.as);
  }
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    write_content(content, text.out);
  }
  Json json = octree_answer(file, std::nullopt, timings);
  json["path"] = text.out.string();
  json["as"] = text.as;
  json["bytes_representation"] = content.size();
  program.say(json, lines({{"written", text.out.string()},
                           {"form", text.as},
                           {"depth", std::to_string(octree->universe().depth)},
                           {"bytes", std::to_string(content.size())}}));
  return done;
}

int octree(const Program& program, const OctreeText& text) {
  if (text.as.empty()) need_octree_extension(text.out);
  if (!text.window.empty() && text.grey)
    throw CLI::ValidationError("--grey", "a tree is --grey or an object by --window, not both");
  need_folder_of(text.out);
  Timings timings;
  const voxel::OctreeFile file = !text.from.empty()   ? from_representation(text, timings)
                                 : is_octree(text.in) ? from_octree(text, timings)
                                                      : from_scan(program, text, timings);
  return text.as.empty() ? write_and_say(program, file, text.out, timings)
                         : export_as(program, text, file, timings);
}

}  // namespace

void add_octree(Program& program) {
  const auto to_build = std::make_shared<OctreeText>();
  CLI::App& build = program.verb(
      "octree", "Builds an octree of a scan's window or of all its samples, or puts one into another form",
      "octotomy octree head.nrrd -o skull.octree --window 300:\n"
      "  octotomy octree skull.octree -o skull.txt --as linear\n"
      "  octotomy octree skull.txt -o skull.octree --from linear --depth 8",
      [&program, to_build] { return octree(program, *to_build); });
  build.add_option("file", to_build->in, "A scan, an .octree file, or with --from a representation")
      ->required()
      ->check(scan_path());
  build.add_option("-o,--out", to_build->out, "An .octree file, or with --as the representation's")
      ->required();
  build.add_option("--window", to_build->window,
                   "LOW:HIGH or LOW: in sample units, or a tissue (bone, skin, ...): a binary octree");
  build.add_flag("--grey", to_build->grey, "A min-max octree of all samples");
  build
      .add_option("--voxel", to_build->voxel_mm,
                  "Edge of a voxel, mm; default: as fine as the scan, at most 512 a side; with --from 1")
      ->check(above_zero());
  build
      .add_option(
          "--as", to_build->as,
          "Write treecode, linear, explicit, runs, segments, marginal, faces or array (text), packed or "
          "bits (bytes)")
      ->check(CLI::IsMember(representation_names()));
  build.add_option("--from", to_build->from, "Read the file as such a representation")
      ->check(CLI::IsMember(representation_names()));
  build.add_option("--depth", to_build->depth, "With --from: the universe has 2^N voxels a side")
      ->check(CLI::Range(2, voxel::Universe::max_depth))
      ->type_name("N");
  add_scan_options(build, to_build->scan);
}

}  // namespace octotomy::planner::cli
