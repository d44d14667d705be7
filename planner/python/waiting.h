// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <future>
#include <pybind11/pybind11.h>
#include <stop_token>
#include <thread>
#include <utility>

namespace octotomy::planner::python {

/// Runs work(stop) on another thread, while other threads of Python can run, and returns its answer. Ctrl-C
/// requests the work to stop, waits for its end and raises KeyboardInterrupt. Precondition: the caller holds
/// the interpreter's lock, and the work uses no Python object.
template <typename Work>
auto without_lock(const Work& work) {
  std::packaged_task<decltype(work(std::stop_token{}))(std::stop_token)> task(work);
  auto answer = task.get_future();
  bool interrupted = false;
  {
    const pybind11::gil_scoped_release released;
    std::jthread worker([&task](const std::stop_token& stop) { task(stop); });
    while (!interrupted && answer.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      const pybind11::gil_scoped_acquire held;
      interrupted = PyErr_CheckSignals() != 0;
    }
    if (interrupted) worker.request_stop();
    worker.join();
  }
  if (interrupted) throw pybind11::error_already_set();
  return answer.get();
}

}  // namespace octotomy::planner::python
