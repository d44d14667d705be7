// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/progress_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>

#include "planner/cli/verb/verb.h"
#include "planner/operation/table/stopwatch.h"

namespace octotomy::planner::cli {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Seconds silence{1.0};

std::string whole_seconds(Seconds time) {
  return std::to_string(std::lround(time.count())) + " s";
}

class Line {
 public:
  void share(const std::string& doing, double fraction) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (doing_.empty() || fraction < fraction_) {
      start_ = now;
      start_fraction_ = fraction;
    }
    if (doing != doing_) doing_start_ = now;
    doing_ = doing;
    fraction_ = fraction;
    told_ = now;
    const std::string left = left_text(fraction - start_fraction_, 1.0 - fraction, now - start_);
    show(percent() + doing + (left.empty() ? "" : ", " + left));
    if (fraction < 1.0) return;
    erase();
    doing_.clear();
  }

  void silent_work() {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now - told_ < silence) return;
    if (!doing_.empty()) {
      show(percent() + doing_ + ", for " + whole_seconds(now - doing_start_));
    } else if (const std::optional<RunningStage> stage = newest_stage()) {
      if (now - stage->start < silence) return;
      std::string name = stage->name;
      std::replace(name.begin(), name.end(), '_', ' ');
      show("       " + name + ", for " + whole_seconds(now - stage->start));
    } else {
      erase();
    }
    told_ = now;
  }

  /// Erases the line. Works even if another thread holds the lock, because the process may end while that
  /// thread prints.
  void leave(bool for_good) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    erase();
    is_over_ = is_over_ || for_good;
  }

 private:
  std::string percent() const {
    char text[16];
    std::snprintf(text, sizeof text, "%3d %%  ", static_cast<int>(100.0 * fraction_));
    return text;
  }
  void show(const std::string& text) {
    if (is_over_) return;
    // The line is erased first, so that nothing remains of a longer text.
    std::fprintf(stderr, "\r\x1b[2K%s", line_of(text).c_str());
    std::fflush(stderr);
    is_shown_ = true;
  }
  void erase() {
    if (!is_shown_) return;
    std::fputs("\r\x1b[2K", stderr);
    std::fflush(stderr);
    is_shown_ = false;
  }

  std::mutex mutex_;
  std::string doing_;  ///< name of the current task; empty if no task has reported progress
  double fraction_ = 0.0, start_fraction_ = 0.0;
  /// When the current task's fraction began to grow, when the task began, and when progress was last
  /// reported.
  Clock::time_point start_, doing_start_, told_ = Clock::now();
  bool is_shown_ = false, is_over_ = false;
};

/// The line is never destroyed, because a thread may report progress while the process ends.
Line& line() {
  static auto& only = *new Line;
  return only;
}

}  // namespace

std::string left_text(double done, double rest, Seconds time) {
  constexpr Seconds least_time{2.0};
  constexpr double least_done = 0.02;
  if (time < least_time || done < least_done || rest <= 0.0) return {};
  const Seconds left = time * (rest / done);
  constexpr Seconds long_time{120.0};
  return "about " +
         (left < long_time ? whole_seconds(left)
                           : std::to_string(std::lround(left.count() / 60.0)) + " min") +
         " left";
}

void show_progress(const std::string& doing, double fraction) {
  line().share(doing, fraction);
}

void show_silent_work() {
  line().silent_work();
}

void erase_progress() {
  line().leave(false);
}

void end_progress() {
  line().leave(true);
}

}  // namespace octotomy::planner::cli
