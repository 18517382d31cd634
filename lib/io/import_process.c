// SPDX-License-Identifier: MIT
#include "import_process.h"

#include "base/context.h"

#include <stdio.h>
#include <string.h>

static const char kRemedy[] = "repair it, or convert it to GLB";

enum {
    MIN_MEMORY = 512 << 20, // what a process with assimp takes in any case, with room for a model
    MEMORY_PER_BYTE = 64,   // of the file: no format that assimp reads here needs more
    SECONDS_AT_LEAST = 10,
};

static size_t GetMemoryBudget(const pvtLoadJob* job)
{
    const size_t wanted = MIN_MEMORY + (size_t)MEMORY_PER_BYTE * job->size;
    const size_t left = pvtGetFreeBytes(job->context);
    return left < SIZE_MAX - MIN_MEMORY && wanted > left + MIN_MEMORY ? left + MIN_MEMORY : wanted;
}

// Nothing is looked at before the header, which is written last, says that the result is whole.
static pvtStatus CheckEnd(const pvtLoadJob* job, const pvtChildResult* result)
{
    if (result->signal != 0) {
        return pvtFailOfSignal(job, result->signal, "", "assimp", kRemedy);
    }
    const pvtImportHeader* header = (const pvtImportHeader*)(const void*)result->bytes;
    if (result->size < sizeof *header ||
        memcmp(header->magic, PVT_IMPORT_MAGIC, sizeof header->magic) != 0 ||
        header->version != PVT_IMPORT_VERSION) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: the importer ended early (status %d); the file is damaged: %s",
                       job->path, result->exitCode, kRemedy);
    }
    return PVT_OK;
}

pvtStatus pvtRunImporter(const pvtLoadJob* job, pvtChildResult* result)
{
    const char* dot = strrchr(job->path, '.');
    char ending[8];
    (void)snprintf(ending, sizeof ending, "%s", dot != NULL ? dot + 1 : "");
    const pvtChildDef def = {
        .program = "paravent-import",
        .purpose = "this format",
        .remedy = "build paravent with libassimp-dev, name its folder in PARAVENT_MODULE_PATH, or "
                  "convert the model to GLB",
        .argument = ending,
        .input = job->file,
        .memory = GetMemoryBudget(job),
        .seconds = SECONDS_AT_LEAST + 2 * (job->size >> 20),
    };
    pvtStatus status = pvtRunChild(job, &def, result);
    if (status == PVT_OK) {
        status = CheckEnd(job, result);
        if (status != PVT_OK) {
            pvtChildResult_Free(result);
        }
    }
    return status;
}
