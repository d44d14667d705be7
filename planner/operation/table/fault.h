// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

// Kinds of errors for users. They do not depend on the kernel, library or room from which an error comes.
namespace octotomy::planner {

enum class Fault {
  Input,      ///< data, text or a value from outside the program is wrong
  Geometry,   ///< the data are valid, but the operation has no answer for them
  Cancelled,  ///< the work was stopped
  Resource,   ///< memory, disk space or time was exhausted, or a child process failed
  Internal,   ///< a mistake in the program, which users cannot correct
};

/// Thrown for a mistake in the program. Its text names the place.
struct InternalError : std::logic_error {
  using std::logic_error::logic_error;
};

/// The kind of an error. Errors of the kernels are classified by their codes, and failed system calls by
/// their numbers; std::bad_alloc is Resource. std::runtime_error, with which the planner refuses, and the
/// kernels' InvalidInput and TooLarge are Input. Everything else is Internal: std::logic_error and any plain
/// kind of it, such as std::invalid_argument of a broken precondition and std::out_of_range of map::at();
/// std::bad_cast; errors of JSON access in the program.
Fault fault_of(const std::exception& error);

/// The name of a kind: "input", "geometry", "cancelled", "resource" or "internal".
std::string to_string(Fault fault);
/// The kind with this name; none for other words.
std::optional<Fault> fault_named(std::string_view name);

/// The error's text for users. For an Internal error, the text says so and requests a report.
std::string message_of(const std::exception& error);

/// Whether an error is due to the data or to a limit of the work, so that the caller may try another method
/// or report the reason. False for a stop, for exhausted memory and for a mistake in the program.
bool is_no_answer(const std::exception& error);

/// Throws an error of the same kind with `where` before its text. Stops and std::bad_alloc are rethrown
/// unchanged. Precondition: called in the handler of `error`.
[[noreturn]] void rethrow_at(const std::string& where, const std::exception& error);

}  // namespace octotomy::planner
