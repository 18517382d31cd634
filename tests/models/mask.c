// SPDX-License-Identifier: MIT
// PNG (ISO/IEC 15948) with one stored block of deflate (RFC 1951) in zlib's frame (RFC 1950).
#include "mask.h"

#include <assert.h>
#include <string.h>

enum { ROW_BYTES = 1 + MASK_SIZE / 8, DATA_BYTES = MASK_SIZE * ROW_BYTES };

typedef struct Bytes {
    uint8_t* at;
    size_t size;
} Bytes;

static void Put(Bytes* bytes, const void* data, size_t size)
{
    assert(bytes->size + size <= MASK_PNG_ROOM);
    if (size > 0) {
        memcpy(bytes->at + bytes->size, data, size);
        bytes->size += size;
    }
}

// The most significant byte first.
static void PutWord(Bytes* bytes, uint32_t word)
{
    const uint8_t data[4] = {(uint8_t)(word >> 24), (uint8_t)(word >> 16), (uint8_t)(word >> 8),
                             (uint8_t)word};
    Put(bytes, data, sizeof data);
}

static uint32_t GetCrc(const uint8_t* data, size_t size)
{
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; ++i) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0);
        }
    }
    return ~crc;
}

static void PutChunk(Bytes* bytes, const char* type, const uint8_t* data, size_t size)
{
    PutWord(bytes, (uint32_t)size);
    const size_t begin = bytes->size;
    Put(bytes, type, 4);
    Put(bytes, data, size);
    PutWord(bytes, GetCrc(bytes->at + begin, bytes->size - begin));
}

static uint32_t GetAdler(const uint8_t* data, size_t size)
{
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < size; ++i) {
        a = (a + data[i]) % 65521;
        b = (b + a) % 65521;
    }
    return b << 16 | a;
}

static void PutPixels(Bytes* bytes, const Mask* mask)
{
    uint8_t rows[DATA_BYTES] = {0};
    for (int y = 0; y < MASK_SIZE; ++y) {
        for (int x = 0; x < MASK_SIZE; ++x) {
            const int bit = mask->isOpaque[y][x] ? 0x80 >> (x & 7) : 0;
            uint8_t* byte = &rows[y * ROW_BYTES + 1 + x / 8];
            *byte = (uint8_t)(*byte | bit);
        }
    }
    uint8_t stream[DATA_BYTES + 11] = {0x78, 0x01, 0x01};
    stream[3] = DATA_BYTES & 0xff;
    stream[4] = DATA_BYTES >> 8;
    stream[5] = (uint8_t)~stream[3];
    stream[6] = (uint8_t)~stream[4];
    memcpy(stream + 7, rows, DATA_BYTES);
    Bytes end = {stream + 7 + DATA_BYTES, 0};
    PutWord(&end, GetAdler(rows, DATA_BYTES));
    PutChunk(bytes, "IDAT", stream, sizeof stream);
}

size_t EncodeMask(const Mask* mask, uint8_t png[MASK_PNG_ROOM])
{
    static const uint8_t header[] = {0, 0, 0, MASK_SIZE, 0, 0, 0, MASK_SIZE, 1, 3, 0, 0, 0};
    static const uint8_t palette[] = {24, 48, 16, 60, 110, 40};
    static const uint8_t alphas[] = {0, 255};
    Bytes bytes = {png, 0};
    Put(&bytes, "\x89PNG\r\n\x1a\n", 8);
    PutChunk(&bytes, "IHDR", header, sizeof header);
    PutChunk(&bytes, "PLTE", palette, sizeof palette);
    PutChunk(&bytes, "tRNS", alphas, sizeof alphas);
    PutPixels(&bytes, mask);
    PutChunk(&bytes, "IEND", NULL, 0);
    return bytes.size;
}
