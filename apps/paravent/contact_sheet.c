// SPDX-License-Identifier: MIT
// Twelve views of each occluder over its original, with captions.
#include "judgement.h"
#include "lettering.h"

#include <stdio.h>
#include <string.h>

enum {
    COLUMNS = 4,
    TILE = 360,
    GAP = 12,
    HEAD = 56,    // above the first block: what the colours mean
    TITLE = 40,   // above each block: the occluder
    CAPTION = 30, // below each tile
    TITLE_LETTERS = 80,
};

static const uint8_t PAPER[3] = {232, 232, 232};
static const uint8_t INK[3] = {30, 30, 30};
static const uint8_t ALARM[3] = {190, 20, 20};

static void CopyTile(const pvtImage* tile, pvtImage* sheet, int x, int y)
{
    for (int row = 0; row < tile->height; ++row) {
        uint8_t* to = sheet->pixels + 4 * ((size_t)(y + row) * (size_t)sheet->width + (size_t)x);
        const uint8_t* from = tile->pixels + 4 * (size_t)row * (size_t)tile->width;
        memcpy(to, from, 4 * (size_t)tile->width);
    }
}

static void DrawHead(pvtImage* sheet, const pvtJudgement* judgement, size_t shown)
{
    static const struct {
        uint8_t colour[3];
        const char* text;
    } keys[] = {{{0, 0, 0}, "ORIGINAL"}, {{255, 221, 0}, "BOTH"}, {{30, 80, 230}, "OVER-OCCLUDED"}};
    const pvtLettering lettering = {2, {INK[0], INK[1], INK[2]}};
    const int line = (HEAD - 2 * PVT_LETTER_HEIGHT) / 2 + GAP / 2;
    int x = GAP;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; ++k) {
        pvtFillRectangle(sheet, keys[k].colour, (int[4]){x, line - 3, 20, 20});
        pvtDrawText(sheet, &lettering, (int[2]){x + 28, line}, keys[k].text);
        x += 28 + 2 * PVT_LETTER_WIDTH * ((int)strlen(keys[k].text) + 2);
    }
    const int views = judgement->evaluation->options.views;
    if ((size_t)views > shown) {
        char text[TITLE_LETTERS];
        (void)snprintf(text, sizeof text, "%zu OF %d VIEWS", shown, views);
        const int width = 2 * PVT_LETTER_WIDTH * (int)strlen(text);
        pvtDrawText(sheet, &lettering, (int[2]){sheet->width - GAP - width, line}, text);
    }
}

static void DrawCaption(pvtImage* sheet, const pvtOccluderScore* score, size_t view,
                        const int at[2])
{
    const bool isWorst = view == score->worstView;
    const uint8_t* colour = isWorst ? ALARM : INK;
    const pvtLettering lettering = {2, {colour[0], colour[1], colour[2]}};
    char text[TITLE_LETTERS];
    (void)snprintf(text, sizeof text, "%sRECALL %.1f%%", isWorst ? "WORST: " : "",
                   100.0 * score->views[view].uniform.recall);
    pvtDrawText(sheet, &lettering, at, text);
}

static void DrawTitle(pvtImage* sheet, const pvtJudgement* judgement, size_t index, int y)
{
    const pvtOccluderScore* score = &judgement->evaluation->occluders[index];
    const pvtLettering lettering = {2, {INK[0], INK[1], INK[2]}};
    char text[320], name[200];
    pvtShortenName(judgement->names[index], 40, name, sizeof name);
    (void)snprintf(text, sizeof text, "%s, %zu TRIANGLES, RECALL %.1f%%", name,
                   score->triangleCount, 100.0 * score->uniform.recall);
    pvtDrawText(sheet, &lettering, (int[2]){GAP, y + (TITLE - 2 * PVT_LETTER_HEIGHT) / 2}, text);
}

// Where the tiles of a block stand.
static int GetBlockHeight(const pvtSheetViews* chosen)
{
    const int rows = ((int)chosen->count + COLUMNS - 1) / COLUMNS;
    return TITLE + rows * (TILE + CAPTION);
}

static pvtStatus DrawBlock(pvtContext* context, const pvtJudgement* judgement, size_t index,
                           const pvtMesh* meshes, const pvtSheetViews* chosen, pvtImage* sheet)
{
    const pvtOccluderScore* score = &judgement->evaluation->occluders[index];
    const pvtMesh* const pair[2] = {&meshes[0], &meshes[1 + index]};
    pvtImage tiles[PVT_SHEET_VIEWS];
    const pvtStatus status = pvtDrawSheetViews(context, chosen, pair, TILE, tiles);
    if (status != PVT_OK) {
        return status;
    }
    const int top = HEAD + (int)index * GetBlockHeight(chosen);
    DrawTitle(sheet, judgement, index, top);
    for (size_t i = 0; i < chosen->count; ++i) {
        const int x = GAP + (int)(i % COLUMNS) * (TILE + GAP);
        const int y = top + TITLE + (int)(i / COLUMNS) * (TILE + CAPTION);
        CopyTile(&tiles[i], sheet, x, y);
        DrawCaption(sheet, score, chosen->views[i], (int[2]){x, y + TILE + 8});
        pvtImage_Free(context, &tiles[i]);
    }
    return PVT_OK;
}

pvtStatus pvtMakeContactSheet(pvtContext* context, const pvtJudgement* judgement,
                              const pvtMesh* meshes, pvtImage* sheet)
{
    const pvtSheetViews chosen = pvtChooseSheetViews(judgement->evaluation);
    const int columns = (int)chosen.count < COLUMNS ? (int)chosen.count : COLUMNS;
    const int narrow = columns < 2 ? 2 : columns; // the captions above need some room
    const int width = GAP + narrow * (TILE + GAP);
    const size_t count = judgement->evaluation->count;
    pvtStatus status =
        pvtCreateImage(context, width, HEAD + (int)count * GetBlockHeight(&chosen), sheet);
    if (status != PVT_OK) {
        return status;
    }
    pvtFillRectangle(sheet, PAPER, (int[4]){0, 0, sheet->width, sheet->height});
    DrawHead(sheet, judgement, chosen.count);
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        status = DrawBlock(context, judgement, i, meshes, &chosen, sheet);
    }
    if (status != PVT_OK) {
        pvtImage_Free(context, sheet);
    }
    return status;
}
