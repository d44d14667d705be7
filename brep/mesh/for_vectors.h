// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Compiles a loop for the vector instructions of several processors. Neither contraction nor reordering of
// sums is allowed, so all versions compute the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define OCTOTOMY_FOR_VECTORS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define OCTOTOMY_FOR_VECTORS
#endif
