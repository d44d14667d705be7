// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Compiles a loop for several vector instruction sets; the loader chooses the best. No operation is
// contracted or reordered, so all versions compute the same bits. Clang and sanitizers compile the plain
// loop.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define OCTOTOMY_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define OCTOTOMY_VECTOR_CLONES
#endif
