// SPDX-License-Identifier: MIT
// A contact sheet: a block of six views a level, with captions.
#include "ladder.h"
#include "lettering.h"

#include <stdio.h>
#include <string.h>

enum { TILE = 240, BLOCK_WIDTH = 3 * TILE, BLOCK_HEIGHT = 2 * TILE, GAP = 12, TITLE = 36 };

static const uint8_t PAPER[3] = {232, 232, 232};
static const uint8_t INK[3] = {30, 30, 30};

static void CopyBlock(const pvtImage* block, pvtImage* sheet, const int at[2])
{
    for (int row = 0; row < block->height; ++row) {
        const size_t to = (size_t)(at[1] + row) * (size_t)sheet->width + (size_t)at[0];
        memcpy(sheet->pixels + 4 * to, block->pixels + 4 * (size_t)row * (size_t)block->width,
               4 * (size_t)block->width);
    }
}

static pvtStatus DrawLevel(pvtRun* run, pvtGl* gl, const pvtPreviewOptions* preview,
                           const pvtLadderResult* result, size_t index, pvtImage* sheet)
{
    const pvtLevel* level = &result->ladder.levels[index];
    const int at[2] = {GAP + (int)(index % 2) * (BLOCK_WIDTH + GAP),
                       (int)(index / 2) * (TITLE + BLOCK_HEIGHT + GAP) + TITLE};
    pvtImage block = {0};
    const pvtStatus status = pvtRenderPreview(run->context, gl, preview, &result->model.mesh,
                                              &level->occluder.mesh, &block);
    if (status != PVT_OK) {
        return status;
    }
    char text[96];
    (void)snprintf(text, sizeof text, "LOD%zu: %zu TRIANGLES, ERROR %.3g, FROM %.4g", index,
                   level->occluder.mesh.triangleCount, level->stats.errorBound, level->distance);
    const pvtLettering lettering = {2, {INK[0], INK[1], INK[2]}};
    CopyBlock(&block, sheet, at);
    pvtDrawText(sheet, &lettering, (int[2]){at[0], at[1] - (TITLE + 2 * PVT_LETTER_HEIGHT) / 2},
                text);
    pvtImage_Free(run->context, &block);
    return PVT_OK;
}

pvtStatus pvtDrawLadder(pvtRun* run, pvtGl* gl, const pvtLadderLine* options,
                        const pvtLadderResult* result, pvtImage* sheet)
{
    pvtPreviewOptions preview = pvtDefaultPreviewOptions();
    preview.up = (pvtAxis)options->generate.up;
    preview.tileSize = TILE;
    const int count = (int)result->ladder.count;
    const int columns = count > 1 ? 2 : 1;
    const int rows = (count + 1) / 2;
    pvtStatus status = pvtCreateImage(run->context, GAP + columns * (BLOCK_WIDTH + GAP),
                                      rows * (TITLE + BLOCK_HEIGHT + GAP), sheet);
    if (status != PVT_OK) {
        return status;
    }
    pvtFillRectangle(sheet, PAPER, (int[4]){0, 0, sheet->width, sheet->height});
    for (size_t i = 0; i < (size_t)count && status == PVT_OK; ++i) {
        status = DrawLevel(run, gl, &preview, result, i, sheet);
    }
    if (status != PVT_OK) {
        pvtImage_Free(run->context, sheet);
    }
    return status;
}
