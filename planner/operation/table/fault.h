// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

// Errors as people meet them, whichever kernel, library or room they come from.
namespace octotomy::planner {

enum class Fault {
  Input,      ///< data, text or a value from outside is wrong
  Geometry,   ///< the data are sound, but the operation has no answer on them
  Cancelled,  ///< the work was stopped
  Resource,   ///< memory, disk, time or a child process gave out
  Internal,   ///< a mistake in the program, which users cannot correct
};

/// A mistake in the program. Its text names the place.
struct InternalError : std::logic_error {
  using std::logic_error::logic_error;
};

/// The kernels' errors by their codes, failed system calls by their numbers, and std::bad_alloc as Resource.
/// std::runtime_error is a refusal of the planner, std::invalid_argument one of a kernel: both are Input, as
/// is std::length_error. Everything else is Internal: std::logic_error, as of map::at(), std::bad_cast, JSON
/// that the program itself misread.
Fault fault_of(const std::exception& error);

/// "input", "geometry", "cancelled", "resource" or "internal".
std::string to_string(Fault fault);
/// The inverse of to_string(); none for other words.
std::optional<Fault> fault_named(std::string_view name);

/// The error's text for people. For an Internal error it names the fault as internal and asks to report it.
std::string message_of(const std::exception& error);

/// Whether the cause is the data or a limit on the work, so that the caller may try another method or report
/// the reason. False for a stop, for exhausted memory and for a mistake in the program.
bool is_no_answer(const std::exception& error);

/// Throws an error of the same kind whose text begins with `where`. Stops and std::bad_alloc are thrown as
/// they are. Precondition: called in the handler of `error`.
[[noreturn]] void rethrow_at(const std::string& where, const std::exception& error);

}  // namespace octotomy::planner
