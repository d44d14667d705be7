// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cerrno>
#include <stdexcept>
#include <string>

namespace octotomy::voxel {

/// The kind of an error. Exit statuses follow from it, never from a message.
enum class ErrorCode {
  Input,      ///< data or text from outside is wrong
  Geometry,   ///< the data are sound, but the operation has no answer on them
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

/// Thrown after a stop token was set.
struct Stopped : Error {
  explicit Stopped(const std::string& message) : Error(ErrorCode::Cancelled, message) {}
};

/// Thrown for a wrong value or wrong data that may come from outside the program. The message states the
/// fault and, if it helps, the remedy. A plain std::invalid_argument, in contrast, reports a mistake of the
/// caller, who broke a precondition that no outside value can break.
struct InvalidInput : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Thrown for a size that may come from outside the program if the function's result would be too large.
struct TooLarge : std::length_error {
  using std::length_error::length_error;
};

/// The code of a failed system call: Resource if memory, the disk or one of their limits is exhausted,
/// otherwise Input.
inline ErrorCode code_of_errno(int number) {
  return number == ENOSPC || number == EDQUOT || number == EFBIG || number == EIO || number == ENOMEM ||
                 number == EMFILE
             ? ErrorCode::Resource
             : ErrorCode::Input;
}

}  // namespace octotomy::voxel
