// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace octotomy::brep {

/// The kind of an error. Exit statuses depend on it, never on a message.
enum class ErrorCode {
  Input,      ///< a file or number from outside is wrong
  Geometry,   ///< the data are sound, but the operation has no answer on them
  Cancelled,  ///< a stop was requested
  Resource,   ///< memory, disk or time was exhausted
};

/// The mesh kernel's error: a code and a message that names the place, the cause and the next step.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// A stop was requested, so no result was computed. This does not mean that the operation has no result.
struct Stopped : Error {
  explicit Stopped(const std::string& message) : Error(ErrorCode::Cancelled, message) {}
};

/// Refuses a value or data that may come from outside the program. The message states the fault and, if it
/// helps, the remedy. A precondition that only the caller can break throws a plain std::invalid_argument.
struct InvalidInput : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Refuses a size that may come from outside the program, because the result would be too large.
struct TooLarge : std::length_error {
  using std::length_error::length_error;
};

}  // namespace octotomy::brep
