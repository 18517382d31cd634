// SPDX-License-Identifier: MIT
// Programs from the shaders that are built into the library.
#include "gl/gl_context.h"

#include "base/context.h"
#include "gl/shaders.h"

typedef struct Sources {
    const char *name, *vertex, *fragment;
} Sources;

static const Sources programSources[PVT_PROGRAM_COUNT] = {
    [PVT_PROGRAM_SLICE] = {"slice", pvtShaderSliceVert, pvtShaderOneFrag},
    [PVT_PROGRAM_SILHOUETTE] = {"silhouette", pvtShaderSilhouetteVert, pvtShaderOneFrag},
    [PVT_PROGRAM_SURFACE] = {"surface", pvtShaderSurfaceVert, pvtShaderNormalFrag},
    [PVT_PROGRAM_OCCLUDER] = {"occluder", pvtShaderSurfaceVert, pvtShaderOccluderFrag},
    [PVT_PROGRAM_EDGE] = {"edge", pvtShaderEdgeVert, pvtShaderEdgeFrag},
    [PVT_PROGRAM_RESOLVE] = {"resolve", pvtShaderResolveVert, pvtShaderResolveFrag},
};

// 0 when it does not compile; then `log` says why.
static GLuint CompileShader(const pvtGlFunctions* f, GLenum type, const char* source, char* log)
{
    const GLuint shader = f->CreateShader(type);
    f->ShaderSource(shader, 1, &source, NULL);
    f->CompileShader(shader);
    GLint done = 0;
    f->GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        f->GetShaderInfoLog(shader, PVT_GL_LOG_SIZE, NULL, log);
        f->DeleteShader(shader);
        return 0;
    }
    return shader;
}

static GLuint LinkProgram(const pvtGlFunctions* f, GLuint vertex, GLuint fragment, char* log)
{
    const GLuint program = f->CreateProgram();
    f->AttachShader(program, vertex);
    f->AttachShader(program, fragment);
    f->LinkProgram(program);
    GLint done = 0;
    f->GetProgramiv(program, GL_LINK_STATUS, &done);
    if (!done) {
        f->GetProgramInfoLog(program, PVT_GL_LOG_SIZE, NULL, log);
        f->DeleteProgram(program);
        return 0;
    }
    return program;
}

static GLuint BuildProgram(const pvtGlFunctions* f, const Sources* sources, char* log)
{
    GLuint program = 0;
    const GLuint vertex = CompileShader(f, GL_VERTEX_SHADER, sources->vertex, log);
    if (vertex == 0) {
        return 0;
    }
    const GLuint fragment = CompileShader(f, GL_FRAGMENT_SHADER, sources->fragment, log);
    if (fragment != 0) {
        program = LinkProgram(f, vertex, fragment, log);
        f->DeleteShader(fragment);
    }
    f->DeleteShader(vertex);
    return program;
}

pvtStatus pvtGetGlProgram(pvtContext* context, pvtGl* gl, pvtGlProgram which, GLuint* program)
{
    if (gl->programs[which] == 0) {
        char log[PVT_GL_LOG_SIZE] = "";
        const Sources* sources = &programSources[which];
        gl->programs[which] = BuildProgram(&gl->functions, sources, log);
        if (gl->programs[which] == 0) {
            return pvtFail(context, PVT_UNSUPPORTED, "%s: the driver refuses the shader \"%s\": %s",
                           gl->name, sources->name, log);
        }
    }
    *program = gl->programs[which];
    return PVT_OK;
}
