// SPDX-License-Identifier: MIT
// `paravent evaluate --report`: one page with everything in it.
#ifndef PVT_APP_HTML_REPORT_H
#define PVT_APP_HTML_REPORT_H

#include "judgement.h"
#include "run.h"

/// PVT_UNSUPPORTED in a build without Node, PVT_LIMIT for more triangles than a browser can take:
/// to be asked before the long work. `meshes` holds the original, then `count` − 1 occluders.
pvtStatus pvtCheckReport(pvtRun* run, const pvtMesh* meshes, size_t count);

/// Writes the page, whole or not at all.
pvtStatus pvtWriteReport(pvtRun* run, const char* path, const pvtJudgement* judgement,
                         const pvtMesh* meshes);

#endif
