// SPDX-License-Identifier: MIT
// Programs of the project's own that run parsers written for files from friends: when one of them
// fails, hangs or takes all memory, it takes no more with it than itself.
#ifndef PVT_IO_CHILD_PROCESS_H
#define PVT_IO_CHILD_PROCESS_H

#include "child_files.h"
#include "formats.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pvtChildDef {
    const char* program;  ///< its file's name: see companion.h
    const char* purpose;  ///< what needs it, such as "this format", for the message without it
    const char* remedy;   ///< what to do where it is not installed
    const char* argument; ///< its first argument
    int input;            ///< the file that it reads
    size_t memory;        ///< [bytes] its second argument, which it has to keep
    size_t seconds;       ///< its third argument: of processor time
} pvtChildDef;

/// How it ended, and what it has written, mapped into memory.
typedef struct pvtChildResult {
    int signal;   ///< 0, or what it was killed by
    int exitCode; ///< of one that was not killed
    const uint8_t* bytes;
    size_t size;
} pvtChildResult;

/// Runs the program and waits; kills it when the caller cancels. PVT_OK however it ended;
/// PVT_UNSUPPORTED when it is not there; PVT_LIMIT when its output does not fit in memory.
pvtStatus pvtRunChild(const pvtLoadJob* job, const pvtChildDef* def, pvtChildResult* result);
void pvtChildResult_Free(pvtChildResult* result);

/// Fails with what the signal means. `reader` is who reads it, such as "assimp"; `remedy` ends the
/// text. `place` is "" or a place in the file with ": " behind it.
pvtStatus pvtFailOfSignal(const pvtLoadJob* job, int number, const char* place, const char* reader,
                          const char* remedy);

#ifdef __cplusplus
}
#endif
#endif
