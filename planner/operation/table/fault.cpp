// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/fault.h"

#include <new>
#include <system_error>

#include "brep/mesh/error.h"
#include "voxel/space/error.h"
#include "voxel/space/write_failure.h"

namespace octotomy::planner {
namespace {

template <typename Kind>
const Kind* as(const std::exception& error) {
  return dynamic_cast<const Kind*>(&error);
}

/// The error codes of both kernels are equal and have the same order, and Fault begins with them.
template <typename Code>
Fault fault_of_code(Code code) {
  static_assert(static_cast<int>(Code::Resource) == static_cast<int>(Fault::Resource));
  return static_cast<Fault>(code);
}

}  // namespace

Fault fault_of(const std::exception& error) {
  if (const auto* of_voxels = as<voxel::Error>(error)) return fault_of_code(of_voxels->code());
  if (const auto* of_meshes = as<brep::Error>(error)) return fault_of_code(of_meshes->code());
  if (as<std::bad_alloc>(error) != nullptr) return Fault::Resource;
  if (const auto* of_system = as<std::system_error>(error))
    return fault_of_code(voxel::code_of_errno(of_system->code().value()));
  const bool is_refusal = as<std::runtime_error>(error) != nullptr ||
                          as<voxel::InvalidInput>(error) != nullptr ||
                          as<brep::InvalidInput>(error) != nullptr || as<voxel::TooLarge>(error) != nullptr ||
                          as<brep::TooLarge>(error) != nullptr;
  return is_refusal ? Fault::Input : Fault::Internal;
}

std::string to_string(Fault fault) {
  switch (fault) {
    case Fault::Input:
      return "input";
    case Fault::Geometry:
      return "geometry";
    case Fault::Cancelled:
      return "cancelled";
    case Fault::Resource:
      return "resource";
    case Fault::Internal:
      break;
  }
  return "internal";
}

std::optional<Fault> fault_named(std::string_view name) {
  for (const Fault fault :
       {Fault::Input, Fault::Geometry, Fault::Cancelled, Fault::Resource, Fault::Internal})
    if (to_string(fault) == name) return fault;
  return std::nullopt;
}

std::string message_of(const std::exception& error) {
  if (const auto* of_system = as<std::system_error>(error))
    return error.what() + voxel::way_out_of(of_system->code().value());
  if (as<std::bad_alloc>(error) != nullptr) return "out of memory: use larger voxels or a smaller scan";
  if (fault_of(error) != Fault::Internal) return error.what();
  return "this is a mistake in the program, not in its use: " + std::string(error.what()) +
         "; please report it";
}

bool is_no_answer(const std::exception& error) {
  const Fault fault = fault_of(error);
  return fault != Fault::Cancelled && fault != Fault::Internal && as<std::bad_alloc>(error) == nullptr;
}

void rethrow_at(const std::string& where, const std::exception& error) {
  const Fault fault = fault_of(error);
  if (fault == Fault::Cancelled || as<std::bad_alloc>(error) != nullptr) throw;
  if (fault == Fault::Internal) throw InternalError(where + error.what());
  const std::string named = where + message_of(error);
  if (as<brep::Error>(error) != nullptr) throw brep::Error(static_cast<brep::ErrorCode>(fault), named);
  if (as<voxel::Error>(error) != nullptr || fault != Fault::Input)
    throw voxel::Error(static_cast<voxel::ErrorCode>(fault), named);
  throw std::runtime_error(named);
}

}  // namespace octotomy::planner
