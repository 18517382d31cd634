// SPDX-License-Identifier: MIT
// The importer process: a program of the project's own that reads one file through assimp. Its
// parsers were written for files from friends; when one of them fails, it takes no more with it
// than itself.
#ifndef PVT_IO_IMPORT_PROCESS_H
#define PVT_IO_IMPORT_PROCESS_H

#include "child_process.h"
#include "import_result.h"

/// Runs the importer over the job's file, by the ending of its path. The result is at least a
/// header, which says that it is whole. Memory is bounded by what the context may still take, time
/// by the file's size.
pvtStatus pvtRunImporter(const pvtLoadJob* job, pvtChildResult* result);

#endif
