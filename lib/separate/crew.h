// SPDX-License-Identifier: MIT
// Many pieces of work that each need a context: side by side when they are many, and one after the
// other, each on all threads, when they are few.
#ifndef PVT_SEPARATE_CREW_H
#define PVT_SEPARATE_CREW_H

#include <paravent/base.h>

typedef struct pvtCrewWork {
    const char* stage;  ///< what progress calls it
    size_t count;       ///< pieces, begun in the order 0 to count − 1
    bool isAlone;       ///< never two pieces at once
    bool keepsWarnings; ///< else they are dropped
    /// Does a piece with a context of its own, whose memory is taken from the caller's and gone at
    /// the end: what is to stay is allocated with the caller's. Any failure ends the whole; it is
    /// then the first piece's, in order, that failed.
    pvtStatus (*run)(pvtContext* context, size_t piece, void* user);
    /// Puts a name before messages and warnings of the piece.
    void (*name)(size_t piece, char* text, size_t size, void* user);
    void* user;
} pvtCrewWork;

/// A piece that meets the memory limit while others work is done again when it has it all. Warnings
/// come in the order of the pieces, whoever did them.
pvtStatus pvtRunCrew(pvtContext* context, const pvtCrewWork* work);

/// How many pieces work at once.
int pvtGetCrewSize(const pvtContext* context, size_t count, bool isAlone);

#endif
