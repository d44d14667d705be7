// SPDX-License-Identifier: AGPL-3.0-or-later

/// The false alarms that the thread sanitizer leaves out in every program. Installed libraries were built
/// without it, so that it reports races between their threads. It also misses that try_lock_for() locks a
/// mutex (github.com/llvm/llvm-project/issues/62623): remove_unfinished() and Session::close_within() call it.
extern "C" const char* __tsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)
const char* __tsan_default_suppressions() {            // NOLINT(bugprone-reserved-identifier)
  return "race:libITKCommon\n"
         "race:libOpenImageIO\n"
         "race:octotomy::voxel::remove_unfinished\n"
         "mutex:octotomy::planner::serve::Session::close_within\n";
}
