// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>

#include "planner/cli/verb.h"
#include "planner/nearest_name.h"
#include "planner/octree_answer.h"
#include "planner/representation.h"
#include "voxel/combine.h"
#include "voxel/expression.h"
#include "voxel/octree_file.h"
#include "voxel/read_scene.h"
#include "voxel/staging.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

// What is written -----------------------------------------------------------------------------------------

void check_octree_extension(const fs::path& out) {
  if (!is_octree(out))
    throw std::runtime_error(out.string() +
                             ": an octree is written as .octree; for another form of it add --as");
}

voxel::OctreeFile read_timed(const fs::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  return voxel::read_octree(path);
}

void write_content(const std::string& content, const fs::path& path) {
  voxel::Staging staging(path.parent_path());
  const fs::path staged = staging.folder() / path.filename();
  std::FILE* const stream = std::fopen(staged.c_str(), "wb");
  bool written =
      stream != nullptr && std::fwrite(content.data(), 1, content.size(), stream) == content.size();
  if (stream != nullptr && std::fclose(stream) != 0) written = false;  // a full disk may show only here
  if (!written) throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
  staging.commit(path.filename());
}

/// Writes the file and says of it what info does.
int write_and_say(const Program& program, const voxel::OctreeFile& file, const fs::path& out,
                  Timings& timings, const std::vector<std::string>& findings = {}) {
  if (program.stop.stop_requested()) throw Stopped("stopped before " + out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_octree(file, out);
  }
  Json json = octree_answer(file, fs::file_size(out), timings);
  json["path"] = out.string();
  for (const std::string& finding : findings) {
    warn(finding);
    json["findings"].push_back(finding);
  }
  program.say(json, octree_text(out.string(), json));
  return done;
}

// octree --------------------------------------------------------------------------------------------------

struct OctreeText {
  fs::path in, out;
  std::string window, as, from;
  bool grey = false;
  std::optional<int> depth;
  std::optional<double> voxel_mm;
};

voxel::Octree windowed(const voxel::GreyOctree& grey, const WindowText& window) {
  voxel::Window leaf{grey, window.low};
  if (window.high) leaf.high = *window.high;
  return voxel::combine(grey.universe(), voxel::Expression(leaf));
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

voxel::OctreeFile from_scan(const OctreeText& text, Timings& timings) {
  if (is_mesh(text.in))
    throw std::runtime_error(text.in.string() + ": is a mesh: octotomy voxelise makes an octree of one");
  if (text.window.empty() && !text.grey)
    throw std::runtime_error(text.in.string() +
                             ": is a scan, say what of it: --window LOW:HIGH for an object, for example "
                             "--window 300:, or --grey for all samples");
  std::optional<WindowText> window;
  if (!text.window.empty()) window = parse_window(text.window);
  voxel::Scene scene;
  {
    const Stopwatch watch(timings, "read");
    scene = voxel::read_scene(text.in);
  }
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
  if (text.as.empty()) check_octree_extension(text.out);
  if (!text.window.empty() && text.grey)
    throw CLI::ValidationError("--grey", "a tree is --grey or an object by --window, not both");
  need_folder_of(text.out);
  Timings timings;
  const voxel::OctreeFile file = !text.from.empty()   ? from_representation(text, timings)
                                 : is_octree(text.in) ? from_octree(text, timings)
                                                      : from_scan(text, timings);
  return text.as.empty() ? write_and_say(program, file, text.out, timings)
                         : export_as(program, text, file, timings);
}

// eval ----------------------------------------------------------------------------------------------------

struct EvalText {
  std::string expression;
  fs::path out;
  std::vector<std::string> lets, windows, motions;
};

/// NAME=VALUE texts by name; refuses others, and names said twice.
std::map<std::string, std::string> bound(const std::vector<std::string>& texts, const std::string& option,
                                         const std::string& value) {
  std::map<std::string, std::string> values;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw CLI::ValidationError(option,
                                 std::string("'").append(text).append("' binds nothing: give NAME=") + value);
    if (!values.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
      throw CLI::ValidationError(option, "'" + text.substr(0, equals) + "' is bound twice");
  }
  return values;
}

std::vector<std::string> names_of(const std::map<std::string, std::string>& values) {
  std::vector<std::string> names;
  names.reserve(values.size());
  for (const auto& [name, unused] : values) names.push_back(name);
  return names;
}

glm::dmat4 parse_motion(const std::string& name, const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end + 1) {
    numbers.push_back(std::strtod(at, &end));
    const bool read = end != at;
    if (read && *end == ',') continue;
    if (read && *end == '\0' && (numbers.size() == 3 || numbers.size() == 7 || numbers.size() == 10)) break;
    throw CLI::ValidationError("--motion",
                               std::string("'").append(name).append("=").append(text) +
                                   "' is no motion: give X,Y,Z in mm, then perhaps DEGREES and the "
                                   "axis X,Y,Z, then perhaps the point X,Y,Z in mm it passes through");
  }
  voxel::Motion motion;
  motion.translate_mm = {numbers[0], numbers[1], numbers[2]};
  if (numbers.size() >= 7) {
    motion.degrees = numbers[3];
    motion.axis = {numbers[4], numbers[5], numbers[6]};
  }
  if (numbers.size() == 10) motion.about_mm = {numbers[7], numbers[8], numbers[9]};
  return voxel::moved_from_still(motion);
}

/// A file as an operand, with its universe.
struct Operand {
  voxel::Expression expression;
  voxel::Universe universe;
};

Operand operand_of(const std::string& name, const fs::path& path,
                   const std::map<std::string, std::string>& windows) {
  if (!is_octree(path))
    throw std::runtime_error(name + "=" + path.string() +
                             ": names stand for .octree files: make one with octotomy octree");
  const voxel::OctreeFile file = voxel::read_octree(path);
  const auto window = windows.find(name);
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    if (window == windows.end())
      throw std::runtime_error(path.string() + ": is grey, say which object '" + name + "' is: --window " +
                               name + "=LOW:HIGH, for example --window " + name + "=300:");
    const WindowText range = parse_window(window->second);
    voxel::Window leaf{*grey, range.low};
    if (range.high) leaf.high = *range.high;
    return {leaf, grey->universe()};
  }
  if (window != windows.end())
    throw std::runtime_error(path.string() + ": holds no samples to take a --window of: leave '" + name +
                             "' out");
  const auto* octree = std::get_if<voxel::Octree>(&file.tree);
  if (octree == nullptr)
    throw std::runtime_error(path.string() +
                             ": holds fractions, which have no Boolean: digitise it as centre or half");
  return {*octree, octree->universe()};
}

int eval(const Program& program, const EvalText& text) {
  check_octree_extension(text.out);
  need_folder_of(text.out);
  const auto lets = bound(text.lets, "--let", "FILE");
  const auto windows = bound(text.windows, "--window", "LOW:HIGH");
  const auto motions = bound(text.motions, "--motion", "X,Y,Z");
  const std::vector<std::string> known = names_of(lets);
  for (const auto& [name, unused] : windows)
    if (!lets.contains(name))
      throw CLI::ValidationError("--window",
                                 "'" + name + "' is not bound by --let" + suggestion(name, known));

  // Read what the expression names, and no more.
  const std::vector<std::string> used = voxel::names_in(text.expression);
  std::vector<std::string> findings;
  for (const std::string& name : known)
    if (std::find(used.begin(), used.end(), name) == used.end())
      findings.push_back("--let " + name + ": the expression does not name it");
  Timings timings;
  std::map<std::string, Operand> operands;
  {
    const Stopwatch watch(timings, "read");
    for (const std::string& name : used)
      if (const auto let = lets.find(name); let != lets.end())
        operands.emplace(name, operand_of(name, let->second, windows));
  }
  const voxel::Names names{[&](std::string_view name) {
                             const auto found = operands.find(std::string(name));
                             if (found == operands.end())
                               throw std::invalid_argument("nothing is called '" + std::string(name) + "'" +
                                                           suggestion(name, known) + ": bind it with --let " +
                                                           std::string(name) + "=FILE");
                             return found->second.expression;
                           },
                           [&](std::string_view name) {
                             const auto found = motions.find(std::string(name));
                             if (found == motions.end())
                               throw std::invalid_argument("no motion is called '" + std::string(name) + "'" +
                                                           suggestion(name, names_of(motions)) +
                                                           ": bind it with --motion " + std::string(name) +
                                                           "=X,Y,Z");
                             return parse_motion(found->first, found->second);
                           }};
  const voxel::Expression expression = voxel::parse_expression(text.expression, names);
  const voxel::Universe universe = operands.at(used.front()).universe;
  for (const std::string& name : used)
    if (!(operands.at(name).universe == universe))
      findings.push_back(name + ": lives in another universe than " + used.front() +
                         ", whose voxels the result has: it is sampled at their centres");
  voxel::OctreeFile result{voxel::Octree::empty(universe), text.expression, ""};
  {
    const Stopwatch watch(timings, "combine");
    result.tree = voxel::combine(universe, expression);
  }
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION}, {"expression", text.expression}};
  for (const std::string& name : used) made["let"][name] = fs::path(lets.at(name)).filename().string();
  for (const auto& [name, window] : windows) made["window"][name] = window;
  for (const auto& [name, motion] : motions) made["motion"][name] = motion;
  result.metadata = made.dump();
  return write_and_say(program, result, text.out, timings, findings);
}

}  // namespace

bool is_octree(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".octree";
}

int info_of_octree(const Program& program, const fs::path& path) {
  Timings timings;
  const voxel::OctreeFile file = read_timed(path, timings);
  Json json = octree_answer(file, fs::file_size(path), timings);
  json["source"] = path.string();
  program.say(json, octree_text(path.string(), json));
  return done;
}

void add_octree_verbs(Program& program) {
  const auto to_build = std::make_shared<OctreeText>();
  CLI::App& build = program.verb(
      "octree", "Builds an octree of a scan's window or of all its samples, or puts one into another form",
      "octotomy octree head.nrrd -o skull.octree --window 300:\n"
      "  octotomy octree skull.octree -o skull.txt --as linear\n"
      "  octotomy octree skull.txt -o skull.octree --from linear --depth 8",
      [&program, to_build] { return octree(program, *to_build); });
  build.add_option("file", to_build->in, "A scan, an .octree file, or with --from a representation")
      ->required()
      ->check(CLI::ExistingPath);
  build.add_option("-o,--out", to_build->out, "An .octree file, or with --as the representation's")
      ->required();
  build.add_option("--window", to_build->window, "LOW:HIGH or LOW: in sample units: a binary octree");
  build.add_flag("--grey", to_build->grey, "A min-max octree of all samples");
  build
      .add_option("--voxel", to_build->voxel_mm,
                  "Edge of a voxel, mm; default: as fine as the scan, at most 512 a side; with --from 1")
      ->check(CLI::PositiveNumber);
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

  const auto to_evaluate = std::make_shared<EvalText>();
  CLI::App& evaluate = program.verb(
      "eval", "Evaluates a Boolean expression of octrees: & | - ^ ~, parentheses, move(a, m)",
      "octotomy eval \"skull - cut\" -o rest.octree --let skull=skull.octree --let cut=cut.octree",
      [&program, to_evaluate] { return eval(program, *to_evaluate); });
  evaluate.add_option("expression", to_evaluate->expression, "For example \"(a | b) - c\"")->required();
  evaluate.add_option("-o,--out", to_evaluate->out, "An .octree file, in the universe of the first name")
      ->required();
  evaluate.add_option("--let", to_evaluate->lets, "NAME=FILE: what a name stands for, an .octree file")
      ->type_name("NAME=FILE")
      ->expected(1)
      ->take_all();
  evaluate.add_option("--window", to_evaluate->windows, "NAME=LOW:HIGH: which object of a grey octree")
      ->type_name("NAME=LOW:HIGH")
      ->expected(1)
      ->take_all();
  evaluate
      .add_option(
          "--motion", to_evaluate->motions,
          "NAME=X,Y,Z[,DEGREES,X,Y,Z[,X,Y,Z]]: a translation in mm after a rotation about an axis through "
          "a point")
      ->type_name("NAME=X,Y,Z")
      ->expected(1)
      ->take_all();
}

}  // namespace octotomy::planner::cli
