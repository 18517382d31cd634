// SPDX-License-Identifier: MIT
#include "base/bits.h"
#include "base/context.h"

#include <assert.h>
#include <paravent/section.h>

// A slice of the largest grid with four cells a voxel is 8192 cells wide; its padding adds some.
enum { MAX_SIDE = 1 << 20 };

pvtStatus pvtCreateBitmap(pvtContext* context, int width, int height, pvtBitmap* bitmap)
{
    *bitmap = (pvtBitmap){0};
    if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "a bitmap of %d × %d cells; each side must be 1 to %d", width, height,
                       MAX_SIDE);
    }
    const size_t wordsPerRow = pvtGetWordCount((size_t)width);
    uint64_t* words = pvtAllocate(context, wordsPerRow * (size_t)height, sizeof *words);
    if (words == NULL) {
        return pvtContext_GetStatus(context);
    }
    *bitmap = (pvtBitmap){words, width, height, wordsPerRow};
    return PVT_OK;
}

void pvtBitmap_Free(pvtContext* context, pvtBitmap* bitmap)
{
    pvtRelease(context, bitmap->words);
    *bitmap = (pvtBitmap){0};
}

bool pvtBitmap_Get(const pvtBitmap* bitmap, int x, int y)
{
    if (x < 0 || y < 0 || x >= bitmap->width || y >= bitmap->height) {
        return false;
    }
    return pvtGetBit(bitmap->words + (size_t)y * bitmap->wordsPerRow, (size_t)x);
}

void pvtBitmap_Set(pvtBitmap* bitmap, int x, int y, bool value)
{
    assert(x >= 0 && y >= 0 && x < bitmap->width && y < bitmap->height);
    uint64_t* row = bitmap->words + (size_t)y * bitmap->wordsPerRow;
    if (value) {
        pvtSetBit(row, (size_t)x);
    } else {
        pvtClearBit(row, (size_t)x);
    }
}

uint64_t pvtBitmap_Count(const pvtBitmap* bitmap)
{
    const size_t wordCount = bitmap->wordsPerRow * (size_t)bitmap->height;
    uint64_t count = 0;
    for (size_t i = 0; i < wordCount; ++i) {
        count += (uint64_t)pvtCountBits(bitmap->words[i]);
    }
    return count;
}
