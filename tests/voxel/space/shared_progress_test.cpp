// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/shared_progress.h"

#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace octotomy::voxel {
namespace {

TEST(PartOfProgress, IsScaledToTheWholeAndStopsWithIt) {
  std::vector<double> reported;
  std::stop_source source;
  const Progress whole{source.get_token(), [&](double fraction) { reported.push_back(fraction); }};
  const Progress part = part_of(whole, 0.5, 0.75);
  part.at(0.0);
  part.at(1.0);
  EXPECT_EQ(reported, (std::vector<double>{0.5, 0.75}));
  source.request_stop();
  EXPECT_THROW(part.at(0.0), Stopped);
}

TEST(SharedProgress, ReportsOnTheThreadThatMadeItAndStopsOnAny) {
  std::vector<double> reported;
  std::stop_source source;
  const Progress progress{source.get_token(), [&](double fraction) { reported.push_back(fraction); }};
  SharedProgress shared(progress, 4);
  std::thread([&] { shared.one_more(); }).join();
  EXPECT_TRUE(reported.empty());
  shared.one_more();
  EXPECT_EQ(reported, std::vector<double>{0.5});
  source.request_stop();
  bool stopped = false;
  std::thread([&] {
    try {
      shared.one_more();
    } catch (const Stopped&) {
      stopped = true;
    }
  }).join();
  EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace octotomy::voxel
