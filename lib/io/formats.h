// SPDX-License-Identifier: MIT
// The readers and writers behind pvtLoadModel and pvtSaveModel.
#ifndef PVT_IO_FORMATS_H
#define PVT_IO_FORMATS_H

#include "source.h"

#include <paravent/io.h>
#include <paravent/output.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A file that is open, and what is wanted of it.
typedef struct pvtLoadJob {
    pvtContext* context;
    const pvtLoadOptions* options;
    const char* path;
    int file;    ///< a regular file
    size_t size; ///< [bytes] at least 1
} pvtLoadJob;

/// glTF 2.0, as GLB or as JSON.
pvtStatus pvtLoadGltf(const pvtLoadJob* job, const pvtSource* source, pvtModel* model);
/// OBJ, PLY, STL, FBX and DAE, by the path's ending.
pvtStatus pvtImportModel(const pvtLoadJob* job, pvtModel* model);

/// What is saved: meshes that were checked by pvtSaveModel.
typedef struct pvtSaveJob {
    pvtContext* context;
    const pvtSaveItem* items;
    size_t count;
} pvtSaveJob;

/// Each fills an open output; a failure to write is told when it is committed.
pvtStatus pvtWriteGltf(const pvtSaveJob* job, bool binary, pvtOutput* output);
pvtStatus pvtWriteLevels(pvtContext* context, const pvtLevelSet* set, bool binary,
                         pvtOutput* output);
pvtStatus pvtWriteObj(const pvtSaveJob* job, pvtOutput* output);
pvtStatus pvtWritePly(const pvtSaveJob* job, pvtOutput* output);
pvtStatus pvtWriteTscn(const pvtSaveJob* job, pvtOutput* output);

#ifdef __cplusplus
}
#endif
#endif
