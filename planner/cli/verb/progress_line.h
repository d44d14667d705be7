// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

// The process's line of progress on standard error. All functions may be called from any thread. Callers
// check that standard error is a terminal.

namespace octotomy::planner::cli {

using Seconds = std::chrono::duration<double>;

/// The remaining time as text, such as "about 40 s left", extrapolated from the fraction done. Empty if two
/// seconds or a fiftieth of the work have not passed yet, because an estimate would be unreliable.
std::string left_text(double done, double rest, Seconds time);

/// Shows the fraction of a task that is done, from 0 to 1. A fraction of 1 ends the task.
void show_progress(const std::string& doing, double fraction);

/// Must be called a few times a second. If nothing has reported progress for a second, shows the current task
/// and its elapsed time. The task is the last one that reported progress, or else the stage that a Stopwatch
/// measures.
void show_silent_work();

/// Erases the line, so that other output can be printed. The next report shows it again.
void erase_progress();
/// Erases the line and prints no further progress, because the verb has ended.
void end_progress();

}  // namespace octotomy::planner::cli
