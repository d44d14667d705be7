// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/error.h"

#include <cerrno>
#include <gtest/gtest.h>

#include "voxel/space/progress.h"

namespace octotomy::voxel {
namespace {

TEST(Error, OfASystemCallIsOfResourcesOnlyWhereDiskOrMemoryGaveOut) {
  EXPECT_EQ(code_of_errno(ENOSPC), ErrorCode::Resource);
  EXPECT_EQ(code_of_errno(EFBIG), ErrorCode::Resource);
  EXPECT_EQ(code_of_errno(ENOMEM), ErrorCode::Resource);
  EXPECT_EQ(code_of_errno(ENOENT), ErrorCode::Input);
  EXPECT_EQ(code_of_errno(EACCES), ErrorCode::Input);
}

TEST(Progress, ThatIsStoppedThrowsAnErrorOfCancellationAndReportsNothing) {
  std::stop_source stop;
  double reported = -1.0;
  const Progress progress{stop.get_token(), [&](double fraction) { reported = fraction; }};
  progress.at(0.5);
  EXPECT_EQ(reported, 0.5);
  stop.request_stop();
  try {
    progress.at(0.75);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
  EXPECT_EQ(reported, 0.5);
}

}  // namespace
}  // namespace octotomy::voxel
