// SPDX-License-Identifier: MIT
// What the programs run by pvtRunChild begin with: limits on themselves, and their input.
#ifndef PVT_IO_CHILD_MAIN_HPP
#define PVT_IO_CHILD_MAIN_HPP

#include "child_files.h"

#include <cstddef>

namespace pvt
{

/// The input's own bytes.
struct Input {
    const char* bytes;
    std::size_t size;
};

/// Bounds memory [bytes] and processor time [s], as the arguments say: past the time SIGXCPU tells
/// why the process ended. No further file can be opened.
void SetChildLimits(const char* memory, const char* seconds);

/// Throws std::runtime_error or std::bad_alloc.
Input MapChildInput();

} // namespace pvt

#endif
