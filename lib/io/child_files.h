// SPDX-License-Identifier: MIT
// The descriptors that a program run by pvtRunChild begins with; it has no other.
#ifndef PVT_IO_CHILD_FILES_H
#define PVT_IO_CHILD_FILES_H

enum {
    PVT_CHILD_INPUT = 3,
    PVT_CHILD_OUTPUT = 4,
    PVT_CHILD_ALIVE = 5, ///< closed when the process ends
};

#endif
