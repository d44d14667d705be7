// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <sys/types.h>

// Messages between a harness and the program that serves it cases, over a SOCK_SEQPACKET socket.
//
// A request is one byte, `more` or `last`, and the words after the program's name, each ended by a zero byte.
// The child that gets it runs main() on them; it answers Returned and waits for the next one, or, after the
// last, exits as main()'s return would have it.
namespace octotomy::tests {

inline constexpr char more_follow = '+', last_of_child = '.';

struct CaseReport {
  enum Kind : int {
    Begun,     ///< a child waits for requests
    Returned,  ///< main() returned `status`
    Ended,     ///< the child ended: `status` is its exit status, or minus the signal
  };
  Kind kind = Begun;
  pid_t child = 0;
  int status = 0;
  long resident_kib = 0;  ///< the most that the child ever held
};

}  // namespace octotomy::tests
