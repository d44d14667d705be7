// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

// Kinds of errors as reported to users, independent of the kernel, library or room they come from.
namespace octotomy::planner {

enum class Fault {
  Input,      ///< data, text or a value from outside is wrong
  Geometry,   ///< the data are sound, but the operation has no answer on them
  Cancelled,  ///< the work was stopped
  Resource,   ///< memory, disk space or time was exhausted, or a child process failed
  Internal,   ///< a mistake in the program, which users cannot correct
};

/// A mistake in the program. Its text names the place.
struct InternalError : std::logic_error {
  using std::logic_error::logic_error;
};

/// The kernels' errors by their codes, failed system calls by their numbers, and std::bad_alloc as Resource.
/// The planner refuses by std::runtime_error, a kernel by its InvalidInput or TooLarge: these are Input.
/// Everything else is Internal: std::logic_error and any plain kind of it, such as std::invalid_argument of a
/// broken precondition and std::out_of_range of map::at(); std::bad_cast; errors of JSON access in the program.
Fault fault_of(const std::exception& error);

/// "input", "geometry", "cancelled", "resource" or "internal".
std::string to_string(Fault fault);
/// The inverse of to_string(); none for other words.
std::optional<Fault> fault_named(std::string_view name);

/// The error's text for users. An Internal error is called internal, with a request to report it.
std::string message_of(const std::exception& error);

/// Whether the cause is the data or a limit on the work, so that the caller may try another method or report
/// the reason. False for a stop, for exhausted memory and for a mistake in the program.
bool is_no_answer(const std::exception& error);

/// Throws an error of the same kind whose text begins with `where`. Stops and std::bad_alloc are rethrown
/// unchanged. Precondition: called in the handler of `error`.
[[noreturn]] void rethrow_at(const std::string& where, const std::exception& error);

}  // namespace octotomy::planner
