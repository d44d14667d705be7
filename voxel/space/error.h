// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cerrno>
#include <stdexcept>
#include <string>

namespace octotomy::voxel {

/// The kind of an error. Exit statuses are derived only from it, not from messages.
enum class ErrorCode {
  Input,      ///< data or text from outside is wrong
  Geometry,   ///< the data are valid, but the operation has no result for them
  Cancelled,  ///< a stop token was set
  Resource,   ///< memory, disk or time ran out, or a child process failed
};

/// The voxel kernel's error: a code and a message that names the place, the cause and the next step.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

/// Thrown by work that ended early because a stop token was set.
struct Stopped : Error {
  explicit Stopped(const std::string& message) : Error(ErrorCode::Cancelled, message) {}
};

/// Thrown for a wrong value or wrong data that may come from outside the program. The message states the
/// fault and, if it helps, the remedy. A plain std::invalid_argument, in contrast, reports a broken
/// precondition that no outside value can break, so a mistake in the calling code.
struct InvalidInput : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Thrown if the result would be too large for a size that may come from outside the program.
struct TooLarge : std::length_error {
  using std::length_error::length_error;
};

/// The code for the error number of a failed system call: Resource if memory, the disk or one of their limits
/// is exhausted, otherwise Input.
inline ErrorCode code_of_errno(int number) {
  return number == ENOSPC || number == EDQUOT || number == EFBIG || number == EIO || number == ENOMEM ||
                 number == EMFILE
             ? ErrorCode::Resource
             : ErrorCode::Input;
}

}  // namespace octotomy::voxel
