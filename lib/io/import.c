// SPDX-License-Identifier: MIT
#include "formats.h"

#include "base/context.h"

pvtStatus pvtImportModel(const pvtLoadJob* job, pvtModel* model)
{
    (void)model;
    return pvtFail(job->context, PVT_UNSUPPORTED,
                   "%s: this build reads GLB and glTF only; convert the model", job->path);
}
