// SPDX-License-Identifier: MIT
// `paravent generate --separate`: an occluder a mesh node.
#ifndef PVT_APP_SEPARATE_H
#define PVT_APP_SEPARATE_H

#include "generate.h"

/// Makes the occluders, and with them what the rest of the run looks at: all of them as one mesh,
/// where they stand, and numbers of the whole.
pvtStatus pvtBuildSeparately(pvtRun* run, const pvtBuildOptions* build, pvtGenerated* generated);

/// The model file: a node for each node that has an occluder, named after it.
pvtStatus pvtSaveSeparately(pvtRun* run, const pvtGenerateOptions* options,
                            const pvtGenerated* generated);

/// The keys "nodes", "nodes_without" and "occluders".
void pvtWriteSeparate(pvtJson* json, const pvtGenerated* generated);
/// The first line of the summary.
void pvtPrintSeparate(pvtRun* run, const pvtGenerateOptions* options,
                      const pvtGenerated* generated);

#endif
