// SPDX-License-Identifier: AGPL-3.0-or-later

/// What the thread sanitizer passes over in every program: libraries as installed were built without it, and
/// it sees races in all that their own threads do; and it does not see that a mutex was taken within a time
/// (github.com/llvm/llvm-project/issues/62623), as remove_unfinished() and Desk::close_within() take it.
extern "C" const char* __tsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)
const char* __tsan_default_suppressions() {            // NOLINT(bugprone-reserved-identifier)
  return "race:libITKCommon\n"
         "race:libOpenImageIO\n"
         "race:octotomy::voxel::remove_unfinished\n"
         "mutex:octotomy::planner::serve::Desk::close_within\n";
}
