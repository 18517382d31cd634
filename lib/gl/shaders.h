// SPDX-License-Identifier: MIT
// The files of shaders/ as strings: "slice.vert" is pvtShaderSliceVert. cmake/PvtShaders.cmake
// writes their definitions at build time.
#ifndef PVT_GL_SHADERS_H
#define PVT_GL_SHADERS_H

extern const char pvtShaderEdgeFrag[];
extern const char pvtShaderEdgeVert[];
extern const char pvtShaderNormalFrag[];
extern const char pvtShaderOccluderFrag[];
extern const char pvtShaderOneFrag[];
extern const char pvtShaderResolveFrag[];
extern const char pvtShaderResolveVert[];
extern const char pvtShaderSilhouetteVert[];
extern const char pvtShaderSliceVert[];
extern const char pvtShaderSurfaceVert[];

#endif
