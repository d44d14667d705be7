// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/random_suite.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>

#include "brep/mesh/parallel_tasks.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json_file.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan.h"
#include "planner/plan/random_plan.h"
#include "planner/result/report/result_folder.h"
#include "verify/certificate/exact_agreement.h"
#include "verify/certificate/sets_as_given.h"
#include "verify/question/random_expression.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/space/unfinished_folder.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

using verify::Certificate;
using verify::Random;
using verify::Verdict;
using voxel::Expression;
using voxel::Octree;

constexpr const char* scans_prefix = "octotomy-random-";

/// The system's folder for temporary files. First removes leftovers of killed runs from it.
std::filesystem::path cleared_temporary_folder() {
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  voxel::remove_abandoned(folder, scans_prefix);
  return folder;
}

std::string letter(int leaf) {
  return std::string(1, static_cast<char>('a' + leaf));
}

/// A question of the exact tiers: sets of voxels, and an expression of them.
struct ExactQuestion {
  RandomTier tier = RandomTier::Exact;
  verify::ExpressionTree tree;
  std::vector<Octree> sets;
  std::string told;

  const Octree& set(std::string_view name) const { return sets[static_cast<std::size_t>(name[0] - 'a')]; }
  Expression expression() const {
    voxel::Names names;
    names.object = [this](std::string_view name) { return Expression(set(name)); };
    return voxel::parse_expression(text(tree, letter), names);
  }
  /// Whether the result is neither empty nor equal to one of the sets.
  bool has_substance() const {
    const Octree result = voxel::combine(sets.front().universe(), expression());
    return !result.is_empty() && std::find(sets.begin(), sets.end(), result) == sets.end();
  }
};

/// Sets of one size: in how many per cent of the questions they occur, the universe's depth, the side of a
/// set in voxels, and the largest number of sets in an expression.
struct SetSize {
  int per_cent, depth, side, leaves;
};
using SetSizes = std::array<SetSize, 5>;
// Large sets are rarer and fewer in an expression, because the number of triangles grows with the square of
// the side.
constexpr SetSizes sizes_in_general{
    {{40, 3, 8, 7}, {25, 4, 14, 6}, {20, 5, 24, 4}, {10, 5, 32, 3}, {5, 6, 48, 3}}};
// In sets of two voxels along a side, faces, edges and corners can already meet in every way.
constexpr SetSizes sizes_as_given{{{40, 2, 2, 4}, {30, 2, 2, 3}, {22, 2, 2, 2}, {6, 2, 3, 3}, {2, 2, 4, 2}}};

ExactQuestion exact_question(std::uint64_t seed, RandomTier tier) {
  const SetSizes& sizes = tier == RandomTier::AsGiven ? sizes_as_given : sizes_in_general;
  Random random(seed);
  int drawn = verify::random_int(random, 0, 99);
  std::size_t i = 0;
  while (drawn >= sizes[i].per_cent) drawn -= sizes[i++].per_cent;
  voxel::Universe universe;
  universe.depth = sizes[i].depth;
  ExactQuestion question;
  question.tier = tier;
  for (int leaf = 0; leaf < std::min(sizes[i].leaves, 4); ++leaf) {
    verify::RandomSet set = verify::random_set(random, universe, sizes[i].side);
    question.told += (leaf > 0 ? ", " : "") + letter(leaf) + " = " + set.recipe;
    question.sets.push_back(std::move(set.octree));
  }
  question.tree = verify::random_tree(
      random,
      {.depth = 6, .leaves = sizes[i].leaves, .names = static_cast<int>(question.sets.size()), .xors = 1});
  question.told = text(question.tree, letter) + " at " + std::to_string(sizes[i].side) + " voxels a side, " +
                  question.told;
  return question;
}

/// The certificate of a question. It is a FAIL if a kernel refuses to answer although it must.
Certificate answer_of(const ExactQuestion& question, const std::stop_token& stop) {
  Certificate certificate;
  try {
    if (question.tier == RandomTier::AsGiven)
      certificate =
          verify::certify_sets(text(question.tree, letter),
                               [&](std::string_view name) { return question.set(name); }, {stop, {}})
              .certificate;
    else
      certificate = verify::certify_exact(verify::exact_answers(question.expression(), {stop, {}}));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (fault_of(error) == Fault::Cancelled) throw;
    certificate.tier = verify::Tier::Exact;
    certificate.verdict = verify::Verdict::Fail;
    certificate.reasons.push_back("no answer: " + message_of(error));
  }
  certificate.operation = question.told;
  return certificate;
}

/// Half of a universe, cut along `axis` at the lower face of voxel `cut`: the upper half if `upper`, else the
/// lower one.
Octree half_of(const voxel::Universe& universe, int axis, bool upper, int cut) {
  glm::dvec3 low(-1.0), high(universe.side());
  (upper ? low : high)[axis] = cut - 0.5;
  return voxel::combine(
      universe, Expression(voxel::Box{universe.lattice().lps_mm(low), universe.lattice().lps_mm(high)}));
}

/// Simplifies a question as long as the kernels still disagree: removes operators, then halves, quarters, ...
/// of the sets. Returns the simplest question found.
ExactQuestion simplified(ExactQuestion question, const std::stop_token& stop) {
  const auto fails = [&](const ExactQuestion& q) {
    return answer_of(q, stop).verdict == verify::Verdict::Fail;
  };
  bool simpler_found = true;
  while (simpler_found) {
    simpler_found = false;
    for (verify::ExpressionTree& tree : verify::simpler(question.tree)) {
      ExactQuestion simple = question;
      simple.tree = std::move(tree);
      if (!fails(simple)) continue;
      question = std::move(simple);
      simpler_found = true;
      break;
    }
  }
  const voxel::Universe universe = question.sets.front().universe();
  for (int part = universe.side() / 2; part >= 1; part /= 2)
    for (int axis = 0; axis < 3; ++axis)
      for (int cut = part; cut < universe.side(); cut += part)
        for (const bool upper : {false, true}) {
          const Octree half = half_of(universe, axis, upper, cut);
          ExactQuestion simple = question;
          for (Octree& set : simple.sets) set = voxel::combine(universe, Expression(set) & half);
          if (simple.sets != question.sets && fails(simple)) question = std::move(simple);
        }
  return question;
}

/// Writes a question as a plan. Its sets become scans of labels, on which the plan has windows.
void write_plan(const ExactQuestion& question, const std::filesystem::path& folder) {
  Json json{
      {"octotomy_plan", 1}, {"name", "disagreement"}, {"scans", Json::object()}, {"steps", Json::array()}};
  const std::string expression = text(question.tree, letter);
  for (const std::string& name : voxel::names_in(expression)) {
    const Octree& set = question.sets[static_cast<std::size_t>(name[0] - 'a')];
    voxel::write_scene(voxel::label_map(set.universe().lattice(), {&set, 1}).scene,
                       folder / (name + ".nrrd"));
    json["scans"][name] = {{"path", name + ".nrrd"}};
    json["steps"].push_back({{"id", name}, {"do", "window"}, {"scan", name}, {"low", 0.5}});
  }
  json["steps"].push_back({{"id", "result"}, {"do", "combine"}, {"expression", expression}});
  voxel::write_file(folder / "disagreement.plan.json", json_text(json, 2));
}

/// The evaluation of a random plan, or the reason why there is none.
struct PlanAnswer {
  std::optional<Evaluation> evaluation;
  std::string refusal;

  const Object* first_failure() const {
    if (evaluation)
      for (const Object& object : evaluation->objects)
        if (object.certificate && object.certificate->verdict == verify::Verdict::Fail) return &object;
    return nullptr;
  }
};

PlanAnswer answer_of(const RandomPlan& plan, const std::stop_token& stop) {
  EvaluateOptions options;
  options.stop = stop;
  PlanAnswer answer;
  try {
    answer.evaluation = evaluate(parse_plan(text(plan), {}), options);
  } catch (const std::runtime_error& error) {
    if (fault_of(error) == Fault::Cancelled) throw;
    answer.refusal = error.what();
  }
  return answer;
}

/// The simplest plan that was found for which the kernels still disagree.
RandomPlan simplified(RandomPlan plan, const std::string& failing, const std::stop_token& stop) {
  plan = up_to(plan, failing);
  bool simpler_found = true;
  while (simpler_found) {
    simpler_found = false;
    for (RandomPlan& simple : simpler(plan)) {
      const PlanAnswer answer = answer_of(simple, stop);
      const Object* object = answer.first_failure();
      if (object == nullptr) continue;
      plan = up_to(simple, object->id);
      simpler_found = true;
      break;
    }
  }
  return plan;
}

void write_plan(RandomPlan plan, const std::filesystem::path& folder) {
  for (auto& [name, scan] : plan.scans.items()) {
    const std::filesystem::path from = scan["path"].get<std::string>();
    std::filesystem::copy_file(from, folder / from.filename());
    scan["path"] = from.filename().string();
  }
  voxel::write_file(folder / "disagreement.plan.json", text(plan));
}

/// One run of the suite. Results are stored by the number of their question, so that their order does not
/// depend on threads.
class Asking {
 public:
  explicit Asking(const RandomSuiteOptions& options) : options_(options) {
    if (std::count(options.tiers.begin(), options.tiers.end(), RandomTier::Bounded) > 0)
      scans_ = write_random_scans(folder_.path());
  }

  RandomSuite run() {
    RandomSuite all;
    const auto cases = static_cast<std::size_t>(options_.count);
    constexpr std::size_t at_a_time = 4096;
    for (std::size_t first = 0; first < cases; first += at_a_time) {
      std::vector<RandomSuite> parts(std::min(at_a_time, cases - first));
      brep::run_parallel_tasks(parts.size(), [&](std::size_t i) {
        if (options_.stop.stop_requested()) throw Stopped("stopped between random questions");
        ask(options_.seed + first + i, parts[i]);
        report(++done_, cases);
      });
      for (RandomSuite& part : parts) {
        add(all.exact, part.exact);
        add(all.as_given, part.as_given);
        add(all.bounded, part.bounded);
        std::move(part.disagreements.begin(), part.disagreements.end(),
                  std::back_inserter(all.disagreements));
      }
    }
    all.worst = std::move(worst_);
    return all;
  }

 private:
  static void add(RandomAnswers& all, RandomAnswers& part) {
    const auto asked_before = static_cast<std::size_t>(all.asked);
    all.verdicts += part.verdicts;
    all.asked += part.asked;
    all.of_substance += part.of_substance;
    all.no_answer += part.no_answer;
    all.refused += part.refused;
    for (Certificate& result : part.results)
      if (asked_before < RandomAnswers::most_told || result.verdict != Verdict::Pass)
        all.results.push_back(std::move(result));
  }

  void ask(std::uint64_t seed, RandomSuite& suite) {
    for (const RandomTier tier : options_.tiers)
      if (tier == RandomTier::Bounded)
        ask_bounded(seed, suite);
      else
        ask_exact(seed, tier, suite);
  }

  void report(std::size_t done, std::size_t of) {
    if (!options_.progress) return;
    const std::lock_guard lock(reporting_);
    options_.progress("random questions, " + std::to_string(done) + " of " + std::to_string(of),
                      static_cast<double>(done) / static_cast<double>(of));
  }

  /// Stores an object if it is the worst one so far. Only one is stored, because objects are large; of equal
  /// ones, that of the smallest seed.
  void contend(std::uint64_t seed, verify::Contested&& found) {
    const std::lock_guard lock(keeping_);
    if (worst_ && (verify::is_worse(worst_->certificate, found.certificate) ||
                   (!verify::is_worse(found.certificate, worst_->certificate) && seed > worst_seed_)))
      return;
    worst_ = std::move(found);
    worst_seed_ = seed;
  }

  void ask_exact(std::uint64_t seed, RandomTier tier, RandomSuite& suite) {
    ExactQuestion question = exact_question(seed, tier);
    const Certificate certificate = answer_of(question, options_.stop);
    RandomAnswers& answers = tier == RandomTier::AsGiven ? suite.as_given : suite.exact;
    answers.asked = 1;
    answers.of_substance = question.has_substance();
    answers.no_answer = certificate.verdict == Verdict::Warn;
    if (answers.no_answer == 0) planner::add(answers.verdicts, certificate);
    answers.results.push_back(certificate);
    if (certificate.verdict != Verdict::Fail) return;
    question = simplified(std::move(question), options_.stop);
    write(name_of(tier), seed, text(question.tree, letter), answer_of(question, options_.stop).reasons, suite,
          [&](const std::filesystem::path& folder) { write_plan(question, folder); });
  }

  void ask_bounded(std::uint64_t seed, RandomSuite& suite) {
    Random random(seed);
    RandomPlan plan = random_plan(random, scans_);
    const PlanAnswer answer = answer_of(plan, options_.stop);
    suite.bounded.asked = 1;
    if (!answer.evaluation) {
      suite.bounded.refused = 1;
      return;
    }
    const Objects& objects = answer.evaluation->objects;
    const Object& result = objects.back();
    const bool resolved = !result.certificate || result.certificate->resolved();
    suite.bounded.of_substance = resolved && !result.voxel.octree.is_empty() &&
                                 std::none_of(objects.begin(), objects.end() - 1, [&](const Object& object) {
                                   return object.voxel.octree == result.voxel.octree;
                                 });
    suite.bounded.no_answer = !result.mesh.within;
    std::optional<verify::Contested> worst;
    for (const Object& object : objects) {
      if (!object.certificate) continue;
      planner::add(suite.bounded.verdicts, *object.certificate);
      verify::keep_worse(worst, {*object.certificate, object.voxel.octree, object.mesh.within});
    }
    if (worst) contend(seed, std::move(*worst));
    if (result.certificate) suite.bounded.results.push_back(*result.certificate);
    const Object* failure = answer.first_failure();
    if (failure == nullptr) return;
    plan = simplified(std::move(plan), failure->id, options_.stop);
    const PlanAnswer last = answer_of(plan, options_.stop);
    write(name_of(RandomTier::Bounded), seed, last.evaluation->objects.back().definition,
          last.evaluation->objects.back().certificate->reasons, suite,
          [&](const std::filesystem::path& folder) { write_plan(plan, folder); });
  }

  template <typename Write>
  void write(const std::string& tier, std::uint64_t seed, const std::string& question,
             const std::vector<std::string>& reasons, RandomSuite& suite, const Write& into) {
    std::filesystem::create_directories(options_.failures);
    const std::filesystem::path path = options_.failures / (tier + "_" + std::to_string(seed));
    std::filesystem::remove_all(path);
    std::filesystem::create_directory(path);
    into(path);
    suite.disagreements.push_back({seed, tier, question, reasons, path / "disagreement.plan.json"});
  }

  const RandomSuiteOptions& options_;
  voxel::UnfinishedFolder folder_{cleared_temporary_folder(), scans_prefix};
  std::vector<RandomScan> scans_;
  std::atomic<std::size_t> done_ = 0;
  std::mutex reporting_, keeping_;
  std::optional<verify::Contested> worst_;
  std::uint64_t worst_seed_ = 0;
};

}  // namespace

double RandomSuite::substance() const {
  int asked = 0, of_substance = 0;
  for (const RandomAnswers* answers : {&exact, &as_given, &bounded}) {
    asked += answers->asked;
    of_substance += answers->of_substance;
  }
  return asked == 0 ? 0.0 : static_cast<double>(of_substance) / asked;
}

const char* name_of(RandomTier tier) {
  return tier == RandomTier::Exact ? "exact" : tier == RandomTier::AsGiven ? "as_given" : "bounded";
}

RandomSuite ask_random(const RandomSuiteOptions& options) {
  return Asking(options).run();
}

}  // namespace octotomy::planner
