// SPDX-License-Identifier: MIT
// What the commands that build occluders have in common: what is opened before the long work, so
// that nothing missing is found behind it, and the input.
#ifndef PVT_APP_SETUP_H
#define PVT_APP_SETUP_H

#include "generate.h"

typedef struct pvtSetup {
    pvtViewList views;
    pvtGl* gl; ///< null: neither slicer nor preview needs it
    bool slicesOnGl;
} pvtSetup;

/// Checks the files that the line names, reads the views, and sees whether slices and pictures can
/// be made. Close it also on failure.
pvtStatus pvtOpenSetup(pvtRun* run, const pvtGenerateOptions* options, const char* input,
                       pvtSetup* setup);
/// What the line asks for, with the slicer that was opened. Borrows from both.
pvtBuildOptions pvtSetup_GetBuildOptions(const pvtSetup* setup, const pvtGenerateOptions* options);
void pvtSetup_Close(pvtRun* run, pvtSetup* setup);

/// The model, or the part of it that the line names.
pvtStatus pvtLoadInput(pvtRun* run, const pvtGenerateOptions* options, const char* path,
                       pvtModel* model);

#endif
