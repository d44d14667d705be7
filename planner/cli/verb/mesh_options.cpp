// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/mesh_options.h"

#include <CLI/CLI.hpp>

#include "planner/operation/file/mesh_in.h"

namespace octotomy::planner::cli {
namespace {

std::vector<std::string> words_of(const CLI::App& verb, const char* name) {
  const CLI::Option* option = verb.get_option_no_throw(name);
  return option == nullptr ? std::vector<std::string>{} : option->results();
}

}  // namespace

void add_mesh_options(CLI::App& verb) {
  const auto add = [&](const char* name, const char* says) {
    if (verb.get_option_no_throw(name) != nullptr) return;
    // CLI11 stores the words in the option, so the function has nothing to do.
    verb.add_option_function<std::vector<std::string>>(
            name, [](const std::vector<std::string>&) {}, says)
        ->expected(1)
        ->take_all()
        ->group("mesh");
  };
  add("--frame",
      "Directions of x, y and z in mesh files, overriding the files' own statements: LPS, RAS, or three "
      "other letters, one each of L or R, A or P, S or I; for a single file FILE=RAS");
  add("--unit",
      "Unit of mesh files, overriding their own statements: um, mm, cm, m, inch or foot; for one file as "
      "FILE=inch");
}

void choose_mesh_options(const CLI::App& verb) {
  choose_mesh_reading(words_of(verb, "--frame"), words_of(verb, "--unit"));
}

}  // namespace octotomy::planner::cli
