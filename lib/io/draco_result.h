// SPDX-License-Identifier: MIT
// What paravent-draco is asked, and what it hands back: files of these structs, in this machine's
// byte order. The program believes its caller; the caller believes nothing that comes back.
#ifndef PVT_IO_DRACO_RESULT_H
#define PVT_IO_DRACO_RESULT_H

#include <stdint.h>

enum {
    PVT_DRACO_VERSION = 1,
    PVT_DRACO_TEXT_SIZE = 512,
};

#define PVT_DRACO_MAGIC "pvtdrac"
/// For a number of faces that is not known beforehand.
#define PVT_DRACO_ANY UINT64_MAX

/// Behind it: streams, attributes' unique ids (uint32_t), and the streams' bytes.
typedef struct pvtDracoRequest {
    char magic[8];
    uint32_t version, reserved;
    uint64_t streamCount, idCount;
} pvtDracoRequest;

typedef struct pvtDracoStream {
    uint64_t offset, size;          ///< [bytes] in the request
    uint64_t firstId, idCount;      ///< the attributes that are wanted of it
    uint64_t pointCount, faceCount; ///< what it has to hold; faces may be PVT_DRACO_ANY
    uint64_t mostFaces;             ///< for that case
} pvtDracoStream;

typedef enum pvtDracoStatus {
    PVT_DRACO_DONE,
    PVT_DRACO_INVALID,  ///< `text` says why
    PVT_DRACO_MISCOUNT, ///< it holds `pointCount` points and `faceCount` faces
    PVT_DRACO_OUT_OF_MEMORY,
} pvtDracoStatus;

/// Written last, so that it is there only behind a whole result; but `current` stands there from
/// the begin, so that it tells where a crash was. Behind it: one mesh a stream, one attribute an
/// id, and data.
typedef struct pvtDracoHeader {
    char magic[8];
    uint32_t version;
    uint32_t status;  ///< pvtDracoStatus, of stream `current`
    uint64_t current; ///< the stream that is being decoded
    uint64_t pointCount, faceCount;
    char text[PVT_DRACO_TEXT_SIZE];
} pvtDracoHeader;

typedef struct pvtDracoMesh {
    uint64_t faceCount;
    uint64_t indices; ///< [bytes] in the result, of 3 × faceCount uint32_t
} pvtDracoMesh;

/// One element a point of the stream, one behind the other.
typedef struct pvtDracoAttribute {
    uint32_t isFound;        ///< 0: the stream has no attribute of this id
    uint32_t componentType;  ///< as glTF numbers them; 0: it has none for it
    uint32_t componentCount; ///< of an element
    uint32_t reserved;
    uint64_t data; ///< [bytes] in the result
} pvtDracoAttribute;

#endif
