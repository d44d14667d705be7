// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Included before ITK's own headers. Debian's ITK knows only the compiler that it was built with; this is
// what it would detect about clang.
#if defined(__clang__)
#define ITK_COMPILER_DETECTION_H
#define ITK_NOEXCEPT noexcept
#define ITK_ALIGNAS(X) alignas(X)
#define ITK_CONSTEXPR constexpr
#define ITK_CONSTEXPR_FUNC constexpr
#define ITK_CONSTEXPR_VAR constexpr
#define ITK_NULLPTR nullptr
#define ITK_THREAD_LOCAL thread_local
#endif
