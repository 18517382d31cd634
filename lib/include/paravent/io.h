// SPDX-License-Identifier: MIT
// Models and images, in and out.
#ifndef PARAVENT_IO_H
#define PARAVENT_IO_H

#include <paravent/image.h>
#include <paravent/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What to do with glTF materials whose alphaMode is MASK. AUTO: their alpha decides, texel by
/// texel, and triangles are cut to what is opaque of them for sure; where a texture cannot be
/// looked at it is SKIP. OPAQUE: as if they had no mask. SKIP: they are left out. What is left out
/// is told by a warning.
typedef enum pvtMasked { PVT_MASKED_AUTO, PVT_MASKED_OPAQUE, PVT_MASKED_SKIP } pvtMasked;

typedef struct pvtLoadOptions {
    int scene;        ///< −1: the default scene, or the first; else its index; default −1
    const char* node; ///< only nodes of this name and what is below them; null: everything
    pvtMasked masked; ///< default PVT_MASKED_AUTO
    /// How closely masked textures are looked at: texels are taken together, as long as they stay
    /// smaller than the model's longest side over this (with keepMeshes: each mesh's own), and are
    /// opaque when all of them are. Coarser means fewer triangles, and less of the opaque parts,
    /// never more. 1 to 65536; default 1024.
    int maskedResolution;
    double maskedCell; ///< [wu] > 0: texels are taken together up to this size instead; default 0
    size_t maxBytes;   ///< of any one file; default 4 GiB
    bool keepMeshes;   ///< fill pvtModel's meshes too; default false
} pvtLoadOptions;

/// One instance of a mesh by a node: a run of triangles of the model's mesh. Where a node of OBJ,
/// FBX or DAE has several meshes, they are taken as one.
typedef struct pvtModelPart {
    char* name; ///< the node's, else the mesh's, else "node_12"; UTF-8
    size_t firstTriangle, triangleCount;
    size_t meshIndex;     ///< parts with the same number are instances of the same mesh: of
                          ///< pvtModel's meshes, where they are kept
    double transform[16]; ///< mesh to world, column after column
} pvtModelPart;

/// A file's triangles with world transforms applied; mirrored instances are wound the right way.
typedef struct pvtModel {
    pvtMesh mesh;
    pvtModelPart* parts;
    size_t partCount;
    pvtMesh* meshes; ///< with keepMeshes: each in its own space; empty where no part takes it
    size_t meshCount;
} pvtModel;

PVT_API pvtLoadOptions pvtDefaultLoadOptions(void);

/// glTF and GLB by their contents; OBJ, PLY, STL, FBX and DAE by their names' endings. glTF reads
/// the buffers beside the file, and nothing outside of its folder; no other format opens a second
/// file. Triangles with positions that are not finite, or too large for a float, are dropped with a
/// warning; blended materials are left out with one, and skins and morph targets give their bind
/// pose with one: the mesh as it was modelled, where the joint nearest to the root puts it, and the
/// base shape whatever the weights. PVT_INVALID_INPUT names file, place, reason and remedy;
/// PVT_UNSUPPORTED names the format or the required extension that is missing; PVT_INVALID_ARGUMENT
/// the scene or node that is not there. A file without any triangle is PVT_INVALID_INPUT, and so is
/// one that contradicts itself: counts, ranges and bounds are held against the data. One all of
/// whose surface is masked away is PVT_NOTHING_INSIDE. Textures of masked materials are read as
/// PNG, JPEG or WebP, by OpenImageIO (see pvtLoadImage), which only a file with such a texture
/// opens.
///
/// OBJ, PLY, STL, FBX and DAE are parsed by assimp in a process of its own, the program
/// paravent-import, and what KHR_draco_mesh_compression holds by paravent-draco. They are looked
/// for in the folders of PARAVENT_MODULE_PATH, then in "paravent" and "../lib/paravent" beside the
/// program or library, then where they were installed; PVT_UNSUPPORTED without them.
PVT_API pvtStatus pvtLoadModel(pvtContext* context, const pvtLoadOptions* options, const char* path,
                               pvtModel* model);
PVT_API void pvtModel_Free(pvtContext* context, pvtModel* model);
/// Whether the file begins as GLB or glTF does, whatever its name; false also when it cannot be
/// read.
PVT_API bool pvtIsGltf(pvtContext* context, const char* path);

/// A number or a text to store with a node: under extras.paravent of glTF, and as the entry
/// "paravent" of the metadata of Godot's nodes.
typedef struct pvtExtra {
    const char* key;
    double number;
    const char* text; ///< not null: instead of the number
} pvtExtra;

/// A node at the root of the file.
typedef struct pvtSaveItem {
    const char* name;
    const pvtMesh* mesh;
    const pvtExtra* extras;
    size_t extraCount;
    /// 16 numbers, mesh to world, column after column; null: none. In glTF and in Godot's scenes
    /// items with the same `mesh` share it, and the node gets the transform; a transform with
    /// shear, and any in other formats, moves a copy of the mesh.
    const double* transform;
} pvtSaveItem;

/// Writes .glb, .gltf (with its buffer inside), .obj, .ply or .tscn by the path's ending; whole or
/// not at all. A .tscn is a scene of Godot 4 with an OccluderInstance3D an item. PVT_UNSUPPORTED
/// for another ending, PVT_OUTPUT_FAILED with the reason.
PVT_API pvtStatus pvtSaveModel(pvtContext* context, const char* path, const pvtSaveItem* items,
                               size_t count);
/// Whether pvtSaveModel knows the path's ending: to be asked before the long work.
PVT_API bool pvtCanSaveModel(const char* path);

/// Levels of detail of one thing, from fine to coarse, and what stands beside them.
typedef struct pvtLevelSet {
    const pvtSaveItem* levels;
    size_t levelCount; ///< at least 1
    /// One a level: the screen coverage down to which it is shown, as MSFT_screencoverage has it.
    /// The first level's node names the others by the extension MSFT_lod; they are in no scene.
    /// Null: all levels are plain nodes of the scene.
    const double* coverages;
    const pvtSaveItem* others; ///< further nodes, in front of the levels
    size_t otherCount;
    /// A GLB or glTF whose whole contents come first: nodes, meshes, materials, animations and
    /// what this library does not know. Its buffers become one, and images beside it are taken in.
    /// Null: none.
    const char* original;
    int scene; ///< of the original that the nodes join; −1: the default scene, or the first
} pvtLevelSet;

/// Writes .glb or .gltf, which alone have levels; else as pvtSaveModel does.
PVT_API pvtStatus pvtSaveLevels(pvtContext* context, const char* path, const pvtLevelSet* set);
/// Whether pvtSaveLevels knows the path's ending.
PVT_API bool pvtCanSaveLevels(const char* path);

/// PNG, by OpenImageIO, which is opened at the first call; PVT_UNSUPPORTED without it. Its module
/// paravent_image.so is looked for in the same places as paravent-import.
PVT_API pvtStatus pvtSaveImage(pvtContext* context, const char* path, const pvtImage* image);
/// Any format that OpenImageIO reads.
PVT_API pvtStatus pvtLoadImage(pvtContext* context, const char* path, pvtImage* image);

#ifdef __cplusplus
}
#endif
#endif
