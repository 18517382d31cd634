// SPDX-License-Identifier: MIT
#include "child_main.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>

namespace pvt
{

namespace
{

void SetLimit(__rlimit_resource resource, rlim_t most)
{
    rlimit limit{};
    if (getrlimit(resource, &limit) == 0) {
        limit.rlim_cur = std::min(limit.rlim_max, most);
        limit.rlim_max = limit.rlim_cur;
        (void)setrlimit(resource, &limit);
    }
}

} // namespace

void SetChildLimits(const char* memory, const char* seconds)
{
    SetLimit(RLIMIT_CORE, 0);
    // Above the first limit a signal that tells why, above the second the end.
    const rlim_t most = std::strtoull(seconds, nullptr, 10);
    rlimit time{most, most + 5};
    (void)setrlimit(RLIMIT_CPU, &time);
    SetLimit(RLIMIT_NOFILE, PVT_CHILD_ALIVE + 1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(PVT_CHILD_SANITIZED)
    SetLimit(RLIMIT_AS, std::strtoull(memory, nullptr, 10));
#else
    (void)memory; // a sanitizer's own map is larger than any limit
#endif
}

Input MapChildInput()
{
    struct stat info {
    };
    if (fstat(PVT_CHILD_INPUT, &info) != 0 || info.st_size <= 0) {
        throw std::runtime_error("it cannot be read");
    }
    const std::size_t size = static_cast<std::size_t>(info.st_size);
    void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, PVT_CHILD_INPUT, 0);
    if (bytes == MAP_FAILED) {
        throw std::bad_alloc();
    }
    return {static_cast<const char*>(bytes), size};
}

} // namespace pvt
