// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>

// The line at the bottom of a terminal that says what is being done. Of the process, on standard error; any
// thread may call. Callers look whether that is a terminal.

namespace octotomy::planner::cli {

using Seconds = std::chrono::duration<double>;

/// How long the rest takes if it goes on as the share done in a time: "about 40 s left". Empty before two
/// seconds or a fiftieth of the work, which tell nothing.
std::string left_text(double done, double rest, Seconds time);

/// A share of the work, 0..1, which 1 ends.
void show_progress(const std::string& doing, double fraction);

/// To be called a few times a second. Where nothing was told for a second, says what is being done and how
/// long by now: the last thing that told a share, else the stage whose Stopwatch runs.
void show_silent_work();

/// Takes the line away, before other words come.
void erase_progress();
/// The same for good: the verb has ended.
void end_progress();

}  // namespace octotomy::planner::cli
