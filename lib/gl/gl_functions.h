// SPDX-License-Identifier: MIT
// The OpenGL functions that this library calls, as a table that each context fills for itself:
// two contexts of different libraries in one process must never meet in one global symbol.
#ifndef PVT_GL_FUNCTIONS_H
#define PVT_GL_FUNCTIONS_H

#include <GL/glcorearb.h>

/// X(TYPE, Name): member Name of type PFNGL<TYPE>PROC, loaded as "gl<Name>".
#define PVT_GL_FUNCTIONS(X)                                                                        \
    X(ACTIVETEXTURE, ActiveTexture)                                                                \
    X(ATTACHSHADER, AttachShader)                                                                  \
    X(BINDBUFFER, BindBuffer)                                                                      \
    X(BINDFRAMEBUFFER, BindFramebuffer)                                                            \
    X(BINDTEXTURE, BindTexture)                                                                    \
    X(BINDVERTEXARRAY, BindVertexArray)                                                            \
    X(BLENDFUNCSEPARATE, BlendFuncSeparate)                                                        \
    X(BUFFERDATA, BufferData)                                                                      \
    X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus)                                              \
    X(CLEAR, Clear)                                                                                \
    X(CLEARCOLOR, ClearColor)                                                                      \
    X(COMPILESHADER, CompileShader)                                                                \
    X(CREATEPROGRAM, CreateProgram)                                                                \
    X(CREATESHADER, CreateShader)                                                                  \
    X(DELETEBUFFERS, DeleteBuffers)                                                                \
    X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                                                      \
    X(DELETEPROGRAM, DeleteProgram)                                                                \
    X(DELETESHADER, DeleteShader)                                                                  \
    X(DELETETEXTURES, DeleteTextures)                                                              \
    X(DELETEVERTEXARRAYS, DeleteVertexArrays)                                                      \
    X(DEPTHFUNC, DepthFunc)                                                                        \
    X(DEPTHMASK, DepthMask)                                                                        \
    X(DISABLE, Disable)                                                                            \
    X(DRAWARRAYS, DrawArrays)                                                                      \
    X(DRAWARRAYSINSTANCED, DrawArraysInstanced)                                                    \
    X(DRAWBUFFER, DrawBuffer)                                                                      \
    X(DRAWELEMENTS, DrawElements)                                                                  \
    X(ENABLE, Enable)                                                                              \
    X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)                                            \
    X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D)                                                  \
    X(FRONTFACE, FrontFace)                                                                        \
    X(GENBUFFERS, GenBuffers)                                                                      \
    X(GENFRAMEBUFFERS, GenFramebuffers)                                                            \
    X(GENTEXTURES, GenTextures)                                                                    \
    X(GENVERTEXARRAYS, GenVertexArrays)                                                            \
    X(GETERROR, GetError)                                                                          \
    X(GETINTEGERV, GetIntegerv)                                                                    \
    X(GETPROGRAMINFOLOG, GetProgramInfoLog)                                                        \
    X(GETPROGRAMIV, GetProgramiv)                                                                  \
    X(GETSHADERINFOLOG, GetShaderInfoLog)                                                          \
    X(GETSHADERIV, GetShaderiv)                                                                    \
    X(GETSTRING, GetString)                                                                        \
    X(GETUNIFORMLOCATION, GetUniformLocation)                                                      \
    X(LINKPROGRAM, LinkProgram)                                                                    \
    X(PIXELSTOREI, PixelStorei)                                                                    \
    X(READBUFFER, ReadBuffer)                                                                      \
    X(READPIXELS, ReadPixels)                                                                      \
    X(SCISSOR, Scissor)                                                                            \
    X(SHADERSOURCE, ShaderSource)                                                                  \
    X(STENCILFUNC, StencilFunc)                                                                    \
    X(STENCILOPSEPARATE, StencilOpSeparate)                                                        \
    X(TEXIMAGE2D, TexImage2D)                                                                      \
    X(TEXPARAMETERI, TexParameteri)                                                                \
    X(UNIFORM1F, Uniform1f)                                                                        \
    X(UNIFORM1I, Uniform1i)                                                                        \
    X(UNIFORM2F, Uniform2f)                                                                        \
    X(UNIFORM3F, Uniform3f)                                                                        \
    X(UNIFORM3I, Uniform3i)                                                                        \
    X(UNIFORMMATRIX4FV, UniformMatrix4fv)                                                          \
    X(USEPROGRAM, UseProgram)                                                                      \
    X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                                                    \
    X(VERTEXATTRIBIPOINTER, VertexAttribIPointer)                                                  \
    X(VERTEXATTRIBPOINTER, VertexAttribPointer)                                                    \
    X(VIEWPORT, Viewport)

typedef struct pvtGlFunctions {
#define PVT_GL_MEMBER(TYPE, Name) PFNGL##TYPE##PROC Name;
    PVT_GL_FUNCTIONS(PVT_GL_MEMBER)
#undef PVT_GL_MEMBER
} pvtGlFunctions;

#endif
