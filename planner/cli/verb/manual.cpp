// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/manual.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

namespace octotomy::planner::cli {
namespace {

using Options = std::vector<const CLI::Option*>;
using Verbs = std::vector<const CLI::App*>;

/// The options of a verb that its help shows.
Options shown_options(const CLI::App& app) {
  Options options = app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
  return options;
}

Verbs shown_verbs(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// The names of an option, such as "-o" and "--out"; none for a positional.
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// Escapes text for a man page: backslashes, minus signs, and a dot or quote that begins a line.
std::string troff(const std::string& text) {
  std::string safe = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  safe = replaced(safe, "\n.", "\n\\&.");
  return safe.starts_with('.') || safe.starts_with('\'') ? "\\&" + safe : safe;
}

std::string troff_options(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : shown_options(app)) {
    std::string names;
    for (const std::string& name : names_of(*option)) names += (names.empty() ? "" : ", ") + name;
    if (names.empty()) names = option->get_name();
    text += ".TP\n.B " + troff(names);
    if (takes_value(*option) && !option->get_type_name().empty())
      text += " \\fI" + troff(option->get_type_name()) + "\\fR";
    text += "\n" + troff(option->get_description()) + "\n";
  }
  return text;
}

/// The footer of a verb, such as its examples, as lines that the man page does not fill.
std::string troff_footer(const CLI::App& app) {
  return app.get_footer().empty() ? "" : ".PP\n.nf\n" + troff(app.get_footer()) + "\n.fi\n";
}

/// The section of a verb; for a group, the sections of all its verbs.
std::string troff_verb(const CLI::App& verb, const std::string& name) {
  if (verb.get_subcommands([](const CLI::App*) { return true; }).empty())
    return ".SS " + troff(name) + "\n" + troff(verb.get_description()) + "\n" + troff_options(verb) +
           troff_footer(verb);
  std::string text;
  for (const CLI::App* within : shown_verbs(verb))
    text += troff_verb(*within, name + " " + within->get_name());
  return text;
}

std::string man_page(const CLI::App& app) {
  std::string text =
      ".TH OCTOTOMY 1 \"\" \"Octotomy " OCTOTOMY_VERSION
      "\" \"User Commands\"\n.SH NAME\noctotomy \\- plan an operation on a skull in two geometry "
      "kernels that check each other\n.SH SYNOPSIS\n.B octotomy\n\\fIVERB\\fR [\\fIOPTION\\fR]...\n"
      ".SH DESCRIPTION\n";
  text += troff(app.get_description()) + "\n" + troff_options(app) + ".SH VERBS\n";
  for (const CLI::App* verb : shown_verbs(app)) text += troff_verb(*verb, verb->get_name());
  return text + ".SH EXAMPLES\n" + troff_footer(app);
}

/// The words that may follow a verb, separated by spaces: its options and, for a group, its verbs.
std::string joined_names(const CLI::App& app, const Options& options) {
  std::string text;
  for (const CLI::App* verb : app.get_parent() == nullptr ? Verbs() : shown_verbs(app))
    text += (text.empty() ? "" : " ") + verb->get_name();
  for (const CLI::Option* option : options)
    for (const std::string& name : names_of(*option)) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::string bash_completion(const CLI::App& app) {
  std::string verbs;
  std::string cases;
  for (const CLI::App* verb : shown_verbs(app)) {
    verbs += (verbs.empty() ? "" : " ") + verb->get_name();
    cases += "    " + verb->get_name() + ") words='" + joined_names(*verb, shown_options(*verb)) + "' ;;\n";
  }
  return "# bash completion for octotomy\n_octotomy() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} words\n"
         "  COMPREPLY=()\n"
         "  if [ \"$COMP_CWORD\" -gt 1 ] && [[ $word != -* ]]; then return; fi\n"
         "  case ${COMP_WORDS[1]} in\n" +
         cases + "    *) words='" + verbs + " " + joined_names(app, shown_options(app)) +
         "' ;;\n  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\ncomplete -o default -F _octotomy octotomy\n";
}

/// Escapes text for a zsh word in single quotes with a description in brackets.
std::string zsh(const std::string& text) {
  std::string safe = replaced(text, "'", "'\\''");
  for (const char* mark : {"[", "]", ":"}) safe = replaced(safe, mark, std::string("\\") + mark);
  return replaced(safe, "\n", " ");
}

std::string zsh_completion(const CLI::App& app) {
  std::string verbs;
  std::string cases;
  for (const CLI::App* verb : shown_verbs(app)) {
    verbs += "    '" + verb->get_name() + ":" + zsh(verb->get_description()) + "'\n";
    cases += "  " + verb->get_name() + ")\n    _arguments";
    for (const CLI::Option* option : shown_options(*verb))
      for (const std::string& name : names_of(*option))
        cases += " \\\n      '*" + name + "[" + zsh(option->get_description()) + "]" +
                 (takes_value(*option) ? ":" + zsh(option->get_type_name()) + ":_files'" : "'");
    cases += " \\\n      '*:file:_files' ;;\n";
  }
  return "#compdef octotomy\nlocal -a verbs\nif (( CURRENT == 2 )); then\n  verbs=(\n" + verbs +
         "  )\n  _describe verb verbs\n  return\nfi\nlocal verb=$words[2]\nshift words\n(( CURRENT-- ))\n"
         "case $verb in\n" +
         cases + "esac\n";
}

}  // namespace

std::string manual(const CLI::App& app, const std::string& kind) {
  if (kind == "man") return man_page(app);
  if (kind == "bash") return bash_completion(app);
  if (kind == "zsh") return zsh_completion(app);
  throw CLI::ValidationError("--manual", "'" + kind + "' is not man, bash or zsh");
}

void add_manual(CLI::App& app) {
  app.add_option_function<std::string>("--manual",
                                       [&app](const std::string& kind) {
                                         std::fputs(manual(app, kind).c_str(), stdout);
                                         throw CLI::Success();
                                       })
      ->trigger_on_parse()
      ->group("");
}

}  // namespace octotomy::planner::cli
