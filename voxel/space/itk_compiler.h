// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// To be included before ITK's headers. Debian's ITK recognises only the compiler with which it was built;
// these are the results that its detection would have for clang.
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
