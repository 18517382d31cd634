// SPDX-License-Identifier: MIT
// Framebuffers to draw into, and their bytes packed into bits.
#include "gl/gl_context.h"

#include "base/bits.h"
#include "base/context.h"

#include <string.h>

// The format and type that a sized internal format is uploaded with; no bytes are.
static void DescribeFormat(GLenum sized, GLenum* format, GLenum* type)
{
    switch (sized) {
    case GL_DEPTH24_STENCIL8:
        *format = GL_DEPTH_STENCIL;
        *type = GL_UNSIGNED_INT_24_8;
        break;
    case GL_DEPTH_COMPONENT32F:
        *format = GL_DEPTH_COMPONENT;
        *type = GL_FLOAT;
        break;
    default:
        *format = GL_RGBA;
        *type = GL_UNSIGNED_BYTE;
        break;
    }
}

static GLuint AttachTexture(const pvtGlFunctions* f, const pvtGlTargetDef* def, GLenum sized,
                            GLenum attachment)
{
    GLenum format, type;
    DescribeFormat(sized, &format, &type);
    GLuint texture = 0;
    f->GenTextures(1, &texture);
    f->BindTexture(GL_TEXTURE_2D, texture);
    f->TexImage2D(GL_TEXTURE_2D, 0, (GLint)sized, def->width, def->height, 0, format, type, NULL);
    f->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    f->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    f->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    f->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    f->FramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
    f->BindTexture(GL_TEXTURE_2D, 0);
    return texture;
}

static void AttachTextures(const pvtGlFunctions* f, const pvtGlTargetDef* def, pvtGlTarget* target)
{
    if (def->colorFormat != 0) {
        target->color = AttachTexture(f, def, def->colorFormat, GL_COLOR_ATTACHMENT0);
    }
    if (def->depthFormat != 0) {
        target->depth =
            AttachTexture(f, def, def->depthFormat,
                          def->depthFormat == GL_DEPTH24_STENCIL8 ? GL_DEPTH_STENCIL_ATTACHMENT
                                                                  : GL_DEPTH_ATTACHMENT);
    }
    const GLenum buffer = def->colorFormat != 0 ? GL_COLOR_ATTACHMENT0 : GL_NONE;
    f->DrawBuffer(buffer);
    f->ReadBuffer(buffer);
}

pvtStatus pvtCreateGlTarget(pvtContext* context, pvtGl* gl, const pvtGlTargetDef* def,
                            pvtGlTarget* target)
{
    *target = (pvtGlTarget){0};
    if (def->width > gl->maxSize || def->height > gl->maxSize) {
        return pvtFail(context, PVT_LIMIT,
                       "%d × %d pixels are more than the %d a side that %s can do; lower the "
                       "resolution",
                       def->width, def->height, gl->maxSize, gl->name);
    }
    const pvtGlFunctions* f = &gl->functions;
    pvtGlTarget made = {.width = def->width, .height = def->height};
    f->GenFramebuffers(1, &made.framebuffer);
    f->BindFramebuffer(GL_FRAMEBUFFER, made.framebuffer);
    AttachTextures(f, def, &made);
    pvtStatus status = pvtCheckGl(context, gl, "make a framebuffer");
    if (status == PVT_OK && f->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        status = pvtFail(context, PVT_UNSUPPORTED, "%s cannot draw into a framebuffer of %d × %d",
                         gl->name, def->width, def->height);
    }
    if (status != PVT_OK) {
        pvtGlTarget_Free(gl, &made);
        return status;
    }
    *target = made;
    return PVT_OK;
}

void pvtGlTarget_Free(pvtGl* gl, pvtGlTarget* target)
{
    gl->functions.DeleteFramebuffers(1, &target->framebuffer);
    gl->functions.DeleteTextures(1, &target->color);
    gl->functions.DeleteTextures(1, &target->depth);
    *target = (pvtGlTarget){0};
}

void pvtPackBitmap(const uint8_t* bytes, uint8_t value, pvtBitmap* bitmap)
{
    for (int y = 0; y < bitmap->height; ++y) {
        const uint8_t* from = bytes + (size_t)y * (size_t)bitmap->width;
        uint64_t* row = bitmap->words + (size_t)y * bitmap->wordsPerRow;
        memset(row, 0, bitmap->wordsPerRow * sizeof *row);
        for (size_t x = 0; x < (size_t)bitmap->width; ++x) {
            row[x >> 6] |= (uint64_t)(from[x] == value) << (x & 63);
        }
    }
}
