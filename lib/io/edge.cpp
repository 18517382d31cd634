// SPDX-License-Identifier: MIT
#include "edge.hpp"

#include <cstdio>

namespace pvt
{

namespace
{

// As long as a context's message.
constexpr std::size_t kTextSize = 2048;

} // namespace

void Refuse(const pvtLoadJob& job, const char* format, ...)
{
    char text[kTextSize];
    va_list arguments;
    va_start(arguments, format);
    (void)std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    throw Failure{pvtFail(job.context, PVT_INVALID_INPUT, "%s: %s", job.path, text)};
}

void Refuse(const pvtLoadJob& job, pvtStatus status, const char* format, ...)
{
    char text[kTextSize];
    va_list arguments;
    va_start(arguments, format);
    (void)std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    throw Failure{pvtFail(job.context, status, "%s: %s", job.path, text)};
}

void Warn(const pvtLoadJob& job, const char* format, ...)
{
    char text[kTextSize];
    va_list arguments;
    va_start(arguments, format);
    (void)std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pvtLog(job.context, PVT_LOG_WARNING, "%s: %s", job.path, text);
}

std::string CopyClean(pvtContext* context, const char* text)
{
    char* clean = pvtCopyCleanText(context, text);
    if (clean == nullptr) {
        throw Failure{pvtContext_GetStatus(context)};
    }
    std::string copy;
    try {
        copy = clean;
    } catch (...) {
        pvtRelease(context, clean);
        throw;
    }
    pvtRelease(context, clean);
    return copy;
}

} // namespace pvt
