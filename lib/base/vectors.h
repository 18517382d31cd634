// SPDX-License-Identifier: MIT
// Loops that compilers turn into vector code, once for each machine.
#ifndef PVT_BASE_VECTORS_H
#define PVT_BASE_VECTORS_H

/// In front of a function whose loops give the same bytes at any vector width. Sanitizers and clang
/// 14 do without.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PVT_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PVT_VECTOR_CLONES
#endif

#endif
