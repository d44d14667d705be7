// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/beside.h"

#include <deque>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <utility>

namespace octotomy::planner {

struct Beside::Pieces {
  explicit Pieces(const std::stop_token& asked) : with(asked, [this] { stop.request_stop(); }) {}

  std::stop_source stop;
  std::stop_callback<std::function<void()>> with;
  std::deque<tbb::task_group> groups;  ///< one per task, so that each can be awaited separately
};

Beside::Beside(const std::stop_token& stop) : pieces_(std::make_unique<Pieces>(stop)) {}

Beside::~Beside() {
  pieces_->stop.request_stop();
  // No group is cancelled: TBB would skip parts of loops within a task, and the task would continue with
  // incomplete results.
  for (tbb::task_group& group : pieces_->groups) {
    try {
      group.wait();
    } catch (...) {
      // Ignores the exception, because nobody waits for the task any more.
    }
  }
}

void Beside::begin(std::function<void(const std::stop_token&)> piece) {
  pieces_->groups.emplace_back().run([piece = std::move(piece), stop = pieces_->stop.get_token()] {
    // Isolated, so that a thread that waits within a task starts no other task, which would have to end
    // first.
    tbb::this_task_arena::isolate([&] { piece(stop); });
  });
}

void Beside::wait(std::size_t piece) {
  pieces_->groups.at(piece).wait();
}

void Beside::apart(const std::function<void()>& work) const {
  tbb::this_task_arena::isolate([&] { work(); });
}

}  // namespace octotomy::planner
