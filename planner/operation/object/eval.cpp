// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the octree of a Boolean expression with motions: the verb of octrees in files, the step of objects' octrees.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/half_width.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/operation.h"
#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/combine_grey.h"
#include "voxel/solid/combine_shares.h"
#include "voxel/solid/expression.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

struct Eval {
  std::string expression;
  fs::path out;
  std::vector<std::string> lets, windows, motions;
  bool grey = false;
  std::string digitise = "centre", interpolate = "linear";

  std::vector<std::string> inputs() const { return voxel::names_in(expression); }
};

bool has_motions(const Eval& asked) {
  return !asked.motions.empty();
}

voxel::Resampling resampling_of(const Eval& asked) {
  using voxel::Interpolation;
  return {asked.digitise == "half" ? voxel::Resampling::Voxels::Half : voxel::Resampling::Voxels::Centre,
          asked.interpolate == "nearest" ? Interpolation::Nearest
          : asked.interpolate == "cubic" ? Interpolation::Cubic
                                         : Interpolation::Linear};
}

/// Parses texts NAME=VALUE into values by name. Throws for other texts and for repeated names.
std::map<std::string, std::string> bound(const std::vector<std::string>& texts, const std::string& option,
                                         const std::string& value) {
  std::map<std::string, std::string> values;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw std::runtime_error(option + ": '" + text + "' has no name: write NAME=" + value);
    if (!values.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
      throw std::runtime_error(option + ": '" + text.substr(0, equals) + "' is bound twice");
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
  const std::vector<double> numbers = comma_numbers(text);
  if (numbers.size() != 3 && numbers.size() != 7 && numbers.size() != 10)
    throw std::runtime_error("--motion: '" + name + "=" + text +
                             "' is not a motion: write X,Y,Z in mm, optionally followed by DEGREES and the "
                             "axis X,Y,Z, optionally followed by a point X,Y,Z in mm on the axis");
  voxel::Motion motion;
  motion.translate_mm = {numbers[0], numbers[1], numbers[2]};
  if (numbers.size() >= 7) {
    motion.degrees = numbers[3];
    motion.axis = {numbers[4], numbers[5], numbers[6]};
  }
  if (numbers.size() == 10) motion.about_mm = {numbers[7], numbers[8], numbers[9]};
  return voxel::moved_from_still(motion);
}

/// Motions by name, with a record of those that the expression uses.
class Motions {
 public:
  Motions(const std::vector<std::string>& texts, const std::string& option)
      : texts_(bound(texts, option, "X,Y,Z")), option_(option) {}

  /// The motion of a name. If the name is unknown, throws a message that ends with `remedy`.
  glm::dmat4 at(const std::string& name, const std::string& remedy) {
    const auto found = texts_.find(name);
    if (found == texts_.end())
      throw voxel::InvalidInput("no motion is called '" + name + "'" + suggestion(name, names_of(texts_)) +
                                ": " + remedy);
    used_.insert(name);
    return parse_motion(found->first, found->second);
  }
  /// Throws if the expression does not use a motion, because it would have no effect.
  void need_all_used() const {
    for (const auto& [name, unused] : texts_)
      if (!used_.contains(name))
        throw voxel::InvalidInput(option_ + ": the expression does not use '" + name + "': leave it out");
  }
  const std::map<std::string, std::string>& texts() const { return texts_; }

 private:
  std::map<std::string, std::string> texts_;
  std::string option_;
  std::set<std::string> used_;
};

/// Checks a step. Its expression names objects of the plan, and motions of the step.
void check(const Eval& asked, const FieldLocation& place) {
  if (place.scope == nullptr) return;
  check_output_path(asked.out, {".octree"}, place.at("path"));
  const FieldLocation at = place.at("expression");
  try {
    Motions motions(asked.motions, "'motions'");
    // To check grammar and names any object is sufficient.
    voxel::parse_expression(asked.expression, {[&](std::string_view name) -> voxel::Expression {
                                                 at.need_object(std::string(name));
                                                 return voxel::Sphere{};
                                               },
                                               [&](std::string_view name) {
                                                 return motions.at(std::string(name), "add it to 'motions'");
                                               }});
    motions.need_all_used();
  } catch (const voxel::InvalidInput& error) {
    at.refuse(error.what());
  }
}

/// An operand, from a file or an object of the plan, with its universe.
struct Operand {
  voxel::Expression expression;
  voxel::Universe universe;
  std::optional<voxel::ShareBracket> shares;  // if the file stores the filled shares of voxels
  bool is_grey = false;
};

Operand operand_of(const FileBench& bench, const std::string& name, const fs::path& path,
                   const std::map<std::string, std::string>& windows) {
  if (!names_octree(path.string(), bench))
    throw std::runtime_error(name + "=" + path.string() +
                             ": each name must refer to an .octree file: make one by octotomy octree");
  const voxel::OctreeFile file = octree_named(path.string(), bench);
  const auto window = windows.find(name);
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    if (window == windows.end())
      throw std::runtime_error(path.string() + ": is grey: choose which object '" + name + "' is: --window " +
                               name + "=LOW:HIGH, for example --window " + name + "=300:");
    return {window_on(*grey, parse_sample_window(window->second)), grey->universe(), std::nullopt, true};
  }
  if (window != windows.end())
    throw std::runtime_error(path.string() + ": contains no samples, so --window does not apply: leave '" +
                             name + "' out");
  if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree))
    return {partial->touching, partial->inside.universe(), voxel::bracket_of(*partial)};
  const auto& octree = std::get<voxel::Octree>(file.tree);
  return {octree, octree.universe(), std::nullopt};
}

/// A result with filled shares of voxels, and its volume with bounds as JSON.
struct ShareResult {
  voxel::PartialOctree tree;
  Json said;
};

/// Combines operands that have filled shares of voxels. An operand of whole voxels has shares of 0 and 1.
ShareResult combine_shares(const voxel::Expression& expression,
                           const std::map<std::string, Operand>& operands) {
  std::vector<voxel::ShareOperand> known;
  for (const auto& [name, operand] : operands) {
    const auto* octree = operand.expression.term().leaf
                             ? std::get_if<voxel::Octree>(&*operand.expression.term().leaf)
                             : nullptr;
    if (!operand.shares && octree == nullptr)
      throw std::runtime_error(name +
                               ": contains samples instead of the filled shares that the other operands "
                               "have: make an octree of its window first");
    known.push_back({operand.expression,
                     operand.shares ? *operand.shares : voxel::ShareBracket{*octree, *octree, {}, {}}});
  }
  const voxel::ShareBracket bracket = voxel::combine_shares(expression, known);
  ShareResult result{voxel::middle(bracket), Json::object()};
  const voxel::VolumeBracket volume = voxel::volume_mm3(bracket);
  const voxel::Measures counted = voxel::measure(voxel::at_least_half(result.tree));
  // Three standard deviations of a count for a curved or oblique boundary: 0.26 of a voxel's face times the
  // square root of the number of faces in the boundary (Kendall 1948).
  const double voxel_mm3 = bracket.inside.universe().lattice().voxel_mm3();
  HalfWidth count{3.0 * 0.26 * std::pow(voxel_mm3, 2.0 / 3.0) * std::sqrt(counted.area_crofton13_mm2), {}};
  const bool is_off =
      widen_to_seen(count, {"shares", "|V - the bracket's middle|",
                            std::abs(counted.volume_mm3 - 0.5 * (volume.low_mm3 + volume.high_mm3))});
  result.said = {{"volume_bracket_mm3", {volume.low_mm3, volume.high_mm3}},
                 {"volume_half_width_mm3", volume.half_width_mm3()},
                 {"volume_counted_mm3", counted.volume_mm3},
                 {"volume_counted_half_width_mm3", count.value},
                 {"volume_counted_half_width_of",
                  is_off ? count.terms.back().formula
                         : "3 * 0.26 h^2 sqrt(S); cuts along the lattice add up to h/2 of their area"},
                 {"tighter", volume.half_width_mm3() <= count.value ? "shares" : "count"},
                 {"tighter_by", nullptr}};
  const auto [least, most] = std::minmax({volume.half_width_mm3(), count.value});
  if (least > 0.0) result.said["tighter_by"] = most / least;
  return result;
}

/// Throws if the expression does not use a file, or if options for samples are set and no operand has
/// samples.
void need_options_read(const Eval& asked, const std::vector<std::string>& bound_names,
                       const std::map<std::string, Operand>& operands) {
  for (const std::string& name : bound_names)
    if (!operands.contains(name))
      throw std::runtime_error("--let " + name + ": the expression does not use this name: leave it out");
  if (std::any_of(operands.begin(), operands.end(), [](const auto& one) { return one.second.is_grey; }))
    return;
  if (asked.grey)
    throw std::runtime_error("--grey does not apply, because no operand has samples: leave it out");
  if (asked.interpolate != Eval().interpolate)
    throw std::runtime_error("--interpolate does not apply, because no operand has samples: leave it out");
}

FileAnswer on_files(const Eval& asked, const FileBench& bench) {
  need_octree_extension(asked.out);
  need_folder_of(asked.out);
  auto lets = bound(asked.lets, "--let", "FILE");
  const auto windows = bound(asked.windows, "--window", "LOW:HIGH");
  Motions motions(asked.motions, "--motion");
  if (bench.step != nullptr)
    for (const std::string& object : asked.inputs()) lets.emplace(object, object);
  const std::vector<std::string> known = names_of(lets);
  for (const auto& [name, unused] : windows)
    if (!lets.contains(name))
      throw std::runtime_error("--window: '" + name + "' is not bound by --let" + suggestion(name, known));

  // Only the files that the expression names are read.
  const std::vector<std::string> used = asked.inputs();
  std::vector<std::string> findings;
  Timings& timings = bench.timings;
  std::map<std::string, Operand> operands;
  for (const std::string& name : used)
    if (const auto let = lets.find(name); let != lets.end())
      operands.emplace(name, operand_of(bench, name, let->second, windows));
  const voxel::Names names{[&](std::string_view name) {
                             const auto found = operands.find(std::string(name));
                             if (found == operands.end())
                               throw voxel::InvalidInput("nothing is called '" + std::string(name) + "'" +
                                                         suggestion(name, known) + ": bind it with --let " +
                                                         std::string(name) + "=FILE");
                             return found->second.expression;
                           },
                           [&](std::string_view name) {
                             return motions.at(std::string(name),
                                               "bind it with --motion " + std::string(name) + "=X,Y,Z");
                           }};
  const voxel::Expression expression = voxel::parse_expression(asked.expression, names);
  need_options_read(asked, known, operands);
  motions.need_all_used();
  const voxel::Universe universe = operands.at(used.front()).universe;
  for (const std::string& name : used)
    if (!(operands.at(name).universe == universe))
      findings.push_back(name + ": its universe differs from that of " + used.front() +
                         ", which the result has, so it is resampled there");
  voxel::OctreeFile result{voxel::Octree::empty(universe), asked.expression, ""};
  Json more = Json::object();
  const bool with_shares = std::any_of(operands.begin(), operands.end(),
                                       [](const auto& operand) { return operand.second.shares.has_value(); });
  {
    const Stopwatch watch(timings, "combine");
    const voxel::Resampling resampling = resampling_of(asked);
    if (with_shares) {
      ShareResult combined = combine_shares(expression, operands);
      result.tree = std::move(combined.tree);
      more = std::move(combined.said);
    } else if (asked.grey) {
      voxel::GreyResult options;
      options.resampling = resampling;
      result.tree = voxel::combine_grey(universe, expression, options);
    } else {
      result.tree = voxel::combine(universe, expression, resampling);
    }
  }
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION}, {"expression", asked.expression}};
  for (const std::string& name : used) made["let"][name] = fs::path(lets.at(name)).filename().string();
  for (const auto& [name, window] : windows) made["window"][name] = window;
  for (const auto& [name, motion] : motions.texts()) made["motion"][name] = motion;
  result.metadata = json_text(made);
  return octree_written(result, asked.out, bench.stop, timings, findings, more);
}

}  // namespace

Operation eval_operation() {
  return Describe<Eval>("eval",
                        "Evaluates a Boolean expression of octrees: & | - ^ ~, parentheses, move(a, m).",
                        Makes::File)
      .takes(field("expression", &Eval::expression, "For example \"(a | b) - c\".")
                 .required()
                 .positional("expression"))
      .takes(field("path", &Eval::out,
                   "An .octree file. It has the universe of the first name in the expression.")
                 .required()
                 .called("out"))
      .verb_takes(field("lets", &Eval::lets, "NAME=FILE: the .octree file for a name in the expression.")
                      .repeated()
                      .called("let"))
      .verb_takes(
          field("windows", &Eval::windows,
                "NAME=LOW:HIGH or NAME=TISSUE: the window that selects the object in a name's grey octree.")
              .repeated()
              .called("window"))
      .takes(field("motions", &Eval::motions,
                   "NAME=X,Y,Z[,DEGREES,X,Y,Z[,X,Y,Z]]: a motion for move(a, NAME): a translation in mm, "
                   "after a rotation by DEGREES about an axis through a point.")
                 .repeated()
                 .called("motion"))
      .verb_takes(field("grey", &Eval::grey,
                        "Keeps samples: each voxel gets the sample of the first operand that contains it and "
                        "has samples. Samples move with their operand."))
      .takes(field("digitise", &Eval::digitise,
                   "Which voxels a moved octree has: those whose centre it contains, or those that it fills "
                   "at least half.")
                 .one_of({"centre", "half"})
                 .read_if<Eval>(has_motions, "applies only to moved objects: add 'motions'"))
      .verb_takes(field("interpolate", &Eval::interpolate,
                        "How samples of a moved grey octree are interpolated: nearest, linear or cubic.")
                      .one_of({"nearest", "linear", "cubic"})
                      .read_if<Eval>(has_motions, "applies only to moved objects: add 'motions'"))
      .example(R"({"id": "rest", "do": "eval", "expression": "skull - cut", "path": "rest.octree"})")
      .on_files(
          "octotomy eval \"skull - cut\" -o rest.octree --let skull=skull.octree --let cut=cut.octree\n"
          "  Files of filled shares (--digitise partial) give shares again, with bounds of the volume.",
          on_files)
      .uses([](const Eval& asked) { return asked.inputs(); })
      .check(check)
      .write(write_step<Eval, on_files>);
}

}  // namespace octotomy::planner
