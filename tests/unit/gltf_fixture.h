// SPDX-License-Identifier: MIT
// A cube in glTF, for the tests of the glTF reader.
#ifndef PVT_TEST_GLTF_FIXTURE_H
#define PVT_TEST_GLTF_FIXTURE_H

#include "file_fixture.h"

static inline pvtStatus LoadFile(Fixture* f, const char* name)
{
    pvtModel_Free(f->context, &f->model);
    f->warnings.text[0] = '\0';
    return pvtLoadModel(f->context, &f->options, InFolder(&f->folder, name), &f->model);
}

static inline pvtStatus LoadGlb(Fixture* f, const char* json, const Pack* binary)
{
    WriteGlb(InFolder(&f->folder, "model.glb"), json, binary);
    return LoadFile(f, "model.glb");
}

// The file's name, and the reason.
static inline void CheckRefused(Fixture* f, pvtStatus status, pvtStatus expected,
                                const char* reason)
{
    if (status != expected) {
        fail_msg("status %d, not %d: %s", (int)status, (int)expected,
                 pvtContext_GetMessage(f->context));
    }
    CheckMessage(f->context, "model.gl");
    CheckMessage(f->context, reason);
    assert_int_equal(f->model.mesh.triangleCount, 0);
    assert_null(f->model.parts);
}

#define ASSET "'asset':{'version':'2.0'},"
#define CUBE_BUFFER                                                                                \
    "'buffers':[{'byteLength':168}],'bufferViews':[{'buffer':0,'byteLength':96},"                  \
    "{'buffer':0,'byteOffset':96,'byteLength':72}],"
#define CUBE_ACCESSORS                                                                             \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':8,'type':'VEC3'},"                  \
    "{'bufferView':1,'componentType':5123,'count':36,'type':'SCALAR'}],"
#define CUBE_MESH "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}]"
#define CUBE_DATA ASSET CUBE_BUFFER CUBE_ACCESSORS CUBE_MESH
#define CUBE "{" CUBE_DATA ",'nodes':[{'mesh':0}],'scenes':[{'nodes':[0]}]}"
#define CUBE_NODES(nodes) "{" CUBE_DATA ",'scenes':[{'nodes':[0]}],'nodes':[" nodes "]}"

static inline Pack PackCube(void)
{
    Pack pack = {.size = 0};
    PackBytes(&pack, kCubePositions, sizeof kCubePositions);
    PackBytes(&pack, kCubeIndices, sizeof kCubeIndices);
    return pack;
}

static inline pvtStatus LoadCube(Fixture* f, const char* json)
{
    const Pack cube = PackCube();
    return LoadGlb(f, json, &cube);
}

#endif
