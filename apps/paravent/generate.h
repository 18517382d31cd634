// SPDX-License-Identifier: MIT
// What the files of `paravent generate` share.
#ifndef PVT_APP_GENERATE_H
#define PVT_APP_GENERATE_H

#include "convention.h"
#include "json.h"
#include "run.h"
#include "view_list.h"

#include <paravent/gl.h>
#include <paravent/io.h>
#include <paravent/separate.h>

enum { PVT_SLICER_AUTO, PVT_SLICER_SAMPLE, PVT_SLICER_EGL, PVT_SLICER_OSMESA };

/// The line, as it was read. Choices are places among their words.
typedef struct pvtGenerateOptions {
    pvtCommonOptions common;
    const char *output, *stats, *preview;
    bool separate;
    int budget; ///< 0 with `separate`, until it is chosen: none is given
    int resolution;
    double error;    ///< [wu] 0: the resolution holds
    double deadline; ///< [s] 0: none
    pvtLength tolerance, smallestHole;
    bool ground, terrain;
    int up, enclosed, method, effort;
    const char* views;
    int slicer;
    uint64_t seed;
    int scene;
    const char* node;
    int masked, convention;
} pvtGenerateOptions;

extern const pvtSyntax pvtGenerateSyntax;

/// Groups that other commands take, too: their structs begin with pvtGenerateOptions.
extern const pvtOption pvtOptimizerOptionTable[]; ///< --method, --effort, --views, --seed
extern const pvtOption pvtSolidOptionTable[];     ///< what counts as inside
extern const pvtOption pvtInputOptionTable[];     ///< the part of the file to take
extern const pvtOption pvtSlicerOptionTable[];    ///< --slicer
enum {
    PVT_OPTIMIZER_OPTION_COUNT = 4,
    PVT_SOLID_OPTION_COUNT = 5,
    PVT_INPUT_OPTION_COUNT = 3,
    PVT_SLICER_OPTION_COUNT = 1,
};

pvtGenerateOptions pvtDefaultGenerateOptions(void);
/// `views` holds what --views FILE said, and must stay as long as the result is used.
pvtBuildOptions pvtGetBuildOptions(const pvtGenerateOptions* options, const pvtViewList* views);

/// Everything that a run of generate has made.
typedef struct pvtGenerated {
    const char* input;
    pvtModel model;
    pvtOccluder occluder;     ///< with --separate only its mesh: all of them
    pvtSeparation separation; ///< with --separate
    size_t polygonCount;      ///< that the occluder's mesh holds
    pvtBuildStats stats;
    double began, prepared, loaded, built, previewed, saved; ///< [s] on the clock
} pvtGenerated;

/// What the node of an occluder tells about it.
enum { PVT_OCCLUDER_EXTRA_COUNT = 14 };
void pvtListExtras(const pvtGenerateOptions* options, const pvtBuildStats* stats, int budget,
                   pvtExtra extras[PVT_OCCLUDER_EXTRA_COUNT]);

/// The occluder's model file, with what made it under extras.paravent.
pvtStatus pvtSaveOccluder(pvtRun* run, const pvtGenerateOptions* options,
                          const pvtGenerated* generated);
/// The fields of the contract, in its order.
pvtStatus pvtSaveStats(pvtRun* run, const pvtGenerateOptions* options,
                       const pvtGenerated* generated);
/// The object "options": every option of the syntax but those that only say where results go.
/// `options` may be the begin of a larger struct that the syntax fills.
void pvtWriteOptions(pvtJson* json, const pvtSyntax* syntax, const pvtGenerateOptions* options);
/// A few lines for people.
void pvtPrintSummary(pvtRun* run, const pvtGenerateOptions* options, const pvtGenerated* generated);

#endif
