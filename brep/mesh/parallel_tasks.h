// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <vector>

namespace octotomy::brep {

/// Calls task(i) for each i below `count`, in parallel. All tasks run to their ends; then the exception of the first
/// task that threw, in the order of numbers, is thrown. An exception that leaves a plain TBB loop cancels the loops
/// within its other tasks, and those tasks continue with results that are only half computed. A thread that waits
/// within a task begins no other task, so at any time the data of a thread belong to one task.
template <typename Task>
void run_parallel_tasks(std::size_t count, const Task& task) {
  std::vector<std::exception_ptr> failed(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      try {
        task(i);
      } catch (...) {
        failed[i] = std::current_exception();
      }
    });
  });
  for (const std::exception_ptr& failure : failed)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace octotomy::brep
