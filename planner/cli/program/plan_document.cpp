// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/control_character.h"
#include "planner/plan/difference.h"
#include "planner/plan/history.h"
#include "planner/plan/merge.h"
#include "planner/plan/rebase.h"
#include "planner/plan/signature.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct Paths {
  fs::path base, a, b, out;
};

void add_plan(CLI::App& verb, const std::string& name, fs::path& path, const std::string& says) {
  verb.add_option(name, path, says)->required()->check(CLI::ExistingFile);
}

int diff(const Program& program, const Paths& paths) {
  const PlanDifference found = difference(read_plan(paths.a), read_plan(paths.b));
  Json json = answer({});
  json["a"] = paths.a.string();
  json["b"] = paths.b.string();
  json.update(to_json(found));
  program.say(json, text_of(found));
  return done;
}

int merge_plans(const Program& program, const Paths& paths) {
  need_extension(paths.out, {".json"}, "a plan is");
  need_unread(paths.out, {paths.base, paths.a, paths.b});
  need_folder_of(paths.out);
  const auto read = [folder = fs::absolute(paths.out).parent_path()](const fs::path& path) {
    return rebased(read_plan(path), folder);
  };
  const Merged merged = merge(read(paths.base), read(paths.a), read(paths.b));
  Json json = answer({});
  json["path"] = merged.conflicts.empty() ? Json(paths.out.string()) : Json(nullptr);
  json["conflicts"] = Json::array();
  std::string conflicts;
  for (const MergeConflict& conflict : merged.conflicts) {
    json["conflicts"].push_back({{"step", conflict.step.empty() ? Json(nullptr) : Json(conflict.step)},
                                 {"field", conflict.field.empty() ? Json(nullptr) : Json(conflict.field)},
                                 {"base", conflict.base},
                                 {"a", conflict.a},
                                 {"b", conflict.b}});
    conflicts += (conflicts.empty() ? "" : "; ") + conflict.text();
  }
  if (!merged.conflicts.empty()) {
    if (program.json) program.say(json, "");
    warn("nothing was written, because both plans changed the same values: " + conflicts +
         "; change one plan to the other's values and merge again");
    return bad_input;
  }
  voxel::write_whole(paths.out, merged.text);
  const PlanDifference from_base = difference(read(paths.base), read_plan(paths.out));
  json["changes"] = to_json(from_base);
  program.say(json, "written: " + paths.out.string() + "\n" + text_of(from_base));
  return done;
}

struct HistoryText {
  fs::path plan;
  bool undo = false, redo = false;
  std::string go_to, branch, name;
  int most = 20;
};

void show_history(const Program& program, PlanHistory& history, const HistoryText& text) {
  Json json = answer({});
  json["path"] = PlanHistory::path_of(text.plan).string();
  json["current"] = history.current();
  json["branch"] = history.branch();
  json["count"] = history.edit_count();
  json["branches"] = Json::array();
  for (const auto& [name, tip] : history.branches())
    json["branches"].push_back({{"name", name}, {"tip", tip}});
  json["edits"] = Json::array();
  std::string shown =
      "branch " + history.branch() + ", " + std::to_string(history.edit_count()) + " states\n";
  for (const PlanEdit& edit : history.newest(text.most)) {
    json["edits"].push_back({{"id", edit.id},
                             {"parent", edit.parent ? Json(*edit.parent) : Json(nullptr)},
                             {"what", edit.what},
                             {"made_at", edit.made_at},
                             {"names", edit.names}});
    shown += (edit.id == history.current() ? "> " : "  ") + std::to_string(edit.id) + "  " +
             line_of(edit.made_at + "  " + edit.what);
    for (const std::string& name : edit.names) shown += "  [" + name + "]";
    shown += "\n";
  }
  program.say(json, shown);
}

int history_of(const Program& program, const HistoryText& text) {
  if (int{text.undo} + int{text.redo} + int{!text.go_to.empty()} > 1)
    throw std::runtime_error(
        "--undo, --redo and --go-to each choose a state: give only one of these options");
  const Plan plan = read_plan(text.plan);
  // Listing states does not write to the folder.
  const bool only_lists = !text.undo && !text.redo && text.go_to.empty() && text.branch.empty() &&
                          text.name.empty() && !PlanHistory::can_write(text.plan);
  PlanHistory history(text.plan, only_lists ? PlanHistory::Access::Read : PlanHistory::Access::Write);
  if (only_lists && history.text() != plan.text)
    warn(text.plan.string() + ": was changed after state " + std::to_string(history.current()) +
         ", and its history cannot be written to record that: copy both to a folder of yours");
  if (text.undo && !history.undo())
    throw std::runtime_error("this is the first state: there is nothing to undo");
  if (text.redo && !history.redo())
    throw std::runtime_error("no state was undone on branch '" + history.branch() + "'");
  if (!text.go_to.empty()) history.go_to(text.go_to);
  if (!text.branch.empty()) history.begin_branch(text.branch);
  if (!text.name.empty()) history.name_version(text.name);
  show_history(program, history, text);
  return done;
}

void add_history(Program& program) {
  const auto text = std::make_shared<HistoryText>();
  CLI::App& verb = program.verb(
      "plan history",
      "Lists the states of a plan; each call records changes made in an editor and can switch to another "
      "state",
      "octotomy plan history my.plan.json --name approved\n  octotomy plan history my.plan.json --undo",
      [&program, text] { return history_of(program, *text); });
  add_plan(verb, "plan", text->plan, "A .plan.json; its history is the file beside it that ends in .history");
  verb.add_flag("--undo", text->undo, "Make the previous state current, also in the plan's file");
  verb.add_flag("--redo", text->redo, "Make the state that was undone current again");
  verb.add_option("--go-to", text->go_to, "Make a state current: its number, a version or a branch")
      ->type_name("STATE");
  verb.add_option("--branch", text->branch, "Begin a branch here")->type_name("NAME");
  verb.add_option("--name", text->name, "Name the current state")->type_name("NAME");
  verb.add_option("--most", text->most, "Number of states to list, newest first; default 20")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
}

struct SignText {
  fs::path plan;
  std::string by, as = "reader", note;
};

int sign_plan(const Program& program, const SignText& text) {
  need_no_control(text.by, "--by");
  need_no_control(text.as, "--as");
  need_no_control(text.note, "--note");
  const Plan plan = read_plan(text.plan);
  std::string signed_text = plan.text;
  if (!text.by.empty()) {
    signed_text = with_signature(plan.text, sign(plan, text.by, text.as, text.note));
    if (fs::exists(PlanHistory::path_of(text.plan)))
      PlanHistory(text.plan).record(signed_text, "signed by " + text.by);
    else
      voxel::write_whole(text.plan, signed_text);
  }
  const std::map<std::string, std::string> sums = sums_of_scans(plan);
  Json json = answer({});
  json["path"] = text.plan.string();
  json["signatures"] = Json::array();
  std::string shown;
  for (const Signature& signature : signatures_of(signed_text)) {
    const std::vector<std::string> changed = changed_since(signature, signed_text, sums);
    json["signatures"].push_back(to_json(signature));
    json["signatures"].back()["changed_since"] = changed;
    std::string line = signature.at + "  " + signature.by + ", " + signature.as + ": ";
    for (const std::string& part : changed)
      line += part + (&part == &changed.back() ? " changed since" : ", ");
    line += (changed.empty() ? "holds" : "") + (signature.note.empty() ? "" : " (" + signature.note + ")");
    shown += line_of(line) + "\n";
  }
  program.say(json, shown.empty() ? "nobody has signed it; --by NAME signs\n" : shown);
  return done;
}

void add_sign(Program& program) {
  const auto text = std::make_shared<SignText>();
  CLI::App& verb = program.verb(
      "plan sign", "Signs the current plan and scans; without --by, lists which signatures are valid",
      "octotomy plan sign my.plan.json --by \"A. Reader\" --as \"second reader\"",
      [&program, text] { return sign_plan(program, *text); });
  add_plan(verb, "plan", text->plan, "A .plan.json");
  verb.add_option("--by", text->by, "Who signs")->type_name("NAME");
  verb.add_option("--as", text->as, "Role of the reader; default: reader")->type_name("ROLE");
  verb.add_option("--note", text->note, "What the reader adds")->type_name("TEXT");
}

}  // namespace

void add_plan_document(Program& program) {
  program.app.add_subcommand("plan", "Compares, merges and signs plans and records their history")
      ->require_subcommand(1)
      ->footer("Example:\n  octotomy plan diff before.plan.json after.plan.json");
  const auto paths = std::make_shared<Paths>();
  CLI::App& compared =
      program.verb("plan diff", "Lists the differences between two plans, step by step and field by field",
                   "octotomy plan diff before.plan.json after.plan.json",
                   [&program, paths] { return diff(program, *paths); });
  add_plan(compared, "a", paths->a, "A .plan.json");
  add_plan(compared, "b", paths->b, "Another .plan.json");
  CLI::App& merged = program.verb(
      "plan merge",
      "Merges the changes of two plans to a common original; lists conflicts, with exit status 2",
      "octotomy plan merge base.plan.json mine.plan.json theirs.plan.json -o merged.plan.json",
      [&program, paths] { return merge_plans(program, *paths); });
  add_plan(merged, "base", paths->base, "The common original .plan.json");
  add_plan(merged, "a", paths->a, "A .plan.json changed from the original");
  add_plan(merged, "b", paths->b, "Another .plan.json changed from the original");
  merged
      .add_option("-o,--out", paths->out,
                  "The merged .plan.json; relative paths in it name the same files from its folder")
      ->required();
  add_history(program);
  add_sign(program);
}

}  // namespace octotomy::planner::cli
