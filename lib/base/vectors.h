// SPDX-License-Identifier: MIT
// Loops that compilers turn into vector code, once for each machine.
#ifndef PVT_BASE_VECTORS_H
#define PVT_BASE_VECTORS_H

/// In front of a function whose loops give the same bytes at any vector width. Sanitizers and clang
/// 14 do without.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PVT_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
/// In front of a function that is to be part of each clone that calls it, instead of `static`.
#define PVT_IN_CLONES __attribute__((always_inline)) static inline
#else
#define PVT_VECTOR_CLONES
#define PVT_IN_CLONES static inline
#endif

/// In front of a loop of few rounds, which becomes so many copies with constants for its index.
#if defined(__clang__)
#define PVT_UNROLL _Pragma("unroll")
#elif defined(__GNUC__)
#define PVT_UNROLL _Pragma("GCC unroll 16")
#else
#define PVT_UNROLL
#endif

#endif
