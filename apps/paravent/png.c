// SPDX-License-Identifier: MIT
// PNG (ISO/IEC 15948) with one deflate block (RFC 1951) of fixed codes, whose only matches are with
// the pixel before: runs of one colour. pvtSaveImage compresses better; this one needs no module
// and no file.
#include "png.h"

#include <stdlib.h>
#include <string.h>

enum { CHANNELS = 3, LEAST_MATCH = 3, MOST_MATCH = 258 };

// The file as it grows, with room for all of it, and bits that make no byte yet.
typedef struct PngWriter {
    uint8_t* bytes;
    size_t used;
    uint32_t bits;
    int bitCount;
} PngWriter;

static void PutNumber(PngWriter* writer, uint32_t number)
{
    for (int shift = 24; shift >= 0; shift -= 8) {
        writer->bytes[writer->used++] = (uint8_t)(number >> shift);
    }
}

// Lowest bit first.
static void PutBits(PngWriter* writer, uint32_t bits, int count)
{
    writer->bits |= bits << writer->bitCount;
    writer->bitCount += count;
    while (writer->bitCount >= 8) {
        writer->bytes[writer->used++] = (uint8_t)writer->bits;
        writer->bits >>= 8;
        writer->bitCount -= 8;
    }
}

// A Huffman code: highest bit first.
static void PutCode(PngWriter* writer, uint32_t code, int count)
{
    uint32_t turned = 0;
    for (int i = 0; i < count; ++i) {
        turned |= (code >> i & 1) << (count - 1 - i);
    }
    PutBits(writer, turned, count);
}

// A literal, the end (256), or a length's symbol, by the fixed codes.
static void PutSymbol(PngWriter* writer, uint32_t symbol)
{
    if (symbol < 144) {
        PutCode(writer, 0x30 + symbol, 8);
    } else if (symbol < 256) {
        PutCode(writer, 0x190 + symbol - 144, 9);
    } else if (symbol < 280) {
        PutCode(writer, symbol - 256, 7);
    } else {
        PutCode(writer, 0xC0 + symbol - 280, 8);
    }
}

// `length` bytes as the ones a pixel before.
static void PutMatch(PngWriter* writer, uint32_t length)
{
    uint32_t symbol = 285, extra = 0;
    int extraBits = 0;
    if (length < MOST_MATCH) {
        // Symbols 257 to 264 are lengths 3 to 10; then four symbols for each number of extra bits.
        const uint32_t rest = length - LEAST_MATCH;
        extraBits = rest < 8 ? 0 : 29 - __builtin_clz(rest);
        symbol = 257 + (uint32_t)extraBits * 4 + (rest >> extraBits);
        extra = rest & ((1u << extraBits) - 1);
    }
    PutSymbol(writer, symbol);
    PutBits(writer, extra, extraBits);
    PutCode(writer, CHANNELS - 1, 5);
}

static void PutData(PngWriter* writer, const uint8_t* data, size_t size)
{
    size_t at = 0;
    while (at < size) {
        size_t run = 0;
        while (at >= CHANNELS && at + run < size && run < MOST_MATCH &&
               data[at + run] == data[at + run - CHANNELS]) {
            ++run;
        }
        if (run >= LEAST_MATCH) {
            PutMatch(writer, (uint32_t)run);
            at += run;
        } else {
            PutSymbol(writer, data[at++]);
        }
    }
}

static uint32_t GetCrc(const uint8_t* bytes, size_t size)
{
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ (0xEDB88320u & (0u - (crc & 1)));
        }
    }
    return ~crc;
}

static uint32_t GetAdler(const uint8_t* bytes, size_t size)
{
    uint32_t low = 1, high = 0;
    for (size_t i = 0; i < size; ++i) {
        low = (low + bytes[i]) % 65521;
        high = (high + low) % 65521;
    }
    return high << 16 | low;
}

// Leaves room for the chunk's size, which EndChunk fills in.
static size_t BeginChunk(PngWriter* writer, const char* name)
{
    PutNumber(writer, 0);
    memcpy(writer->bytes + writer->used, name, 4);
    writer->used += 4;
    return writer->used;
}

static void EndChunk(PngWriter* writer, size_t begin)
{
    const size_t end = writer->used;
    writer->used = begin - 8;
    PutNumber(writer, (uint32_t)(end - begin));
    writer->used = end;
    PutNumber(writer, GetCrc(writer->bytes + begin - 4, end - begin + 4));
}

static void PutHead(PngWriter* writer, const pvtImage* image)
{
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    memcpy(writer->bytes, signature, sizeof signature);
    writer->used = sizeof signature;
    const size_t begin = BeginChunk(writer, "IHDR");
    PutNumber(writer, (uint32_t)image->width);
    PutNumber(writer, (uint32_t)image->height);
    static const uint8_t rest[] = {8, 2, 0, 0, 0}; // bits, true colour, and three defaults
    memcpy(writer->bytes + writer->used, rest, sizeof rest);
    writer->used += sizeof rest;
    EndChunk(writer, begin);
}

// Rows of red, green and blue, each behind a 0: no filter.
static void CopyRows(const pvtImage* image, uint8_t* rows)
{
    const uint8_t* from = image->pixels;
    for (int y = 0; y < image->height; ++y) {
        *rows++ = 0;
        for (int x = 0; x < image->width; ++x, from += 4, rows += CHANNELS) {
            memcpy(rows, from, CHANNELS);
        }
    }
}

bool pvtEncodePng(const pvtImage* image, uint8_t** bytes, size_t* size)
{
    const size_t raw = ((size_t)image->width * CHANNELS + 1) * (size_t)image->height;
    uint8_t* rows = calloc(raw, 1);
    // A literal takes at most nine bits, and everything around the data less than 128 bytes.
    PngWriter writer = {.bytes = malloc(raw + raw / 8 + 128)};
    if (rows == NULL || writer.bytes == NULL) {
        free(rows);
        free(writer.bytes);
        return false;
    }
    CopyRows(image, rows);
    PutHead(&writer, image);
    const size_t begin = BeginChunk(&writer, "IDAT");
    PutBits(&writer, 0x0178, 16);    // zlib: deflate, no dictionary
    PutBits(&writer, 1 | 1 << 1, 3); // the last block, of fixed codes
    PutData(&writer, rows, raw);
    PutSymbol(&writer, 256);
    PutBits(&writer, 0, (8 - writer.bitCount) & 7);
    PutNumber(&writer, GetAdler(rows, raw));
    EndChunk(&writer, begin);
    EndChunk(&writer, BeginChunk(&writer, "IEND"));
    free(rows);
    *bytes = writer.bytes;
    *size = writer.used;
    return true;
}
