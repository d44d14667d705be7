// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

// The progress line of the process, on standard error. Any thread may call. Callers must check that standard
// error is a terminal.

namespace octotomy::planner::cli {

using Seconds = std::chrono::duration<double>;

/// The remaining time, extrapolated from the fraction done: "about 40 s left". Empty before two seconds and a
/// fiftieth of the work, when the estimate would be unreliable.
std::string left_text(double done, double rest, Seconds time);

/// Shows the fraction of a task that is done, 0..1; 1 ends the task.
void show_progress(const std::string& doing, double fraction);

/// To be called a few times a second. If no progress was reported for a second, shows the current task and
/// its elapsed time: the last task that reported progress, else the stage of the running Stopwatch.
void show_silent_work();

/// Erases the line before other output.
void erase_progress();
/// Erases the line permanently, because the verb has ended.
void end_progress();

}  // namespace octotomy::planner::cli
