// SPDX-License-Identifier: MIT
// PNG (ISO/IEC 15948), section 5: a signature, then chunks of length, type, data and checksum.
#include "png_strip.h"

#include "base/context.h"

#include <string.h>

enum { SIGNATURE = 8, CHUNK_FRAME = 12, TABLE_SIZE = 256, POLL_BYTES = 4 << 20 };

static uint32_t ReadWord(const uint8_t* bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

// CRC-32 of one byte, for each of them.
static void FillTable(uint32_t table[TABLE_SIZE])
{
    for (uint32_t i = 0; i < TABLE_SIZE; ++i) {
        uint32_t crc = i;
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ ((crc & 1) != 0 ? UINT32_C(0xEDB88320) : 0);
        }
        table[i] = crc;
    }
}

// False when cancelled.
static bool ComputeCrc(pvtContext* context, const uint32_t table[TABLE_SIZE], const uint8_t* bytes,
                       size_t size, uint32_t* crc)
{
    uint32_t value = UINT32_MAX;
    for (size_t i = 0; i < size; ++i) {
        value = table[(value ^ bytes[i]) & 0xff] ^ value >> 8;
        if ((i & (POLL_BYTES - 1)) == 0 && pvtIsCancelled(context)) {
            return false;
        }
    }
    *crc = ~value;
    return true;
}

static bool IsNeeded(const uint8_t* type)
{
    static const char* const needed[] = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; ++i) {
        if (memcmp(type, needed[i], 4) == 0) {
            return true;
        }
    }
    return false;
}

static pvtStatus CopyChunks(pvtContext* context, const char* label, const uint8_t* bytes,
                            size_t size, pvtSource* stripped)
{
    uint32_t table[TABLE_SIZE];
    FillTable(table);
    size_t at = SIGNATURE;
    while (size - at >= CHUNK_FRAME && ReadWord(bytes + at) <= size - at - CHUNK_FRAME) {
        const size_t length = ReadWord(bytes + at);
        const uint8_t* type = bytes + at + 4;
        uint32_t crc = 0;
        if (!ComputeCrc(context, table, type, length + 4, &crc)) {
            return pvtFailCancelled(context);
        }
        if (crc != ReadWord(bytes + at + 8 + length)) {
            return pvtFail(context, PVT_INVALID_INPUT,
                           "%s cannot be read: at byte %zu it does not match its checksum", label,
                           at);
        }
        if (IsNeeded(type)) {
            memcpy(stripped->bytes + stripped->size, bytes + at, CHUNK_FRAME + length);
            stripped->size += CHUNK_FRAME + length;
        }
        if (memcmp(type, "IEND", 4) == 0) {
            return PVT_OK;
        }
        at += CHUNK_FRAME + length;
    }
    return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: it was cut short", label);
}

pvtStatus pvtStripPng(pvtContext* context, const char* label, const uint8_t* bytes, size_t size,
                      pvtSource* stripped)
{
    *stripped = (pvtSource){0};
    pvtSource copy = {pvtAllocate(context, size + PVT_SOURCE_PADDING, 1), SIGNATURE};
    if (copy.bytes == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(copy.bytes, bytes, SIGNATURE);
    const pvtStatus status = CopyChunks(context, label, bytes, size, &copy);
    if (status != PVT_OK) {
        pvtSource_Free(context, &copy);
        return status;
    }
    *stripped = copy;
    return PVT_OK;
}
