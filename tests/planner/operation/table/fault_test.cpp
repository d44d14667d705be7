// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/fault.h"

#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <vector>

#include "brep/mesh/error.h"
#include "planner/plan/step_errors.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

struct Case {
  std::string name;
  std::function<void()> fail;
  Fault fault;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"voxel input", [] { throw voxel::Error(voxel::ErrorCode::Input, "x"); }, Fault::Input},
      {"voxel geometry", [] { throw voxel::Error(voxel::ErrorCode::Geometry, "x"); }, Fault::Geometry},
      {"voxel stop", [] { throw voxel::Stopped("x"); }, Fault::Cancelled},
      {"voxel resource", [] { throw voxel::Error(voxel::ErrorCode::Resource, "x"); }, Fault::Resource},
      {"mesh input", [] { throw brep::Error(brep::ErrorCode::Input, "x"); }, Fault::Input},
      {"mesh geometry", [] { throw brep::Error(brep::ErrorCode::Geometry, "x"); }, Fault::Geometry},
      {"mesh stop", [] { throw brep::Stopped("x"); }, Fault::Cancelled},
      {"mesh resource", [] { throw brep::Error(brep::ErrorCode::Resource, "x"); }, Fault::Resource},
      {"full disk",
       [] { throw std::system_error(std::make_error_code(std::errc::no_space_on_device), "out.nrrd"); },
       Fault::Resource},
      {"absent file",
       [] { throw std::system_error(std::make_error_code(std::errc::no_such_file_or_directory), "in.nrrd"); },
       Fault::Input},
      {"no memory", [] { throw std::bad_alloc(); }, Fault::Resource},
      {"refusal", [] { throw std::runtime_error("x"); }, Fault::Input},
      {"refusal of the voxel kernel", [] { throw voxel::InvalidInput("x"); }, Fault::Input},
      {"refusal of the mesh kernel", [] { throw brep::InvalidInput("x"); }, Fault::Input},
      {"refused size of voxels", [] { throw voxel::TooLarge("x"); }, Fault::Input},
      {"refused size of meshes", [] { throw brep::TooLarge("x"); }, Fault::Input},
      {"broken precondition", [] { throw std::invalid_argument("x"); }, Fault::Internal},
      {"impossible length", [] { std::vector<int>().reserve(std::vector<int>().max_size() + 1); },
       Fault::Internal},
      {"absent key", [] { std::ignore = std::map<int, int>{}.at(1); }, Fault::Internal},
      {"absent place", [] { std::ignore = std::vector<int>{}.at(1); }, Fault::Internal},
      {"absent value", [] { std::ignore = std::optional<int>{}.value(); }, Fault::Internal},
      {"empty function", [] { std::function<void()>{}(); }, Fault::Internal},
      {"broken logic", [] { throw std::logic_error("x"); }, Fault::Internal},
      {"misread JSON", [] { std::ignore = nlohmann::json("text").at("key"); }, Fault::Internal}};
  return all;
}

/// The error that the work throws: its fault and its text.
std::pair<Fault, std::string> caught(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    return {fault_of(error), message_of(error)};
  }
  throw std::logic_error("the work threw nothing");
}

TEST(Fault, IsOfOneKindForEveryTypeThatRoomsThrow) {
  for (const Case& each : cases()) EXPECT_EQ(caught(each.fail).first, each.fault) << each.name;
}

TEST(Fault, IsReadBackFromItsName) {
  for (const Case& each : cases()) EXPECT_EQ(fault_named(to_string(each.fault)), each.fault) << each.name;
  EXPECT_EQ(fault_named("Internal"), std::nullopt);
}

TEST(Fault, KeepsItsKindAndNamesTheStepItIsIn) {
  for (const Case& each : cases()) {
    const auto [fault, message] = caught([&] { name_step_in_errors("cut", each.fail); });
    EXPECT_EQ(fault, each.fault) << each.name;
    const bool goes_by = each.fault == Fault::Cancelled || each.name == "no memory";
    EXPECT_EQ(message.find("step 'cut': ") == std::string::npos, goes_by) << each.name << ": " << message;
  }
}

TEST(Fault, SaysThatTheProgramIsWrongOnlyWhereItIs) {
  for (const Case& each : cases()) {
    const std::string message = caught([&] { name_step_in_errors("cut", each.fail); }).second;
    const bool blames_itself = message.find("mistake in the program") != std::string::npos &&
                               message.find("report") != std::string::npos;
    EXPECT_EQ(blames_itself, each.fault == Fault::Internal) << each.name << ": " << message;
  }
}

TEST(Fault, LeavesNoAnswerWhereAnotherWayMayBeTried) {
  for (const Case& each : cases()) try {
      each.fail();
    } catch (const std::exception& error) {
      EXPECT_EQ(is_no_answer(error),
                each.fault != Fault::Cancelled && each.fault != Fault::Internal && each.name != "no memory")
          << each.name;
    }
}

}  // namespace
}  // namespace octotomy::planner
