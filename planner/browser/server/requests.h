// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "planner/browser/server/desk.h"
#include "planner/browser/server/message.h"

// What a page may ask of the desk, a function a word. All throw what the rooms throw that they call.
namespace octotomy::planner::serve {

/// Which of the server's threads answers: edits wait for no long work, and of some words only the newest
/// request is wanted. An evaluation that certifies has a thread of its own, so that the quick one that
/// follows an edit does not stop it.
enum class Lane { Desk, Evaluate, Certify, Overlap, Long };

struct Word {
  std::string name;
  Lane lane = Lane::Desk;
  bool changes_plan = false;  ///< the answer is the plan's state, which all windows are told
  std::function<Json(Desk& desk, const Json& said, const Watched& watched)> answer;
  bool changes_objects = false;  ///< all windows are told the plan's state
};

const std::vector<Word>& words();
/// Throws voxel::Error, Input, with the nearest word.
const Word& find_word(const std::string& name);

}  // namespace octotomy::planner::serve
